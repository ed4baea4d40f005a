"""Copies of files are whole or not there."""

import shutil

import pytest

from dea.stages.copy_files import copy_files


def test_files_are_copied_to_other_names(tmp_path):
    originals = [tmp_path / name for name in ("a", "b")]
    copies = [tmp_path / "copies" / name for name in ("c", "d")]
    for file in originals:
        file.write_text(file.name)
    copy_files({}, originals, copies)
    assert [file.read_text() for file in copies] == ["a", "b"]


def test_a_copy_that_cannot_be_written_whole_leaves_what_was_there(tmp_path, monkeypatch):
    original, copy = tmp_path / "new", tmp_path / "old"
    original.write_text("new")
    copy.write_text("old")

    def full(source, target):
        target.write_text("n")
        raise OSError("No space left on device")

    monkeypatch.setattr(shutil, "copyfile", full)
    with pytest.raises(OSError, match="No space left"):
        copy_files({}, [original], [copy])
    assert copy.read_text() == "old"
    assert sorted(tmp_path.iterdir()) == [original, copy]
