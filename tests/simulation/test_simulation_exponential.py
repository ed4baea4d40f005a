"""The φ functions of a step, against the exponential of a larger matrix (Higham 2008, 10.7.4)."""

import numpy as np
import pytest
from scipy.linalg import expm

from dea.simulation.exponential import ROOM, advance, advance_three, advance_two


def phi_functions(A):
    """Return φ₁ and φ₂ of a matrix: blocks beside exp A in that of a chain of integrators."""
    n = A.shape[0]
    chain = np.kron(np.eye(3, k=1), np.eye(n))
    chain[:n] = np.hstack([A, np.eye(n), np.zeros((n, n))])
    grown = expm(chain)
    return grown[:n, n : 2 * n], grown[:n, 2 * n :]


def stepped(J, slope, ramp, h):
    n, step = slope.size, np.empty(slope.size)
    if n == 2:
        advance_two(J, slope, ramp, h, step)
    else:
        advance(J, slope, ramp, h, step, np.empty((ROOM, n, n)))
    return step


@pytest.mark.parametrize("norm", [1e-3, 0.3, 3.0, 17.0])
@pytest.mark.parametrize("damping", [-1.0, -0.1, 0.0])
def test_a_step_of_two_states_that_swing(damping, norm):
    """The eigenvalues are a complex pair."""
    h, A = 0.02, norm * np.array([[damping, 1.3], [-0.6, damping]])
    slope, ramp = np.array([0.4, -1.1]), np.array([0.9, 0.7])
    first, second = phi_functions(A)
    expected = h * (first @ slope + second @ ramp)
    np.testing.assert_allclose(stepped(A / h, slope, ramp, h), expected, rtol=1e-7, atol=1e-10)


# Of the larger norms, a step is halved up to seven times and doubled back.
@pytest.mark.parametrize("norm", [0.0, 0.3, 0.9, 3.0, 17.0, 60.0])
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_a_step_is_phi_1_times_the_slope_and_phi_2_times_the_ramp(n, norm):
    rng, h = np.random.default_rng(n), 0.02
    A = rng.standard_normal((n, n)) - n * np.eye(n)
    A *= norm / np.abs(A).sum(axis=1).max()
    slope, ramp, none = rng.standard_normal(n), rng.standard_normal(n), np.zeros(n)
    first, second = phi_functions(A)
    close = {"rtol": 1e-7, "atol": 1e-10}
    np.testing.assert_allclose(stepped(A / h, slope, none, h), h * first @ slope, **close)
    np.testing.assert_allclose(stepped(A / h, none, ramp, h), h * second @ ramp, **close)
    both = h * (first @ slope + second @ ramp)
    np.testing.assert_allclose(stepped(A / h, slope, ramp, h), both, **close)


@pytest.mark.parametrize("norm", [0.0, 0.3, 3.0, 17.0, 47.0])
def test_three_states_are_advanced_by_a_series_unless_they_are_stiff(norm):
    rng, h = np.random.default_rng(8), 0.02
    A = rng.standard_normal((3, 3)) - 3.0 * np.eye(3)
    A *= norm / np.abs(A).sum(axis=1).max()
    slope, ramp, step = rng.standard_normal(3), rng.standard_normal(3), np.empty(3)
    first, second = phi_functions(A)
    assert advance_three(A / h, slope, ramp, h, step)
    expected = h * (first @ slope + second @ ramp)
    np.testing.assert_allclose(step, expected, rtol=1e-8, atol=1e-12)
    assert not advance_three(100.0 * np.eye(3) / h, slope, ramp, h, step)
