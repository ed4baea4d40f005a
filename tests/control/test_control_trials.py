"""What `make control` wrote: the controllers came to the end within limits, the best one first."""

from pathlib import Path

import numpy as np
import pytest

from dea import store

RESULTS = Path(__file__).parents[2] / "results"
TRIALS = sorted(RESULTS.glob("*/control.nc"))
pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(not TRIALS, reason="no controller has been tried"),
]


@pytest.mark.parametrize("path", TRIALS, ids=lambda path: path.parts[-2])
def test_the_adaptive_inverse_follows_best_and_no_limit_is_violated(path):
    trial, record = store.read(path), store.read_record(path.with_name("record.nc"))
    best = trial.sel(controller="adaptive inverse")
    assert best["outcome"].item() == "to the end"
    count = 15.0 / 65535
    assert best["voltage"].min() >= record["voltage"].min() - count
    assert best["voltage"].max() <= record["voltage"].max() + count
    assert np.abs(best["voltage"].diff("time")).max() <= 40.0 / 50.0 + count
    assert not best["quality"].any()
    share = trial["rms_error"] / trial["stroke"]
    ends = share.isel(minute=[0, -1])
    assert (ends.sel(controller="adaptive inverse") < 0.01).all()
    for other in ("fixed inverse", "PI"):
        assert (ends.sel(controller=other) > 2.0 * ends.sel(controller="adaptive inverse")).all()
