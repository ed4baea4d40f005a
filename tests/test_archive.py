from datetime import UTC, datetime

import pytest

from dea import archive
from dea.errors import InputError

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


def test_a_refused_start_leaves_no_folder(tmp_path):
    with pytest.raises(RuntimeError), archive.unfinished("film1", tmp_path, BEGUN):
        raise RuntimeError
    assert not (tmp_path / "film1").exists()
    kept(tmp_path, content=b"first")
    with pytest.raises(RuntimeError), archive.unfinished("film1", tmp_path):
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


@pytest.mark.parametrize("text", ["", "{}", "[1]"])
def test_a_damaged_manifest_is_named(tmp_path, text):
    folder = kept(tmp_path)
    folder.chmod(0o755)
    (folder / archive.MANIFEST).unlink()
    (folder / archive.MANIFEST).write_text(text)
    with pytest.raises(InputError, match=r"manifest\.json"):
        archive.check(folder)
