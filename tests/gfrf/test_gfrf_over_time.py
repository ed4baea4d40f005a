"""Responses through a record: the right order, times, frequencies and units."""

import numpy as np
import pytest
import xarray as xr

from dea.errors import InputError
from dea.gfrf import Grid, response_over_time
from dea.narx import NarxModel, Scaling

RATE, SAMPLES = 50.0, 201
SCALING = Scaling(u_offset=2.0, u_scale=1.5, y_offset=0.7, y_scale=0.4)
# Without lagged outputs, so that every response is a closed form of its own parameter.
MODEL = NarxModel.from_terms(
    {"1": 0.1, "u(t-1)": 1.0, "u(t-1)u(t-2)": 0.5, "u(t-1)^2u(t-2)": 0.2}, scaling=SCALING
)
GRID = Grid(
    instants=8,
    lowest=1e-3,
    highest=0.2,
    count=5,
    plane_highest=0.1,
    plane_count=4,
    plane_times=(0.1, 0.5, 0.9),
    third_frequency=0.07,
)


def times():
    return np.arange(SAMPLES) / RATE


def parameters():
    """Each term's parameter is another function of time."""
    t = times()
    return np.column_stack([0.1 + t, 1.0 + 2.0 * t, 0.5 - t, 0.2 + t**2])


STD = np.array([0.01, 0.02, 0.03, 0.04])  # of each parameter, growing with time


def track_of(withheld=""):
    """A covariance at every sample: independent parameters, of variance STD^2 (1 + t)."""
    covariance = np.diag(STD**2) * (1.0 + times())[:, None, None]
    return xr.Dataset(
        {
            "parameter": (("time", "term"), parameters()),
            "covariance": (("instant", "term", "term_2"), covariance),
        },
        coords={
            "time": times(),
            "instant": times(),
            "term": [str(term) for term in MODEL.terms],
        },
        attrs={"estimator": "output_error", "withheld": withheld},
    )


def responses(withheld=""):
    u = np.random.default_rng(0).standard_normal(SAMPLES)
    return response_over_time(MODEL, track_of(withheld), u, RATE, grid=GRID)


@pytest.fixture(scope="module")
def found():
    return responses()


def complex_of(response):
    return response.sel(part="real").values + 1j * response.sel(part="imag").values


def parameter_at(time, term):
    """The parameter of ``term`` at these times, in physical units of the response."""
    order = len(MODEL.terms[term].u_lags)
    return np.interp(time, times(), parameters()[:, term]) * 0.4 / 1.5**order


def test_times_and_frequencies_are_those_asked_for(found):
    duration = (SAMPLES - 1) / RATE
    np.testing.assert_allclose(found["time_h2"], np.array([0.1, 0.5, 0.9]) * duration)
    assert found.sizes["time"] == 8
    np.testing.assert_allclose(np.diff(found["time"]), duration / 8, atol=1.5 / RATE)
    assert found["frequency"].values[[0, -1]] == pytest.approx([1e-3 * RATE, 0.2 * RATE])
    np.testing.assert_allclose(found["frequency_1"], np.array([1, 2, 3, 4]) * 0.1 * RATE / 4)
    assert found["frequency_3"].item() == pytest.approx(0.07 * RATE)


def test_h1_is_the_closed_form_at_its_times(found):
    omega = 2.0 * np.pi * found["frequency"].values / RATE
    exact = parameter_at(found["time"].values, 1)[:, None] * np.exp(-1j * omega)
    np.testing.assert_allclose(complex_of(found["H1"]), exact, rtol=1e-10)


def test_h2_is_the_closed_form_at_its_times(found):
    omega = 2.0 * np.pi * found["frequency_1"].values / RATE
    w1, w2 = omega[:, None], omega[None, :]
    shape = (np.exp(-1j * (w1 + 2 * w2)) + np.exp(-1j * (2 * w1 + w2))) / 2
    exact = parameter_at(found["time_h2"].values, 2)[:, None, None] * shape
    np.testing.assert_allclose(complex_of(found["H2"]), exact, rtol=1e-10)


def test_h3_is_the_closed_form_at_its_times_and_third_frequency(found):
    omega = 2.0 * np.pi * found["frequency_1"].values / RATE
    w1, w2, w3 = omega[:, None], omega[None, :], 2.0 * np.pi * 0.07
    total = w1 + w2 + w3
    shape = sum(np.exp(-1j * (total + twice)) for twice in (w1, w2, w3)) / 3
    exact = parameter_at(found["time_h2"].values, 3)[:, None, None] * shape
    np.testing.assert_allclose(complex_of(found["H3"]), exact, rtol=1e-10)


def test_the_rest_is_the_constant_in_output_units(found):
    exact = 0.7 + 0.4 * np.interp(found["time"].values, times(), parameters()[:, 0])
    np.testing.assert_allclose(found["y0"], exact, rtol=1e-10)


def test_the_band_of_the_gain_has_the_closed_form_at_its_times(found):
    """|H1| is the parameter of u(t-1) in physical units; its logarithm has the band."""
    time = found["time"].values
    gain = np.abs(parameter_at(time, 1))
    deviation = STD[1] * np.sqrt(1.0 + time) * 0.4 / 1.5
    reach = np.exp(1.959964 * deviation / gain)[:, None] * np.ones(5)
    np.testing.assert_allclose(found["gain_high"] / gain[:, None], reach, rtol=1e-6)
    np.testing.assert_allclose(gain[:, None] / found["gain_low"], reach, rtol=1e-6)
    np.testing.assert_allclose(found["phase_high"] - found["phase_low"], 0.0, atol=1e-9)


def test_the_band_of_the_rest_is_that_of_the_constant(found):
    reach = 1.959964 * 0.4 * STD[0] * np.sqrt(1.0 + found["time"].values)
    np.testing.assert_allclose(found["y0_high"] - found["y0"], reach, rtol=1e-6)
    np.testing.assert_allclose(found["y0"] - found["y0_low"], reach, rtol=1e-6)


def test_h2_lies_within_its_band(found):
    gain = np.abs(complex_of(found["H2"]))
    assert np.all(found["H2_gain_low"] < gain)
    assert np.all(gain < found["H2_gain_high"])
    assert found["H2_phase_low"].dims == ("time_h2", "frequency_1", "frequency_2")


def test_what_the_track_withholds_has_no_band_and_says_why():
    found = responses("biased")
    assert found.attrs["withheld"] == "biased"
    assert np.isfinite(found["H1"]).all()
    for name in ("gain_low", "phase_high", "H2_gain_high", "H2_phase_low", "y0_low"):
        assert np.isnan(found[name]).all()


def test_parameters_of_other_terms_are_refused():
    track = track_of().assign_coords(term=["y(t-1)", "y(t-2)", "y(t-3)", "y(t-4)"])
    with pytest.raises(InputError, match="track: its terms are"):
        response_over_time(MODEL, track, np.ones(3), RATE)


def test_what_the_strongest_tone_dwarfs_is_not_excited_though_it_lies_beyond_the_grid():
    noise = np.random.default_rng(1).standard_normal(20 * SAMPLES)
    u = np.sin(2.0 * np.pi * 0.4 * np.arange(noise.size)) + 1e-4 * noise
    found = response_over_time(MODEL, track_of(), u, RATE, grid=GRID)
    assert found["frequency"].max() < 0.3 * RATE
    assert not found["excited"].any()
    assert not found["excited_h2"].any()
