"""A device with a second mass against the equations of both, integrated together."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built
from numba import njit
from scipy.integrate import solve_ivp

from dea.plant.drive import Drive, _step
from dea.plant.force_laws import mode
from dea.plant.forces import stack, update_memory

DRIVE, SECONDS, PERIOD = Drive(), 2.0, 0.4


def command(t):
    """A command that changes where every step ends."""
    return 3.0 if t % PERIOD < 0.5 * PERIOD else 1.0


def law(form):
    conditions = CONDITIONS._replace(
        stiffness=DRIVE.stiffness, bottom=10.0, top=30.0, time=0.5, rest=0.0
    )
    return built("second_mode", form, 0.6, 3, conditions)[0]


@njit(cache=True)
def stepped(drive, forces, commands, dt):
    state, angles = np.zeros(2), np.zeros(commands.size + 1)
    for k in range(commands.size):
        _step(drive, state, forces, commands[k], dt, False)
        update_memory(forces, state[0], state[1], dt)
        angles[k + 1] = state[0]
    return angles


def found(form, dt):
    times = np.arange(round(SECONDS / dt)) * dt
    commands = np.array([command(t + 0.5 * dt) for t in times])
    return stepped(DRIVE, stack([law(form)]), commands, dt)


def spring(c, x):
    if c[5] == mode.PENDULUM:
        return c[1] * c[4] * np.sin(x / c[4])
    if c[5] == mode.BILINEAR:
        return c[1] * (x if x > 0.0 else c[4] * x)
    return c[1] * (x + x**3 / c[4] ** 2)


def single(c, s):
    pull = spring(c, s[0] - s[2]) + c[2] * (s[1] - s[3])
    return pull, [s[3], (pull - c[3] * s[3]) / c[0]]


def column(c, s):
    w = s[1] - s[3]
    pull = c[1] * (s[0] - s[2]) + c[2] * w + c[3] * w * abs(w)
    return pull, [s[3], pull / c[0]]


def twins(c, s):
    first, second = (
        c[3 * i + 1] * (s[0] - s[2 + 2 * i]) + c[3 * i + 2] * (s[1] - s[3 + 2 * i]) for i in (0, 1)
    )
    return first + second, [s[3], first / c[0], s[5], second / c[3]]


def series(c, s):
    low = c[1] * (s[0] - s[2]) + c[2] * (s[1] - s[3])
    high = c[4] * (s[2] - s[4]) + c[5] * (s[3] - s[5])
    return low, [s[3], (low - high) / c[0], s[5], high / c[3]]


def true(form, attached, masses):
    c = np.asarray(law(form).constants)
    state, angles = np.zeros(2 + 2 * masses), [[0.0]]

    def move(t, s, u):
        pull, ahead = attached(c, s)
        push = DRIVE.gain * u - DRIVE.damping * s[1] - DRIVE.stiffness * s[0]
        return [s[1], push - pull, *ahead]

    half = 0.5 * PERIOD
    for k in range(round(SECONDS / half)):
        u, times = command((k + 0.5) * half), np.linspace(0.0, half, round(half / 1e-3) + 1)
        solved = solve_ivp(
            move, (0.0, half), state, "DOP853", times, args=(u,), rtol=1e-9, atol=1e-9, max_step=0.1
        )
        state = solved.y[:, -1]
        angles.append(solved.y[0, 1:])
    return np.concatenate(angles)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("form", "attached", "masses"),
    [("hardening_absorber", single, 1), ("shared_damping", single, 1),
     ("breathing_crack", single, 1), ("grounded_damper", single, 1),
     ("sloshing_pendulum", single, 1), ("liquid_column", column, 1), ("twin_masses", twins, 2),
     ("masses_in_series", series, 2)],
)  # fmt: skip
def test_halving_the_step_quarters_the_error_of_a_device_with_a_second_mass(form, attached, masses):
    exact = true(form, attached, masses)
    wrong = [np.abs(found(form, 1e-3 / k)[::k] - exact).max() / np.ptp(exact) for k in (1, 2, 4)]
    assert wrong[0] < 3e-4
    assert np.log2(wrong[0] / wrong[2]) == pytest.approx(4.0, abs=0.4)
