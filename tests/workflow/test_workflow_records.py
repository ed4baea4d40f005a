"""Records of hardware are inputs of the study, and never outputs of a rule."""

from datetime import UTC, datetime

import pytest

from dea import archive

pytestmark = pytest.mark.slow


@pytest.fixture
def hardware(project):
    """A study of dea1, which is virtual, and of film1, which is not."""
    small = project.folder / "small.yaml"
    text = small.read_text()
    small.write_text(text.replace("name: dea2,", "name: film1,").replace(", bench: dea2", ""))
    return project


def keep(project, excitation, hour):
    begun = datetime(2026, 3, 1, hour, tzinfo=UTC)
    with archive.unfinished("film1", project.folder / "records", begun) as folder:
        (folder / "record.nc").write_bytes(b"")
        (folder / "link.nc").write_bytes(b"")
        return archive.seal(folder, {"excitation": excitation})


def test_the_study_takes_a_record_of_hardware_and_never_makes_one(hardware):
    run = hardware.snakemake("study", "--dry-run")
    assert run.returncode != 0
    assert "make record NAME=film1 EXCITATION=" in run.stdout + run.stderr

    folders = [keep(hardware, "record", 12), keep(hardware, "second", 13)]
    jobs = hardware.planned("study")
    assert jobs["acquire"] == jobs["take_record"] == 1
    assert jobs["figures_actuator"] == jobs["figures_unconfirmed"] == 1
    # Nothing that Snakemake knows as an output lies in records/.
    run = hardware.snakemake("study", "--delete-all-output", "--dry-run")
    assert "records/" not in run.stdout + run.stderr
    assert all(archive.check(folder) for folder in folders)
