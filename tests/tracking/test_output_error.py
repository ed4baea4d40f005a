"""Tracking by the free run: its estimate, when it stops, and where it starts."""

import numpy as np
from scipy.optimize import least_squares

from dea.narx import NarxModel, simulate, simulate_varying
from dea.tracking import track_parameters
from dea.tracking.kalman import Smoothed
from dea.tracking.output_error import smooth_simulation
from dea.tracking.random_walk import RandomWalk


def standing(theta: np.ndarray, samples: int) -> Smoothed:
    """Parameters that stand still."""
    rows = np.tile(theta, (samples, 1))
    none = np.empty((0, theta.size, theta.size))
    return Smoothed(
        rows, np.ones_like(rows), none, rows, np.zeros(samples), np.zeros(theta.size), 1.0
    )


def test_standing_parameters_are_those_of_the_least_free_run_error():
    """From a start so far off that one linearisation does not suffice."""
    rng = np.random.default_rng(3)
    plant = NarxModel.from_terms({"y(t-1)": 0.9, "u(t-1)": 0.5})
    u = np.repeat(rng.standard_normal(100), 4)
    y = plant.simulate(u) + 0.3 * rng.standard_normal(u.size)
    start = np.array([0.6, 1.5])
    walk = RandomWalk(np.zeros(2), prior_variance=1e9)
    model = plant.with_parameters(start)
    found = smooth_simulation(model, standing(start, u.size - 1), u, y, walk).smoothed
    best = least_squares(lambda theta: simulate(plant.terms, theta, u, y[:1]) - y, plant.parameters)
    np.testing.assert_allclose(found.theta, np.tile(best.x, (u.size - 1, 1)), rtol=2e-3)


def gauss_newton(terms, theta, u, y):
    """Five steps at most, each halved until the error falls; a fall below 1 % is the last."""

    def run(theta):
        return simulate(terms, theta, u, y[:1])

    def squared(theta):
        return np.mean((run(theta) - y) ** 2)

    for _ in range(5):
        columns = [(run(theta + d) - run(theta - d)) / 2e-6 for d in 1e-6 * np.eye(theta.size)]
        step = np.linalg.lstsq(np.stack(columns, axis=1), y - run(theta))[0]
        while not squared(theta + step) < squared(theta):
            step /= 2.0
        theta = theta + step
        if squared(theta) > 0.99 * squared(theta - step):
            break
    return theta


def smoothed_beside(offset, prior_variance):
    """Return a plant, where it began, its record with noise and a constant, and the smoothed."""
    rng = np.random.default_rng(1)
    plant = NarxModel.from_terms({"y(t-1)": 0.9, "u(t-1)": 0.5})
    u = np.repeat(rng.standard_normal(100), 4)
    y = offset + plant.simulate(u) + 0.3 * rng.standard_normal(u.size)
    start, walk = np.array([0.5, 0.5]), RandomWalk(np.zeros(2), prior_variance=prior_variance)
    model = plant.with_parameters(start)
    return plant, start, u, y, smooth_simulation(model, standing(start, u.size - 1), u, y, walk)


def test_where_the_structure_lacks_a_constant_the_free_runs_fit_stays_and_is_not_settled():
    plant, start, u, y, found = smoothed_beside(2.0, prior_variance=1e6)
    assert found.reached
    assert not found.settled
    expected = gauss_newton(plant.terms, start, u, y)
    np.testing.assert_allclose(found.smoothed.theta[[0, -1]], [expected] * 2, rtol=1e-5)


def test_with_white_noise_alone_the_parameters_settle():
    plant, *_, found = smoothed_beside(0.0, prior_variance=1e3)
    assert found.reached
    assert found.settled
    deviation = np.sqrt(found.smoothed.variance[-1])
    assert (np.abs(found.smoothed.theta[-1] - plant.parameters) < 3 * deviation).all()


def test_where_no_step_lowers_the_error_the_result_is_the_start_itself():
    rng = np.random.default_rng(4)
    model = NarxModel.from_terms({"u(t-1)": 0.5})
    u = rng.choice([-1.0, 1.0], 50)
    y = rng.standard_normal(50)
    start = standing(model.parameters, 49)
    # Without any prior variance the smoother returns its start: a step of length zero.
    walk = RandomWalk(np.zeros(1), prior_variance=0.0)
    found = smooth_simulation(model, start, u, y, walk)
    np.testing.assert_array_equal(found.smoothed.theta, start.theta)


def test_where_tracked_parameters_diverge_the_models_own_are_the_start():
    """Pulses bring a cubic map back below the point from which on it runs away.

    The record begins beyond that point, so that the free run diverges with the parameters of least
    one-step error and is bounded with the model's own.
    """
    y = [1.0]
    u = np.zeros(601)
    for t in range(1, u.size):
        if t % 6 == 1:
            u[t - 1], value = 0.8, 0.8
        else:
            value = 1.5 * y[-1] ** 3
        y.append(value)
    y = np.array(y)
    model = NarxModel.from_terms({"1": 0.0, "y(t-1)^3": 0.5, "u(t-1)": 0.1})
    settings = {"noise_ratio": 0.0, "sampling_rate": 50.0}
    runs = {
        method: simulate_varying(
            model.terms,
            track_parameters(model, u, y, method=method, **settings)["parameter"].values,
            u,
            y[:1],
        )
        for method in ("kalman", "output_error")
    }
    assert np.isinf(runs["kalman"][-1])
    own = np.mean((simulate(model.terms, model.parameters, u, y[:1]) - y) ** 2)
    assert np.mean((runs["output_error"] - y) ** 2) <= own
