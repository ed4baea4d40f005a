import re

import numpy as np
import pytest
from hypothesis import given
from narx_strategies import models

from dea.errors import InputError
from dea.narx import NarxModel, Scaling, estimate, select_terms
from dea.terms import Term

SCALING = Scaling(u_offset=2.4, u_scale=0.7, y_offset=1.5, y_scale=0.3)
LINEAR = {"1": 0.1, "y(t-1)": 0.8, "u(t-1)": 0.5}


def read_equation(text):
    """The model that a printed equation describes, read without the library's help."""
    products = re.findall(r"([+-] )?(-?[\d.e+-]+)( [yu]\S*)?(?: |$)", text.removeprefix("y(t) = "))
    return NarxModel(
        tuple(Term.parse(monomial or "1") for _, _, monomial in products),
        np.array([float(sign.strip() + value) for sign, value, _ in products]),
    )


@given(models())
def test_the_printed_equation_is_the_one_simulated(model):
    u = np.random.default_rng(0).uniform(-1, 1, 30)
    np.testing.assert_array_equal(read_equation(str(model)).simulate(u), model.simulate(u))


def test_a_scaled_model_works_in_physical_units():
    model, scaled = NarxModel.from_terms(LINEAR), NarxModel.from_terms(LINEAR, scaling=SCALING)
    u = np.random.default_rng(0).uniform(-1, 1, 50)
    y = scaled.simulate(2.4 + 0.7 * u)
    np.testing.assert_allclose(y, 1.5 + 0.3 * model.simulate(u), rtol=1e-12)
    np.testing.assert_allclose(scaled.predict(2.4 + 0.7 * u, y), y, rtol=1e-12)
    assert str(scaled).endswith("u = (input - 2.4)/0.7, y = (output - 1.5)/0.3")


def test_offsets_are_printed_with_their_sign():
    scaling = Scaling(u_offset=-1.5, u_scale=2.0, y_offset=0.25, y_scale=0.5)
    text = str(NarxModel.from_terms({"y(t-1)": -0.5}, scaling=scaling))
    assert text == "y(t) = -0.5 y(t-1)\nu = (input + 1.5)/2.0, y = (output - 0.25)/0.5"


def test_the_run_starts_from_the_outputs_given():
    model = NarxModel.from_terms(LINEAR, scaling=SCALING)
    measured = np.linspace(3, 4, 20)
    y = model.simulate(np.ones(20), y_initial=measured)
    assert y[0] == pytest.approx(3.0)
    by_hand = 0.1 + 0.8 * (3.0 - 1.5) / 0.3 + 0.5 * (1.0 - 2.4) / 0.7
    assert y[1] == pytest.approx(1.5 + 0.3 * by_hand)


def test_a_run_without_initial_outputs_begins_at_rest():
    """Input and output were at their offsets before; the input acts from its first sample on."""
    slow = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0, "u(t-20)": 0.01})
    halves = [2.0 - 2.0 * 0.5**t for t in range(20)]
    np.testing.assert_allclose(slow.simulate(np.ones(22))[:20], halves)
    assert slow.simulate(np.ones(22))[20] == pytest.approx(2.0 - 2.0 * 0.5**20 + 0.01)
    at_once = NarxModel.from_terms({"1": 0.1, "y(t-2)": 0.5, "u(t)u(t-1)": 2.0}, scaling=SCALING)
    u = 2.4 + 0.7 * np.array([1.0, 2.0, 3.0])
    expected = [0.1, 0.1 + 4.0, 0.1 + 0.05 + 12.0]
    np.testing.assert_allclose(at_once.simulate(u), 1.5 + 0.3 * np.array(expected))
    two = NarxModel.from_terms({"u1(t-1)": 1.0, "u2(t-2)": 1.0})
    np.testing.assert_allclose(two.simulate([[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]]), [0, 1, 12])


def test_prediction_uses_the_measured_past():
    model = NarxModel.from_terms(LINEAR)
    u, y = np.array([1.0, 2.0, 3.0]), np.array([5.0, 7.0, 11.0])
    expected = [5.0, 0.1 + 0.8 * 5 + 0.5 * 1, 0.1 + 0.8 * 7 + 0.5 * 2]
    np.testing.assert_allclose(model.predict(u, y), expected)


def test_models_save_and_load(tmp_path):
    model = NarxModel.from_terms(LINEAR, scaling=SCALING)
    model = model.with_parameters(model.parameters * 1.1, np.diag([1.0, 4.0, 9.0]))
    model.save(tmp_path / "mine.nc", u_units="V", y_units="mm")
    back = NarxModel.load(tmp_path / "mine.nc")
    assert (back.terms, back.scaling, str(back)) == (model.terms, SCALING, str(model))
    np.testing.assert_array_equal(back.parameters, model.parameters)
    np.testing.assert_array_equal(back.standard_errors, [1.0, 2.0, 3.0])
    assert NarxModel.from_terms(LINEAR).standard_errors is None
    assert back.trace is None


@pytest.mark.parametrize(
    ("terms", "message"),
    [
        ({"y(t-1)": 1.0, "v(t-1)": 1.0}, "v\\(t-1\\)"),
        ({"y(t-1)u(t-1)": 1.0, "u(t-1)y(t-1)": 1.0}, "twice"),
        ({"y(t-1)": float("nan")}, "not numbers"),
        ({}, "no term"),
    ],
)
def test_impossible_models_are_refused(terms, message):
    with pytest.raises(InputError, match=message):
        NarxModel.from_terms(terms)


def test_terms_without_parameters_are_refused():
    with pytest.raises(InputError, match=r"terms: it is list\. Give each its parameter"):
        NarxModel.from_terms(["u(t)"])


def test_bad_signals_are_refused():
    model = NarxModel.from_terms(LINEAR)
    with pytest.raises(InputError, match="the first at sample 1"):
        model.simulate([1.0, np.nan])
    with pytest.raises(InputError, match="dimensions"):
        model.simulate([[[1.0, 2.0]]])
    with pytest.raises(InputError, match="2 inputs for a model whose terms name a single input"):
        model.simulate([[1.0, 2.0]])
    with pytest.raises(InputError, match="no numbers"):
        model.simulate(["one", "two"])
    with pytest.raises(InputError, match="parameters: it holds no numbers"):
        NarxModel.from_terms({"y(t-1)": "half"})
    with pytest.raises(InputError, match="sampled together"):
        model.predict([1.0, 2.0], [1.0])
    with pytest.raises(InputError, match="u_scale"):
        Scaling(u_scale=0.0)


def test_a_model_takes_terms_as_people_write_them():
    model = NarxModel(("y(t-1)", "u(t-2)"), [0.5, 0.3])
    assert model.terms == NarxModel.from_terms({"y(t-1)": 0.5, "u(t-2)": 0.3}).terms
    with pytest.raises(InputError, match="term"):
        NarxModel(("z(t-1)",), [0.5])


def test_what_is_no_scaling_is_refused():
    u = np.random.default_rng(0).uniform(-1.0, 1.0, 100)
    wrong, told = {"u_scale": 2.0}, r"scaling: it is dict\. Give a dea\.narx\.Scaling"
    for make in (
        lambda: NarxModel(("y(t-1)",), [0.5], wrong),
        lambda: estimate(("u(t)",), u, 2.0 * u, scaling=wrong),
        lambda: select_terms(u, 2.0 * u, scaling=wrong),
    ):
        with pytest.raises(InputError, match=told):
            make()
    with pytest.raises(InputError, match="scaling: it holds gain"):
        NarxModel.from_dict({"terms": {"y(t-1)": 0.5}, "scaling": {"gain": 2.0}})


@pytest.mark.parametrize("steps", ["2", 0, 1.5, None])
def test_a_prediction_is_a_whole_number_of_samples_ahead(steps):
    model = NarxModel.from_terms(LINEAR)
    with pytest.raises(InputError, match=f"steps: it is {steps!r}"):
        model.predict(np.ones(9), np.ones(9), steps=steps)
