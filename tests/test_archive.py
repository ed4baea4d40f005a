import errno
from datetime import UTC, datetime
from pathlib import Path

import pytest

from dea import archive
from dea.errors import InputError
from dea.stages.take_record import take_record
from synced_files import note_synced

BEGUN = datetime(2026, 3, 1, 12, 30, 5, tzinfo=UTC)


def kept(root, excitation="record", now=BEGUN, content=b"abc"):
    with archive.unfinished("film1", root, now) as folder:
        (folder / "record.nc").write_bytes(content)
        return archive.seal(folder, {"excitation": excitation})


def test_a_record_is_named_by_its_time_and_read_only(tmp_path):
    folder = kept(tmp_path)
    assert folder == tmp_path / "film1/20260301T123005Z"
    assert {path.name for path in folder.iterdir()} == {"record.nc", "manifest.json"}
    assert {path.stat().st_mode & 0o777 for path in folder.iterdir()} == {0o444}
    assert folder.stat().st_mode & 0o777 == 0o555


def test_a_failed_record_stays_under_an_unfinished_name(tmp_path):
    def fail():
        with archive.unfinished("film1", tmp_path, BEGUN) as folder:
            (folder / "samples.partial").write_bytes(b"abc")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert (tmp_path / "film1/20260301T123005Z.partial/samples.partial").read_bytes() == b"abc"
    with pytest.raises(InputError, match="there is no record of film1"):
        archive.chosen("film1", "record", root=tmp_path)


def sealed_from_samples(root):
    with archive.unfinished("film1", root, BEGUN) as folder:
        (folder / "record.nc").write_bytes(b"abc")
        (folder / "device.yaml").write_bytes(b"def")
        samples = folder / "samples.partial"
        samples.write_bytes(b"ghi")
        return archive.seal(folder, {"excitation": "record"})


def test_what_a_record_was_made_from_is_removed_once_all_of_it_is_on_the_disk(
    tmp_path, monkeypatch
):
    done, unlink = [], Path.unlink

    def removed(path, **options):
        if path.exists():
            done.append(f"without {path.name}")
        unlink(path, **options)

    note_synced(monkeypatch, done)
    monkeypatch.setattr(Path, "unlink", removed)
    folder = sealed_from_samples(tmp_path)
    assert {"record.nc", "device.yaml"} <= set(done)
    assert done[-2:] == ["film1", "without samples.partial"]
    assert set(archive.check(folder)["files"]) == {"record.nc", "device.yaml"}
    assert not (folder / "samples.partial").exists()


def test_a_record_that_cannot_be_sealed_keeps_what_it_was_made_from(tmp_path, monkeypatch):
    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space"):
        sealed_from_samples(tmp_path)
    assert (tmp_path / "film1/20260301T123005Z.partial/samples.partial").read_bytes() == b"ghi"


def crash_once_it_has_its_name(root, monkeypatch):
    """Seal a record up to the moment when it has its name; return its folder."""

    def crash(folder):
        if folder.name == "film1":
            raise KeyboardInterrupt

    with monkeypatch.context() as crashing:
        crashing.setattr(archive, "sync_folder", crash)
        with pytest.raises(KeyboardInterrupt):
            sealed_from_samples(root)
    return root / "film1/20260301T123005Z"


def test_a_seal_that_a_crash_ended_is_finished_where_the_record_is_taken(tmp_path, monkeypatch):
    folder = crash_once_it_has_its_name(tmp_path, monkeypatch)
    (folder / "link.nc").touch()
    assert (folder / "samples.partial").exists()
    taken = tmp_path / "record.nc"
    take_record({}, folder / archive.MANIFEST, taken, tmp_path / "link.nc")
    assert taken.read_bytes() == b"abc"
    assert not (folder / "samples.partial").exists()
    assert folder.stat().st_mode & 0o777 == 0o555


def test_samples_beside_a_damaged_record_are_kept(tmp_path, monkeypatch):
    folder = crash_once_it_has_its_name(tmp_path, monkeypatch)
    (folder / "device.yaml").unlink()
    with pytest.raises(InputError, match=r"device\.yaml: is missing"):
        archive.finish(folder)
    assert (folder / "samples.partial").read_bytes() == b"ghi"


def test_a_refused_start_leaves_no_folder(tmp_path):
    with pytest.raises(RuntimeError), archive.unfinished("film1", tmp_path, BEGUN):
        raise RuntimeError
    assert not (tmp_path / "film1").exists()
    kept(tmp_path, content=b"first")
    later = BEGUN.replace(hour=13)
    with pytest.raises(RuntimeError), archive.unfinished("film1", tmp_path, later):
        raise RuntimeError
    assert len(list((tmp_path / "film1").iterdir())) == 1


def test_two_records_of_one_second_do_not_meet(tmp_path):
    kept(tmp_path, content=b"first")
    with (
        pytest.raises(InputError, match="exists already"),
        archive.unfinished("film1", tmp_path, BEGUN),
    ):
        pass
    assert (tmp_path / "film1/20260301T123005Z/record.nc").read_bytes() == b"first"


def test_no_record_starts_before_the_newest_as_where_a_clock_was_wrong(tmp_path):
    ahead = kept(tmp_path, now=BEGUN.replace(year=2036))
    with pytest.raises(InputError, match=r"20360301T123005Z: is of a later time than now, 2026"):
        kept(tmp_path)
    assert [folder.name for folder in ahead.parent.iterdir()] == [ahead.name]
    ahead.rename(ahead.with_name("20260301T113005Z"))
    last = kept(tmp_path)
    assert archive.chosen("film1", "record", root=tmp_path) == last


def test_the_newest_record_of_the_excitation_is_chosen(tmp_path):
    first = kept(tmp_path)
    second = kept(tmp_path, now=BEGUN.replace(hour=13))
    kept(tmp_path, "second", now=BEGUN.replace(hour=14))
    assert archive.chosen("film1", "record", root=tmp_path) == second
    assert archive.chosen("film1", "record", first.name, tmp_path) == first


def test_a_record_that_is_not_there_is_named_with_the_command(tmp_path):
    with pytest.raises(InputError, match="make record NAME=film1 EXCITATION=second"):
        archive.chosen("film1", "second", root=tmp_path)


def test_a_pinned_record_that_is_not_there_lists_those_that_are(tmp_path):
    folder = kept(tmp_path)
    with pytest.raises(InputError, match=rf"no record '2025'.*{folder.name}"):
        archive.chosen("film1", "record", "2025", tmp_path)


@pytest.mark.parametrize(
    ("damage", "said"), [("changed", "is not what"), ("missing", "is missing")]
)
def test_a_damaged_file_is_named(tmp_path, damage, said):
    folder = kept(tmp_path)
    assert archive.check(folder)["excitation"] == "record"
    folder.chmod(0o755)
    file = folder / "record.nc"
    file.unlink()
    if damage == "changed":
        file.write_bytes(b"abd")
    with pytest.raises(InputError, match=rf"record\.nc: {said}"):
        archive.check(folder)


@pytest.mark.parametrize(
    "text", ["", "{}", "[1]", '{"excitation": "record", "files": ["record.nc"]}', '{"files": {}}']
)
def test_a_damaged_manifest_is_named(tmp_path, text):
    folder = kept(tmp_path)
    folder.chmod(0o755)
    (folder / archive.MANIFEST).unlink()
    (folder / archive.MANIFEST).write_text(text)
    with pytest.raises(InputError, match=r"manifest\.json"):
        archive.check(folder)
