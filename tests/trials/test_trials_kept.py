"""What the documents quote of a campaign is what its scores and its jobs' times say."""

import pytest
from made_trials import FAMILY, campaign

from benchmarks.trials import counts, measured, together, with_one_more
from dea import store
from dea.trials import scores


@pytest.mark.parametrize("first", [0, 60])
def test_a_campaign_is_kept_with_its_table_and_the_time_of_a_trial(tmp_path, first):
    labels, verdicts = (
        {f"{int(name) + first:04d}": each for name, each in found.items()} for found in campaign(9)
    )
    found = scores(labels, verdicts, FAMILY).assign_attrs(contract="scores")
    store.write(found, tmp_path / "scores.nc", title="Blind trials", settings={})
    # The last three batches are those of other campaigns.
    batches = {(0, 5): 60.0, (6, 8): 30.0, (6, 11): 1000.0, (3, 8): 1000.0, (9, 14): 1000.0}
    for (begin, end), seconds in batches.items():
        folder = tmp_path / f"{first + begin:04d}-{first + end:04d}" / "benchmark"
        folder.mkdir(parents=True)
        for step, part in (("draw", 0.1), ("diagnose", 1.0)):
            (folder / f"{step}.tsv").write_text(f"s\tcpu_time\n99.0\t{part * seconds}\n")
    kept = measured(tmp_path)
    assert (kept["first"], kept["last"], kept["count"]) == (first, first + 8, 9)
    assert kept["devices"] == {"film": 9}
    assert kept["seconds"] == pytest.approx({"draw": 1.0, "diagnose": 10.0})
    assert kept["table"][0].startswith("| measure")
    assert len(kept["table"]) == 2 + found.sizes["measure"]


def test_campaigns_on_the_present_forms_are_added_up():
    def of(first, size):
        labels, verdicts = (
            {f"{int(name) + first:04d}": each for name, each in found.items()}
            for found in campaign(size)
        )
        return scores(labels, verdicts, FAMILY)

    one, other = of(1472, 60), of(1532, 21)
    assert with_one_more([], of(1471, 9), "a") == []  # on former forms
    kept = with_one_more(with_one_more([], other, "b"), one, "a")
    assert [(each["first"], each["last"], each["commit"]) for each in kept] == [
        (1472, 1531, "a"),
        (1532, 1552, "b"),
    ]
    again = with_one_more(kept, of(1540, 9), "c")  # replaces the one that it shares trials with
    assert [each["commit"] for each in again] == ["a", "c"]
    found = together(kept)
    for name, (number, trials) in counts(one).items():
        more = counts(other)[name]
        assert (found[name]["number"], found[name]["trials"]) == (
            number + more[0],
            trials + more[1],
        )
        assert found[name]["low"] <= found[name]["value"] <= found[name]["high"]
    outcomes, kinds = one["outcome"].values, one["kind"].values
    assert counts(one)["right name"] == [
        int(((kinds == "single") & (outcomes == "right name")).sum()),
        int((kinds == "single").sum()),
    ]
    nothing = one["status"].values[kinds == "null"]
    assert counts(one)["name given on nothing"] == [int((nothing == "named").sum()), nothing.size]
