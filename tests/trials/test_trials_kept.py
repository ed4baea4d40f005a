"""What the documents quote of a campaign is what its scores and its jobs' times say."""

import pytest
from benchmarks.trials import measured
from made_trials import FAMILY, campaign

from dea import store
from dea.trials import scores


def test_a_campaign_is_kept_with_its_table_and_the_time_of_a_trial(tmp_path):
    found = scores(*campaign(9), FAMILY).assign_attrs(contract="scores")
    store.write(found, tmp_path / "scores.nc", title="Blind trials", settings={})
    # The third batch is that of a larger campaign.
    for first, seconds in ((0, 60.0), (6, 30.0), (9, 1000.0)):
        folder = tmp_path / f"{first:04d}-{first + 5:04d}" / "benchmark"
        folder.mkdir(parents=True)
        for step, part in (("draw", 0.1), ("diagnose", 1.0)):
            (folder / f"{step}.tsv").write_text(f"s\tcpu_time\n99.0\t{part * seconds}\n")
    kept = measured(tmp_path)
    assert (kept["first"], kept["last"], kept["count"]) == (0, 8, 9)
    assert kept["devices"] == {"film": 9}
    assert kept["seconds"] == pytest.approx({"draw": 1.0, "diagnose": 10.0})
    assert kept["table"][0].startswith("| measure")
    assert len(kept["table"]) == 2 + found.sizes["measure"]
