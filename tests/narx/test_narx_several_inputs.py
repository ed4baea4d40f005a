"""Models with several inputs: selection, simulation, prediction, files, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import dea
from dea.errors import InputError
from dea.narx import (
    Forward,
    NarxModel,
    Orthogonal,
    Refined,
    Scaling,
    estimate,
    held_out_error,
    refine,
    regressor_matrix,
    simulate_varying,
    simulation_interval,
)
from dea.narx.stability import StabilityTest
from dea.terms import Term

PLANT = {
    "y(t-1)": 0.7,
    "u1(t-1)": 0.5,
    "u2(t-2)": -0.3,
    "u1(t-1)u2(t-1)": 0.2,
    "y(t-1)u2(t-2)": 0.1,
}


def excitation(samples=900, inputs=2, seed=1):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.0, 1.0, (samples, inputs))


def plain(u, samples=None):
    """The plant written out by hand."""
    y = np.zeros(len(u))
    for t in range(2, len(u)):
        y[t] = (
            0.7 * y[t - 1]
            + 0.5 * u[t - 1, 0]
            - 0.3 * u[t - 2, 1]
            + 0.2 * u[t - 1, 0] * u[t - 1, 1]
            + 0.1 * y[t - 1] * u[t - 2, 1]
        )
    return y


@pytest.fixture(scope="module")
def record():
    u = excitation()
    noise = np.random.default_rng(2).normal(0.0, 0.002, len(u))
    units, names = (("V", "%"), "mm"), (("left", "right"), "position")
    return dea.Record.of(u, plain(u) + noise, 10.0, units=units, names=names)


@pytest.fixture(scope="module")
def found(record):
    return dea.select_terms(record, y_lags=2, u_lags=2, degree=2, search=Refined(rounds=20))


def test_simulation_is_the_equation_written_out():
    u = excitation()
    model = NarxModel.from_terms(PLANT)
    np.testing.assert_allclose(model.simulate(u, np.zeros(2)), plain(u), rtol=0.0, atol=1e-14)
    theta = np.broadcast_to(model.parameters, (len(u), 5))
    varying = simulate_varying(model.terms, theta, u, np.zeros(2))
    np.testing.assert_allclose(varying, plain(u), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("search", [Refined(rounds=20), Forward(1e-4, 1e-4)])
def test_selection_recovers_the_plant(record, search):
    model = dea.select_terms(
        record.u, record.y, y_lags=2, u_lags=2, degree=2, search=search, scaling=Scaling()
    )
    assert {str(term) for term in model.terms} == set(PLANT)
    theta = dict(zip(map(str, model.terms), model.parameters, strict=True))
    assert theta == pytest.approx(PLANT, abs=5e-3)


def test_orthogonal_selection_takes_the_terms_of_the_plant_first(record):
    model = dea.select_terms(
        record.u, record.y, y_lags=2, u_lags=2, degree=2, search=Orthogonal(5), scaling=Scaling()
    )
    assert {str(term) for term in model.terms} == set(PLANT)


def test_each_input_may_have_lags_of_its_own(record):
    model = dea.select_terms(record, y_lags=1, u_lags=[[1], [2, 3]], degree=1, search=Orthogonal())
    names = {str(term) for term in model.terms} - {"1"}
    assert names <= {"y(t-1)", "u1(t-1)", "u2(t-2)", "u2(t-3)"}
    assert {"u1(t-1)", "u2(t-2)"} <= names


def test_covariance_holds_the_error_of_the_parameters():
    model = NarxModel.from_terms(PLANT)
    u = excitation()
    errors = []
    for seed in range(40):
        y = plain(u) + np.random.default_rng(seed).normal(0.0, 0.01, len(u))
        fitted = refine(estimate(model.terms, u, y, scaling=Scaling()), u, y)
        errors.append((fitted.parameters - model.parameters) / fitted.standard_errors)
    assert np.std(errors) == pytest.approx(1.0, abs=0.15)


def test_prediction_over_several_samples_is_the_free_run_from_there(record):
    model = NarxModel.from_terms(PLANT)
    ahead = model.predict(record, steps=4)
    at = 300
    run = model.simulate(record.u[at - 5 : at + 1], record.y[at - 5 : at - 3])
    assert ahead[at] == pytest.approx(run[-1], abs=1e-12)
    assert model.score(record) > 0.999
    assert held_out_error(model, record) < 0.003


def test_a_found_model_names_its_inputs_and_survives_its_files(found, record, tmp_path):
    assert found.inputs == 2
    text = str(found)
    assert "u1 = (left " in text
    assert "u2 = (right " in text
    assert "<sub>2</sub>" in found._repr_html_()
    assert "u_{1,t-1}" in found._repr_latex_()
    found.save(tmp_path / "model.nc")
    loaded = NarxModel.load(tmp_path / "model.nc")
    from_text = NarxModel.from_dict(json.loads(json.dumps(found.to_dict())))
    for again in (loaded, from_text):
        assert again.terms == found.terms
        assert again.scaling == found.scaling
        assert again.labels == found.labels
        np.testing.assert_array_equal(again.simulate(record.u), found.simulate(record.u))
    assert str(loaded.stability()) == str(found.stability())
    assert loaded.stability().inputs.shape == found.stability().inputs.shape


def test_columns_of_a_frame_are_found_by_name(found, record):
    turned = pd.DataFrame({"right": record.u[:, 1], "left": record.u[:, 0]})
    expected = found.simulate(record.u)
    assert not np.allclose(found.simulate(record.u[:, ::-1]), expected)
    np.testing.assert_array_equal(found.simulate(turned), expected)
    np.testing.assert_array_equal(simulation_interval(found, turned).value, expected)
    assert found.score(turned, record.y) == found.score(record)
    np.testing.assert_array_equal(found.predict(turned, record.y), found.predict(record))
    with pytest.raises(InputError, match="names: the record has up, left, the model left, right"):
        found.simulate(turned.rename(columns={"right": "up"}))
    for unnamed in (turned[["left", "right"]].set_axis([0, 1], axis=1), record.u):
        np.testing.assert_array_equal(found.simulate(unnamed), expected)
    nameless = replace(found, labels=replace(found.labels, u_name=("input 1", "input 2")))
    assert nameless.score(turned[["left", "right"]], record.y) == found.score(record)
    default = turned.rename(columns={"left": "input 1", "right": "input 2"})
    assert nameless.score(default, record.y) == found.score(record)


def test_the_input_of_a_record_is_taken(found, record):
    expected = found.simulate(record.u)
    np.testing.assert_array_equal(found.simulate(record), expected)
    np.testing.assert_array_equal(simulation_interval(found, record).value, expected)
    with pytest.raises(InputError, match="sampling_rate: the record has 1000 Hz, the model"):
        found.simulate(record._replace(sampling_rate=1000.0))


def test_one_column_is_one_input(record):
    u, y = record.u[:, 0], record.y
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.2})
    np.testing.assert_array_equal(model.simulate(u[:, None], y), model.simulate(u, y))
    assert dea.Record.of(u[:, None], y, 10.0).u.shape == y.shape


@pytest.mark.parametrize(
    ("symbol", "scaling"), [("u1", Scaling()), ("u", Scaling((0.0,), np.array([1.0])))]
)
def test_a_single_input_may_be_numbered(symbol, scaling, record):
    u, y = record.u[:, 0], record.y
    plain = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)^2": 0.2})
    model = NarxModel.from_terms({"y(t-1)": 0.5, f"{symbol}(t-1)^2": 0.2}, scaling=scaling)
    assert model.inputs == 1
    for given in (u, u[:, None]):
        np.testing.assert_array_equal(model.simulate(given, y), plain.simulate(given, y))
    assert str(model.stability(u, y)) == str(plain.stability(u, y))
    code = dea.to_c(model, 10.0).source.replace(f"{symbol}(", "u(")
    assert code == dea.to_c(plain, 10.0).source


def test_stability_holds_no_input_outside_its_range():
    """Without an offset, as for an even system, zero may lie outside the range of an input."""
    model = NarxModel.from_terms({"y(t-1)": 1.2, "u1(t-1)": 0.1, "y(t-1)u2(t-1)": -0.2})
    u = excitation(400) + np.array([0.0, 4.0])
    report = model.stability(u, model.simulate(u))
    assert (report.inputs >= u.min(axis=0)).all()
    assert (report.inputs <= u.max(axis=0)).all()
    assert report.stable


@pytest.mark.parametrize(("inputs", "diagonals"), [(2, 2), (3, 4), (4, 8), (5, 8), (12, 8)])
def test_stability_tries_distinct_diagonals_and_no_more_than_eight(inputs, diagonals):
    u = excitation(60, inputs)
    first, again = (StabilityTest([(u, u[:, 0])]) for _ in range(2))
    np.testing.assert_array_equal(first.lines, again.lines)
    together = first.lines[inputs:]
    assert len(together) == diagonals
    assert len({tuple(line[0]) for line in together} | {tuple(line[-1]) for line in together}) == (
        2 * diagonals
    )
    low, high = u.min(axis=0), u.max(axis=0)
    for line in together:
        for ends in (line[0], line[-1]):
            assert np.all((ends == low) | (ends == high))
        assert line[0, 0] == low[0]


def test_stability_tries_the_inputs_together():
    """At u1 = u2 = 1 the pole is 1.1; with either input alone it is at most 0.8."""
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u1(t-1)": 0.1, "y(t-1)u1(t-1)u2(t-1)": 0.6})
    u = excitation(400)
    assert model.stability(u, model.simulate(u)).largest_pole == pytest.approx(1.1, abs=0.02)
    assert not model.stability(u, model.simulate(u)).stable
    calm = NarxModel.from_terms({"y(t-1)": 0.5, "u1(t-1)": 0.1, "u2(t-1)": 0.1})
    assert calm.stability(u, calm.simulate(u)).stable


def test_random_inputs_keep_the_relation_between_the_inputs():
    from dea.narx.surrogates import phase_randomised, same_class

    rng = np.random.default_rng(3)
    first = np.convolve(rng.standard_normal(2015), np.hanning(16), "valid")
    u = np.column_stack([first, -0.5 * np.roll(first, 5)])
    for draw in (phase_randomised, same_class):
        other = draw(u, rng)
        coupled = np.corrcoef(np.roll(other[:, 0], 5), other[:, 1])[0, 1]
        assert coupled < -0.95
        assert abs(np.corrcoef(u[:, 0], other[:, 0])[0, 1]) < 0.5
    np.testing.assert_array_equal(np.sort(same_class(u, rng), axis=0), np.sort(u, axis=0))


@pytest.mark.parametrize(
    ("terms", "u", "message"),
    [
        (PLANT, excitation()[:, 0], "one input for a model whose terms name inputs up to u2"),
        ({"u(t-1)": 1.0}, excitation(), "2 inputs for a model whose terms name a single input"),
        ({"u3(t-1)": 1.0}, excitation(), "2 inputs for a model whose terms name inputs up to u3"),
    ],
)
def test_inputs_that_are_not_the_model_s_are_refused(terms, u, message):
    with pytest.raises(InputError, match=message):
        NarxModel.from_terms(terms).simulate(u, np.zeros(2))
    with pytest.raises(InputError, match=message):
        regressor_matrix(tuple(map(Term.parse, terms)), u, np.zeros(len(u)))


def test_terms_that_do_not_say_which_input_are_refused():
    with pytest.raises(InputError, match=r"u\(t-1\) does not say which input, u2\(t-1\) does"):
        NarxModel.from_terms({"u(t-1)": 1.0, "u2(t-1)": 1.0})
    with pytest.raises(InputError, match="scaling is of 2"):
        NarxModel.from_terms({"u(t-1)": 1.0}, scaling=Scaling((0.0, 0.0), (1.0, 1.0)))


def test_unusable_inputs_are_refused(record):
    u = record.u.copy()
    u[:, 1] = 3.0
    with pytest.raises(InputError, match="input 2 is constant at 3"):
        dea.select_terms(u, record.y)
    u[10, 1] = np.nan
    with pytest.raises(InputError, match="first at sample 10 of input 2"):
        dea.select_terms(u, record.y)
    with pytest.raises(InputError, match="1 and 2 inputs"):
        dea.select_terms([record.u, record.u[:, 0]], [record.y, record.y])
    with pytest.raises(InputError, match="u_lags"):
        dea.select_terms(record, u_lags=[[1], [1], [1]])
    with pytest.raises(InputError, match="1 of 2 inputs"):
        dea.select_terms(u[:, 0], record.y, scaling=Scaling((0.0, 0.0), (1.0, 1.0)))
    with pytest.raises(InputError, match="names"):
        dea.Record.of(record.u, record.y, 10.0, names=(("left",), "position"))


@pytest.mark.parametrize(
    "handover",
    [
        lambda model: dea.to_c(model, 10.0),
        lambda model: dea.linearise(model, sampling_rate=10.0),
        lambda model: dea.OnlineTracker(model, np.ones(6)),
        lambda model: dea.to_iosystem(model, sampling_rate=10.0),
    ],
)
def test_what_knows_one_input_says_so(handover):
    with pytest.raises(InputError, match="models with one input, and this one has 2"):
        handover(NarxModel.from_terms(PLANT))


def test_a_diagnosis_is_of_the_inputs_of_its_simulation(record):
    with pytest.raises(InputError, match=r"the record has 2 inputs, .* cascaded_tanks has 1 input"):
        dea.diagnose(record, "cascaded_tanks")
