from dataclasses import replace

import numpy as np
import pytest

import dea
from dea.errors import InputError
from dea.gfrf import zero_input_response
from dea.narx import NarxModel, Scaling, UnstableModel, select_terms
from dea.narx.rest import _nearest, rests_over
from dea.narx.simulation import bounded, simulate
from dea.narx.stability import Stability, StabilityTest, time_constant
from dea.narx.surrogates import phase_randomised, same_class
from dea.terms import Term

# At rest y = 0.5 y + 0.3 u + 0.2 u^2: poles at 0.5 whatever the input.
CALM = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.3, "u(t-1)^2": 0.2})
# Its pole is 0.8 + 0.3 u: beyond 1 for an input above 2/3.
RUNAWAY = NarxModel.from_terms({"y(t-1)": 0.8, "y(t-1)u(t-1)": 0.3, "u(t-1)": 0.1})
SLOW = NarxModel.from_terms({"y(t-1)": 0.9995, "u(t-1)": 0.01})


def inputs(samples=2000, seed=0):
    noise = np.random.default_rng(seed).standard_normal(samples + 60)
    smooth = np.convolve(noise, np.hanning(60), "valid")[:samples]
    return smooth / np.abs(smooth).max()


@pytest.mark.parametrize(
    ("model", "status"), [(CALM, "stable"), (RUNAWAY, "unstable"), (SLOW, "slow")]
)
def test_the_status_tells_stable_slow_and_unstable_models_apart(model, status):
    u = inputs()
    report = model.stability(u, CALM.simulate(u))
    assert report.status == status
    assert report.stable == (status == "stable")
    assert str(report).startswith(status)


def test_a_record_alone_is_the_one_that_the_model_is_tried_on():
    u = 50.0 * inputs()
    y = CALM.simulate(u)
    report = RUNAWAY.stability(dea.Record.of(u, y, sampling_rate=10.0))
    assert str(report) == str(RUNAWAY.stability(u, y))
    assert report.inputs[-1] == pytest.approx(u.max())
    with pytest.raises(InputError, match="there is no output"):
        RUNAWAY.stability(u)


def test_poles_are_those_of_the_equation_over_the_whole_input_range():
    u = inputs()
    report = RUNAWAY.stability(u, CALM.simulate(u))
    assert report.inputs[[0, -1]] == pytest.approx([u.min(), u.max()])
    np.testing.assert_allclose(report.poles, np.abs(0.8 + 0.3 * report.inputs), rtol=1e-12)
    np.testing.assert_allclose(
        report.outputs, 0.1 * report.inputs / (0.2 - 0.3 * report.inputs), rtol=1e-9
    )
    assert report.holds == (int(np.sum(np.linspace(u.min(), u.max(), 20) < 2 / 3)), 20)
    assert (report.runs[1], report.surrogates[1]) == (100, 20)


@pytest.mark.parametrize(
    ("modulus", "samples"), [(0.0, 0.0), (np.exp(-0.1), 10.0), (1.0, np.inf), (1.2, np.inf)]
)
def test_the_time_constant_is_that_of_the_decay(modulus, samples):
    assert time_constant(modulus) == pytest.approx(samples)


def test_rests_are_those_that_the_frequency_responses_are_taken_around():
    model = NarxModel.from_terms(
        {"1": 0.02, "y(t-1)": 1.1, "y(t-2)": -0.3, "u(t-1)": 0.1, "y(t-1)u(t-1)^2": 0.05,
         "y(t-2)^3": -0.1}
    )  # fmt: skip
    levels = np.linspace(-1, 1, 9)
    found = rests_over(model.terms, model.parameters, levels)
    settled = [model.simulate(np.full(5000, level))[-1] for level in levels]
    np.testing.assert_allclose(found.outputs, settled, atol=1e-9)
    assert found.outputs[4] == pytest.approx(float(zero_input_response(model)))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_of_several_rests_that_is_followed_which_is_nearest_to_zero_without_input(sign):
    """At rest y**3 - y = u: of -1, 0 and 1 the middle one, which ends at u**2 = 4/27."""
    model = NarxModel.from_terms({"y(t-1)": 2.0, "y(t-1)^3": -1.0, "u(t-1)": 1.0})
    levels = sign * np.linspace(0.0, 1.0, 6)
    found = rests_over(model.terms, model.parameters, levels).outputs
    np.testing.assert_allclose(found**3 - found, levels, atol=1e-9)
    held = levels**2 < 4 / 27
    assert np.count_nonzero(held) == 2
    assert (sign * found[held] <= 0.0).all()
    assert (sign * found[~held] > 1.0).all()


def test_a_model_without_a_rest_is_unstable_there():
    model = NarxModel.from_terms({"1": 1.0, "y(t-1)": 1.0, "y(t-1)^2": 1.0, "u(t-1)": 0.1})
    found = rests_over(model.terms, model.parameters, np.array([-1.0, 0.0, 1.0]))
    assert np.isnan(found.outputs).all()
    assert np.isposinf(found.poles).all()


def test_random_inputs_have_the_values_and_nearly_the_spectrum_of_the_record():
    rng = np.random.default_rng(1)
    for u in (np.sign(inputs()), inputs()):
        same, other = same_class(u, rng), phase_randomised(u, rng)
        np.testing.assert_array_equal(np.sort(same), np.sort(u))
        assert not np.array_equal(same, u)
        assert other.min() >= u.min()
        assert other.max() <= u.max()

    def share_below(signal, line):
        power = np.abs(np.fft.rfft(signal - signal.mean())) ** 2
        return power[:line].sum() / power.sum()

    for surrogate in (same, other):
        assert share_below(surrogate, 60) == pytest.approx(share_below(u, 60), abs=0.02)


@pytest.mark.parametrize("samples", [1000, 1001])
def test_phase_randomised_inputs_within_the_range_keep_the_spectrum_exactly(samples):
    u = inputs(samples)
    wide = np.concatenate([u, [-9.0, 9.0]])  # so that nothing is cut off
    found = phase_randomised(wide, np.random.default_rng(0))
    np.testing.assert_allclose(np.abs(np.fft.rfft(found)), np.abs(np.fft.rfft(wide)), atol=1e-9)


def test_random_inputs_of_one_record_are_the_same_each_time():
    u = inputs(500)
    one, other = StabilityTest([(u, u)]), StabilityTest([(u, u)])
    np.testing.assert_array_equal(one.random, other.random)


def test_a_selected_model_reports_its_final_parameters_and_keeps_the_report(tmp_path):
    u = inputs()
    y = CALM.simulate(u) + 1e-3 * np.random.default_rng(2).standard_normal(u.size)
    found = select_terms(u, y, y_lags=2, u_lags=2, degree=2)
    report = found.stability()
    assert report.stable
    again = found.stability(u, y)
    np.testing.assert_array_equal(report.poles, again.poles)
    found.save(tmp_path / "model.nc")
    assert str(NarxModel.load(tmp_path / "model.nc").stability()) == str(report)
    with pytest.raises(InputError, match="not selected from a record"):
        found.with_parameters(found.parameters).stability()


def test_a_plant_without_a_stable_model_is_returned_with_a_warning():
    """An integrator: its pole is one, and without it nothing explains the output."""
    plant = NarxModel.from_terms({"y(t-1)": 1.0, "u(t-1)": 0.01})
    u = np.random.default_rng(3).uniform(-1, 1, 800)
    y = plant.simulate(u)
    settings = {"y_lags": [1], "u_lags": [1], "degree": 1, "scaling": Scaling()}
    with pytest.warns(UnstableModel, match=r"unstable|slow"):
        found = select_terms(u, y, **settings)
    assert found.stability().status in ("unstable", "slow")


def test_runs_side_by_side_stay_bounded_where_each_alone_does():
    terms = tuple(
        map(Term.parse, ("1", "y(t-1)", "y(t-1)y(t-2)u(t-1)", "u(t-1)^2u(t-3)", "u(t-2)"))
    )
    parameters = np.array([0.05, 0.7, 0.25, 0.2, 0.3])
    driven = [scale * inputs(700, seed) for seed, scale in enumerate(np.linspace(0.5, 4.0, 9))]
    alone = [
        bool(np.isfinite(simulate(terms, parameters, u, np.zeros(700), bound=5.0)[-1]))
        for u in driven
    ]
    assert set(alone) == {True, False}
    together = np.stack(driven, axis=-1)[None]
    assert bounded(terms, parameters, together, 5.0).tolist() == alone
    assert not bounded(terms, parameters, together, 5.0, every=True).any()
    assert bounded(terms, parameters, together[:, :, alone], 5.0, every=True).all()


@pytest.mark.parametrize(("near", "root"), [(0.8, 0.9), (-0.8, -1.0), (0.0, 0.9)])
def test_the_rest_taken_is_the_nearest(near, root):
    assert _nearest(np.array([-1.0, 0.9]), near) == root
    assert np.isnan(_nearest(np.empty(0), near))


@pytest.mark.parametrize("leading", [1e-30, 1e-16, -1e-12, 1e-6])
def test_a_term_that_hardly_counts_does_not_move_the_rest(leading):
    """The root of the linear equation, to first order in what the term adds."""
    terms = (Term(), Term((1,)), Term((), (1,)), Term((1, 1)))
    inputs = np.linspace(-1.0, 1.0, 21)
    found = rests_over(terms, np.array([0.1, 0.5, 0.3, leading]), inputs, 100.0).outputs
    linear = (0.1 + 0.3 * inputs) / 0.5
    np.testing.assert_allclose(found, linear + leading * linear**2 / 0.5, rtol=0.0, atol=1e-11)


def test_a_model_in_physical_units_is_tried_at_the_level_of_its_record():
    """The same dynamics about zero and about 30; from zero the latter leaves every bound."""
    rng = np.random.default_rng(0)
    u = rng.uniform(-1.0, 1.0, 1000)
    centred = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.2, "y(t-1)^2": 0.04})
    # z = y + 30: z' = 30 + 0.8 (z - 30) + 0.2 u + 0.04 (z - 30)^2
    raised = NarxModel.from_terms({"1": 42.0, "y(t-1)": -1.6, "u(t-1)": 0.2, "y(t-1)^2": 0.04})
    y, z = centred.simulate(u), raised.simulate(u, [30.0])
    np.testing.assert_allclose(z - 30.0, y, atol=1e-9)
    report, other = centred.stability(u, y), raised.stability(u, z)
    assert (report.holds, report.runs) == (other.holds, other.runs) == ((20, 20), (100, 100))
    np.testing.assert_allclose(other.outputs - 30.0, report.outputs, atol=1e-9)


def test_inputs_without_a_rest_are_told_beside_the_poles_of_the_others():
    """An integrator with a leak too small to come to rest within the range of its record."""
    poles = np.array([0.9992, np.inf, np.inf])
    report = Stability(
        np.array([0.0, 1.0, 2.0]), np.array([0.0, np.nan, np.nan]), poles,
        (1, 3), (0, 10), (0, 10), 600,
    )  # fmt: skip
    assert str(report).startswith(
        "unstable: no rest at 2 of 3 constant inputs, largest pole 0.99920 (at an input of 0, "
        "time constant 1249 samples); 1 of 3 holds bounded"
    )
    nowhere = replace(report, poles=np.full(3, np.inf))
    assert str(nowhere).startswith("unstable: no rest at 3 of 3 constant inputs; 1 of 3")


@pytest.mark.parametrize("level", [0.0, 1000.0])
def test_how_far_a_run_may_go_does_not_depend_on_the_level_of_the_output(level):
    """The level is a parameter of the equation or an offset of its scaling."""
    u = inputs()
    y = level + CALM.simulate(u)
    # z = level + x: z' = level + (0.8 + 0.3 u) (z - level) + 0.1 u
    raised = NarxModel.from_terms(
        {"1": 0.2 * level, "y(t-1)": 0.8, "y(t-1)u(t-1)": 0.3, "u(t-1)": 0.1 - 0.3 * level}
    )
    offset = replace(RUNAWAY, scaling=Scaling(y_offset=level))
    for driven in (u, 2.0 * u):
        found = [model.stability(driven, y) for model in (raised, offset)]
        assert found[0].status == found[1].status == "unstable"
        assert len({each.holds for each in found}) == len({each.runs for each in found}) == 1


def test_a_constant_output_has_no_range_to_compare_runs_with():
    with pytest.raises(InputError, match="y: it is constant"):
        CALM.stability(inputs(), np.full(2000, 3.0))


def test_random_inputs_are_like_the_whole_of_a_long_record():
    """From half-way on the input is ten times as large, which the model does not survive."""
    model = NarxModel.from_terms({"y(t-1)u(t-1)": 3.0, "y(t-1)u(t-2)": -3.0, "u(t-1)": 0.1})
    u = np.random.default_rng(4).uniform(-1.0, 1.0, 40_000)
    u[:20_000] *= 0.1
    y = CALM.simulate(u)
    for driven, measured in ((u, y), (u[::-1], y[::-1])):
        kept, tried = model.stability(driven, measured).runs
        assert kept < tried


def test_inputs_are_stored_for_one_period_of_what_they_repeat():
    terms, parameters = RUNAWAY.terms, RUNAWAY.parameters
    test = StabilityTest([(inputs(700), inputs(700))])
    assert (test.holds.shape, test.random.shape) == ((1, 1, 20), (1, 700, 120))
    for stored, copies in ((test.holds, 5000), (test.random, 8)):
        whole = np.concatenate([stored] * copies, axis=1)
        given = {"bound": 3.0, "start": 0.1}
        kept = bounded(terms, parameters, stored, samples=whole.shape[1], **given)
        assert kept.tolist() == bounded(terms, parameters, whole, **given).tolist()
        assert set(kept) == {True, False}
