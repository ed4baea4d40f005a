"""The refit of the plain device, by which the strength of a hidden effect is measured."""

from types import SimpleNamespace

import numpy as np
import pytest

from dea.least_squares import Damping, minimise
from dea.plant.hidden.refit import Yardstick, _Refit

T = np.linspace(0.0, 1.0, 200)


def respond(x):
    """A device that changes with one parameter, and breaks beyond a quarter."""
    return np.sin((6.0 + x[0]) * T) if x[0] < 0.25 else np.full(T.size, np.nan)


def test_a_refit_does_not_end_where_the_device_breaks():
    step = 1e-6
    slope = (respond(np.array([step])) - respond(np.zeros(1))) / step
    basis = np.column_stack([slope, respond(np.zeros(1)), np.ones(T.size)])
    plain = SimpleNamespace(
        respond=respond, response=respond(np.zeros(1)), size=1, basis=basis,
        linearised=lambda x, response: basis,
    )  # fmt: skip
    refit = _Refit(plain, 2.0 * np.sin(6.24 * T) + 0.1)
    assert refit.evaluate(np.array([0.3])).cost == np.inf
    found = minimise(refit, np.zeros(1), Damping(), iterations=30, tolerance=1e-9)
    assert found.x[0] == pytest.approx(0.24, abs=0.005)
    assert found.cost < 1e-3


def test_what_a_refit_leaves_of_a_linear_device_is_its_distance_from_all_readings():
    rng = np.random.default_rng(2)
    response, slopes = np.sin(6.0 * T), np.column_stack([np.cos(6.0 * T), T, T**2])
    plain = SimpleNamespace(
        respond=lambda x: response + slopes @ x, response=response, size=3, unchanged=np.zeros(3),
        basis=np.column_stack([slopes, response, np.ones(T.size)]),
        linearised=lambda x, now: np.column_stack([slopes, now, np.ones(T.size)]),
    )  # fmt: skip
    reading = 1.2 * response + slopes @ [0.2, -0.1, 0.3] + 0.5 + 0.03 * rng.standard_normal(T.size)
    best, *_ = np.linalg.lstsq(plain.basis, reading, rcond=None)
    left = np.sqrt(np.mean((reading - plain.basis @ best) ** 2))
    assert Yardstick.unexplained(plain, reading) == pytest.approx(left, rel=1e-4)
