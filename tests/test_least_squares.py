"""The damped least squares against known minima and another solver."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from dea.least_squares import Damping, Model, Point, minimise


class Objective:
    """Sum of squares of a residual with its Jacobian; counts the evaluations."""

    def __init__(self, residual, jacobian):
        self.residual, self.jacobian, self.evaluations = residual, jacobian, 0

    def evaluate(self, x):
        self.evaluations += 1
        r = self.residual(x)
        return Point(x, float(r @ r) if np.isfinite(r).all() else np.inf, r)

    def linearise(self, point, iteration, exact):
        J, r = self.jacobian(point.x), point.value
        A, g = J.T @ J, J.T @ r

        def step(damping):
            return -np.linalg.solve(A + damping * np.diag(np.diag(A)), g)

        return Model(point.cost, step)


def rosenbrock():
    return Objective(
        lambda x: np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]]),
        lambda x: np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]]),
    )


@pytest.mark.parametrize("start", [(-1.2, 1.0), (3.0, -2.0), (0.0, 0.0)])
def test_the_minimum_of_a_curved_valley_is_found(start):
    found = minimise(rosenbrock(), np.array(start), Damping(), iterations=200, tolerance=1e-14)
    assert np.allclose(found.x, 1.0, atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_a_fit_with_large_residuals_ends_where_another_solver_ends(seed):
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 3.0, 60)
    y = 2.0 * np.exp(-1.3 * t) + 0.2 * rng.standard_normal(t.size)

    def residual(x):
        return x[0] * np.exp(-x[1] * t) - y

    def jacobian(x):
        decay = np.exp(-x[1] * t)
        return np.column_stack([decay, -x[0] * t * decay])

    start = np.array([1.0, 0.5])
    found = minimise(
        Objective(residual, jacobian), start, Damping(), iterations=100, tolerance=1e-14
    )
    expected = least_squares(residual, start, jacobian, method="lm", xtol=1e-14, ftol=1e-14)
    assert found.cost == pytest.approx(2.0 * expected.cost, rel=1e-9)
    assert np.allclose(found.x, expected.x, rtol=1e-5)


def test_a_start_without_a_finite_cost_comes_back():
    objective = Objective(lambda x: np.array([np.inf]), lambda x: np.ones((1, 1)))
    found = minimise(objective, np.zeros(1), Damping(), iterations=10, tolerance=0.0)
    assert found.cost == np.inf
    assert objective.evaluations == 1


def test_a_stall_on_old_derivatives_asks_for_exact_ones():
    asked = []

    class Stale(Objective):
        def linearise(self, point, iteration, exact):
            asked.append(exact)
            model = super().linearise(point, iteration, exact)
            if exact:
                return model
            return Model(model.cost, lambda damping: np.array([1e3]), exact=False)

    objective = Stale(lambda x: x - 2.0, lambda x: np.ones((1, 1)))
    found = minimise(objective, np.zeros(1), Damping(tries=2), iterations=5, tolerance=1e-12)
    assert asked[:2] == [False, True]
    assert found.x == pytest.approx(2.0, abs=5e-3)


def test_an_exact_model_begins_with_the_damping_that_a_stale_one_began_with():
    """Derivatives of the wrong sign fail however short the step; the exact ones need a long one."""
    asked = []

    class Reversed:
        def evaluate(self, x):
            return Point(x, float((x - 100.0) @ (x - 100.0)), x)

        def linearise(self, point, iteration, exact):
            sign = 1.0 if exact else -1.0

            def step(damping):
                asked.append((exact, damping))
                return sign * (100.0 - point.x) / (1.0 + damping)

            return Model(point.cost, step, exact)

    damping = Damping(first=1e-3, tries=9)
    found = minimise(Reversed(), np.zeros(1), damping, iterations=4, tolerance=1e-4)
    assert next(value for exact, value in asked if exact) == 1e-3
    assert found.x == pytest.approx(100.0, abs=1.0)
