"""Blind trials are blind: what the diagnosis may read, and a campaign from end to end."""

import json
import re

import pytest
from copied_project import THREE_TRIALS, Project

from dea import store
from dea.errors import InputError
from dea.stages.trial_score import trial_score

pytestmark = pytest.mark.slow
SCORES = "results/trials/tuning/scores.nc"


@pytest.fixture(scope="module")
def unstarted(tmp_path_factory):
    """A copy in which no trial has run."""
    return Project(tmp_path_factory.mktemp("unstarted")).copy()


@pytest.fixture(scope="module")
def planned_jobs(unstarted):
    """Inputs and command of every job of a campaign, by rule."""
    told = ["--dry-run", "--printshellcmds", "--quiet", "host"]
    run = unstarted.snakemake(SCORES, *told, *THREE_TRIALS, small=False)
    assert run.returncode == 0, run.stdout
    jobs: dict[str, list[tuple[list[str], str]]] = {}
    for block in re.split(r"^(?:local)?rule ", run.stdout + run.stderr, flags=re.MULTILINE)[1:]:
        inputs = re.search(r"^ +input: (.*)$", block, re.MULTILINE)
        command = re.search(r"^Shell command: (.*)$", block, re.MULTILINE)
        if inputs and command:
            jobs.setdefault(block.split(":")[0], []).append((inputs[1].split(", "), command[1]))
    return jobs


def test_the_diagnosis_reads_records_and_its_own_code_alone(planned_jobs, unstarted):
    config = (unstarted.folder / "config" / "config.yaml").read_text()
    seeds = re.search(r"seeds: \{tuning: (\d+), reporting: (\d+),", config).groups()
    assert len(planned_jobs["trial_diagnose"]) == 2
    for inputs, command in planned_jobs["trial_diagnose"]:
        [listed] = [name for name in inputs if name.startswith("build/")]
        code = [line[66:] for line in (unstarted.folder / listed).read_text().splitlines()]
        data = [name for name in inputs if name != listed]
        batch = f"results/trials/tuning/{data[0].split('/')[3]}"
        simulations = ["heated_chamber", "positioning_drive"]
        assert data == [
            f"{batch}/records",
            f"{batch}/logs",
            *(f"config/simulations/{name}.py" for name in simulations),
        ]
        truth = ("src/dea/plant/", "src/dea/bench/")
        assert not [name for name in code if name.startswith(truth)]
        assert any(name.startswith("src/dea/discrepancy/") for name in code)
        for secret in ("sealed", "commitment", "truth", *seeds):
            assert secret not in command


def test_a_campaign_may_begin_at_any_number(unstarted):
    campaign = ["--config", "trials={first: 7, count: 5, batch: 2, set: tuning}"]
    run = unstarted.snakemake(SCORES, "--dry-run", "--quiet", "host", *campaign, small=False)
    assert run.returncode == 0, run.stdout
    batches = set(re.findall(r"tuning/(\d{4}-\d{4})/verdicts", run.stdout))
    assert batches == {"0007-0008", "0009-0010", "0011-0011"}


def test_trials_are_drawn_anew_for_another_plain_film_alone(tmp_path):
    project = Project(tmp_path).copy()
    drawn = "results/trials/tuning/0013-0014/commitment.json"
    assert project.snakemake(drawn, *THREE_TRIALS, small=False).returncode == 0
    bench = project.folder / "config/bench.yaml"
    for old, new, planned in (
        ("leakage_ageing: 2.0 ", "leakage_ageing: 2.5 ", {}),
        (
            "frame_radius:     {value: 40.0e-3",
            "frame_radius:     {value: 41.0e-3",
            {"trial_draw": 1},
        ),
    ):
        text = bench.read_text()
        assert text.count(old) == 1
        bench.write_text(text.replace(old, new))
        assert project.planned(drawn, *THREE_TRIALS, small=False) == planned


def test_the_seals_are_opened_after_every_verdict_and_by_one_rule(planned_jobs):
    readers = {
        rule
        for rule, jobs in planned_jobs.items()
        for inputs, _ in jobs
        if any(name.endswith("/sealed") for name in inputs)
    }
    assert readers == {"trial_acquire", "trial_log", "trial_score"}
    [(inputs, _)] = planned_jobs["trial_score"]
    batches = [name.rsplit("/", 1)[0] for name in inputs if name.endswith("/sealed")]
    assert [f"{batch}/verdicts" in inputs for batch in batches] == [True, True]


@pytest.fixture(scope="module")
def campaign(finished_campaign):
    return finished_campaign.folder / "results" / "trials" / "tuning"


def test_three_trials_are_drawn_recorded_diagnosed_and_scored(finished_campaign, campaign):
    scores = store.read(campaign / "scores.nc")
    assert scores["trial"].values.tolist() == [f"{index:04d}" for index in range(13, 16)]
    assert int(scores["confusion"].sum()) == 3
    for name in ("confusion", "risk_coverage", "strength", "gap"):
        figure = finished_campaign.folder / f"results/figures/trials_{name}_tuning.png"
        assert figure.stat().st_size > 5_000
    for kind in ("csv", "md", "tex"):
        table = finished_campaign.folder / f"results/tables/trials_tuning.{kind}"
        assert "right name" in table.read_text()


def test_a_record_says_nothing_of_what_is_hidden(campaign):
    for batch in campaign.glob("*-*"):
        for sealed in (batch / "sealed").glob("*.json"):
            trial = json.loads(sealed.read_text())
            folder = "records" if trial["device"] == "film" else "logs"
            record = store.read_record(batch / folder / f"{sealed.stem}.nc")
            told = json.dumps({key: str(value) for key, value in record.attrs.items()})
            for effect in trial["effects"]:
                assert effect["name"] not in told
                assert effect["form"] not in told
                assert str(effect["size"]) not in told
            assert str(trial["seed"]) not in told


def test_a_label_changed_after_the_verdict_is_refused(campaign, tmp_path):
    batch = sorted(campaign.glob("*-*"))[0]
    sealed = next((batch / "sealed").glob("*.json"))
    honest = sealed.read_text()
    sealed.write_text(honest.replace('"strength": ', '"strength": 1'))
    try:
        with pytest.raises(InputError, match="sealed"):
            trial_score(
                {"set": "tuning", "seed": 1},
                commitment=[batch / "commitment.json"],
                sealed=[batch / "sealed"],
                records=[batch / "records"],
                truth=[batch / "truth"],
                log_truth=[batch / "log_truth"],
                verdicts=[batch / "verdicts"],
                scores=tmp_path / "scores.nc",
            )
    finally:
        sealed.write_text(honest)
    assert not (tmp_path / "scores.nc").exists()
