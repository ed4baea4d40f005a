"""A copy of the project, which a test may run and edit."""

import hashlib
import os
import shutil
import subprocess
from pathlib import Path

from dry_run import dry_run

ROOT = Path(__file__).parents[2]
# Few with short records and quickly diagnosed, since how they are named is tested elsewhere.
THREE_TRIALS = [
    "--config",
    "trials={first: 13, count: 3, batch: 2, set: tuning}",
    "discrepancy={effects: [coulomb_friction, gain_drift, sensor_lag],"
    " budget: {starts: 1, finished: 2, beam: 1, effects: 1, shakes: 0, restarted: 0}}",
    "figures={resolution: 80}",
]
PARTS = ["Snakefile", "config", "workflow", "pyproject.toml", "environment.txt"]


class Project:
    """A copy of the project in a folder of its own, so that a test may run and edit it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def copy(self) -> "Project":
        """Copy the project to its folder, with a link to its source.

        Compiled functions are kept for one place of the source, and jobs refuse a source that is
        not the one their rules list.
        """
        self.folder.mkdir(exist_ok=True)
        for part in PARTS:
            source, copied = ROOT / part, self.folder / part
            if source.is_dir():
                shutil.copytree(source, copied, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(source, copied)
        shutil.copy2(ROOT / "tests/workflow/small.yaml", self.folder)
        (self.folder / "src").symlink_to(ROOT / "src")
        return self

    def copy_source(self) -> None:
        """Replace the link to the source by a copy with the same times, for a test to edit."""
        (self.folder / "src").unlink()
        shutil.copytree(
            ROOT / "src", self.folder / "src", ignore=shutil.ignore_patterns("__pycache__")
        )

    def snakemake(
        self,
        *arguments: str,
        cores: int = 1,
        small: bool = True,
        fresh: bool = False,
        **variables: str,
    ) -> subprocess.CompletedProcess[str]:
        """Run Snakemake in the copy, with further ``variables`` of the environment.

        On one core: other tests keep the others busy, and what two jobs call for the first time at
        once, both compile.

        A dry run is a fork, unless it is to be a ``fresh`` process that imports Snakemake itself.
        """
        options = ["--cores", str(cores), "--profile", "workflow/profiles/default"]
        config = ["--configfile", "config/config.yaml", "small.yaml"] if small else []
        environment = os.environ | {
            "PYTHONPATH": f"{ROOT / 'src'}:{ROOT / 'workflow/plugins'}",
            "OPENBLAS_NUM_THREADS": "1",
            **variables,
        }
        command = [*options, *arguments, *config]
        if "--dry-run" in arguments and not fresh:
            return dry_run(command, self.folder, environment)
        return subprocess.run(
            ["snakemake", *command],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )

    def planned(self, *arguments: str, small: bool = True, fresh: bool = False) -> dict[str, int]:
        """How many jobs of each rule a dry run plans."""
        run = self.snakemake(*arguments, "--dry-run", small=small, fresh=fresh)
        assert run.returncode == 0, run.stdout + run.stderr
        jobs: dict[str, int] = {}
        for line in (run.stdout + run.stderr).splitlines():
            words = line.split()
            if len(words) == 2 and words[1].isdigit() and words[0] != "total":
                jobs[words[0]] = int(words[1])
        return jobs

    def digests(self, *kinds: str) -> dict[str, str]:
        """Hashes of the results of these kinds; the record of an exchange differs in every run."""
        return {
            str(file.relative_to(self.folder)): hashlib.sha256(file.read_bytes()).hexdigest()
            for kind in kinds
            for file in (self.folder / "results").rglob(f"*.{kind}")
            if "link" not in file.name
        }
