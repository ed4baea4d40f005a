"""Records that tell too little of the parameters give no intervals around them."""

import numpy as np
import pytest

import dea
from dea.narx import NOT_WHITE, NarxModel, Scaling, estimate, refine

PLANT = NarxModel.from_terms({"1": -0.2, "y(t-1)": 0.5, "u(t-1)^2": 0.8})


def binary_record(samples):
    rng = np.random.default_rng(3)
    u = rng.choice([-1.0, 1.0], samples)
    return u, PLANT.simulate(u) + 0.01 * rng.standard_normal(samples)


@pytest.mark.parametrize("fit", [estimate, refine])
def test_terms_that_are_one_on_the_record_have_no_interval(fit):
    """On a binary input the square is the constant: only the sum of both parameters is told."""
    u, y = binary_record(400)
    first = estimate(["1", "y(t-1)", "u(t-1)^2"], u, y, scaling=Scaling())
    model = first if fit is estimate else refine(first, u, y)
    assert "terms depend on each other" in model.withheld
    assert model.parameters[[0, 2]].sum() == pytest.approx(0.6, abs=0.05)
    assert np.isnan(dea.parameter_interval(model).low).all()
    assert np.isnan(dea.frequency_response_band(model, 1, np.array([0.1]), 1.0).gain_low).all()


def test_terms_that_the_record_tells_apart_keep_their_intervals():
    rng = np.random.default_rng(5)
    u = rng.uniform(-1.0, 1.0, 400)
    y = PLANT.simulate(u) + 0.01 * rng.standard_normal(400)
    model = refine(estimate(PLANT.terms, u, y, scaling=Scaling()), u, y)
    assert model.withheld == ""
    assert np.isfinite(dea.parameter_interval(model).low).all()


@pytest.mark.parametrize(("equations", "withheld"), [(3, True), (12, True), (13, False)])
def test_so_few_equations_do_not_tell_the_noise(equations, withheld):
    """With nine degrees of freedom a normal interval holds less than 92 %, with ten more."""
    rng = np.random.default_rng(7)
    u = rng.uniform(-1.0, 1.0, equations + 1)
    noise = 0.01 * rng.standard_normal(u.size)
    y = np.zeros(u.size)
    for t in range(1, u.size):
        y[t] = -0.2 + 0.5 * y[t - 1] + 0.8 * u[t - 1] ** 2 + noise[t]
    model = estimate(PLANT.terms, u, y, scaling=Scaling())
    assert ("fewer than ten equations" in model.withheld) is withheld


def test_rounding_is_no_error_that_is_correlated_in_time():
    plant = NarxModel.from_terms({"1": 0.1, "y(t-1)": 1.6, "y(t-2)": -0.65, "u(t-1)": 0.05})
    u = np.cumsum(np.random.default_rng(2).uniform(-1.0, 1.0, 4000))
    y = plant.simulate(u)
    assert estimate(plant.terms, u, y).withheld == ""
    noise = 1e-9 * np.convolve(np.random.default_rng(3).standard_normal(4009), np.ones(10), "valid")
    assert estimate(plant.terms, u, y + y.std() * noise).withheld == NOT_WHITE
