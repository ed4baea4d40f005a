"""The table of tracking holds every score of the datasets."""

import math

import made_datasets as made
from dea.tables.tracking import tracking


def test_the_tracking_table_holds_every_score(each, names, saved):
    tracks = each(made.track)
    csv, _, tex = saved(tracking(tracks))
    assert len(csv) == 4 * len(names)
    for _, row in csv.iterrows():
        track = tracks[row["actuator"]].sel(simulation=row["parameters"])
        assert (row["nmse"], row["rmse (mm)"]) == (float(track["nmse"]), float(track["rmse"]))
    assert r"\toprule" in tex


def test_a_simulation_that_diverged_is_said_to_have(saved):
    track = made.track(1)
    track["nmse"][0] = math.inf
    csv, md, _ = saved(tracking({"dea1": track}))
    assert csv["nmse"][0] == math.inf
    assert "diverged" in md.splitlines()[2]
