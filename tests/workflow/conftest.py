import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PARTS = ["Snakefile", "config", "src", "workflow", "pyproject.toml"]


class Project:
    """A copy of the project in a folder of its own, so that a test may run and edit it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for part in PARTS:
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, folder / part)
        shutil.copy2(ROOT / "tests/workflow/small.yaml", folder)

    def snakemake(
        self, *arguments: str, cores: int = 2, small: bool = True
    ) -> subprocess.CompletedProcess[str]:
        """Run Snakemake in the copy, which it watches; jobs import the source copied from.

        That has its compiled functions at hand, which are kept for one place.
        """
        command = ["snakemake", "--cores", str(cores), "--profile", "workflow/profiles/default"]
        config = ["--configfile", "config/config.yaml", "small.yaml"] if small else []
        environment = os.environ | {
            "PYTHONPATH": str(ROOT / "src"),
            "OPENBLAS_NUM_THREADS": "1",
        }
        return subprocess.run(
            [*command, *arguments, *config],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )

    def planned(self, *arguments: str, small: bool = True) -> dict[str, int]:
        """How many jobs of each rule a dry run plans."""
        run = self.snakemake(*arguments, "--dry-run", small=small)
        assert run.returncode == 0, run.stdout + run.stderr
        jobs: dict[str, int] = {}
        for line in (run.stdout + run.stderr).splitlines():
            words = line.split()
            if len(words) == 2 and words[1].isdigit() and words[0] != "total":
                jobs[words[0]] = int(words[1])
        return jobs


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A copy in which the small study has run."""
    project = Project(tmp_path_factory.mktemp("study"))
    run = project.snakemake("study")
    assert run.returncode == 0, run.stdout + run.stderr
    return project


@pytest.fixture(scope="module")
def finished_campaign(tmp_path_factory):
    """A copy in which a dozen blind trials of the tuning set have run."""
    project = Project(tmp_path_factory.mktemp("trials"))
    dozen = ["--config", "trials={count: 12, set: tuning}"]
    run = project.snakemake("trials", *dozen, small=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return project
