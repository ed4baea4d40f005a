"""Responses of a tracked model at the times of probing stretches."""

import numpy as np
import pytest
import xarray as xr

from dea.gfrf import frequency_response, modelled_stretches
from dea.narx import NarxModel
from dea.nonparametric import Periods

MODEL = NarxModel.from_terms({"1": 0.0, "y(t-1)": 0.5, "u(t-1)": 0.4, "u(t-1)^2": 0.1})
STRETCHES = [
    Periods(np.full((2, 2, 10), level), np.zeros((2, 2, 10)), time)
    for level, time in ((0.2, 5.0), (0.6, 95.0))
]
LINES = np.array([0.1, 0.2])
LACKING = xr.Dataset(
    {
        "model_error_gain": ("frequency", [0.3, 0.3]),
        "model_error_phase": ("frequency", [10.0, 10.0]),
        "H2_model_error_gain": ("frequency", [0.4, 0.4]),
        "H2_model_error_phase": ("frequency", [20.0, 20.0]),
    },
    coords={"frequency": [0.0, 1.0]},
)


def track(withheld: str) -> xr.Dataset:
    """A track whose gain grows in the middle, with its covariance or the reason to withhold it."""
    theta = np.tile(MODEL.parameters, (101, 1))
    theta[50:, 2] *= 1.5
    covariance = np.tile(1e-4 * np.eye(4), (3, 1, 1))
    return xr.Dataset(
        {
            "parameter": (("time", "term"), theta),
            "covariance": (("instant", "term", "term_2"), covariance * (np.nan if withheld else 1)),
            "withheld": withheld,
        },
        coords={
            "time": np.arange(101.0),
            "instant": [0.0, 50.0, 100.0],
            "term": list(map(str, MODEL.terms)),
        },
    )


@pytest.mark.parametrize("withheld", ["", "too few windows"])
def test_the_response_is_that_of_the_time_and_mean_input_of_the_stretch(withheld):
    followed = track(withheld)
    found = modelled_stretches(MODEL, followed, LACKING, STRETCHES, LINES, 1.0)
    for each, level, row in zip(found, (0.2, 0.6), (0, 100), strict=True):
        settings = {"parameters": followed["parameter"].values[row], "operating_point": level}
        pairs = np.array([-0.2, -0.1, 0.1, 0.2])
        H1 = frequency_response(MODEL, 1, LINES, 1.0, **settings)
        H2 = frequency_response(MODEL, 2, (pairs[:, None], pairs[None, :]), 1.0, **settings)
        np.testing.assert_allclose(each.H1, H1)
        np.testing.assert_allclose(each.H2, H2)


def test_a_band_that_is_withheld_leaves_what_the_structure_lacks():
    [bare, _] = modelled_stretches(MODEL, track("too few"), LACKING, STRETCHES, LINES, 1.0)
    [wide, _] = modelled_stretches(MODEL, track(""), LACKING, STRETCHES, LINES, 1.0)
    exact = LACKING * 0.0
    [none, _] = modelled_stretches(MODEL, track("too few"), exact, STRETCHES, LINES, 1.0)
    np.testing.assert_allclose(none.band.gain, 0.0, atol=1e-12)
    np.testing.assert_allclose(none.H2_band.gain, 0.0, atol=1e-12)
    assert (bare.H2_band.gain > 0.4).all()
    assert (bare.H2_band.phase > np.radians(20.0)).all()
    assert (bare.band.gain > 0.3).all()
    assert (bare.band.phase > np.radians(10.0)).all()
    assert (wide.band.gain > bare.band.gain).all()
    assert (wide.H2_band.gain > bare.H2_band.gain).all()


@pytest.mark.parametrize("withheld", ["", "too few windows"])
def test_a_track_is_the_same_as_it_is_made_and_as_it_is_stored(withheld):
    stored = track(withheld)
    made = stored.drop_vars("withheld").assign_attrs(withheld=withheld)
    unknown = LACKING.drop_vars(list(LACKING))
    pairs = (
        modelled_stretches(MODEL, each, responses, STRETCHES, LINES, 1.0)
        for each, responses in ((stored, LACKING * np.nan), (made, unknown))
    )
    for one, other in zip(*pairs, strict=True):
        np.testing.assert_array_equal(one.H1, other.H1)
        np.testing.assert_array_equal(one.band.gain, other.band.gain)
        np.testing.assert_array_equal(one.H2_band.phase, other.H2_band.phase)
