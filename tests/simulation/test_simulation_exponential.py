"""The φ functions of a step, against the exponential of a larger matrix (Higham 2008, 10.7.4)."""

import numpy as np
import pytest
from scipy.linalg import expm

from dea.simulation.cayley_hamilton import advance_four, advance_three, advance_two
from dea.simulation.exponential import ROOM, advance


def phi_functions(A):
    """Return φ₁ and φ₂ of a matrix: blocks beside exp A in that of a chain of integrators."""
    n = A.shape[0]
    chain = np.kron(np.eye(3, k=1), np.eye(n))
    chain[:n] = np.hstack([A, np.eye(n), np.zeros((n, n))])
    grown = expm(chain)
    return grown[:n, n : 2 * n], grown[:n, 2 * n :]


def stepped(J, slope, ramp, h):
    n, step = slope.size, np.empty(slope.size)
    advance(J, slope, ramp, h, step, np.empty((ROOM, n, n)))
    return step


@pytest.mark.parametrize("norm", [1e-3, 0.3, 3.0, 17.0])
@pytest.mark.parametrize("damping", [-1.0, -0.1, 0.0])
def test_a_step_of_two_states_that_swing(damping, norm):
    """The eigenvalues are a complex pair."""
    h, A = 0.02, norm * np.array([[damping, 1.3], [-0.6, damping]])
    slope, ramp, step = np.array([0.4, -1.1]), np.array([0.9, 0.7]), np.empty(2)
    first, second = phi_functions(A)
    expected = h * (first @ slope + second @ ramp)
    assert advance_two(A / h, slope, ramp, h, step)
    np.testing.assert_allclose(step, expected, rtol=1e-7, atol=1e-10)


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


BY_SIZE = {2: advance_two, 3: advance_three, 4: advance_four}


def of_kind(kind, n, rng):
    A = rng.standard_normal((n, n))
    match kind:
        case "decays":
            return A - n * np.eye(n)
        case "swings":
            return A - A.T
        case "stiff":
            Q = np.linalg.qr(A)[0]
            return Q @ np.diag(-np.logspace(0, -3, n)) @ Q.T
        case "chain":
            return np.triu(A, 1)
        case "other units":
            D = np.diag(10.0 ** rng.uniform(-3, 3, n))
            return D @ (A - n * np.eye(n)) @ np.linalg.inv(D)


@pytest.mark.parametrize("norm", [0.0, 1e-6, 0.3, 0.999, 1.001, 5.0, 17.0, 60.0])
@pytest.mark.parametrize("kind", ["decays", "swings", "stiff", "chain", "other units"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_few_states_are_advanced_by_the_characteristic_polynomial(n, kind, norm):
    rng, h = np.random.default_rng(8), 0.02
    A = of_kind(kind, n, rng)
    A *= norm / np.abs(A).sum(axis=1).max()
    slope, ramp, step = rng.standard_normal(n), rng.standard_normal(n), np.empty(n)
    first, second = phi_functions(A)
    assert BY_SIZE[n](A / h, slope, ramp, h, step)
    expected = h * (first @ slope + second @ ramp)
    np.testing.assert_allclose(step, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("kind", ["decays", "swings", "stiff"])
def test_two_states_are_so_advanced_when_they_are_stiff(kind):
    rng, h = np.random.default_rng(9), 0.02
    A = of_kind(kind, 2, rng)
    A *= 900.0 / np.abs(A).sum(axis=1).max()
    slope, ramp, step = rng.standard_normal(2), rng.standard_normal(2), np.empty(2)
    first, second = phi_functions(A)
    assert advance_two(A / h, slope, ramp, h, step)
    expected = h * (first @ slope + second @ ramp)
    np.testing.assert_allclose(step, expected, rtol=1e-8)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_step_that_is_too_large_or_no_number_is_left_to_the_matrices(n):
    h, none, step = 0.02, np.zeros(n), np.full(n, 7.0)
    for A in (-3000.0 * np.eye(n), np.full((n, n), np.nan), np.full((n, n), -np.inf)):
        assert not BY_SIZE[n](A / h, none, none, h, step)
    np.testing.assert_array_equal(step, 7.0)
