"""Runs that are killed, or that a full disk ends, and what the next run makes of what they left."""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
import yaml
from copied_project import ROOT, Project

from dea.audit import Manifest, verify

pytestmark = pytest.mark.slow
KINDS = ("nc", "png", "pdf", "csv", "md", "tex")


def merged(first, second):
    """Two mappings as Snakemake merges two config files."""
    return first | {
        key: merged(first[key], value)
        if isinstance(value, dict) and isinstance(first.get(key), dict)
        else value
        for key, value in second.items()
    }


@pytest.fixture
def project(tmp_path):
    """A copy of the project that `make` runs, with the small study as its config."""
    project = Project(tmp_path / "project").copy()
    shutil.copy(ROOT / "Makefile", project.folder)
    config = project.folder / "config/config.yaml"
    small = yaml.safe_load((project.folder / "small.yaml").read_text())
    config.write_text(yaml.safe_dump(merged(yaml.safe_load(config.read_text()), small)))
    return project


def start(project, target, limit="unlimited"):
    """Begin `make` with the environment of the tests; no file may be larger than ``limit`` KiB."""
    environment = os.environ | {
        "PYTHONPATH": str(ROOT / "src"),
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
    }
    make = f"ulimit -f {limit} && exec make --old-file=.venv/installed CORES=2 {target}"
    with output(project).open("w") as file:
        return subprocess.Popen(
            ["bash", "-c", make], cwd=project.folder, env=environment,
            stdout=file, stderr=subprocess.STDOUT,
        )  # fmt: skip


def output(project):
    """What the last run printed; a file, since jobs may outlive the run."""
    return project.folder / "output.txt"


def end(project, running):
    """Wait for the end of a run; return its status and what it printed."""
    return running.wait(), output(project).read_text()


def below(process, name):
    """The processes of Python below one that run the program or module ``name``."""
    found = []
    for child in psutil.Process(process.pid).children(recursive=True):
        with suppress(psutil.NoSuchProcess):
            words = [Path(word).name for word in child.cmdline()[:3]]  # none of one that has ended
            if words and words[0].startswith("python") and name in words[1:]:
                found.append(child)
    return found


def wait_for(process, name):
    """The first process below one with this word in its command line, once there is one."""
    while process.poll() is None:
        if found := below(process, name):
            return found[0]
        time.sleep(0.02)
    raise AssertionError(f"it ended without {name}")


def interrupt_what_is_left():
    """End a run whose own parents were killed, as the next one, which is refused, asks for."""
    lock = Path("build/lock")
    if (
        lock.exists()
        and subprocess.run(["flock", "--nonblock", lock, "true"], check=False).returncode
    ):
        with suppress(psutil.NoSuchProcess):
            left = psutil.Process(int(lock.read_text()))
            left.send_signal(signal.SIGINT)
            left.wait()


def assert_as_if_nothing_had_happened(project, finished):
    """Nothing is half-written, all bytes are those of an undisturbed run, and the audit agrees."""
    results = project.folder / "results"
    assert not list(results.rglob("*partial"))
    made = project.digests(*KINDS)
    assert made.items() <= finished.digests(*KINDS).items()
    assert verify(Manifest.read()) == []


def test_a_job_and_a_run_that_are_killed_and_a_full_disk_leave_no_trace(
    project, finished, monkeypatch
):
    target = "results/dea1/orders.nc"
    monkeypatch.chdir(project.folder)

    status, said = end(project, start(project, target, limit=100))
    assert status != 0
    assert re.search(r"results/dea1/log/acquire.log: .*Error.*File too large", said), said

    running = start(project, target)
    wait_for(running, "dea.stages.acquire").kill()
    status, said = end(project, running)
    assert status != 0
    assert "Killed" in said
    assert not Path("results/dea1/record.nc").exists()

    abandoned = start(project, target)
    job = wait_for(abandoned, "dea.stages.acquire")
    wait_for(abandoned, "snakemake").kill()
    job.suspend()  # goes on after the next run has begun
    abandoned.wait()
    assert not Path("results/MANIFEST.json").exists()
    again = start(project, target)
    wait_for(again, "dea.stages.acquire")
    job.resume()
    status, said = end(project, again)
    assert status == 0, said
    assert Path(target).exists()
    assert_as_if_nothing_had_happened(project, finished)


def test_a_second_run_beside_the_first_is_refused(project):
    first = start(project, "results/dea1/orders.nc")
    wait_for(first, "snakemake")
    status, said = end(project, start(project, "results/dea1/orders.nc"))
    running = {process.pid for process in below(first, "snakemake")}
    wait_for(first, "snakemake").kill()
    first.wait()
    assert status != 0
    named = re.search(r"another run of this project, process (\d+), has not ended yet", said)
    assert named, said
    assert int(named[1]) in running


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(3))
def test_a_study_that_is_killed_at_random_moments_ends_with_the_same_bytes(
    project, finished, monkeypatch, seed
):
    monkeypatch.chdir(project.folder)
    chance = random.Random(seed)
    for _ in range(8):
        interrupt_what_is_left()
        running = start(project, "study")
        time.sleep(chance.uniform(1.0, 12.0))
        victims = psutil.Process(running.pid).children(recursive=True)
        jobs = [one for one in victims if below(running, "snakemake") != [one]]
        if jobs:
            chance.choice(jobs).kill()
        if chance.random() < 0.5:
            for process in below(running, "snakemake"):
                process.kill()
            running.wait()
        else:
            end(project, running)
    interrupt_what_is_left()
    status, said = end(project, start(project, "study"))
    assert status == 0, said
    assert project.digests(*KINDS) == finished.digests(*KINDS)
    assert_as_if_nothing_had_happened(project, finished)


@pytest.mark.campaign
@pytest.mark.skipif(os.geteuid() != 0, reason="only root mounts a small disk")
def test_a_study_on_a_full_disk_says_so_and_ends_with_the_same_bytes_on_a_larger_one(
    project, finished, monkeypatch
):
    monkeypatch.chdir(project.folder)
    Path("results").mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "none", "results"], check=True)
    try:
        status, said = end(project, start(project, "study"))
        assert status != 0
        assert "the disk of results/dea1 has 2 MB left" in said, said  # before any voltage
        subprocess.run(["mount", "-o", "remount,size=200m", "results"], check=True)
        status, said = end(project, start(project, "results/dea1/orders.nc"))
        assert status == 0, said
        ballast = Path("results/ballast")
        ballast.write_bytes(bytes(shutil.disk_usage("results").free))
        status, said = end(project, start(project, "study"))
        assert status != 0
        assert "No space left on device" in said, said
        ballast.unlink()
        status, said = end(project, start(project, "study"))
        assert status == 0, said
        assert project.digests(*KINDS) == finished.digests(*KINDS)
        assert_as_if_nothing_had_happened(project, finished)
    finally:
        subprocess.run(["umount", "results"], check=True)
