"""Which jobs an edit of the configuration reruns: those that are told another value."""

import re

import pytest
from copied_project import Project

pytestmark = pytest.mark.slow
TARGETS = "study", "discrepancy", "control_all", "trials"


@pytest.fixture(scope="module")
def unstarted(tmp_path_factory):
    """A copy in which nothing has run."""
    return Project(tmp_path_factory.mktemp("unstarted")).copy()


def told(project):
    """The commands of all jobs with their settings, by rule."""
    asked = ["--dry-run", "--printshellcmds", "--quiet", "host"]
    run = project.snakemake(*TARGETS, *asked, small=False)
    assert run.returncode == 0, run.stdout
    commands: dict[str, set[str]] = {}
    for block in re.split(r"^(?:local)?rule ", run.stdout, flags=re.MULTILINE)[1:]:
        if command := re.search(r"^Shell command: (.*)$", block, re.MULTILINE):
            commands.setdefault(block.split(":")[0], set()).add(command[1])
    return commands


@pytest.fixture(scope="module")
def before(unstarted):
    return told(unstarted)


PLAYED = {"acquire", "acquire_second", "acquire_probed", "trial_acquire"}


@pytest.mark.parametrize(
    ("old", "new", "rules"),
    [
        ("resamples: 10 ", "resamples: 9 ", {"select"}),
        ("rounds: 200 ", "rounds: 100 ", {"select", "select_common"}),
        ("start: 500 ", "start: 400 ", {"orders", "select", "select_common", "validate"}),
        ("degree: 3 ", "degree: 2 ", {"orders", "select", "select_common"}),
        ("degree: 3\n", "degree: 2\n", {"recover"}),
        ("dynamic: 5 ", "dynamic: 4 ", {"orders"}),
        ("instants: 360             # of H1", "instants: 180 # of H1", {"gfrf"}),
        ("mode: buffered ", "armed_by: L. Galvani\n  mode: buffered ", set()),
        ("late_after: 5.0e-3 ", "late_after: 6.0e-3 ", {"control"}),
        ("mode: buffered ", "mode: polled ", PLAYED),
        ("ramp_rate: 1.0 ", "ramp_rate: 2.0 ", {*PLAYED, "control"}),
        ("simulation: dea_film ", "simulation: dea_membrane ", {"diagnose"}),
        ("warm_up: 1.0 ", "warm_up: 0.5 ", {"diagnose", "trial_diagnose"}),
        ("clean: 1.15 ", "clean: 1.2 ", {"diagnose", "trial_diagnose", "figures_trials"}),
    ],
)
def test_an_edit_reruns_the_jobs_that_read_the_key(unstarted, before, old, new, rules):
    config = unstarted.folder / "config/config.yaml"
    content = config.read_text()
    assert content.count(old) == 1
    try:
        config.write_text(content.replace(old, new))
        after = told(unstarted)
    finally:
        config.write_text(content)
    assert after.keys() == before.keys()
    assert {rule for rule in before if before[rule] != after[rule]} == rules
