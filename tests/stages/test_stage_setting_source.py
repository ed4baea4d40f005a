"""Which file is named where a setting does not fit the record that it is for."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from dea import store
from dea.errors import InputError
from dea.narx import NarxModel
from dea.stages.orders import orders
from dea.stages.select import select
from dea.stages.track import track
from dea.stages.validate import validate
from made_datasets import record_of

RECORD, MODEL, CASE = (
    Path("results/mine/record.nc"),
    Path("results/mine/model.nc"),
    Path("config/cases/mine.yaml"),
)
OWN = {
    "identification": {"start": 0.0, "length": 40.0, "y_lags": 2, "u_lags": [1, 2]},
    "orders": {"start": 20.0, "length": 10.0},
    "validation": {"windows": [[20.0, 30.0]], "before": 10.0, "max_lag": 10},
    "tracking": {
        "trackers": {"local": {"window": 200}, "rls": {"forgetting": 0.99}},
        "instants": 5,
        "frozen_window": 50,
    },
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A record of 400 samples at 10 Hz and a model, in the folder of a project."""
    monkeypatch.chdir(tmp_path)
    for folder in (RECORD.parent, CASE.parent):
        folder.mkdir(parents=True)
    model = NarxModel.from_terms({"y(t-1)": 0.8, "u(t-1)": 0.3})
    u = np.random.default_rng(3).standard_normal(400)
    store.write(record_of(u, model.simulate(u), 10.0), RECORD, title="made")
    model.save(MODEL, u_units="V", y_units="mm")


def run(stage, **changes):
    """Run a stage with settings of which these are changed, and return its error."""
    settings = {name: own | changes.get(name, {}) for name, own in OWN.items()}
    files = [RECORD] if stage in (orders, select) else [RECORD, MODEL]
    with pytest.raises(InputError) as caught:
        stage(settings | {"seed": 0, "system": "mine"}, *files, Path("out.nc"))
    return caught.value


WRONG = [
    (select, {"identification": {"y_lags": 500}}, "identification.y_lags"),
    (orders, {"identification": {"u_lags": [1, 500]}}, "identification.u_lags"),
    (select, {"identification": {"length": 50.0}}, "identification.start, identification.length"),
    (orders, {"orders": {"length": 50.0}}, "orders.start, orders.length"),
    (validate, {"validation": {"max_lag": 80}}, "validation.max_lag"),
    (validate, {"validation": {"windows": [[0.0, 30.0]]}}, "validation.windows"),
    (track, {"tracking": {"frozen_window": 1}}, "tracking.frozen_window"),
    (
        track,
        {"tracking": {"trackers": {"local": {"window": 2}}}},
        "tracking.trackers.local.window",
    ),
]


@pytest.mark.parametrize(("stage", "changes", "keys"), WRONG)
def test_a_setting_of_a_case_is_named_where_it_stands(stage, changes, keys, mine):
    CASE.write_text(yaml.safe_dump(changes))
    error = run(stage, **changes)
    assert (error.file, error.field) == (CASE, keys)
    assert str(error).startswith(f"{CASE}: {keys}: {RECORD}: ")
    assert error.remedy


@pytest.mark.parametrize("case", [None, {"title": "mine", "identification": {"degree": 2}}])
def test_a_setting_of_the_study_is_named_with_the_record(case, mine):
    """Of an actuator, or of a case that leaves it to the study."""
    if case:
        CASE.write_text(yaml.safe_dump(case))
    error = run(select, identification={"y_lags": 500})
    assert (error.file, error.field) == (RECORD, "identification.y_lags")
    assert error.problem == "samples 0 to 399 are 400, of which lags and terms take 1501"


def test_flagged_samples_are_those_of_the_record(mine):
    CASE.write_text(yaml.safe_dump({"identification": {"y_lags": 40}}))
    record = store.read(RECORD)
    flags = np.where(np.arange(400) % 50 == 0, 1, 0).astype("uint8")
    record["quality"] = ("time", flags, {"units": "1", "long_name": "quality"})
    store.write(record, RECORD, title="made")
    error = run(select, identification={"y_lags": 40})
    assert (error.file, error.field) == (RECORD, "quality")
