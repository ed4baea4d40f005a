"""GFRFs against time-domain simulation, closed forms and laws they must obey."""

from itertools import permutations
from math import factorial
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.signal import freqz

from dea.errors import InputError
from dea.gfrf import frequency_response, zero_input_response
from dea.narx import NarxModel, Scaling

RATE = 50.0
PUBLISHED = Path(__file__).parents[2] / "config" / "published_models.yaml"
DEA2 = yaml.safe_load(PUBLISHED.read_text())["models"]["DEA2"]


def random_model(seed: int) -> NarxModel:
    """Two poles inside 0.7, a constant, and terms of every kind up to the third degree."""
    rng = np.random.default_rng(seed)
    radius, angle = rng.uniform(0.2, 0.7), rng.uniform(0.0, np.pi)
    small = iter(rng.uniform(-0.06, 0.06, 7))
    return NarxModel.from_terms(
        {
            "1": next(small),
            "y(t-1)": 2.0 * radius * np.cos(angle),
            "y(t-2)": -(radius**2),
            "u(t-1)": rng.uniform(0.5, 1.0),
            "u(t-2)": rng.uniform(-0.3, 0.3),
            "y(t-1)^2": next(small),
            "y(t-1)y(t-2)^2": next(small),
            "y(t-1)u(t-1)": next(small),
            "y(t-2)u(t-1)u(t-2)": next(small),
            "u(t-2)^2": next(small),
            "u(t-1)^3": next(small),
        },
        scaling=Scaling(
            u_offset=rng.uniform(-1.0, 2.0),
            u_scale=rng.uniform(0.5, 2.0),
            y_offset=rng.uniform(-1.0, 2.0),
            y_scale=rng.uniform(0.5, 2.0),
        ),
    )


seeds = st.integers(0, 2**32 - 1)


def settling(seed: int) -> NarxModel:
    model = random_model(seed)
    assume(np.isfinite(zero_input_response(model, allow_missing=True)))
    return model


def line_by_simulation(model: NarxModel, bins: tuple[int, ...], period: int) -> complex:
    """H_n from the line at the sum of n tones, its higher orders removed by an amplitude sweep."""
    order = len(bins)
    time = np.arange(3 * period)
    tones = sum(np.cos(2.0 * np.pi * b * time / period) for b in bins)
    # The line is a polynomial eps^n (c_0 + c_1 eps^2 + ...); c_0 is what is wanted. Tones that move
    # the normalised output by less than a tenth keep the polynomial short.
    gain = np.abs(frequency_response(model, 1, np.linspace(0.0, RATE / 2, 50), RATE)).max()
    gain *= model.scaling.u_scale / model.scaling.y_scale
    levels = 0.08 / max(gain, 1.0) * np.cos(np.pi * (np.arange(6) + 0.5) / 12.0)
    rest = zero_input_response(model)
    lines = []
    for level in levels:
        u = model.scaling.u_offset + model.scaling.u_scale * level * tones
        y = model.simulate(u, np.full(model.max_lag, rest))[-period:]
        lines.append(np.fft.fft(y - rest)[sum(bins) % period] / period)
    sweep = (levels[:, None] ** 2) ** np.arange(levels.size)
    c_0 = np.linalg.solve(sweep, np.array(lines) / levels**order)[0]
    return c_0 * 2.0**order / factorial(order) / model.scaling.u_scale**order


@pytest.mark.parametrize(
    ("bins", "tolerance"), [((37,), 1e-9), ((37, 101), 1e-8), ((37, 101, -211), 1e-6)]
)
@settings(max_examples=12, deadline=None)
@given(seed=seeds)
def test_gfrf_is_the_line_that_the_simulated_model_shows(bins, tolerance, seed):
    model = settling(seed)
    period = 4096
    frequencies = tuple(np.array(b * RATE / period) for b in bins)
    exact = frequency_response(model, len(bins), frequencies, RATE)
    assert line_by_simulation(model, bins, period) == pytest.approx(exact, rel=tolerance)


def closed_forms_of_dea2(f1, f2):
    """The printed (25)-(31) and the corrected ones, for the structure of (21)."""
    t1, t2, t3, t4, t5, t6, t7, t8, t9, t10 = DEA2.values()
    w1, w2 = 2 * np.pi * f1 / RATE, 2 * np.pi * f2 / RATE

    def e(angle):
        return np.exp(-1j * angle)

    y0 = t1 / (1 - t2 - t3)

    def H1(w, extra):
        numerator = t4 * e(w) + t5 * e(2 * w) + (t6 + extra) * e(3 * w)
        return numerator / (1 - t2 * e(w) - t3 * e(2 * w))

    s = w1 + w2
    B = 1 - t2 * e(s) - t3 * e(2 * s)
    mixed = t8 * y0 / 2 * (e(2 * w1 + 3 * w2) + e(3 * w1 + 2 * w2))
    A = y0 * (t7 + t10) * e(s) + mixed + y0 * t9 * e(3 * s)
    printed_H1 = [H1(w, y0 * t9) for w in (w1, w2)]
    printed_A = (
        y0 / 2 * (t7 + t10) * e(2 * s)
        + mixed
        + t9 / 2 * (printed_H1[0] * e(w1 + 3 * w2) + printed_H1[1] * e(3 * w1 + w2))
    )
    return H1(w1, 0.0), A / B, printed_H1[0], printed_A / B


def test_dea2_follows_the_corrected_closed_forms():
    model = NarxModel.from_terms(DEA2)
    f1, f2 = np.meshgrid(np.linspace(-2.0, 2.0, 9), np.linspace(-2.0, 2.0, 9))
    H1, H2, _, _ = closed_forms_of_dea2(f1, f2)
    np.testing.assert_allclose(frequency_response(model, 1, f1, RATE), H1, rtol=1e-12)
    np.testing.assert_allclose(frequency_response(model, 2, (f1, f2), RATE), H2, rtol=1e-12)


def test_the_printed_closed_forms_are_far_off():
    H1, _, printed_H1, _ = closed_forms_of_dea2(np.array(0.1), np.array(0.1))
    assert abs(printed_H1 / H1 - 1) == pytest.approx(0.37, abs=0.01)
    grid = np.meshgrid(np.linspace(0.05, 1.0, 20), np.linspace(0.05, 1.0, 20))
    _, H2, _, printed_H2 = closed_forms_of_dea2(*grid)
    off = abs(printed_H2 / H2 - 1)
    assert off.min() == pytest.approx(1.34, abs=0.01)
    assert off.max() == pytest.approx(1.84, abs=0.01)


@settings(max_examples=25, deadline=None)
@given(seed=seeds, frequencies=st.tuples(*[st.floats(-20.0, 20.0)] * 3))
def test_gfrfs_are_symmetric_and_real_signals_keep_them_hermitian(seed, frequencies):
    model = settling(seed)
    H3 = [frequency_response(model, 3, p, RATE) for p in permutations(frequencies)]
    np.testing.assert_allclose(H3, H3[0], rtol=1e-9, atol=1e-13)
    mirrored = frequency_response(model, 3, tuple(-f for f in frequencies), RATE)
    np.testing.assert_allclose(mirrored, H3[0].conj(), rtol=1e-9, atol=1e-13)


def test_a_linear_model_is_what_freqz_says():
    terms = {"y(t-1)": 1.5, "y(t-2)": -0.7, "u(t)": 0.2, "u(t-1)": 0.4, "u(t-3)": -0.1}
    f = np.linspace(0.0, 25.0, 40)
    _, expected = freqz([0.2, 0.4, 0.0, -0.1], [1.0, -1.5, 0.7], f, fs=RATE)
    found = frequency_response(NarxModel.from_terms(terms), 1, f, RATE)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    H2 = frequency_response(NarxModel.from_terms(terms), 2, (f, f), RATE)
    np.testing.assert_array_equal(H2, 0.0)


@settings(max_examples=15, deadline=None)
@given(seed=seeds, volt=st.floats(-0.2, 0.2))
def test_at_zero_frequency_gfrfs_are_the_derivatives_of_the_rest(seed, volt):
    model = settling(seed)
    u = model.scaling.u_offset + volt
    step = 1e-4 * model.scaling.u_scale
    try:
        y = [zero_input_response(model, operating_point=u + k * step) for k in (-2, -1, 0, 1, 2)]
    except InputError:
        assume(False)
    slope = (y[0] - 8 * y[1] + 8 * y[3] - y[4]) / (12 * step)
    curvature = (-y[0] + 16 * y[1] - 30 * y[2] + 16 * y[3] - y[4]) / (12 * step**2)
    H1 = frequency_response(model, 1, 0.0, RATE, operating_point=u)
    H2 = frequency_response(model, 2, (0.0, 0.0), RATE, operating_point=u)
    # Near a fold the rest bends too sharply for differences over a step.
    assume(abs(H2) * step <= 0.01 * max(1.0, abs(H1)))
    np.testing.assert_allclose(H1, slope, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(H2, curvature / 2, rtol=1e-4, atol=1e-4)


def test_varying_parameters_and_frequency_grids_broadcast():
    model = NarxModel.from_terms(DEA2)
    sets = model.parameters * np.linspace(0.95, 1.0, 6).reshape(2, 3, 1)
    f1, f2 = np.array([0.1, 0.2, 0.4])[:, None], np.array([0.3, 0.6])[None, :]
    together = frequency_response(model, 2, (f1, f2), RATE, parameters=sets)
    assert together.shape == (2, 3, 3, 2)
    for at in np.ndindex(2, 3, 3, 2):
        single = model.with_parameters(sets[at[:2]])
        pair = (f1[at[2], 0], f2[0, at[3]])
        np.testing.assert_allclose(together[at], frequency_response(single, 2, pair, RATE))


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"order": 2, "frequencies": np.ones(3)}, "frequencies"),
        ({"order": 1, "frequencies": 30.0}, "frequencies"),
        ({"order": 2, "frequencies": (np.ones(3), np.ones(4))}, "frequencies"),
        ({"order": 0, "frequencies": ()}, "order"),
        ({"order": 1, "frequencies": 1.0, "parameters": np.ones(3)}, "parameters"),
    ],
)
def test_wrong_requests_are_refused(options, field):
    with pytest.raises(InputError) as caught:
        frequency_response(NarxModel.from_terms(DEA2), sampling_rate=RATE, **options)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (([1.0, 2.0],), r"order: it is \[1\.0, 2\.0\]\. Give a whole number, 1 or more, before"),
        ((1, [1.0, np.nan]), "frequencies: one is nan. Give finite numbers in Hz"),
        ((1, np.inf), "frequencies: one is inf. Give finite numbers in Hz"),
        ((1,), "frequencies: there is none. Give an array, not a tuple, of the frequencies"),
        ((1, (1.0, 2.0)), "2 frequency arrays for order 1. Give an array, not a tuple"),
        ((2, [1.0, 2.0]), "1 frequency arrays for order 2. Give a tuple of 2 arrays"),
    ],
)
def test_what_is_wrong_with_orders_and_frequencies_is_named(given, message):
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.5})
    with pytest.raises(InputError, match=message):
        frequency_response(model, *given, sampling_rate=50.0)


@pytest.mark.parametrize("level", [np.nan, -np.inf])
def test_an_operating_point_that_is_not_finite_is_refused(level):
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.5})
    with pytest.raises(InputError, match=f"operating_point: it is {level}. Give a finite number"):
        frequency_response(model, 1, 1.0, 50.0, operating_point=level)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequencies": ["a"]}, "frequencies: it holds no numbers"),
        ({"operating_point": "x"}, "operating_point: it holds no numbers"),
        ({"parameters": ["a", "b"]}, "parameters: it holds no numbers"),
        ({"sampling_rate": "50"}, "sampling_rate: it is '50'. Give a positive number in Hz"),
        ({"sampling_rate": 0.0}, "sampling_rate: it is 0.0. Give a positive number in Hz"),
    ],
)
def test_what_is_no_number_is_named(change, message):
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.5})
    given = {"order": 1, "frequencies": 1.0, "sampling_rate": 50.0} | change
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        frequency_response(model, **given)
