import numpy as np
import pytest

import dea
from dea import store
from dea.narx import NarxModel, Refined, nmse
from dea.narx.inclusion import inclusion_frequency
from dea.narx.orders import compare_orders, linear_model


def response(model, samples, seed, noise=0.002):
    rng = np.random.default_rng(seed)
    u = rng.uniform(-1, 1, samples)
    return u, model.simulate(u) + noise * rng.standard_normal(samples)


def test_orders_stop_paying_at_those_of_the_plant(tmp_path):
    linear = NarxModel.from_terms({"y(t-1)": 1.5, "y(t-2)": -0.8, "u(t-1)": 0.3, "u(t-2)": 0.1})
    cubic = NarxModel.from_terms({"y(t-1)": 0.6, "u(t-1)": 0.3, "u(t-1)^3": 0.4})
    second = compare_orders(
        *response(linear, 800, 0), *response(linear, 400, 1), dynamic=4, polynomial=1, y_units="mm"
    )
    assert second.dynamic_nmse[0] > 20 * second.dynamic_nmse[1]
    np.testing.assert_allclose(second.dynamic_nmse[1:], second.dynamic_nmse[1], rtol=0.2)
    assert second.dynamic_terms.values.tolist() == [3, 5, 7, 9]
    assert second.dynamic_fpe.attrs["units"] == "mm^2"
    store.write(second, tmp_path / "orders.nc", title="Orders")
    third = compare_orders(
        *response(cubic, 800, 0), *response(cubic, 400, 1), dynamic=1, polynomial=4, lags=1
    )
    assert third.polynomial_nmse[1] > 20 * third.polynomial_nmse[2]
    np.testing.assert_allclose(third.polynomial_nmse[3], third.polynomial_nmse[2], rtol=0.2)


def test_a_linear_model_is_scored_by_its_free_run():
    plant = NarxModel.from_terms({"1": 0.1, "y(t-1)": 0.9, "u(t-1)": 0.3})
    u, y = response(plant, 600, 0, noise=0.05)
    u_test, y_test = response(plant, 300, 1, noise=0.05)
    found = compare_orders(u, y, u_test, y_test, dynamic=1, polynomial=1, lags=1)
    run = linear_model(u, y, 1).simulate(u_test, y_test)
    assert float(found.dynamic_nmse[0]) == pytest.approx(nmse(y_test[1:], run[1:]))


def test_sure_terms_are_always_found_and_foreign_ones_are_not():
    plant = NarxModel.from_terms({"y(t-1)": 0.6, "u(t-1)": 0.4, "y(t-1)u(t-1)^2": 0.3})
    u, y = response(plant, 1000, 0)
    foreign = NarxModel.from_terms({"u(t-2)^3": 1.0, "y(t-2)": 1.0}).terms
    settings = {"y_lags": 2, "u_lags": 2, "scaling": plant.scaling, "search": Refined(1e-5)}
    found, again = (
        inclusion_frequency(
            plant.terms + foreign, u, y, rng=np.random.default_rng(5), resamples=6, **settings
        )
        for _ in range(2)
    )
    np.testing.assert_array_equal(found, again)
    assert np.all(found[:3] == 1.0)
    assert np.all(found[3:] <= 0.5)


def test_stretches_too_short_for_the_selection_are_left_out_of_its_resamples():
    """The terms sought may need fewer lags than the search looks at."""
    u = np.random.default_rng(3).uniform(-1.0, 1.0, 800)
    y = NarxModel.from_terms({"y(t-1)": 0.6, "u(t-1)": 0.4}).simulate(u)
    y = y + 1e-3 * np.random.default_rng(4).standard_normal(y.size)
    y[[300, 308]] = np.nan
    record = dea.Record.of(u, y, 50.0)
    found = inclusion_frequency(
        ["y(t-1)", "u(t-1)"], record, rng=np.random.default_rng(5), resamples=2, y_lags=4,
        u_lags=4, degree=1,
    )  # fmt: skip
    assert found.tolist() == [1.0, 1.0]
