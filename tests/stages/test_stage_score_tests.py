"""Scores of a model on the test records of a case."""

import numpy as np
import pytest

from dea import store
from dea.errors import InputError
from dea.narx import NarxModel
from dea.stages.score_tests import score_tests
from made_datasets import record_of

MODEL = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.3, "u(t-1)^2": 0.1})
IDENTIFICATION = {"start": 0.0, "length": 30.0, "y_lags": 1, "u_lags": 1}
SETTINGS = {"identification": IDENTIFICATION, "system": "mine"}


def scored(folder, model=MODEL, **rates):
    """Score a model, of a record at 10 Hz, on test records of it with these names and rates."""
    rng = np.random.default_rng(3)
    for name, rate in ({"record": 10.0} | rates).items():
        u = rng.standard_normal(400)
        store.write(record_of(u, model.simulate(u), rate), folder / f"{name}.nc", title="made")
    model.save(folder / "model.nc", u_units="V", y_units="mm")
    tests = [folder / f"{name}.nc" for name in rates]
    files = [folder / name for name in ("record.nc", "model.nc")]
    score_tests(SETTINGS, *files, tests, folder / "test_scores.nc")
    return store.read(folder / "test_scores.nc")


def test_each_test_record_is_scored(tmp_path):
    found = scored(tmp_path, later=10.0, drifting_clock=10.001)
    assert found["part"].values.tolist() == ["later", "drifting_clock"]
    assert np.all(found["nmse"] < 1e-20)
    assert str(found["stability"].values) == "not tested"


def test_all_structures_are_scored_on_the_same_samples(tmp_path):
    """One of them has a longer lag than the model."""
    found = scored(tmp_path, NarxModel.from_terms({"u(t)": 0.3, "u(t)^2": 0.1}), later=10.0)
    assert int(found["initial_outputs"]) > 0
    assert found["samples"].values.tolist() == [400 - int(found["initial_outputs"])]


def test_a_test_record_of_another_rate_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"the record has 50 Hz, the model 10 Hz") as caught:
        scored(tmp_path, later=10.0, faster=50.0)
    assert caught.value.field == "sampling_rate"
    assert caught.value.file == tmp_path / "faster.nc"
    assert "test_records.faster" in caught.value.remedy
    assert not (tmp_path / "test_scores.nc").exists()
