"""Leakage of charge, against other integrators, states of rest and a high-pass filter."""

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import U
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dea.simulation import catalogue


@pytest.mark.parametrize(("growth", "quickening"), [(0.0, 0.0), (2.0, 0.0), (2.0, 1.5)])
def test_charge_leakage_solves_its_differential_equation(growth, quickening):
    loss, tau, part, fine = 0.3, 2.0, 0.4, 200
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=tau, start_part=part,
        full_field=4.0, quickening=quickening,
    )  # fmt: skip

    def speed(field):
        return np.exp(quickening * abs(field) / 4.0) / (tau * (1.0 + loss))

    def target(field):
        return loss * np.exp(growth * (abs(field) / 4.0 - 1.0)) * field

    # At the start the part of what is lost in the end, as far as the loss does not grow on the way.
    whole = target(U[0]) / U[0]
    lost, expected = part * U[0] * whole / (1.0 + whole), []
    for u in U:
        total = 0.0
        for _ in range(fine):
            before = lost
            lost += DT / fine * (target(u - lost) - lost) * speed(u - lost)
            total += u - 0.5 * (before + lost)
        expected.append(total / fine)
    assert np.allclose(catalogue()["charge_leakage"].shape_input(U, q, DT), expected, atol=5e-3)


@pytest.mark.parametrize("quickening", [0.0, 2.0])
def test_half_the_interval_leaves_a_quarter_of_the_error_of_a_leaking_charge(quickening):
    loss, growth, tau, peak, interval = 0.5, 4.0, 1.0, 3.0, 0.1
    u = 0.3 + 3.0 * np.sin(0.15 * np.arange(80))
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=tau, start_part=0.5,
        full_field=peak, quickening=quickening,
    )  # fmt: skip

    def slope(_, x, level):
        field = level - x[0]
        target = loss * np.exp(growth * (abs(field) / peak - 1.0)) * field
        speed = np.exp(quickening * abs(field) / peak) / (tau * (1.0 + loss))
        return [(target - x[0]) * speed, field]

    whole = loss * np.exp(growth * (u[0] / peak - 1.0))
    lost, expected = 0.5 * whole / (1.0 + whole) * u[0], []
    for level in u:
        solved = solve_ivp(
            slope, (0, interval), [lost, 0.0], "LSODA", args=(level,), rtol=1e-9, atol=1e-11
        )
        lost, area = solved.y[:, -1]
        expected.append(area / interval)
    errors = []
    for parts in (1, 2, 4):
        found = catalogue()["charge_leakage"].shape_input(np.repeat(u, parts), q, interval / parts)
        errors.append(np.std(found.reshape(-1, parts).mean(1) - expected))
    assert errors[0] < 5e-3
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.15)


@pytest.mark.parametrize("level", [1.0, 3.0, -3.0])
@pytest.mark.parametrize("start_part", [0.0, 2.0])
@pytest.mark.parametrize(("growth", "quickening"), [(9.0, 6.0), (20.0, 8.0), (20.0, 0.0)])
def test_a_leaking_charge_settles_under_a_held_input(growth, quickening, start_part, level):
    """The shortest time constant and the largest loss: the field settles where the loss stays."""
    loss, peak, u = 0.9, 3.0, np.full(2000, level)
    q = values(
        "charge_leakage", loss=loss, field_growth=growth, settling_time=10 * DT, full_field=peak,
        start_part=start_part, quickening=quickening,
    )  # fmt: skip
    settled = brentq(
        lambda field: field + loss * np.exp(growth * (field / peak - 1.0)) * field - abs(level),
        0.0, abs(level), xtol=1e-12,
    )  # fmt: skip
    found = catalogue()["charge_leakage"].shape_input(u, q, DT)
    np.testing.assert_allclose(found[-200:], np.sign(level) * settled, rtol=1e-9)


@pytest.mark.parametrize("tau", [0.5, 3.0])
def test_a_charge_that_leaks_as_a_whole_is_a_high_pass_filter(tau):
    q = values(
        "charge_leakage", loss=1e3, field_growth=0.0, settling_time=tau, start_part=1.0
    )  # fmt: skip
    found = catalogue()["charge_leakage"].shape_input(U, q, DT)
    # Over a step at a held input, the mean of what a capacitor in series leaves.
    after, decay = [], np.exp(-DT / tau)
    charge = U[0]
    for u in U:
        after.append((u - charge) * tau / DT * (1.0 - decay))
        charge = u + (charge - u) * decay
    np.testing.assert_allclose(found, after, atol=3e-3 * np.ptp(U))
    lost, settling = catalogue()["charge_leakage"].quantities
    assert lost.of(q, SCALES) == pytest.approx(1000.0 / 1001.0)
    assert settling.of(q, SCALES) == tau
