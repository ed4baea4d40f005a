"""Models that carry rate, units and names, and take records in the place of two arrays."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.figure import Figure

import dea
from dea.errors import InputError
from dea.narx import (
    NarxModel,
    Scaling,
    compare_orders,
    estimate,
    held_out_error,
    inclusion_frequency,
    lag_choices,
    linear_model,
    refine,
)
from dea.narx.labels import Labels
from dea.terms import Term

RATE = 20.0


def made(size=400, seed=0):
    u = np.random.default_rng(seed).uniform(-1.0, 1.0, size)
    y = np.zeros(size)
    for t in range(2, size):
        y[t] = 0.6 * y[t - 1] + 0.5 * u[t - 1] + 0.2 * u[t - 2] ** 2
    return u, y


def record(size=400, seed=0, **changes):
    u, y = made(size, seed)
    given = {"units": ("V", "mm"), "names": ("drive", "position")} | changes
    return dea.Record.of(u, y, RATE, **given)


@pytest.fixture(scope="module")
def found():
    return dea.select_terms(record(), y_lags=1, u_lags=2, degree=2)


def test_the_model_of_a_record_is_that_of_its_arrays_and_knows_them(found):
    plain = dea.select_terms(*made(), y_lags=1, u_lags=2, degree=2)
    assert found.terms == plain.terms
    np.testing.assert_array_equal(found.parameters, plain.parameters)
    assert (found.labels.sampling_rate, found.labels.y_units) == (RATE, "mm")
    assert plain.labels.sampling_rate is None


def test_labels_survive_a_file(found, tmp_path):
    found.save(tmp_path / "model.nc")
    loaded = NarxModel.load(tmp_path / "model.nc")
    assert loaded.labels == found.labels
    assert loaded.to_dict() == found.to_dict()
    assert json.loads(json.dumps(found.to_dict()))["labels"]["u_name"] == "drive"


def test_a_response_takes_the_rate_of_the_model_and_asks_where_there_is_none(found):
    known = dea.frequency_response(found, 1, 2.0)
    np.testing.assert_array_equal(known, dea.frequency_response(found, 1, 2.0, RATE))
    with pytest.raises(InputError, match="sampling_rate: it is 1000 Hz, and the model is of 20 Hz"):
        dea.frequency_response(found, 1, 2.0, 1000.0)
    plain = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0})
    with pytest.raises(InputError, match="does not know its sampling rate"):
        dea.frequency_response(plain, 1, 0.1)


def test_missing_samples_of_a_record_are_left_out(found):
    whole = record()
    y = whole.y.copy()
    y[150:160] = np.nan
    with_gap = dea.select_terms(whole._replace(y=y), y_lags=1, u_lags=2, degree=2)
    assert set(with_gap.terms) == set(found.terms)
    assert found.score(whole._replace(y=y)) == pytest.approx(1.0, abs=1e-6)


def test_several_records_share_a_model_and_must_agree():
    both = dea.select_terms([record(200, 1), record(200, 2)], y_lags=1, u_lags=2, degree=2)
    assert both.score(record(200, 3)) > 1 - 1e-6
    with pytest.raises(InputError, match="records of one rate"):
        dea.select_terms([record(), record(units=("V", "um"))])


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_a_prediction_runs_freely_from_the_outputs_measured_so_far(found, steps):
    u, y = made(60, 4)
    y += 0.05 * np.random.default_rng(5).standard_normal(y.size)
    ahead = found.predict(u, y, steps=steps)
    for t in range(found.max_lag + steps - 1, y.size):
        start = t - steps + 1 - found.max_lag
        run = found.simulate(u[start : t + 1], y[start : start + found.max_lag])
        assert ahead[t] == pytest.approx(run[-1], abs=1e-12)


def test_the_score_is_the_variance_explained_by_the_free_run(found):
    u, y = made(200, 6)
    noisy = y + 0.1 * np.random.default_rng(7).standard_normal(y.size)
    lag = found.max_lag
    error = noisy[lag:] - found.simulate(u, noisy)[lag:]
    expected = 1 - np.sum(error**2) / np.sum((noisy[lag:] - noisy[lag:].mean()) ** 2)
    assert found.score(u, noisy) == pytest.approx(expected)


def test_tracking_and_cross_validation_take_the_record(found):
    whole = record()
    track = dea.track_parameters(found, whole)
    assert float(track["time"][-1]) == pytest.approx(whole.time[-1])
    assert held_out_error(found, whole) == held_out_error(found, whole.u, whole.y)


def test_signals_bring_their_units_and_names():
    u, y = made()
    labelled = xr.DataArray(y, dims="time", attrs={"units": "um", "long_name": "stroke"})
    found = dea.Record.of(pd.Series(u, name="volts"), labelled, 10.0)
    assert (found.u_name, found.u_units, found.y_name, found.y_units) == (
        "volts", "1", "stroke", "um"
    )  # fmt: skip
    assert found.part(1.0, 2.0).u.size == 10


@pytest.mark.parametrize(
    ("u", "y", "rate", "message"),
    [
        ([0.0, 1.0], [0.0], 1.0, "input and output have shapes"),
        ([0.0, np.nan], [0.0, 1.0], 1.0, "the input has missing values"),
        ([0.0, 1.0], [0.0, 1.0], 0.0, "sampling_rate: it is 0"),
    ],
)
def test_signals_that_make_no_record_are_refused(u, y, rate, message):
    with pytest.raises(InputError, match=message):
        dea.Record.of(u, y, rate)


def test_a_notebook_shows_the_equation_with_four_digits(found):
    shown = NarxModel((Term.parse("y(t-1)"),), [0.123456], labels=found.labels)
    assert shown._repr_latex_() == r"$\displaystyle y_{t} = 0.1235 y_{t-1}$"
    assert "0.1235 <i>y</i>" in shown._repr_html_()


def test_the_plot_shows_both_outputs_with_their_units(found):
    axes = found.plot(record())
    assert axes.get_xlabel() == "time (s)"
    assert axes.get_ylabel() == "position (mm)"
    measured, run = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_allclose(measured, run, atol=1e-6)


def test_the_plot_goes_into_axes_that_are_given(found):
    axes = Figure().add_subplot()
    assert found.plot(record(), axes=axes) is axes
    assert len(axes.lines) == 2


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sampling_rate": 1000.0}, "sampling_rate: the record has 1000 Hz, the model"),
        ({"u_units": "kV"}, "units: the record has kV, "),
        ({"y_units": "m"}, "units: the record has .*, m, the model"),
    ],
)
def test_a_record_unlike_the_model_s_is_refused(found, changed, message):
    own = record(200, 1)
    for use in (found.score, found.predict):
        with pytest.raises(InputError, match=message):
            use(own._replace(**changed))
    near = own._replace(sampling_rate=1.0005 * own.sampling_rate, u_name="another name")
    assert found.score(near) == found.score(own)


def test_rates_may_differ_as_clocks_do():
    model = dea.NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.2})
    inputs = np.random.default_rng(2).uniform(-1.0, 1.0, (2, 200))
    records = [
        dea.Record.of(u, model.simulate(u), rate)
        for u, rate in zip(inputs, (50.0, 49.99999999999999), strict=True)
    ]
    assert dea.select_terms(records, y_lags=1, u_lags=1, degree=1).labels.sampling_rate == 50.0
    with pytest.raises(InputError, match="Give records of one rate"):
        dea.select_terms([records[0], dea.Record.of(inputs[1], model.simulate(inputs[1]), 49.0)])


def test_a_model_runs_on_signals_that_do_not_vary():
    """A hold and a rest are what a model is asked for, though it could not come from them."""
    model = dea.NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.5})
    u, y = np.ones(3), np.array([0.0, 0.6, 0.7])
    np.testing.assert_allclose(model.predict(u, y), [0.0, 0.5, 0.8])
    np.testing.assert_allclose(model.predict(u, y, steps=2), [0.0, 0.6, 0.75])
    assert np.isfinite(model.score(u, y))
    with pytest.raises(InputError, match="3 samples leave 0 equations after a lag of 4"):
        model.predict(u, y, steps=4)
    with pytest.raises(InputError, match="y: it has no variance"):
        model.score(np.arange(3.0), np.ones(3))


@pytest.mark.parametrize("use", [dea.NarxModel.predict, dea.NarxModel.score])
def test_an_output_beside_a_record_is_refused(found, use):
    with pytest.raises(InputError, match=r"given beside a dea\.Record"):
        use(found, record(), record().y)


@pytest.mark.parametrize("rate", [20, np.int64(20), np.float32(20.0)])
def test_a_model_is_plain_values_whatever_numbers_it_was_made_from(rate, tmp_path):
    of_integers = dea.Record.of(*made(), rate)
    model = dea.select_terms(of_integers, y_lags=1, u_lags=2, degree=2)
    model.save(tmp_path / "model.nc")
    for each in (model, NarxModel.load(tmp_path / "model.nc")):
        assert json.loads(json.dumps(each.to_dict()))["labels"]["sampling_rate"] == 20.0
    scaling = Scaling(np.float32(0.5), np.int64(2), np.float32(0.25), np.float64(3.0))
    narrow = NarxModel.from_terms({"y(t-1)": 0.5}, scaling=scaling)
    assert json.loads(json.dumps(narrow.to_dict()))["scaling"]["y_offset"] == 0.25
    labels = {"sampling_rate": np.int64(20), "u_units": "V"}
    loaded = NarxModel.from_dict(narrow.to_dict() | {"labels": labels})
    assert json.loads(json.dumps(loaded.to_dict()))["labels"]["sampling_rate"] == 20.0


def test_least_squares_and_refinement_take_the_record():
    terms, whole = ("y(t-1)", "u(t-1)", "u(t-2)^2"), record()
    plain = refine(estimate(terms, whole.u, whole.y), whole.u, whole.y)
    found = refine(estimate(terms, whole), whole)
    np.testing.assert_array_equal(found.parameters, plain.parameters)
    assert found.labels.sampling_rate == RATE
    with pytest.raises(InputError, match="sampling_rate: the record has 1000 Hz, the model"):
        refine(found, whole._replace(sampling_rate=1000.0))
    with pytest.raises(InputError, match="y: there is no output"):
        estimate(terms, whole.u)


def test_records_beside_signals_and_a_record_in_place_of_a_list_are_refused():
    whole = record()
    with pytest.raises(InputError, match=r"u: record 2 is tuple\. Give a dea\.Record of each"):
        dea.select_terms([whole, (whole.u, whole.y)])
    with pytest.raises(InputError, match=r"records: it is one\. Give a list"):
        dea.select_common_terms(whole)
    with pytest.raises(InputError, match=r"records: there is none\. Give a list"):
        dea.select_common_terms([])
    with pytest.raises(InputError, match=r"y: it is a dea\.Record\. Give its signals, record\.u"):
        lag_choices(whole)


def test_missing_outputs_are_named_with_what_leaves_them_out():
    u, y = made()
    y[7] = np.nan
    told = "y: 1 sample is missing, the first is sample 7. Give {}"
    with pytest.raises(InputError, match=told.format(r"dea\.Record\.of\(u, y, sampling_rate\)")):
        dea.select_terms(u, y)
    for given in ((u, y), (dea.Record.of(u, y, RATE),)):
        with pytest.raises(InputError, match=told.format("a part without a missing sample")):
            dea.select_lags(*given)


@pytest.mark.parametrize(("choices", "one"), [([3], "3"), ([(2, 2), (1,)], r"\(1,\)")])
def test_choices_of_lags_are_pairs(choices, one):
    with pytest.raises(InputError, match=f"choices: one is {one}. Give pairs of output lags"):
        dea.select_lags(record(), choices=choices)


def frames():
    """Two inputs as a frame, the same with its columns exchanged, and the output."""
    a, b = np.random.default_rng(8).uniform(-1.0, 1.0, (2, 400))
    y = np.zeros(a.size)
    for t in range(1, y.size):
        y[t] = 0.6 * y[t - 1] + 0.5 * a[t - 1] - 0.3 * b[t - 1]
    one = pd.DataFrame({"a": a, "b": b})
    return one, one[["b", "a"]], y


def test_columns_of_frames_are_found_by_name_where_a_model_is_made_and_used():
    one, other, y = frames()
    halves = [one[:200], other[200:]], [y[:200], y[200:]]
    for given in ((one, y), halves):
        model = dea.select_terms(*given, y_lags=1, u_lags=1, degree=1)
        assert [name for name, _ in model.named_inputs] == ["a", "b"]
        assert model.score(one, y) == model.score(other, y) > 0.999
    terms = ("y(t-1)", "u1(t-1)", "u2(t-1)")
    assert estimate(terms, other, y, scaling=Scaling()).parameters == pytest.approx(
        [0.6, -0.3, 0.5]
    )


def test_systems_of_one_structure_name_their_columns_alike():
    one, other, y = frames()
    first, second = dea.select_common_terms([(one, y), (other, y)], y_lags=1, u_lags=1, degree=1)
    assert first.labels.u_name == second.labels.u_name == ("a", "b")
    np.testing.assert_allclose(first.parameters, second.parameters)
    elsewhere = other.set_axis(["p", "q"], axis=1)
    models = dea.select_common_terms([(one, y), (elsewhere, y)], y_lags=1, u_lags=1, degree=1)
    assert models[1].labels.u_name == ("p", "q")


def test_refinement_takes_the_columns_that_the_model_names():
    one, other, y = frames()
    terms, whole = ("y(t-1)", "u1(t-1)", "u2(t-1)"), dea.Record.of(one, y, RATE)
    model = estimate(terms, whole, scaling=Scaling())
    assert refine(model, other, y).parameters == pytest.approx([0.6, 0.5, -0.3])
    assert refine(model, one, y).labels == model.labels


def test_a_name_that_columns_share_tells_nothing():
    one, _, y = frames()
    model = dea.select_terms(one.set_axis(["a", "a"], axis=1), y, y_lags=1, u_lags=1, degree=1)
    assert model.labels == Labels()
    assert model.score(one.to_numpy(), y) > 0.999


def test_an_output_that_is_passed_whole_may_lack_samples_after_the_first_ones(found):
    u, y = made()
    holes = np.where(np.arange(y.size) < found.max_lag, y, np.nan)
    np.testing.assert_array_equal(found.simulate(u, holes), found.simulate(u, y))
    with pytest.raises(InputError, match="y_initial: 1 of 2 samples are not numbers"):
        found.simulate(u, np.where(np.arange(y.size) == 1, np.nan, y))


def test_orders_and_inclusion_take_the_record():
    whole, (u, y) = record(), made()
    assert linear_model(whole, None, 2).labels.y_units == "mm"
    orders = {"dynamic": 2, "polynomial": 1, "lags": 1}
    found = compare_orders(whole, None, u, y, **orders)
    assert found.equals(compare_orders(u, y, u, y, **orders))
    settings = {"resamples": 1, "blocks": 2, "y_lags": 1, "u_lags": 1, "degree": 1}
    shares = [
        inclusion_frequency(("y(t-1)", "u(t-1)"), *given, rng=np.random.default_rng(0), **settings)
        for given in ((whole,), (u, y))
    ]
    np.testing.assert_array_equal(*shares)


def test_units_and_names_survive_a_file_though_no_rate_is_known(tmp_path):
    plain = dea.select_terms(*made(), y_lags=1, u_lags=2, degree=2)
    plain.save(tmp_path / "model.nc", u_units="V", y_units="mm")
    labels = NarxModel.load(tmp_path / "model.nc").labels
    assert labels == Labels(u_units="V", y_units="mm")
    one, _, y = frames()
    named = dea.select_terms(one, y, y_lags=1, u_lags=1, degree=1)
    named.save(tmp_path / "named.nc")
    assert NarxModel.load(tmp_path / "named.nc").labels == named.labels
