import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from narx_strategies import models
from scipy.optimize import least_squares as scipy_least_squares

from dea.errors import InputError
from dea.narx import NarxModel, Scaling, estimate, refine, regressor_matrix, scaling_of, simulate
from dea.narx.free_run_fit import fit_free_runs
from dea.narx.segments import sensitivities
from published_plants import published_plants

PLANT = {"1": 0.1, "y(t-1)": 1.2, "y(t-2)": -0.4, "u(t-1)": 0.2, "y(t-1)u(t-1)^2": -0.15}


def record(samples=2000, noise=0.05, seed=0):
    rng = np.random.default_rng(seed)
    u = rng.standard_normal(samples)
    model = NarxModel.from_terms(PLANT)
    y = model.simulate(u)
    return model, u, y + noise * y.std() * rng.standard_normal(samples)


def test_estimates_equal_textbook_least_squares():
    model, u, y = record()
    found = estimate(model.terms, u, y, scaling=Scaling())
    matrix = regressor_matrix(model.terms, u, y)
    theta, rest, _, _ = np.linalg.lstsq(matrix, y[2:], rcond=None)
    np.testing.assert_allclose(found.parameters, theta, rtol=1e-10)
    covariance = rest[0] / (y.size - 2 - 5) * np.linalg.inv(matrix.T @ matrix)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-8)


@pytest.mark.slow
def test_standard_errors_are_the_spread_over_repetitions():
    """Equation error is what least squares assumes: there its standard errors hold."""
    model = NarxModel.from_terms(PLANT)
    u = np.random.default_rng(1).standard_normal(400)
    found = []
    for seed in range(150):
        e = 0.05 * np.random.default_rng([2, seed]).standard_normal(400)
        y = np.zeros(400)
        for t in range(2, 400):
            row = regressor_matrix(model.terms, u[t - 2 : t + 1], y[t - 2 : t + 1])
            y[t] = row[0] @ model.parameters + e[t]
        found.append(estimate(model.terms, u, y, scaling=Scaling()))
    spread = np.std([one.parameters for one in found], axis=0)
    claimed = np.mean([one.standard_errors for one in found], axis=0)
    np.testing.assert_allclose(claimed, spread, rtol=0.25)


def test_refined_standard_errors_hold_under_coloured_noise():
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.5})
    u = np.repeat(np.random.default_rng(1).standard_normal(150), 10)
    clean = model.simulate(u)
    found = []
    for seed in range(150):
        e = np.random.default_rng([3, seed]).standard_normal(1500)
        coloured = NarxModel.from_terms({"y(t-1)": 0.9, "u(t-1)": 0.1}).simulate(e)
        found.append(refine(model, u, clean + coloured))
    spread = np.std([one.parameters for one in found], axis=0)
    claimed = np.mean([one.standard_errors for one in found], axis=0)
    np.testing.assert_allclose(claimed, spread, rtol=0.3)


@given(models(), st.integers(0, 2**32 - 1))
def test_sensitivities_equal_finite_differences(model, seed):
    rng = np.random.default_rng(seed)
    u, start = rng.uniform(-1, 1, 25), rng.uniform(-0.3, 0.3, 5)
    y, slope = sensitivities(model.terms, model.parameters, u, start)
    np.testing.assert_allclose(
        y, simulate(model.terms, model.parameters, u, start), rtol=1e-10, atol=1e-14
    )
    for j in range(model.parameters.size):
        step = np.zeros(model.parameters.size)
        step[j] = 1e-6
        up, down = (
            simulate(model.terms, model.parameters + sign * step, u, start) for sign in (1, -1)
        )
        np.testing.assert_allclose(slope[:, j], (up - down) / 2e-6, rtol=1e-5, atol=1e-7)


def test_refinement_reaches_the_minimum_another_optimiser_finds():
    model, u, y = record()
    biased = estimate(model.terms, u, y, scaling=Scaling())
    refined = refine(biased, u, y)

    def error(unknowns):
        return simulate(model.terms, unknowns[:5], u, unknowns[5:]) - y

    start = np.concatenate([model.parameters, y[:2]])
    oracle = scipy_least_squares(error, start, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    np.testing.assert_allclose(refined.parameters, oracle.x[:5], rtol=1e-5)


def test_pieces_with_starts_of_their_own_are_fitted_as_all_unknowns_at_once_are():
    """Parameters and covariance, against a general optimiser and the inverse of all its squares."""
    plant = NarxModel.from_terms({"y(t-1)": 0.6, "y(t-2)": 0.1, "u(t-1)": 0.4, "u(t-2)^2": 0.2})
    u = np.random.default_rng(21).uniform(-1.0, 1.0, (7, 60))
    noise = np.random.default_rng(22).standard_normal(u.shape)
    y = np.array([plant.simulate(each) for each in u]) + 0.05 * noise
    start = estimate(plant.terms, list(u), list(y), scaling=Scaling())
    found = refine(start, list(u), list(y))

    def error(unknowns):
        starts = unknowns[4:].reshape(7, 2)
        return np.concatenate(
            [
                simulate(plant.terms, unknowns[:4], inputs, first) - outputs
                for inputs, outputs, first in zip(u, y, starts, strict=True)
            ]
        )

    oracle = scipy_least_squares(
        error, np.concatenate([plant.parameters, y[:, :2].ravel()]), jac="3-point",
        xtol=1e-14, ftol=1e-14, gtol=1e-14,
    )  # fmt: skip
    np.testing.assert_allclose(found.parameters, oracle.x[:4], rtol=1e-5)
    variance = 2.0 * oracle.cost / (y.size - oracle.x.size)
    expected = variance * np.linalg.inv(oracle.jac.T @ oracle.jac)[:4, :4]
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-3)


def test_refinement_removes_the_bias_of_noisy_outputs():
    model, u, y = record(noise=0.2)
    biased = estimate(model.terms, u, y, scaling=Scaling())
    refined = refine(biased, u, y)
    lost, left = (np.abs(found.parameters - model.parameters).max() for found in (biased, refined))
    assert lost > 0.1
    assert left < 0.03
    assert np.all(np.abs(refined.parameters - model.parameters) < 4 * refined.standard_errors)


def test_several_records_are_estimated_together():
    model, u, y = record(noise=0.0)
    pieces = [slice(0, 700), slice(700, 1100), slice(1100, 2000)]
    found = estimate(model.terms, [u[p] for p in pieces], [y[p] for p in pieces], scaling=Scaling())
    np.testing.assert_allclose(found.parameters, model.parameters, rtol=1e-9)
    again = refine(
        found.with_parameters(found.parameters * 0.95),
        [u[p] for p in pieces],
        [y[p] for p in pieces],
    )
    np.testing.assert_allclose(again.parameters, model.parameters, rtol=1e-6)


def test_the_scaling_is_mean_and_half_range():
    scaling = scaling_of(
        [(np.array([1.0, 3.0]), np.array([0.0, 4.0])), (np.array([5.0]), np.array([8.0]))]
    )
    assert scaling == Scaling(u_offset=3.0, u_scale=2.0, y_offset=4.0, y_scale=4.0)


def test_a_model_that_diverges_cannot_be_refined():
    _, u, y = record()
    with pytest.raises(InputError, match="diverges"):
        refine(NarxModel.from_terms({"y(t-1)": 1.5, "u(t-1)": 1.0}), u, y)


def test_refinement_finds_the_minimum_where_noise_takes_least_squares_far_off():
    """A slow input and noise on the output: from least squares alone, a pole ends near -1."""
    model = published_plants()["DEA1"]
    for seed in (3, 4):
        rng = np.random.default_rng([9, seed])
        spectrum = np.fft.rfft(rng.standard_normal(3000))
        spectrum[np.fft.rfftfreq(3000) > 0.02] = 0.0
        u = np.fft.irfft(spectrum, 3000)
        u /= 3.0 * u.std()
        clean = model.simulate(u, np.zeros(model.max_lag))
        y = clean + 0.02 * clean.std() * rng.standard_normal(3000)
        biased = estimate(model.terms, u, y, scaling=Scaling())
        noise = np.mean((clean - y) ** 2)
        assert fit_free_runs(model.terms, biased.parameters, [(u, y)]).msse > 1.2 * noise
        assert np.mean((refine(biased, u, y).simulate(u, y) - y) ** 2) < 1.05 * noise


def test_a_record_at_rest_beside_others_is_refined_with_them():
    """Its outputs are zero, and a run may still leave them: a model with a constant does."""
    rng = np.random.default_rng(11)
    plant = NarxModel.from_terms({"1": 0.05, "y(t-1)": 0.7, "u(t-1)": 0.3})
    u = rng.uniform(-1.0, 1.0, 300)
    moving = plant.simulate(u) + 0.01 * rng.standard_normal(300)
    still = np.zeros(100), np.zeros(100)
    found = refine(plant, [u, still[0]], [moving, still[1]])
    # The level is a compromise between both records; the dynamics are those of the moving one.
    assert 0.0 < found.parameters[0] < 0.05
    np.testing.assert_allclose(found.parameters[1:], [0.7, 0.3], atol=0.02)
