"""What make gives to its programs, for which others stand that print what they are given."""

import fcntl
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STANDIN = f"""#!{sys.executable}
import json, os, sys
print("ran", json.dumps([os.path.basename(sys.argv[0]), *sys.argv[1:]]), file=sys.stderr)
print("known")
"""


@pytest.fixture
def folder(tmp_path):
    """A folder, whose path has a space, with the Makefile and with stand-ins for its programs."""
    folder = tmp_path / "my project"
    for place in (".venv/bin", ".venv-docs/bin", "workflow", "results/known"):
        (folder / place).mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", folder)
    shutil.copy(ROOT / "workflow/alone.sh", folder / "workflow")
    (folder / "results/known/summary.txt").touch()
    for program in (".venv/bin/python", ".venv/bin/snakemake", ".venv/bin/pytest"):
        write_program(folder / program, STANDIN)
    write_program(folder / ".venv-docs/bin/mkdocs", '#!/bin/sh\necho "from $PYTHONPATH"\n')
    for made in (".venv/installed", ".venv-docs/installed"):
        (folder / made).touch()
    return folder


def write_program(path, text):
    path.write_text(text)
    path.chmod(0o755)


def make(folder, *arguments):
    """Run make there; return its status, and what it and the stand-ins printed."""
    free = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    run = subprocess.run(
        ["make", "--old-file=.venv/installed", "--old-file=.venv-docs/installed", *arguments],
        cwd=folder, env=free | {"CORES": "1"}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return run.returncode, run.stdout + run.stderr


def programs(said):
    """The command lines of the stand-ins."""
    return [json.loads(line[4:]) for line in said.splitlines() if line.startswith("ran ")]


@pytest.mark.parametrize("profile", ["slrum", "default", "sl*", "../profiles/slurm", "slurm x"])
def test_a_profile_that_is_none_is_named(folder, profile):
    shutil.copytree(ROOT / "workflow/profiles", folder / "workflow/profiles")
    status, said = make(folder, "study", f"PROFILE={profile}")
    assert status == 2
    assert len(said.splitlines()) == 1
    assert f"PROFILE={profile} is none. Name a folder of workflow/profiles" in said


def test_an_empty_number_of_cores_is_none_given(folder):
    assert make(folder, "study", "CORES=")[0] == 0


@pytest.mark.parametrize("value", ["0", "-1", "abc", "2 3", "1.5", "$$(touch x)", "'"])
@pytest.mark.parametrize("name", ["CORES", "JOBS"])
def test_a_number_of_cores_or_jobs_that_is_none_is_named(folder, name, value):
    status, said = make(folder, "study", "PROFILE=slurm", f"{name}={value}")
    assert status == 2
    assert len(said.splitlines()) == 1
    assert f"{name}=" in said
    assert "is no whole number above 0" in said
    assert not (folder / "x").exists()


WORDS = ["my  case", 'it\'s "$$b"; #']


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize(
    ("target", "variable", "option"),
    [
        ("case", "NAME", "--name"),
        ("case", "RATE", "--rate"),
        ("case", "INPUT", "--input"),
        ("case", "SIMULATION", "--simulation"),
        ("diagnose", "SIMULATION", "--simulation"),
        ("diagnose", "NAME", "--name"),
        ("handover", "NAME", "--name"),
        ("record", "EXCITATION", "--excitation"),
        ("record", "OPERATOR", "--operator"),
        ("audit", "SAMPLE", "--sample"),
        ("audit", "SIGNERS", "--signers"),
        ("records", "FROM", "--from"),
    ],
)
def test_a_value_reaches_its_program_as_one_word(folder, target, variable, option, word):
    given = {"case": ["FILE=a b.csv"], "diagnose": ["FILE=a b.csv", "SIMULATION=own.py"]}
    first = {"record": ["NAME=film1"], **given}.get(target, [])
    _, said = make(folder, target, *first, f"{variable}={word}")
    plain = word.replace("$$", "$")
    assert f"{option}={plain}" in programs(said)[0]
    if target in given:
        assert programs(said)[0][-2:] == ["--", "a b.csv"]


def test_several_names_are_one_wrong_name_but_where_several_are_meant(folder):
    for target in ("record", "handover", "diagnose"):
        words = programs(make(folder, target, "NAME=dea1 dea2")[1])[0]
        assert "dea1 dea2" in [word.removeprefix("--name=") for word in words]
    ran = programs(make(folder, "resolve", "NAME=dea1 dea2")[1])
    assert [line[3] for line in ran[:2]] == ["--name=dea1", "--name=dea2"]


@pytest.mark.parametrize("file", ["my file.csv", "my  file ~/x.csv"])
def test_the_home_folder_is_found_where_no_shell_has_replaced_it(folder, file):
    _, said = make(folder, "case", f"FILE=~/{file}")
    assert programs(said)[0][-1] == f"{Path.home()}/{file}"


def test_the_documentation_is_built_in_a_folder_with_a_space(folder):
    status, said = make(folder, "docs")
    assert status == 0
    assert f"from {folder}/src\n" in said


@pytest.fixture
def whole(folder):
    """The folder with what an environment is made from, older than the environments."""
    sources = ["environment.txt", "pyproject.toml", "requirements.in", "requirements-workflow.in"]
    (folder / "docs/site").mkdir(parents=True)
    for source in (*sources, "docs/site/environment.txt"):
        (folder / source).touch()
        os.utime(folder / source, (0, 0))
    write_program(folder / "standin", STANDIN)
    write_program(folder / ".venv-docs/bin/python", STANDIN)
    return folder


def environments(folder, target):
    """Make a target, and return how environments were made for it."""
    free = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    ran = subprocess.run(
        ["make", target, "PYTHON=./standin"],
        cwd=folder, env=free | {"CORES": "1"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [line[3:] for line in programs(ran.stderr) if line[:3] == ["standin", "-m", "venv"]]


@pytest.mark.parametrize(("target", "own"), [("env", ".venv"), ("docs", ".venv-docs")])
def test_an_environment_of_another_folder_is_made_again(whole, target, own):
    """Its programs and its package name that folder: they would run the code that lies there."""
    made = "home = /usr/bin\ncommand = /usr/bin/python3.11 -m venv {}\n"
    file = whole / own / "pyvenv.cfg"
    assert environments(whole, target) == []
    for here in (f"{whole}/{own}", f"--clear {whole}/{own}"):
        file.write_text(made.format(here))
        assert environments(whole, target) == []
    for elsewhere in (f"/the original/{own}", f"{whole}-2/{own}", f"/a{whole}/{own}"):
        file.write_text(made.format(elsewhere))
        assert environments(whole, target) == [["--clear", own]]
    # Whoever links to an environment means it; nor is one that others use to be emptied.
    (whole / own).rename(whole / "shared")
    (whole / own).symlink_to("shared")
    assert environments(whole, target) == []


@pytest.fixture
def signed(folder):
    """The signature of a manifest, and a key."""
    (folder / "results/MANIFEST.json").write_text("{}")
    subprocess.run(
        ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", folder / "my key"], check=True
    )
    assert make(folder, "sign", "KEY=my key")[0] == 0
    return folder / "results/MANIFEST.json.sig"


@pytest.mark.skipif(not shutil.which("ssh-keygen"), reason="ssh-keygen is not installed")
def test_a_key_that_does_not_sign_leaves_the_signature(folder, signed):
    before = signed.read_text()
    assert "BEGIN SSH SIGNATURE" in before
    (folder / "no key").write_text("text")
    for key in ("absent", "no key"):
        status, said = make(folder, "sign", f"KEY={key}")
        assert status == 2
        assert f"error: KEY: {key} does not sign. Name a private key" in said
    assert signed.read_text() == before
    assert {file.name for file in (folder / "results").iterdir()} == {
        "MANIFEST.json", "MANIFEST.json.sig", "known",
    }  # fmt: skip
    (folder / "results/MANIFEST.json").unlink()
    status, said = make(folder, "sign", "KEY=my key")
    assert status == 2
    assert "results/MANIFEST.json: there is none. Make results first" in said
    assert signed.read_text() == before


def test_results_are_not_removed_under_a_run(folder):
    (folder / "build").mkdir()
    with (folder / "build/lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        status, said = make(folder, "clean")
    assert status == 2
    assert "error: another run of this project" in said
    assert (folder / "results/known/summary.txt").exists()
    (folder / "results/README.md").touch()
    status, said = make(folder, "clean")
    assert status == 0
    assert [file.name for file in (folder / "results").iterdir()] == ["README.md"]
    assert not programs(said), "there is no manifest to write"


def test_results_on_another_disk_are_removed_too(folder, tmp_path):
    (folder / "results").rename(tmp_path / "disk")
    (folder / "results").symlink_to(tmp_path / "disk")
    (folder / "results/README.md").touch()
    assert make(folder, "clean")[0] == 0
    assert (folder / "results").is_symlink()
    assert [file.name for file in (tmp_path / "disk").iterdir()] == ["README.md"]
