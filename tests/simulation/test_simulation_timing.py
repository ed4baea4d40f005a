"""Outputs that are logged early or late by parts of a sample."""

import numpy as np
import pytest

from dea.simulation import load_simulation, prepared
from dea.simulation.timing import shifted


@pytest.mark.parametrize("samples", [-2.3, -1.0, -0.4, 0.25, 0.99, 1.0, 3.6])
def test_a_shifted_sine_is_that_of_the_other_instants(samples):
    t = np.arange(200.0)
    found = shifted(np.sin(0.2 * t), samples)
    np.testing.assert_allclose(found[10:-10], np.sin(0.2 * (t - samples))[10:-10], atol=1e-3)


def test_whole_samples_are_moved_unchanged():
    y = np.random.default_rng(1).standard_normal(50)
    assert shifted(y, 0.0) is y
    np.testing.assert_array_equal(shifted(y, 2.0)[2:], y[:-2])
    np.testing.assert_array_equal(shifted(y, -1.0)[:-1], y[1:])
    np.testing.assert_array_equal(shifted(y, 2.0)[:2], y[[0, 0]])


def test_the_derivative_by_the_shift_is_the_same_from_both_sides():
    y = np.random.default_rng(2).standard_normal(50)
    ahead, behind = ((shifted(y, s) - y) / s for s in (1e-6, -1e-6))
    np.testing.assert_allclose(ahead, behind, atol=1e-4)


def test_a_simulation_can_be_logged_late():
    u = np.repeat(np.random.default_rng(3).uniform(-1, 1, 20), 25)
    extended = prepared(load_simulation("mass_spring_damper"), u, 1e-3, 1e-5)
    values = extended.layout.prior_means
    plain = extended.simulate(values, u, 1e-3)
    values[extended.layout.names.index("timing_offset")] = 2e-3
    np.testing.assert_allclose(extended.simulate(values, u, 1e-3)[2:], plain[:-2])
