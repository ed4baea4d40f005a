"""The study on a cluster: how it is planned, and a run on a Slurm of one node."""

import os
import re
import resource
import shutil
import subprocess

import pytest
import yaml
from copied_project import ROOT

KINDS = ("nc", "png", "pdf", "csv", "md", "tex")
SLURM = ["--workflow-profile", "workflow/profiles/default", "--profile", "workflow/profiles/slurm"]


def many(count):
    """A config of so many actuators."""
    lines = [
        f"  - {{name: x{place:03d}, device: config/devices/virtual_bench.yaml, bench: dea1}}"
        for place in range(count)
    ]
    return "\n".join(["actuators:", *lines, ""])


@pytest.mark.slow
def test_every_rule_of_one_actuator_is_in_its_group(project):
    """A rule outside of the group between two inside would split it into several submissions."""
    groups = yaml.safe_load((ROOT / "workflow/profiles/slurm/profile.yaml").read_text())["groups"]
    small = project.folder / "small.yaml"
    content = yaml.safe_load(small.read_text())
    content["actuators"] = content["actuators"][:1]
    small.write_text(yaml.safe_dump(content))
    jobs = project.planned("study")
    between = {
        "acquire", "acquire_probed", "orders", "select", "validate", "forecast", "track", "gfrf",
        "confirm",
    }  # fmt: skip
    assert between <= groups.keys() & jobs.keys()
    assert set(groups.values()) == {"actuator"}


@pytest.mark.campaign
def test_the_plan_of_six_hundred_actuators_is_made_with_little(project):
    (project.folder / "small.yaml").write_text(many(600))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    jobs = project.planned("study", fresh=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert jobs["acquire"] == jobs["gfrf"] == 600
    assert jobs["figures_responses_100"] == 1
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 40.0
    assert after.ru_maxrss < 500_000  # KiB


@pytest.mark.campaign
@pytest.mark.skipif(not shutil.which("sbatch"), reason="no Slurm is installed")
def test_a_study_on_slurm_has_the_same_bytes_and_one_submission_for_each_actuator(
    project, finished
):
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src"), "OPENBLAS_NUM_THREADS": "1"}
    config = ["--configfile", "config/config.yaml", "small.yaml"]
    run = subprocess.run(
        ["snakemake", *SLURM, "--jobs", "4", "study", *config],
        cwd=project.folder, env=environment, capture_output=True, text=True,
    )  # fmt: skip
    said = run.stdout + run.stderr
    assert run.returncode == 0, said
    submitted = re.findall(r"submitted with SLURM jobid \d+ \(log: \S+slurm_logs/(\w+)", said)
    assert sum(name.startswith("group_actuator") for name in submitted) == 2
    assert not [name for name in submitted if "first_actuator" in name and "group" not in name]
    assert project.digests(*KINDS) == finished.digests(*KINDS)
