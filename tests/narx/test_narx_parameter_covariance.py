"""The covariance of refined parameters against dense matrices and repeated records."""

import numpy as np

from dea.narx import NarxModel, Scaling, estimate, refine
from dea.narx.parameter_covariance import FreeRun, covariance_of_free_runs, noise_model
from dea.narx.segments import sensitivities

PLANT = NarxModel.from_terms({"y(t-1)": 0.7, "u(t-1)": 0.4, "y(t-1)u(t-1)^2": 0.2})


def noisy_equation(samples: int, seed: int):
    """A free run of PLANT and a record whose noise enters the equation."""
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1.0, 1.0, samples)
    y = np.zeros(samples)
    for t in range(1, samples):
        y[t] = (0.7 + 0.2 * u[t - 1] ** 2) * y[t - 1] + 0.4 * u[t - 1]
        y[t] += 0.02 * rng.standard_normal()
    run, slope = sensitivities(PLANT.terms, PLANT.parameters, u, y)
    return FreeRun(u, run, y - run, slope)


def test_noise_in_the_equation_is_told_from_noise_on_the_output():
    run = noisy_equation(3000, 2)
    feedback, noise = noise_model(PLANT.terms, PLANT.parameters, [run])
    np.testing.assert_allclose(feedback[0][1:, 1], 0.7 + 0.2 * run.u[:-1] ** 2)
    assert noise.order == 0
    on_output = run._replace(residual=np.random.default_rng(3).standard_normal(3000))
    feedback, noise = noise_model(PLANT.terms, PLANT.parameters, [on_output])
    assert not np.any(feedback[0])
    assert noise.order == 0


def test_the_covariance_is_the_dense_sandwich_under_noise_in_the_equation():
    run = noisy_equation(300, 4)
    found = covariance_of_free_runs(PLANT.terms, PLANT.parameters, [run], 3)
    feedback = np.diag(0.7 + 0.2 * run.u[:-1] ** 2, -1)
    through = np.eye(300) - feedback
    driving = through @ run.residual
    root = np.linalg.inv(through)
    G = np.linalg.inv(run.slope.T @ run.slope)
    dense = G @ run.slope.T @ root @ root.T @ run.slope @ G * np.mean(driving**2) * 300 / 297
    np.testing.assert_allclose(found, dense, rtol=1e-8)


def test_refined_standard_errors_are_the_spread_over_repetitions():
    """Where least squares is biased: the noise is on the output."""
    u = np.random.default_rng(5).uniform(-1.0, 1.0, 400)
    clean = PLANT.simulate(u)
    found = [
        refine(estimate(PLANT.terms, u, y, scaling=Scaling()), u, y)
        for y in (
            clean + 0.05 * np.random.default_rng([6, seed]).standard_normal(400)
            for seed in range(120)
        )
    ]
    spread = np.std([one.parameters for one in found], axis=0)
    claimed = np.mean([one.standard_errors for one in found], axis=0)
    np.testing.assert_allclose(claimed, spread, rtol=0.25)


def test_least_squares_withholds_its_intervals_where_noise_biases_it():
    rng = np.random.default_rng(7)
    u = rng.uniform(-1.0, 1.0, 3000)
    y = PLANT.simulate(u) + 0.05 * rng.standard_normal(3000)
    biased = estimate(PLANT.terms, u, y, scaling=Scaling())
    assert "biased" in biased.withheld
    assert not refine(biased, u, y).withheld
    run = noisy_equation(3000, 8)
    assert not estimate(PLANT.terms, run.u, run.output + run.residual, scaling=Scaling()).withheld
