"""The audit of a small study that the workflow has made."""

import shutil
from pathlib import Path

import pytest
from copied_project import ROOT

from dea.audit import Manifest, verify
from dea.audit.recompute import recompute

pytestmark = pytest.mark.slow


@pytest.fixture
def study(finished, tmp_path, monkeypatch):
    """A copy of the finished results beside the code and config that made them."""
    shutil.copytree(finished.folder / "results", tmp_path / "results")
    shutil.copy(ROOT / "environment.txt", tmp_path)
    (tmp_path / "src").symlink_to(ROOT / "src")
    for folder in ("config", "build"):
        (tmp_path / folder).symlink_to(finished.folder / folder)
    monkeypatch.chdir(tmp_path)
    return Manifest.read()


def test_an_untouched_study_passes(study):
    assert verify(study) == []


def test_a_byte_flipped_in_any_file_is_found(study):
    files = [path for path in Path("results").rglob("*") if path.is_file() and path.stat().st_size]
    files = [path for path in files if path.name != "MANIFEST.json"]
    assert len(files) > 100
    for path in files:
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)
    assert {str(path) for path in files} <= {finding.path for finding in verify(study)}


def test_jobs_that_run_again_make_the_same_bytes(study):
    for products, findings in recompute(study, 3, seed=1):
        assert findings == [], products
