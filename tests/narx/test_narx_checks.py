"""What is refused, and what is just allowed; the ratio by which terms are chosen."""

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.errors import InputError
from dea.narx import Scaling, estimate, regressor_matrix, select_terms
from dea.narx.checks import as_input, as_record, as_signal, check_inputs
from dea.narx.estimation import least_squares, scaling_of
from dea.narx.held_out import held_out_error
from dea.narx.metrics import fpe
from dea.narx.model import NarxModel
from dea.narx.simulation import simulate, simulate_varying
from dea.narx.trace import serr
from dea.narx.validation import Windows, validate
from dea.store import Record
from dea.terms import Term

MODEL = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-2)": 0.3})


def record(samples, seed=0):
    u = np.random.default_rng(seed).standard_normal(samples)
    return u, MODEL.simulate(u) + 0.1 * u


def test_as_many_equations_as_parameters_are_enough():
    u, y = record(9)
    assert as_record(u, y, 3, 6)[0].size == 9
    assert estimate(MODEL.terms, u[:4], y[:4], scaling=Scaling()).parameters.size == 2
    with pytest.raises(InputError, match="9 samples leave 6 equations after a lag of 3, for 7"):
        as_record(u, y, 3, 7)
    with pytest.raises(InputError, match="leave 0 equations"):
        as_record(u, y, 9)
    with pytest.raises(InputError, match="leave 0 equations"):
        as_record(u, y, 12)
    assert as_record(u, y, 8)[1].size == 9


def test_the_covariance_counts_the_parameters_that_the_data_determine():
    """A doubled regressor shares its parameter; the degrees of freedom are those of the rank."""
    u, y = record(60)
    once = (Term.parse("y(t-1)"), Term.parse("u(t-2)"))
    found = least_squares(once, [(u, y)])
    theta, covariance = found.parameters, found.covariance
    again = least_squares((*once, once[1]), [(u, y)])
    doubled, wide = again.parameters, again.covariance
    np.testing.assert_allclose(doubled, [theta[0], theta[1] / 2, theta[1] / 2], rtol=1e-9)
    matrix = regressor_matrix(once, u, y)
    rest = y[2:] - matrix @ theta
    variance = rest @ rest / (58 - 2)
    np.testing.assert_allclose(covariance, variance * np.linalg.inv(matrix.T @ matrix), rtol=1e-9)
    sum_of_both = np.array([[1, 0, 0], [0, 1, 1]])
    np.testing.assert_allclose(sum_of_both @ wide @ sum_of_both.T, covariance, rtol=1e-9)


def test_outputs_that_every_run_would_count_as_diverged_are_refused():
    u, y = record(200)
    large = y * 1e10 / np.abs(y).max()
    start = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-2)": 0.3})
    for tried in (
        lambda: estimate(MODEL.terms, u, large, scaling=Scaling()),
        lambda: select_terms(u, large, y_lags=1, u_lags=2, degree=1, scaling=Scaling()),
        lambda: start.score(u, large),
        lambda: start.predict(u, large),
    ):
        with pytest.raises(InputError, match=r"y: sample .* larger units, or leave scaling out"):
            tried()
    assert estimate(MODEL.terms, u, large).score(u, large) > 0.5
    assert estimate(MODEL.terms, u, large / 4, scaling=Scaling()).score(u, large / 4) > 0.5


def test_an_even_model_is_scaled_about_zero():
    records = [(np.array([1.0, 3.0, 5.0]), np.array([0.0, 4.0, 8.0]))]
    assert scaling_of(records, centre_input=False) == Scaling(0.0, 2.0, 4.0, 4.0)


def test_a_scaling_leads_there_and_back():
    scaling = Scaling(u_offset=2.0, u_scale=4.0, y_offset=-1.0, y_scale=0.5)
    assert scaling.normalise_input(np.array([2.0, 6.0])).tolist() == [0.0, 1.0]
    assert scaling.normalise_output(np.array([-1.0, -0.5])).tolist() == [0.0, 1.0]
    assert scaling.restore_output(np.array([0.0, 1.0])).tolist() == [-1.0, -0.5]
    for wrong in ({"u_scale": -1.0}, {"y_scale": 0.0}, {"y_offset": np.inf}):
        with pytest.raises(InputError):
            Scaling(**wrong)
    assert Scaling(y_offset=-3.0).y_offset == -3.0


def test_the_ratio_is_a_share_of_the_power_and_infinite_where_a_run_diverges():
    assert serr(5.0, 3.0, 4.0) == 0.5
    assert serr(3.0, 5.0, 4.0) == -0.5
    assert serr(np.inf, 3.0, 4.0) == np.inf
    assert serr(5.0, np.inf, 4.0) == serr(np.inf, np.inf, 4.0) == -np.inf


def test_the_final_prediction_error_of_one_sample_more_than_terms_is_finite():
    y, run = np.array([1.0, 2.0, 3.0, 4.0]), np.array([1.0, 2.0, 3.0, 6.0])
    assert fpe(y, run, 3) == pytest.approx(1.0 * 1.75 / 0.25)
    assert fpe(y, run, 4) == fpe(y, run, 5) == np.inf


def test_a_run_may_reach_its_bound_and_not_exceed_it():
    """y doubles from one: the bound is met at the third step."""
    terms, theta = (Term.parse("y(t-1)"),), np.array([2.0])
    for sign in (1.0, -1.0):
        start = np.array([sign])
        for bound, last in ((8.0, 3), (7.9, 2)):
            runs = [
                simulate(terms, theta, np.zeros(6), start, bound),
                simulate_varying(terms, np.full((6, 1), 2.0), np.zeros(6), start, bound),
            ]
            for run in runs:
                assert np.flatnonzero(np.isfinite(run)).tolist() == list(range(last + 1))
                assert np.isposinf(run[last + 1 :]).all()


def test_parts_may_be_as_short_as_the_lags_and_two():
    u, y = record(16)
    assert np.isfinite(held_out_error(MODEL, u, y, parts=4))
    with pytest.raises(InputError, match="5 parts of 16 samples"):
        held_out_error(MODEL, u, y, parts=5)


@pytest.mark.parametrize(
    ("windows", "before", "fits"),
    [
        ([(20.0, 26.0), (4.0, 10.0)], 4.0, True),  # from the first sample to the last
        ([(20.0, 26.1), (4.0, 10.1)], 4.0, False),
        ([(20.0, 26.0), (3.9, 9.9)], 4.0, False),
        ([(20.0, 24.1)], 4.0, True),  # one sample longer than twice the lags
        ([(20.0, 24.0)], 4.0, False),
        ([(20.0, 26.0)], 0.0, False),
    ],
)
def test_windows_use_the_whole_record_and_no_more(windows, before, fits):
    u, y = record(260)
    chosen = Windows(windows, before, max_lag=20)
    if fits:
        found = validate({"model": MODEL}, u, y, 10.0, chosen)
        np.testing.assert_array_equal(found.measured[0], y[200 : round(10 * windows[0][1])])
        np.testing.assert_array_equal(found.input[-1][0], u[round(10 * windows[-1][0])])
    else:
        with pytest.raises(InputError, match="windows"):
            validate({"model": MODEL}, u, y, 10.0, chosen)


def test_a_stretch_of_a_record_may_be_at_rest():
    """A hold between two samples that are missing, and a decay from a state that was driven to."""
    terms = NarxModel.from_terms({"y(t-1)": 0.0, "u(t-1)": 0.0}).terms
    u = np.repeat(np.random.default_rng(3).standard_normal(30), 40)
    y = lfilter([0.0, 0.3], [1.0, -0.7], u)
    u_rest, decay = np.zeros(60), 0.7 ** np.arange(60)
    parameters = estimate(terms, [u, u_rest], [y, decay], scaling=None).parameters
    np.testing.assert_allclose(parameters, [0.7, 0.3], atol=1e-6)
    gappy = y.copy()
    gappy[[202, 238]] = np.nan
    found = select_terms(Record.of(u, gappy, 10.0), y_lags=1, u_lags=1, degree=1)
    assert {str(term) for term in found.terms} >= {"y(t-1)", "u(t-1)"}
    with pytest.raises(InputError, match="it is constant at 0"):
        estimate(terms, [u_rest, u_rest], [decay, decay], scaling=None)


def test_a_signal_is_refused_by_its_dimensions_and_by_its_first_bad_sample():
    for values, words in (
        (np.ones((3, 2)), "y: it has 2 dimensions"),
        ([1.0, 2.0, np.nan, 4.0, np.inf], "y: 2 of 5 samples are not numbers, .* at sample 2"),
        ([1.0, "two"], "y: it holds no numbers"),
    ):
        with pytest.raises(InputError, match=words):
            as_signal(values, "y")
    found = as_signal([1.0, np.nan, 3.0], "y", missing=True)
    np.testing.assert_array_equal(found, [1.0, np.nan, 3.0])
    with pytest.raises(InputError, match="1 of 3 samples are not numbers, the first at sample 2"):
        as_signal([1.0, np.nan, -np.inf], "y", missing=True)


def test_one_column_is_one_input_and_several_lie_column_by_column():
    np.testing.assert_array_equal(as_input(np.arange(3.0)[:, None]), [0.0, 1.0, 2.0])
    several = np.arange(8.0).reshape(4, 2)
    found = as_input(several)
    np.testing.assert_array_equal(found, several)
    assert found.flags.f_contiguous
    assert as_signal(several[:, 1], "y").flags.c_contiguous
    with pytest.raises(InputError, match="u: it has 3 dimensions"):
        as_input(np.ones((2, 2, 1)))


def test_a_bad_sample_of_several_inputs_is_named_with_its_input():
    several = np.zeros((6, 3))
    several[4, 0] = several[3, 2] = several[3, 1] = np.nan
    with pytest.raises(InputError, match=r"3 of 18 samples .* at sample 3 of input 2"):
        as_input(several)
    several = np.zeros((6, 2))
    several[0, 0] = np.inf
    with pytest.raises(InputError, match=r"1 of 12 samples .* at sample 0 of input 1"):
        as_input(several)


@pytest.mark.parametrize(
    ("numbered", "inputs", "words"),
    [
        (None, 1, None),  # terms without an input
        (None, 3, None),
        (0, 1, None),
        (1, 1, None),
        (2, 2, None),
        (2, 3, None),
        (0, 2, "2 inputs for a model whose terms name a single input, u"),
        (2, 1, "one input for a model whose terms name inputs up to u2"),
        (3, 2, "2 inputs for a model whose terms name inputs up to u3"),
    ],
)
def test_a_model_takes_no_fewer_inputs_than_its_terms_name(numbered, inputs, words):
    u = np.zeros((5, inputs)) if inputs > 1 else np.zeros(5)
    if words is None:
        check_inputs(numbered, u)
    else:
        with pytest.raises(InputError, match=words):
            check_inputs(numbered, u)


def test_signals_of_other_lengths_are_no_record():
    u, y = record(9)
    with pytest.raises(InputError, match="y: it has 8 samples and u has 9"):
        as_record(u, y[:8])
    several = np.column_stack([u, u])
    found, _ = as_record(several, y)
    np.testing.assert_array_equal(found, several)


def test_a_record_needs_an_equation_though_no_terms_are_counted():
    u, y = record(4)
    assert as_record(u, y, 3)[0].size == 4
    with pytest.raises(InputError, match="4 samples leave 0 equations after a lag of 4"):
        as_record(u, y, 4)
    with pytest.raises(InputError, match="1 sample leaves 0 equations after a lag of 4"):
        as_record(u[:1], y[:1], 4)
    with pytest.raises(InputError, match="it has 1 sample and u has 4"):
        as_record(u, y[:1])


@pytest.mark.parametrize(
    ("signal", "values", "words"),
    [
        ("u", [2.5] * 6, "u: it is constant at 2.5"),
        ("y", [2.5] * 6, "y: it is constant at 2.5"),
        ("y", [np.nan, 2.5, np.nan, 2.5, 2.5, np.nan], "y: it is constant at 2.5"),
        ("y", [np.nan] * 6, "y: every sample is missing"),
        ("u", [[2.0, 3.0]] * 6, "u: it is constant at 2, 3"),
    ],
)
def test_a_signal_that_does_not_vary_is_refused(signal, values, words):
    signals = dict(zip("uy", record(6), strict=True)) | {signal: np.array(values)}
    with pytest.raises(InputError, match=words):
        as_record(**signals, missing=True)


def test_one_input_that_varies_is_enough():
    u, y = record(6)
    for several in (np.column_stack([u, np.ones(6)]), np.column_stack([np.ones(6), u])):
        np.testing.assert_array_equal(as_record(several, y)[0], several)
    with pytest.raises(InputError, match="y: 1 of 6 samples are not numbers"):
        as_record(u, np.where(np.arange(6) == 2, np.nan, y))
