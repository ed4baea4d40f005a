"""What all campaigns share: the command that repeats them, what is kept, and what they refuse."""

import csv
import importlib
import json
import os
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml

from benchmarks import (
    acquisition,
    calibration,
    control_robustness,
    fresh_clone,
    intervals,
    resolution,
    stored,
)
from benchmarks import trials as kept_trials
from benchmarks.command_line import run
from benchmarks.coverage import __main__ as coverage
from benchmarks.coverage import film
from benchmarks.faults import __main__ as faults
from dea.errors import InputError
from dea.narx import load_published

ROOT = Path(__file__).parents[2]


def asked_by(command):
    """Return the last line that a make command would run."""
    make = ["make", "--dry-run", "--no-print-directory", *shlex.split(command)[1:]]
    plain = {"PATH": os.environ["PATH"], "HOME": os.environ.get("HOME", "/")}
    done = subprocess.run(make, cwd=ROOT, env=plain, capture_output=True, text=True, check=True)
    return " ".join(done.stdout.replace("\\\n", " ").splitlines()[-1].split())


@pytest.mark.parametrize(
    ("target", "given", "wanted"),
    [
        ("coverage", {"COUNT": 5, "SEED": 2, "SAMPLES": 300}, "--count 5 --seed 2 --samples 300"),
        ("coverage-film", {"COUNT": 5, "SEED": 2}, "--count 5 --seed 2"),
        ("control-robustness", {"COUNT": 5, "SEED": 2}, "--count 5 --seed 2"),
        ("faults", {"COUNT": 5, "SEED": 2, "LONGEST": 3.5},
         "--count 5 --seed 2 --longest 3.5 --keep build/faults"),
        ("mutants", {"COUNT": 5, "SEED": 2, "BUDGET": 9.0, "ROOM": ["narx", "gfrf"]},
         "--count 5 --seed 2 --room narx --room gfrf --budget 9.0"),
        ("intervals", {"COUNT": 5, "SEED": 2}, "--count 5 --seed 2"),
        ("resolution-trials", {"COUNT": 5, "SET": "ambiguous", "FORMS": ["free", "fixed"]},
         "--count 5 --set ambiguous --forms free fixed"),
        ("benchmark-naming", {"COUNT": 5, "RECORDS": []}, "--count 5 --records"),
        ("benchmark-naming", {"RECORDS": ["silverbox"]}, "--records silverbox"),
        ("benchmark-naming", {"RECORDS": None}, ""),
        ("benchmark", {}, "-m benchmarks"),
        ("calibration", {}, "benchmarks.calibration"),
        ("soak", {}, "--soak"),
        ("fresh", {"CORES": 3}, "--cores 3"),
    ],
)  # fmt: skip
def test_the_command_of_a_campaign_gives_all_that_it_was_given(target, given, wanted):
    line = asked_by(stored.command(target, **given))
    assert line.endswith(f"{wanted} --store" if wanted else "--store")
    assert ("--records" in line) is (given.get("RECORDS") is not None)


@pytest.mark.parametrize(
    ("said", "asked"), [("", False), ("DRIFTING=0", False), ("DRIFTING=1", True)]
)
def test_drifting_plants_alone_are_asked_for_with_one(said, asked):
    assert ("--drifting" in asked_by(f"make coverage {said}")) is asked


@pytest.mark.parametrize(
    "target",
    [
        "coverage",
        "coverage-film",
        "control-robustness",
        "calibration",
        "benchmark",
        "benchmark-naming",
        "faults",
        "soak",
    ],
)
def test_a_campaign_that_is_not_asked_to_keep_its_result_does_not(target):
    assert "--store" not in asked_by(f"make {target} COUNT=1")
    assert "--store" not in asked_by(f"make {target} STORE=0")


def test_models_are_made_before_their_controllers_are_tried():
    done = subprocess.run(
        ["make", "--dry-run", "control-robustness"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert done.index(" control_models") < done.index("benchmarks.control_robustness")


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository of one file, in the place of the project's."""

    def git(*arguments):
        named = ["-c", "user.name=A", "-c", "user.email=a@b"]
        subprocess.run(["git", *named, *arguments], cwd=tmp_path, check=True, capture_output=True)

    (tmp_path / "program.py").write_text("1\n")
    (tmp_path / ".gitignore").write_text("results/\n")
    git("init")
    git("add", ".")
    git("commit", "--message", "first")
    monkeypatch.setattr(stored, "ROOT", tmp_path)
    return tmp_path


def test_a_commit_is_named_where_the_program_is_as_it_says(repository):
    for ignored in ("results", "docs"):
        (repository / ignored).mkdir()
        (repository / ignored / "made.txt").touch()
    assert len(stored.commit()) == 40


def test_a_changed_file_and_one_that_git_does_not_know_are_told(repository):
    (repository / "program.py").write_text("2\n")
    assert stored.commit().endswith("-dirty")
    (repository / "program.py").write_text("1\n")
    assert not stored.commit().endswith("-dirty")
    (repository / "other.py").touch()
    assert stored.commit().endswith("-dirty")


@pytest.fixture
def documents(tmp_path, monkeypatch):
    """Where results for the documents go, in the place of the project's."""
    monkeypatch.setattr(stored, "FOLDER", tmp_path / "measured")
    return tmp_path / "measured"


def of_documents(folder):
    return {file.stem: json.loads(file.read_text()) for file in folder.glob("*.json")}


def test_coverage_is_kept_with_all_that_it_was_given(documents, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(coverage, "run", lambda settings: [])
    given = ["--count", "3", "--samples", "200", "--output", str(tmp_path / "coverage")]
    coverage.main(given)
    assert not documents.exists()
    coverage.main([*given, "--store"])
    found = of_documents(documents)["coverage"]
    assert found["command"] == "make coverage COUNT=3 SEED=1 SAMPLES=200 STORE=1"
    assert found["values"]["samples"] == 200
    assert found["values"]["table"][0].startswith("| drift")


def test_control_trials_are_kept_with_all_that_they_were_given(documents, tmp_path, monkeypatch):
    monkeypatch.setattr(control_robustness, "TABLE", tmp_path / "table.csv")
    outcome = control_robustness.Outcome(0.01, False, "")
    monkeypatch.setattr(
        control_robustness,
        "campaign",
        lambda count, seed: [(name, outcome) for name in control_robustness.SCENARIOS] * count,
    )
    control_robustness.main(["--count", "2"])
    assert not documents.exists()
    control_robustness.main(["--count", "2", "--seed", "7", "--store"])
    found = of_documents(documents)["control_robustness"]
    assert found["command"] == "make control-robustness COUNT=2 SEED=7 STORE=1"
    assert found["values"]["trials"] == 2 * len(control_robustness.SCENARIOS)


@pytest.mark.parametrize(
    ("module", "arguments"),
    [
        (coverage, ["--plant", "foo"]),
        (coverage, ["--count", "0"]),
        (film, ["--count", "0"]),
        (coverage, ["--store", "--drifting"]),
        (control_robustness, ["--count", "0"]),
        (intervals, ["--count", "0"]),
        (resolution, ["--count", "0"]),
        (acquisition, ["--store"]),
        (faults, ["--schedule", "{bad"]),
        (faults, ["--schedule", '{"victim": "nobody"}']),
        (faults, ["--schedule", '{"victim": "plain", "nothing": 1}']),
        (faults, ["--examples", "--only", "nothing_like_it"]),
        (faults, ["--only", "a full disk"]),
        (faults, ["--count", "0"]),
        (importlib.import_module("benchmarks.mutants.__main__"), ["--count", "0"]),
        (importlib.import_module("benchmarks.naming.__main__"), ["--count", "0"]),
    ],
)
def test_what_a_campaign_cannot_do_is_refused_on_one_line(module, arguments, capsys):
    with pytest.raises(SystemExit) as ended:
        module.main(arguments)
    assert ended.value.code == 2
    assert "error: " in capsys.readouterr().err.splitlines()[-1]


def test_scores_that_are_not_there_are_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(kept_trials, "TRIALS", tmp_path)
    with pytest.raises(SystemExit):
        run(lambda: kept_trials.main(["--set", "tuning"]))
    assert "make trials SET=tuning" in capsys.readouterr().err


def test_a_clone_is_kept_in_a_new_folder_alone(tmp_path):
    with pytest.raises(InputError, match="it exists"):
        fresh_clone.main(["--keep", str(tmp_path)])


def test_a_clone_is_measured(documents, tmp_path, monkeypatch, capsys):
    """Programs that do nothing stand in for git and make."""
    for name in ("git", "make"):
        program = tmp_path / "bin" / name
        program.parent.mkdir(exist_ok=True)
        program.write_text('#!/bin/sh\nmkdir -p "$4/.venv" 2> /dev/null\nexit 0\n')
        program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:/usr/bin:/bin")
    clone = tmp_path / "clone"
    fresh_clone.main(["--keep", str(clone), "--cores", "1"])
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {"cores", "environment", "study", "again"}
    assert found["environment"]["megabytes"] == 0
    assert not documents.exists()


def test_the_memory_of_a_study_is_that_of_its_largest_job(tmp_path):
    for system, name, used in (("dea1", "select", "210.4"), ("figures", "fig1", "612.7"),
                               ("dea1", "track", "-"), ("dea2", "gfrf", "nan")):  # fmt: skip
        file = tmp_path / system / "benchmark" / f"{name}.tsv"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"s\tmax_rss\tmax_vms\n3.1\t{used}\t9000\n")
    assert fresh_clone.largest_job(tmp_path) == 613
    assert fresh_clone.largest_job(tmp_path / "dea2") is None


def test_every_miss_that_is_too_large_is_named():
    assert calibration.beyond("dea1", (0.03, 3.9, 0.2), 1.1) == []
    assert calibration.beyond("dea1", (0.05, 3.9, float("nan")), 1.1) == [
        "dea1, gain: 0.05, at most 0.04",
        "dea1, curvature: nan, at most 0.25",
    ]


def test_a_mean_displacement_that_does_not_fall_or_rise_as_in_the_paper_is_named(bench, capsys):
    bench({"dea1": 0.9, "dea2": 0.9, "dea6": 1.1})
    assert calibration.main([]) == 0
    bench({"dea1": 1.1, "dea2": 1.1, "dea6": 0.9})
    assert calibration.main([]) == 1
    said = capsys.readouterr().err
    assert "dea2, mean displacement, end over start: 1.1, below 1 in the paper" in said
    assert "dea6, mean displacement, end over start: 0.9, above 1 in the paper" in said
    assert "dea1" not in said
    [unknown] = calibration.beyond("dea2", (0.0, 0.0, 0.0), float("nan"))
    assert "nan" in unknown


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with the project's configuration; films that do as measured stand in for its own.

    What it returns writes the bench's actuators, given the end of each mean displacement over its
    start.
    """
    (tmp_path / "config").mkdir()
    for name in ("config.yaml", "published_models.yaml"):
        (tmp_path / "config" / name).symlink_to(ROOT / "config" / name)
    monkeypatch.chdir(tmp_path)
    models = load_published(calibration.PUBLISHED)

    def film_as_measured(name):
        return calibration.published(models[name.upper()], 50.0)

    def write(changes):
        content = yaml.safe_load((ROOT / "config" / "bench.yaml").read_text())
        content["actuators"] = dict.fromkeys(changes)
        calibration.BENCH.write_text(yaml.safe_dump(content))
        monkeypatch.setattr(calibration, "read_parameters", lambda file, name: name)
        monkeypatch.setattr(calibration, "virtual", film_as_measured)
        monkeypatch.setattr(
            calibration, "means", lambda name: np.linspace(1.0, changes[name], calibration.PIECES)
        )

    return write


def test_the_published_models_are_taken_at_the_rate_that_they_are_sampled_at(bench):
    bench({"dea1": 1.1})
    assert calibration.main([]) == 0
    with calibration.TABLE.open() as table:
        rows = list(csv.DictReader(table))
    assert rows
    assert all(row["measured"] == row["virtual"] for row in rows if row["quantity"] != "drift")


def test_the_table_of_the_calibration_tells_limits_next_to_values(bench):
    bench({"dea1": 1.1, "dea2": 0.9, "dea6": 1.2})
    calibration.main([])
    with calibration.TABLE.open() as table:
        rows = list(csv.DictReader(table))
    drift = {row["actuator"]: row for row in rows if row["quantity"] == "drift"}
    assert {name: row["virtual"] for name, row in drift.items()} == {
        "dea1": "1.100", "dea2": "0.900", "dea6": "1.200",
    }  # fmt: skip
    assert {name: (row["lowest"], row["highest"]) for name, row in drift.items()} == {
        "dea1": ("", ""), "dea2": ("", "1"), "dea6": ("1", ""),
    }  # fmt: skip
    half = {"gain": lambda _: 0.04, "phase": lambda _: 4.0, "curvature": lambda value: value / 4}
    for row in rows:
        if row["quantity"] != "drift":
            value = float(row["measured"])
            margin = half[row["quantity"]](value)
            assert float(row["lowest"]) == pytest.approx(value - margin, abs=1e-3)
            assert float(row["highest"]) == pytest.approx(value + margin, abs=1e-3)


def test_an_actuator_without_a_published_model_is_named_as_not_calibrated(bench, capsys):
    bench({"dea1": 1.1, "dea7": 1.0})
    assert calibration.main([]) == 0
    assert "dea7 has no published model: not calibrated" in capsys.readouterr().out
    assert "dea7" not in calibration.TABLE.read_text()


def test_a_bench_without_any_measured_actuator_is_refused(bench):
    bench({"dea7": 1.0})
    with pytest.raises(InputError, match=r"bench\.yaml: actuators: none .* has a published model"):
        calibration.main([])


def test_records_of_two_seeds_are_others_and_their_forms_go_round():
    first, again, other = intervals.draw(1, 3), intervals.draw(1, 3), intervals.draw(2, 2)
    assert (first.y == again.y).all()
    assert first.form == "clip"
    assert other.form == "delay"
    seen = {intervals.draw(seed, number).true for seed in (1, 2) for number in range(5)}
    assert len(seen) == 10


def test_a_delay_and_a_limit_act_as_their_textbooks_say():
    for number in range(5):
        drawn = intervals.draw(1, number)
        assert drawn.u.shape == drawn.y.shape == (intervals.SAMPLES,)
    assert intervals.acting("sharp", 2.0, 0.5) == 1.5
    assert intervals.acting("jump", 0.4, 0.5) == 0.0
    assert intervals.acting("clip", 2.0, 0.5) == 0.5


def test_an_interrupted_campaign_of_intervals_goes_on(documents, tmp_path, monkeypatch, capsys):
    asked = []

    def judged(which):
        asked.append(which)
        seed, number = which
        row = {"seed": seed, "number": number, "form": intervals.FORMS[number % 5], "wrong": False}
        right = {"named": True, "inside": number != 3, "half": 0.1, "error": 0.3}
        return row | (right if number else {"named": False})

    monkeypatch.setattr(intervals, "OUTCOMES", tmp_path / "intervals.jsonl")
    monkeypatch.setattr(intervals, "judged", judged)
    monkeypatch.setattr(stored, "commit", lambda: "abc")
    intervals.main(["--count", "4", "--cores", "1"])
    intervals.main(["--count", "6", "--cores", "1", "--store"])
    assert asked == [(1, number) for number in range(6)]
    found = of_documents(documents)["intervals"]
    assert found["command"] == "make intervals COUNT=6 SEED=1 STORE=1"
    counts = found["values"]["all"]
    assert [counts[name] for name in ("records", "right", "wrong", "inside")] == [6, 5, 0, 4]
    assert counts["low"] < 0.8 < counts["high"]
    assert "5 of 6 named right, 0 wrong; 4 intervals hold the truth" in capsys.readouterr().out


def test_resolutions_are_kept_where_asked(documents, tmp_path, monkeypatch, capsys):
    class Drawn:
        name = "0000"

    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(resolution, "OUTCOMES", tmp_path / "resolution.jsonl")
    monkeypatch.setattr(resolution, "draw_trial", lambda *which, ambiguous: Drawn())
    row = {"right": True, "wrong": False, "left open": True, "seconds": 30.0}
    row |= {"limit violated": False, "trial": "0000"}
    monkeypatch.setattr(
        resolution, "resolved", lambda trial, forms, *rest: row | {"forms": str(forms)}
    )
    given = ["--count", "1", "--set", "ambiguous_tuning", "--forms", "free"]
    resolution.main(given)
    assert not documents.exists()
    resolution.main([*given, "--store"])
    found = of_documents(documents)["resolution"]
    wanted = "make resolution-trials COUNT=1 SET=ambiguous_tuning FORMS=free STORE=1"
    assert found["command"] == wanted
    assert len(found["values"]["table"]) == 3
