"""Linear models: against finite differences, python-control's own, and the frequency responses."""

from dataclasses import replace

import numpy as np
import pytest

import control
import dea
from dea.control import linearise, linearise_over_time, to_iosystem
from dea.errors import InputError
from dea.gfrf import zero_input_response
from dea.narx import Labels, NarxModel, Scaling
from dea.tracking import with_constant
from published_plants import published_plants, smooth_input

RATE = 50.0
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=-0.2, y_scale=0.7)
MODELS = {
    name: NarxModel(plant.terms, plant.parameters, SCALING)
    for name, plant in published_plants().items()
}
MODELS["feedthrough"] = NarxModel.from_terms(
    {"1": 0.1, "y(t-1)": 0.5, "y(t-2)^2": 0.1, "u(t)": 0.3, "u(t)u(t-3)": 0.2}, scaling=SCALING
)
POINT = 2.7


@pytest.mark.parametrize("name", MODELS)
def test_both_forms_have_the_frequency_response_of_the_probing_method(name):
    model, f = MODELS[name], np.array([0.1, 1.0, 7.0, 20.0])
    expected = dea.frequency_response(model, 1, f, RATE, operating_point=POINT)
    linear = linearise(model, POINT, sampling_rate=RATE)
    for system in (linear.transfer_function(), linear.state_space()):
        found = system(np.exp(2j * np.pi * f / RATE))
        np.testing.assert_allclose(found, expected, rtol=1e-9)
        assert system.dt == pytest.approx(1 / RATE)


@pytest.mark.parametrize("name", MODELS)
def test_small_steps_of_the_free_run_follow_it(name):
    model, small, samples = MODELS[name], 1e-6, 300
    linear = linearise(model, POINT, sampling_rate=RATE)
    rest = zero_input_response(model, operating_point=POINT)
    assert linear.output.value == pytest.approx(rest, abs=1e-14)
    lag = model.max_lag
    u = np.full(samples + lag, POINT)
    u[lag:] += small
    run = model.simulate(u, np.full(lag, rest))[lag:]
    time = np.arange(samples) / RATE
    step = control.forced_response(linear.state_space(), time, np.full(samples, small)).outputs
    np.testing.assert_allclose(run - rest, step, rtol=1e-3, atol=1e-4 * np.ptp(step))


@pytest.mark.parametrize("name", MODELS)
def test_python_control_simulates_the_free_run(name):
    model, u = MODELS[name], SCALING.restore_input(0.7 * smooth_input(400))
    expected = model.simulate(u)
    system = to_iosystem(model, RATE)
    found = control.input_output_response(system, np.arange(u.size) / RATE, u)
    np.testing.assert_allclose(found.outputs, expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("name", ["DEA2", "DEA6", "feedthrough"])
def test_python_control_linearises_the_nonlinear_system_to_the_same(name):
    model = MODELS[name]
    linear, system = linearise(model, POINT, sampling_rate=RATE), to_iosystem(model, RATE)
    u0 = SCALING.normalise_input(np.array(POINT))
    y0 = SCALING.normalise_output(linear.output.value)
    state = np.array([y0 if label.startswith("y") else u0 for label in system.state_labels])
    numerical = control.linearize(system, state, [POINT])
    z = np.exp(2j * np.pi * np.array([0.2, 3.0]) / RATE)
    np.testing.assert_allclose(linear.transfer_function()(z), numerical(z), rtol=1e-4)


def noisy_record(plant, seed, samples=3000):
    rng = np.random.default_rng(seed)
    u = SCALING.restore_input(rng.uniform(-0.7, 0.7, samples))
    noise = 1e-3 * rng.standard_normal(samples)
    return u, plant.simulate(u) + noise


def test_intervals_are_the_spread_of_refined_estimates():
    plant = MODELS["DEA2"]
    found = []
    for seed in range(24):
        u, y = noisy_record(plant, seed)
        model = dea.narx.refine(dea.narx.estimate(plant.terms, u, y, scaling=SCALING), u, y)
        found.append(linearise(model, POINT, sampling_rate=RATE))
    for part in ("numerator", "denominator"):
        values = np.array([getattr(each, part).value for each in found])
        reach = np.array([getattr(each, part).high - getattr(each, part).value for each in found])
        moving = values.std(axis=0) > 0
        ratio = 1.96 * values.std(axis=0)[moving] / reach.mean(axis=0)[moving]
        assert moving.sum() >= 2
        assert np.all((ratio > 0.6) & (ratio < 1.6)), ratio


def test_without_a_covariance_there_are_values_and_no_intervals():
    linear = linearise(MODELS["DEA3"], sampling_rate=RATE)
    assert linear.input == SCALING.u_offset
    assert np.all(np.isfinite(linear.numerator.value))
    assert np.all(np.isnan(linear.numerator.low))
    assert linear.denominator.value[0] == 1.0


def test_a_track_gives_a_linear_model_at_each_instant():
    plant = MODELS["DEA2"]
    u, y = noisy_record(plant, 7)
    model = dea.narx.refine(dea.narx.estimate(plant.terms, u, y, scaling=SCALING), u, y)
    track = dea.track_parameters(model, u, y, method="output_error", sampling_rate=RATE, instants=5)
    systems = linearise_over_time(with_constant(model), track, sampling_rate=RATE)
    assert list(systems) == track["instant"].values.tolist()
    assert track.attrs["withheld"] == ""
    true = linearise(plant, sampling_rate=RATE).transfer_function()
    for system in systems.values():
        assert np.all(system.numerator.high >= system.numerator.low)
        assert np.any(system.numerator.high > system.numerator.low)
        assert control.dcgain(system.transfer_function()) == pytest.approx(
            control.dcgain(true), rel=0.02
        )


def test_a_track_of_other_terms_is_refused():
    plant = MODELS["DEA2"]
    u, y = noisy_record(plant, 1, 400)
    track = dea.track_parameters(plant, u, y, instants=3, sampling_rate=RATE)
    with pytest.raises(InputError, match="track"):
        linearise_over_time(MODELS["DEA1"], track, sampling_rate=RATE)


def test_a_model_that_does_not_rest_is_refused():
    with pytest.raises(InputError, match="does not settle"):
        linearise(NarxModel.from_terms({"y(t-1)": 1.1, "u(t-1)": 1.0}), sampling_rate=RATE)


def test_a_model_that_numbers_its_only_input_is_the_same_linear_model():
    plain = NarxModel.from_terms({"y(t-1)": 0.9, "u(t-1)": 0.1, "u(t-2)^2": 0.05})
    numbered = NarxModel.from_terms({"y(t-1)": 0.9, "u1(t-1)": 0.1, "u1(t-2)^2": 0.05})
    expected, found = (linearise(each, 0.4, sampling_rate=RATE) for each in (plain, numbered))
    np.testing.assert_allclose(found.numerator.value, [0.0, 0.1, 0.04], atol=1e-15)
    np.testing.assert_array_equal(found.numerator.value, expected.numerator.value)


@pytest.mark.parametrize(
    "use",
    [
        lambda model, rate: linearise(model, sampling_rate=rate),
        dea.to_c,
        to_iosystem,
        lambda model, rate: dea.write_fmu(model, "never.fmu", rate, compiler=None),
    ],
)
def test_another_rate_than_the_model_s_own_is_refused(use):
    model = replace(MODELS["DEA1"], labels=Labels(sampling_rate=RATE))
    with pytest.raises(InputError, match="it is 100 Hz, and the model is of 50 Hz"):
        use(model, 100.0)
    with pytest.raises(InputError, match="the model does not know its sampling rate"):
        use(MODELS["DEA1"], None)
