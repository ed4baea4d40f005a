"""Built-in devices against their published equations, written again and solved by LSODA."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dea.simulation import ExtendedSimulation, load_simulation


def torricelli(t, levels, u, upper_out, lower_in, lower_out, pump):
    upper, lower = np.sqrt(np.maximum(levels, 0.0))
    return [pump * u - upper_out * upper, lower_in * upper - lower_out * lower]


def drive(t, state, u, winding, motor, frequency, damping, gain):
    """Wigren and Schoukens (2017): two lags of motors, then the resonance of pulley and belt."""
    current, speed, pulley, rate = state
    omega = 2.0 * np.pi * frequency
    return [
        (u - current) / winding,
        (gain * current - speed) / motor,
        rate,
        omega**2 * (speed - pulley) - 2.0 * damping * omega * rate,
    ]


def oscillator(t, state, u, frequency, damping, gain):
    omega = 2.0 * np.pi * frequency
    return [state[1], omega**2 * (gain * u - state[0]) - 2.0 * damping * omega * state[1]]


def lag(t, state, u, time, gain):
    return [(gain * u - state[0]) / time]


@pytest.mark.parametrize(
    ("name", "law", "measured", "start", "values", "low", "interval"),
    [
        ("cascaded_tanks", torricelli, 1, [4.0, 7.0], [0.06, 0.05, 0.04, 0.03], 1.0, 4.0),
        ("electric_drive", drive, 2, [0.3, 1.0, 0.5, 2.0], [0.03, 0.3, 2.0, 0.3, 1.7], -1.0, 0.02),
        ("mass_spring_damper", oscillator, 0, [0.05, 2.0], [8.0, 0.3, 1.4], -1.0, 0.01),
        ("piezo_stage", lag, 0, [30.0], [0.02, 12.0], 0.0, 0.01),
    ],
)
def test_a_device_follows_its_published_equations(
    name, law, measured, start, values, low, interval
):
    held = replace(load_simulation(name), input_interpolation="zero")
    extended = ExtendedSimulation(held, substeps=16)
    given = extended.layout.prior_means
    given[: len(values) + len(start)] = values + start
    u = np.random.default_rng(1).uniform(low, 3.0, 80)
    state, expected = np.array(start), []
    for each in u:
        expected.append(state[measured])
        solved = solve_ivp(
            law, (0.0, interval), state, args=(each, *values), method="LSODA", rtol=1e-9, atol=1e-12
        )
        state = solved.y[:, -1]
    found = extended.simulate(given, u, interval)
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.std(expected))
