"""Cross-kernels of models with several inputs against tones in a simulation and Volterra sums."""

from dataclasses import replace

import numpy as np
import pytest

import dea
from dea.errors import InputError
from dea.gfrf import Grid, response_over_time, zero_input_response
from dea.narx import Labels, NarxModel, Scaling

RATE = 50.0
TERMS = {
    "y(t-1)": 0.9,
    "y(t-2)": -0.3,
    "u1(t-1)": 0.4,
    "u2(t-2)": -0.25,
    "u1(t-1)u2(t-3)": 0.15,
    "u1(t-2)^2": 0.1,
    "y(t-1)u2(t-1)": 0.2,
    "y(t-1)^2": 0.05,
    "u1(t-1)u2(t-1)^2": 0.1,
}
SCALING = Scaling((1.0, -2.0), (2.0, 4.0), 0.5, 3.0)
MODEL = NarxModel.from_terms(TERMS, scaling=SCALING)
CENTRE = np.array([1.3, -1.5])
PERIOD = 500  # samples in which every tone below repeats: multiples of 0.1 Hz


def line(cycles, tones, level):
    """Amplitude of the output at ``cycles`` per period, tones given as (input, cycles)."""
    t = np.arange(12 * PERIOD)
    u = np.tile(CENTRE, (t.size, 1))
    for column, each in tones:
        u[:, column] += level * np.cos(2 * np.pi * each * t / PERIOD)
    y = MODEL.simulate(u)[-PERIOD:]
    return np.fft.rfft(y)[cycles] / PERIOD * 2


def richardson(amplitude, order):
    """The amplitude over level^order, terms of higher order removed by halving the level."""
    a, b = (amplitude(level) / level**order for level in (0.02, 0.01))
    return (4.0 * b - a) / 3.0


@pytest.mark.parametrize("number", [1, 2, np.int64(2)])
def test_first_order_is_the_amplitude_of_a_small_tone(number):
    response = dea.frequency_response(MODEL, 1, 1.7, RATE, inputs=number, operating_point=CENTRE)
    measured = richardson(lambda a: line(17, [(number - 1, 17)], a), 1)
    assert response == pytest.approx(measured, rel=1e-6)


@pytest.mark.parametrize("pair", [(1, 2), (2, 1), (1, 1), (2, 2)])
def test_second_order_is_the_amplitude_of_the_sum_frequency(pair):
    """One tone in each input of the pair: the line at f1 + f2 is 2 H2 (A/2)^2."""
    response = dea.frequency_response(
        MODEL, 2, (1.1, 2.3), RATE, inputs=pair, operating_point=CENTRE
    )
    tones = [(pair[0] - 1, 11), (pair[1] - 1, 23)]
    measured = richardson(lambda a: line(34, tones, a), 2)
    assert response == pytest.approx(measured, rel=1e-5)


def test_third_order_cross_kernel_is_the_amplitude_of_three_tones():
    """The line at f1 + f2 + f3 is 3! H3 (A/2)^3, as half an amplitude's 6/8."""
    response = dea.frequency_response(
        MODEL, 3, (1.1, 2.3, 4.1), RATE, inputs=(1, 2, 2), operating_point=CENTRE
    )
    measured = richardson(lambda a: line(75, [(0, 11), (1, 23), (1, 41)], a), 3)
    assert response == pytest.approx(measured * 4 / 6, rel=1e-4)


def test_cross_kernel_is_the_transform_of_the_measured_volterra_kernel():
    """h2^{12}(a, b) from pulses: y(both) - y(first) - y(second) + y(rest), halved by symmetry."""
    memory, size = 60, 1e-3
    rest = zero_input_response(MODEL, operating_point=CENTRE)

    def output(pulses):
        u = np.tile(CENTRE, (3 * memory, 1))
        for column, at in pulses:
            u[at, column] += size
        return MODEL.simulate(u, np.full(MODEL.max_lag, rest))

    last = 2 * memory
    none = output([])[last]
    alone = [
        [output([(column, last - k)])[last] - none for k in range(memory)] for column in (0, 1)
    ]
    kernel = np.empty((memory, memory))
    for a in range(memory):
        for b in range(memory):
            both = output([(0, last - a), (1, last - b)])[last] - none
            kernel[a, b] = (both - alone[0][a] - alone[1][b]) / (2 * size**2)
    f1, f2 = 1.1, 2.3
    k = np.arange(memory)
    transform = np.exp(-2j * np.pi * f1 * k / RATE) @ kernel @ np.exp(-2j * np.pi * f2 * k / RATE)
    response = dea.frequency_response(
        MODEL, 2, (f1, f2), RATE, inputs=(1, 2), operating_point=CENTRE
    )
    assert response == pytest.approx(transform, rel=2e-3)


def test_one_signal_on_both_inputs_is_a_model_of_one_input():
    merged = {"y(t-1)": 0.5, "u(t-1)": 0.3, "u(t-2)": 0.2, "u(t-1)u(t-2)": 0.1, "u(t-1)^2": 0.4}
    split = {"y(t-1)": 0.5, "u1(t-1)": 0.3, "u2(t-2)": 0.2, "u1(t-1)u2(t-2)": 0.1, "u2(t-1)^2": 0.4}
    f = (np.linspace(0.1, 5.0, 7)[:, None], np.linspace(-5.0, 5.0, 9)[None, :])
    one = dea.frequency_response(NarxModel.from_terms(merged), 2, f, RATE)
    several = NarxModel.from_terms(split)
    total = sum(
        dea.frequency_response(several, 2, f, RATE, inputs=(i, j)) for i in (1, 2) for j in (1, 2)
    )
    np.testing.assert_allclose(total, one, rtol=0.0, atol=1e-14)


@pytest.mark.slow
def test_bands_cover_the_responses_of_drawn_parameters():
    rng = np.random.default_rng(0)
    model = MODEL.with_parameters(MODEL.parameters, np.diag((1e-4 * MODEL.parameters) ** 2))
    band = dea.frequency_response_band(model, 2, (1.1, 2.3), RATE, inputs=(1, 2))
    drawn = model.parameters * (1.0 + 1e-4 * rng.standard_normal((4000, len(model.terms))))
    gains = np.abs(
        dea.frequency_response(model, 2, (1.1, 2.3), RATE, inputs=(1, 2), parameters=drawn)
    )
    low, high = np.quantile(gains, [0.025, 0.975])
    assert band.gain_low == pytest.approx(low, rel=2e-5)
    assert band.gain_high == pytest.approx(high, rel=2e-5)


def test_inputs_are_named_by_their_names_too():
    record = dea.Record.of(
        np.random.default_rng(1).uniform(-1, 1, (300, 2)),
        np.random.default_rng(2).uniform(-1, 1, 300),
        RATE,
        names=(("left", "right"), "position"),
    )
    model = dea.select_terms(record, y_lags=1, u_lags=1, degree=1)
    by_name = dea.frequency_response(model, 1, 2.0, inputs="right", allow_missing=True)
    by_number = dea.frequency_response(model, 1, 2.0, inputs=2, allow_missing=True)
    np.testing.assert_array_equal(by_name, by_number)
    with pytest.raises(InputError, match="there is no input 'up'"):
        dea.frequency_response(model, 1, 2.0, inputs="up")


@pytest.mark.parametrize(
    ("order", "inputs", "message"),
    [
        (1, None, "0 are named for order 1 of a model with 2"),
        (2, 1, "1 are named for order 2"),
        (1, 3, "there is no input 3"),
        (1, 0, "there is no input 0"),
    ],
)
def test_which_input_must_be_said(order, inputs, message):
    with pytest.raises(InputError, match=message):
        dea.frequency_response(MODEL, order, (1.0,) * order, RATE, inputs=inputs)


def test_an_operating_point_has_a_level_for_each_input():
    with pytest.raises(InputError, match="1 numbers for 2 inputs"):
        dea.frequency_response(MODEL, 1, 1.0, RATE, inputs=1, operating_point=1.0)


def test_responses_over_time_are_those_of_every_input_and_pair():
    record = dea.Record.of(
        np.random.default_rng(1).uniform(-1, 1, (400, 2)),
        np.random.default_rng(2).uniform(-1, 1, 400),
        RATE,
        units=(("V", "%"), "mm"),
        names=(("left", "right"), "position"),
    )
    terms = {"1": 0.1, "y(t-1)": 0.5, "u1(t-1)": 0.4, "u2(t-2)": -0.2, "u1(t-1)u2(t-1)": 0.1}
    model = NarxModel.from_terms(terms, scaling=SCALING)
    model = replace(model, labels=Labels.of(record))
    track = dea.track_parameters(model, record, instants=20)
    grid = Grid(instants=10, count=4, plane_count=3)
    found = response_over_time(model, track, record.u, RATE, grid=grid)
    assert found["input"].values.tolist() == ["left", "right"]
    assert found["pair"].values.tolist() == ["left × left", "left × right", "right × right"]
    at = {"time": found["time"], "method": "nearest"}
    theta = track["parameter"].sel(**at).values
    f, plane = found["frequency"].values, found["frequency_1"].values
    for k, name in enumerate(("left", "right")):
        expected = dea.frequency_response(
            model, 1, f, RATE, inputs=name, parameters=theta, allow_missing=True
        )
        np.testing.assert_array_equal(found["H1"].isel(input=k, part=0), expected.real)
    theta = track["parameter"].sel(time=found["time_h2"], method="nearest").values
    crossed = dea.frequency_response(
        model, 2, (plane[:, None], plane), RATE, inputs=("left", "right"), parameters=theta
    )
    np.testing.assert_array_equal(found["H2"].isel(pair=1, part=1), crossed.imag)
    assert found["H3"].dims[0] == found["excited"].dims[0] == "input"


def test_responses_over_time_take_one_column_as_one_input_and_no_other_number():
    rng = np.random.default_rng(1)
    u, y = rng.uniform(-1, 1, (400, 1)), rng.uniform(-1, 1, 400)
    model = NarxModel.from_terms({"1": 0.1, "y(t-1)": 0.5, "u(t-1)": 0.4})
    track = dea.track_parameters(model, u, y, instants=20, sampling_rate=RATE)
    grid = Grid(instants=10, count=4, plane_count=3)
    column, signal = (
        response_over_time(model, track, each, RATE, grid=grid) for each in (u, u[:, 0])
    )
    np.testing.assert_array_equal(column["input_spectrum"], signal["input_spectrum"])
    with pytest.raises(InputError, match="it holds 2 of 1 inputs"):
        response_over_time(model, track, np.hstack([u, u]), RATE, grid=grid)
