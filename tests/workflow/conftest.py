import fcntl
import os

import pytest
from copied_project import THREE_TRIALS, Project


def pytest_itemcollected(item):
    """Count what needs a study or a campaign that has run among the slow tests."""
    if {"finished", "finished_campaign"} & set(item.fixturenames):
        item.add_marker(pytest.mark.slow)


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path).copy()


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A copy in which the small study has run, once for all of the workers of a test run."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent
    project = Project(shared / "study")
    with (shared / "study.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not project.folder.exists():
            project.copy()
            run = project.snakemake("study")
            (shared / "study.log").write_text(run.stdout + run.stderr)
            if run.returncode == 0:
                project.copy_source()
                (shared / "study.done").touch()
    assert (shared / "study.done").exists(), (shared / "study.log").read_text()
    return project


@pytest.fixture(scope="module")
def finished_campaign(tmp_path_factory):
    """A copy in which three blind trials of the tuning set have run, in two batches."""
    project = Project(tmp_path_factory.mktemp("trials")).copy()
    run = project.snakemake("trials", *THREE_TRIALS, small=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return project
