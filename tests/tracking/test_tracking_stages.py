"""The two stages on a short record: files in, files out, and what they refuse."""

import json
import subprocess
import sys

import numpy as np
import pytest

from dea import store
from dea.errors import InputError
from dea.gfrf import frequency_response
from dea.narx import NarxModel, Scaling
from dea.probing import Probing
from dea.stages.confirm import confirm
from dea.stages.gfrf import gfrf
from dea.stages.track import track
from made_datasets import record_of

RATE, SAMPLES = 50.0, 6000
MODEL = NarxModel.from_terms(
    {"y(t-1)": 0.9, "u(t-1)": 0.05, "u(t-2)": 0.04, "y(t-1)u(t-1)": 0.02, "u(t-1)^2": 0.01},
    scaling=Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.7, y_scale=0.4),
)
SETTINGS = {
    "seed": 1,
    "system": "dea1",
    "tracking": {
        "trackers": {
            "rls": {"forgetting": 0.999, "leakage": 1e-4},
            "output_error": {"thinning": 10},
        },
        "instants": 60,
        "frozen_window": 500,
    },
    "gfrf": {"tracker": "output_error", "instants": 12, "count": 20, "plane_count": 8},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A record of MODEL with a slow input, and the two datasets made from it."""
    folder = tmp_path_factory.mktemp("dea1")
    rng = np.random.default_rng(1)
    spectrum = np.fft.rfft(rng.standard_normal(SAMPLES))
    spectrum[np.fft.rfftfreq(SAMPLES, 1.0 / RATE) > 1.0] = 0.0
    u = np.fft.irfft(spectrum, SAMPLES)
    u = 2.4 + 0.6 * u / u.std()
    y = MODEL.simulate(u) + 1e-4 * rng.standard_normal(SAMPLES)
    store.write(record_of(u, y, RATE), folder / "record.nc", title="made")
    MODEL.save(folder / "model.nc", u_units="V", y_units="mm")
    files = {name: folder / f"{name}.nc" for name in ("record", "model", "track")}
    track(SETTINGS, **files)
    gfrf(SETTINGS, **files, gfrf=folder / "gfrf.nc")
    return folder


def test_the_track_holds_every_tracker_and_its_free_run(folder):
    found = store.read(folder / "track.nc")
    assert found["tracker"].values.tolist() == ["rls", "output_error"]
    assert found["simulation"].values.tolist() == ["fixed", "rls", "output_error"]
    assert found["term"].values[0] == "1"
    assert found["simulated"].attrs["units"] == "mm"
    assert float(found["nmse"].max()) < 1e-4
    assert np.isnan(found["noise_ratio"].sel(tracker="rls")).all()


def test_the_responses_are_those_of_the_plant(folder):
    found = store.read(folder / "gfrf.nc")
    exact = frequency_response(MODEL, 1, found["frequency"].values, RATE)
    H1 = found["H1"].values @ [1.0, 1.0j]
    trusted = found["excited"].values.astype(bool)
    np.testing.assert_allclose(
        H1[:, trusted], np.broadcast_to(exact[trusted], H1[:, trusted].shape), rtol=0.02
    )
    f = found["frequency_1"].values
    exact = frequency_response(MODEL, 2, (f[:, None], f), RATE)
    H2 = found["H2"].values @ [1.0, 1.0j]
    both = found["excited_h2"].values.astype(bool)
    np.testing.assert_allclose(H2[0][both], exact[both], rtol=0.1)
    assert found["H2"].attrs["units"] == "mm/V^2"


def test_where_the_excitation_ends_the_mask_does(folder):
    found = store.read(folder / "gfrf.nc")
    f, mask = found["frequency"].values, found["excited"].values.astype(bool)
    assert mask[f < 0.9].all()
    assert not mask[f > 1.3].any()
    # Parseval: the density's integral is the variance of the input.
    u = store.read(folder / "record.nc")["voltage"].values
    power = np.trapezoid(found["input_spectrum"].values, f)
    assert power == pytest.approx(u.var(), rel=0.15)


def test_responses_of_another_model_are_refused(folder, tmp_path):
    NarxModel.from_terms({"1": 0.0, "y(t-1)": 0.5, "u(t-1)": 0.1}).save(tmp_path / "model.nc")
    command = [sys.executable, "-m", "dea.stages.gfrf", "--settings", json.dumps(SETTINGS)]
    for name in ("record", "track"):
        command += [f"--{name}", str(folder / f"{name}.nc")]
    command += ["--model", str(tmp_path / "model.nc"), "--gfrf", str(tmp_path / "gfrf.nc")]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 2
    assert "terms" in run.stderr
    # The library knows arrays alone; the command line says which files they came from.
    assert str(tmp_path / "model.nc") in run.stderr
    assert not (tmp_path / "gfrf.nc").exists()


def test_a_tracker_that_was_not_run_is_refused(folder, tmp_path):
    files = {name: folder / f"{name}.nc" for name in ("record", "model", "track")}
    chosen = SETTINGS["gfrf"] | {"tracker": "kalman"}
    with pytest.raises(InputError, match=r"gfrf\.tracker: 'kalman' .* rls or output_error"):
        gfrf(SETTINGS | {"gfrf": chosen}, **files, gfrf=tmp_path / "gfrf.nc")
    assert not (tmp_path / "gfrf.nc").exists()


def test_the_same_files_give_the_same_bytes(folder, tmp_path):
    files = {name: folder / f"{name}.nc" for name in ("record", "model")}
    track(SETTINGS, **files, track=tmp_path / "track.nc")
    assert (tmp_path / "track.nc").read_bytes() == (folder / "track.nc").read_bytes()


def test_a_confirmation_says_whose_parameters_it_rests_on(folder, tmp_path):
    probing = Probing(
        times=[30.0], bias=2.4, rms=0.02, lowest=0.1, highest=4.0, band=1.0, realisations=2,
        periods=2, settle=5.0,
    )  # fmt: skip
    probed = probing.place(store.read(folder / "record.nc")["voltage"].values, RATE, seed=5)
    y = MODEL.simulate(probed.voltage)
    y += 1e-6 * np.random.default_rng(2).standard_normal(y.size)
    record = record_of(probed.voltage, y, RATE).assign_attrs(probing_period=10.0)
    for name in ("probing", "realisation"):
        values = getattr(probed, name)
        record[name] = "time", values, {"units": "1", "long_name": name}
    store.write(record, tmp_path / "record.nc", title="made")
    settings = SETTINGS | {"confirmation": {"even_above": 0.9}}
    made = [folder / f"{name}.nc" for name in ("model", "track", "gfrf")]
    confirm(settings, tmp_path / "record.nc", *made, tmp_path / "confirmation.nc")
    found = store.read(tmp_path / "confirmation.nc")
    tracked = store.read(folder / "track.nc").sel(tracker="output_error")
    assert found.attrs["tracker"] == "output_error"
    assert found.attrs["estimator"] == str(tracked["estimator"].values)
    assert found.attrs["model_band_withheld"] == str(tracked["withheld"].values)
    np.testing.assert_array_equal(found["even_judged"], found["even_in_band"] >= 0.9)
