"""Records that tell too little of single parameters."""

import numpy as np
import pytest

import dea
from benchmarks.coverage.judged import terms
from benchmarks.coverage.plants import plants
from benchmarks.coverage.records import generators, records
from dea.narx import NarxModel, Scaling, estimate, refine, simulate
from dea.tracking import with_constant
from dea.tracking.bands import LARGEST_CURVATURE, UNDETERMINED
from dea.tracking.local import curvature_of_windows


def tracked(name, kind, noise, drift, number, method, **settings):
    """A record of a drifting plant: the model with a constant, its track, and the true course."""
    plant = plants()[name]
    drawn = generators(78, f"{name} {kind} {noise} {drift}", [number])
    made = records(plant, kind, noise, 4000, drawn, drift)
    u, y = made.u[0], made.y[0]
    model = refine(estimate(terms(plant), u, y, scaling=Scaling()), u, y)
    followed = with_constant(model)
    course = dict(zip(terms(plant), made.parameters[0].T, strict=True))
    true = np.stack([course.get(term, np.zeros(u.size)) for term in followed.terms], axis=1)
    return followed, dea.track_parameters(model, u, y, method=method, **settings), true


@pytest.mark.parametrize("noise", ["equation", "output", "coloured output"])
def test_ten_terms_and_an_input_of_few_frequencies_leave_single_parameters_open(noise):
    _, track, _ = tracked("DEA2", "band-limited", noise, "ramp", 2, "local")
    assert track.attrs["withheld"] == UNDETERMINED
    assert track["band_low"].isnull().all()
    assert track["band_high"].isnull().all()
    assert track["covariance"].isnull().all()
    assert np.isfinite(track["parameter_std"]).all()


@pytest.mark.parametrize(("name", "kind"), [("DEA2", "white"), ("two_poles", "band-limited")])
def test_what_a_record_determines_is_given(name, kind):
    _, track, _ = tracked(name, kind, "output", "ramp", 0, "local")
    assert track.attrs["withheld"] == ""
    assert np.isfinite(track["band_low"]).all()


def test_estimates_of_the_whole_record_are_withheld_with_them(monkeypatch):
    """White errors in a record whose windows leave parameters open: no other reason is seen."""
    asked = ("DEA2", "band-limited", "coloured output", "ramp", 4, "kalman")
    _, track, true = tracked(*asked)
    assert track.attrs["withheld"] == UNDETERMINED
    monkeypatch.setattr("dea.tracking.track.curvature_of_windows", lambda *_: 0.0)
    _, given, _ = tracked(*asked)
    assert given.attrs["withheld"] == ""
    at = given["instant"].values.astype(int)
    outside = (true[at] < given["band_low"].values) | (true[at] > given["band_high"].values)
    assert outside.mean() > 0.5


def test_a_record_too_short_for_a_window_determines_nothing():
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.5}, scaling=Scaling())
    rng = np.random.default_rng(1)
    u = rng.standard_normal(200)
    y = simulate(model.terms, model.parameters, u, np.zeros(1)) + 0.01 * rng.standard_normal(200)
    assert curvature_of_windows(model, u, y) < LARGEST_CURVATURE
    assert curvature_of_windows(model, u[:30], y[:30]) == np.inf
