"""A campaign of two trials draws, answers, opens the seals, and goes on where it ended."""

import json
import shlex
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.naming import campaign, measured, trials
from benchmarks.naming.__main__ import command, made_at, values
from benchmarks.naming.campaign import Settings, of_trials
from benchmarks.naming.methods import REFERENCE, methods
from benchmarks.naming.scores import OURS
from benchmarks.stored import commit
from dea.errors import InputError

ROOT = Path(__file__).parents[2]

QUICK = (REFERENCE, "random_choice", "ridge")


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    return Settings("tuning", 1, 2, 3000, 1, tmp_path_factory.mktemp("kept"))


@pytest.fixture
def quick(monkeypatch):
    """Ask the quick methods alone; the simulation alone stands in for the diagnosis."""
    monkeypatch.setattr(campaign, "_AT_ONCE", 1)
    asked = {name: methods()[name] for name in QUICK} | {OURS: methods()[REFERENCE]}
    for module in ("campaign", "scores", "__main__"):
        monkeypatch.setattr(f"benchmarks.naming.{module}.methods", lambda: asked)
    return asked


def answers(settings):
    files = sorted(settings.keep.glob("*/*/answers/*.json"))
    return {file: json.loads(file.read_text()) for file in files}


@pytest.mark.slow
def test_two_trials_are_answered_scored_and_kept(settings, quick, monkeypatch):
    tried = of_trials(replace(settings, cores=2))
    assert len(tried) == 2
    assert len(answers(settings)) == 2 * len(quick)
    found = values(tried, [], settings)
    assert made_at(*tried) == commit()
    assert found["count"] == sum(found["kinds"].values()) == 2
    assert set(found["trials"]) == {each.name for each in tried}
    for each in tried:
        assert set(each.said) == set(quick)
        assert each.said[REFERENCE].status == "none"
        assert all(one.seconds > 0.0 for one in each.said.values())

    def refuses(posed):
        raise AssertionError("answered already")

    monkeypatch.setattr(campaign, "_answer", refuses)
    assert of_trials(settings) == tried


def test_a_method_whose_file_changed_is_asked_again(settings, quick, monkeypatch):
    before = of_trials(settings)
    monkeypatch.setattr(campaign, "_code", lambda name, sources: f"another {name}")
    asked = []
    known = campaign._answer

    def answer(name, posed):
        asked.append(name)
        return known(name, posed)

    monkeypatch.setattr(campaign, "_answer", answer)
    after = of_trials(settings)
    assert sorted(asked) == sorted([*quick, *quick])
    assert [{n: s.error for n, s in each.said.items()} for each in after] == [
        {n: s.error for n, s in each.said.items()} for each in before
    ]


def test_a_method_that_cannot_answer_says_why(settings, quick, monkeypatch):
    def refuses(task):
        raise InputError("the record is too short", field="record", remedy="Record longer")

    asked = dict(quick) | {"ridge": quick["ridge"].__class__("ridge", "", refuses)}
    monkeypatch.setattr("benchmarks.naming.campaign.methods", lambda: asked)
    monkeypatch.setattr(campaign, "_code", lambda name, sources: f"refusing {name}")
    found = of_trials(settings)
    assert all("too short" in each.said["ridge"].failed for each in found)
    assert values(found, [], settings)["failed"]["ridge"] == 2


@pytest.fixture
def listed(monkeypatch):
    """Have the files that a digest is made of in its place, with names from the project's root."""
    monkeypatch.chdir(ROOT)

    def names(patterns, files):
        matching = {file for pattern in patterns for file in ROOT.glob(pattern)}
        return {str(Path(file).absolute().relative_to(ROOT)) for file in matching | files}

    monkeypatch.setattr(campaign, "digest", names)


def test_an_answer_depends_on_the_files_of_its_method(listed):
    def names(method):
        files = campaign._code(method, frozenset())
        return {Path(f).name for f in files if "/methods/" in f} - {"__init__.py"}

    assert names("sindy") == {"sindy.py", "_library.py", "_residual.py", "_stlsq.py"}
    assert names("aic") == {"aic.py", "_grey_box.py"}
    assert names("diagnosis") == {"diagnosis.py"}


def test_an_answer_depends_on_how_its_task_is_set(listed):
    every = {
        "benchmarks/naming/campaign.py", "benchmarks/naming/shared.py", "benchmarks/naming/task.py",
        "config/config.yaml", "config/simulations/positioning_drive.py", "src/dea/store/records.py",
        "src/dea/discrepancy/rules.py", "src/dea/simulation/effects/end_stop.py",
        "src/dea/missing.py", "src/dea/seeds.py", "src/dea/least_squares.py",
    }  # fmt: skip
    of_trial = campaign._code("aic", trials.FILES)
    assert of_trial >= every
    assert "benchmarks/naming/trials.py" in of_trial
    assert not any("/figures/" in file or "/narx/" in file for file in of_trial)


def test_an_answer_depends_on_its_record(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    file = tmp_path / "data" / "cascaded_tanks" / "dataBenchmark.csv"
    with pytest.raises(InputError, match="make records"):
        measured.files("cascaded_tanks", tmp_path)
    file.parent.mkdir(parents=True)
    file.write_text("uEst,yEst\n1,2\n")
    files = measured.files("cascaded_tanks", tmp_path)
    assert {f.name for f in files} == {file.name, "cascaded_tanks.yaml", "measured.py"}
    before = campaign._code("aic", files)
    assert before == campaign._code("aic", files)
    file.write_text("uEst,yEst\n1,3\n")
    assert campaign._code("aic", files) != before


def test_the_stored_command_repeats_the_campaign(monkeypatch):
    monkeypatch.chdir(ROOT)
    settings = Settings("tuning", 3, 5, 2500, 1, Path("kept"))
    stored = command(settings, ["cascaded_tanks", "silverbox"])
    run = subprocess.run(
        ["make", "--dry-run", *shlex.split(stored)[1:]], capture_output=True, text=True, check=True
    ).stdout
    wanted = (
        "--count 5 --set tuning --seed 3 --longest 2500 --records cascaded_tanks silverbox --store"
    )
    assert wanted in " ".join(run.replace("\\\n", " ").split())
    assert "RECORDS" not in command(settings, list(measured.RECORDS))


def test_a_drawn_trial_depends_on_all_that_draws_and_records_it(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    found = set()

    def seen(patterns, files):
        found.update(file for pattern in patterns for file in ROOT.glob(pattern))
        found.update(files)
        raise InterruptedError

    monkeypatch.setattr(trials, "digest", seen)
    with pytest.raises(InterruptedError):
        trials.draw(tmp_path, "tuning", 1, 0)
    assert {str(Path(file).relative_to(ROOT)) for file in found} >= {
        "benchmarks/naming/trials.py", "config/config.yaml", "config/bench.yaml",
        "src/dea/stages/trial_draw.py", "src/dea/stages/trial_acquire.py",
        "src/dea/stages/trial_log.py", "src/dea/modbus/codec.py", "src/dea/seeds.py",
        "src/dea/bench/server.py", "src/dea/acquisition/acquire.py", "src/dea/excitation.py",
        *(str(file.relative_to(ROOT)) for file in (ROOT / "src/dea/plant/hidden").rglob("*.py")),
    }  # fmt: skip


@pytest.mark.slow
def test_a_trial_that_other_code_drew_is_drawn_again(settings, quick, monkeypatch):
    first = of_trials(settings)
    folder = settings.keep / "tuning-1" / first[0].name
    (folder / "code.txt").write_text("other")
    old = folder / "answers" / "old.json"
    old.write_text("{}")
    assert [each.label for each in of_trials(settings)] == [each.label for each in first]
    assert not old.exists()
