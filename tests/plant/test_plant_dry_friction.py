"""Dry friction on the devices against an implicit method of SciPy with its own step."""

import numpy as np
import pytest
from films import nominal
from scipy.integrate import solve_ivp

from dea.plant.drive import Drive, turn
from dea.plant.film import GRAVITY, STIFFNESS, SUBSTEP, Y, move
from dea.plant.force_laws.friction import LORENTZIAN, STRIBECK
from dea.plant.forces import ForceLaw, stack

# Sliding and static force, Stribeck speed, speed of regularisation: in shares of the largest force
# that the spring changes by, and of the speed of the motion.
SHARES = {
    "stribeck": (STRIBECK, (0.1, 0.15, 0.3, 0.003)),
    "lorentzian": (LORENTZIAN, (0.2, 0.25, 0.5, 0.03)),
}


def stribeck(c, v):
    return (c[0] + (c[1] - c[0]) * np.exp(-abs(v) / c[2])) * v / np.hypot(v, c[3])


def lorentzian(c, v):
    return (c[0] + (c[1] - c[0]) / (1 + (v / c[2]) ** 2)) * v / np.hypot(v, c[3])


LAWS = {"stribeck": stribeck, "lorentzian": lorentzian}


def solved(acceleration, duration, start):
    """Positions at every sub-step by LSODA."""
    times = SUBSTEP * np.arange(round(duration / SUBSTEP))
    found = solve_ivp(
        lambda t, x: [x[1], acceleration(t, *x)], (0, duration), start, "LSODA", times,
        rtol=1e-9, atol=1e-13, max_step=2e-3,
    )  # fmt: skip
    return found.y[0]


@pytest.mark.parametrize("law", SHARES)
def test_a_ball_on_a_film_of_swinging_stiffness_sticks_and_slides(law):
    film, mean, rate = nominal(damping=4.0), 48.0, 2 * np.pi * 0.8
    rest, travel = film.mass * GRAVITY / mean, 4e-4
    kind, shares = SHARES[law]
    scale = np.array([mean * travel] * 2 + [rate * travel] * 2)
    constants = shares * scale
    swing = travel / rest

    def stiffness(t):
        return mean / (1 + swing * np.sin(rate * t))

    def acceleration(t, y, v):
        dry = LAWS[law](constants, v)
        return GRAVITY - (film.damping * v + stiffness(t) * y + dry) / film.mass

    scalars, row = np.zeros(STIFFNESS + 1), stack([ForceLaw(kind, constants)])
    scalars[Y] = rest
    positions = []
    for k in range(3000):
        positions.append(scalars[Y])
        move(film, scalars, row, stiffness((k + 0.5) * SUBSTEP), SUBSTEP)
    exact = solved(acceleration, 3.0, [rest, 0.0])
    np.testing.assert_allclose(positions, exact, atol=2e-3 * travel)
    assert np.ptp(exact) > 0.5 * travel


@pytest.mark.slow
@pytest.mark.parametrize("law", SHARES)
def test_a_drive_sticks_and_slides(law):
    drive, rate, size = Drive(), 2 * np.pi * 0.7, 2.0
    travel = drive.gain * size / drive.stiffness
    kind, shares = SHARES[law]
    constants = shares * np.array([drive.stiffness * travel] * 2 + [rate * travel] * 2)
    command = size * np.sin(rate * SUBSTEP * np.arange(3000))

    def acceleration(t, y, v):
        held = command[min(int(t / SUBSTEP + 1e-9), command.size - 1)]
        return drive.gain * held - drive.damping * v - drive.stiffness * y - LAWS[law](constants, v)

    angle = np.empty_like(command)
    turn(drive, np.zeros(2), stack([ForceLaw(kind, constants)]), command, angle)
    exact = solved(acceleration, 3.0, [0.0, 0.0])
    np.testing.assert_allclose(angle, exact, atol=2e-3 * travel)
