import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dea.acquisition import DrivenSamples, recover
from dea.acquisition.partial import HEADING, MARK, PartialFile, set_aside
from dea.errors import InputError


def block(start, size):
    steps = np.arange(start, start + size)
    return DrivenSamples(
        steps, steps + 7, steps % 5, steps % 3, steps * 11, steps * 0, steps / 7, steps / 3
    )


REPEATED = 1, 2, 4  # blocks after which the note on the file follows again


def write(path, sizes):
    """Write blocks of these sizes; return where the first note and each block end."""
    ends, start = [], 0
    for n in range(len(sizes) + 1):
        path.unlink(missing_ok=True)
        file, start = PartialFile(path, {"lead": 3}), 0
        for size in sizes[:n]:
            file.samples(block(start, size))
            start += size
        file.close()
        ends.append(path.stat().st_size)
    note = ends[0] - len(HEADING)
    return [end - note * (n in REPEATED) for n, end in enumerate(ends)]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("partial") / "whole.partial"
    sizes = [1, 5, 55, 2]
    return path, sizes, write(path, sizes)


def test_what_is_written_is_recovered(written):
    path, sizes, _ = written
    found = recover(path)
    assert found.damaged == 0
    assert found.notes == [{"lead": 3}]
    for column, expected in zip(found.samples, block(0, sum(sizes)), strict=True):
        assert np.array_equal(column, expected)


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_a_crash_at_any_byte_leaves_everything_up_to_that_block(written, data):
    path, sizes, ends = written
    content = path.read_bytes()
    cut = data.draw(st.integers(len(HEADING), len(content)))
    torn = path.with_name("torn.partial")
    torn.write_bytes(content[:cut])
    found = recover(torn)
    blocks = sum(end <= cut for end in ends[1:])
    assert found.samples.position.size == sum(sizes[:blocks])
    assert np.array_equal(found.samples.displacement, block(0, sum(sizes[:blocks])).displacement)
    note = ends[0] - len(HEADING)
    assert found.damaged == (cut not in [len(HEADING), *ends, *(ends[n] + note for n in REPEATED)])


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_a_damaged_byte_loses_the_block_it_is_in_and_alters_nothing(written, data):
    path, sizes, ends = written
    content = bytearray(path.read_bytes())
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] ^= data.draw(st.integers(1, 255))
    torn = path.with_name("damaged.partial")
    torn.write_bytes(content)
    found = recover(torn)
    starts = np.cumsum([0, *sizes])
    damaged = next((i for i, end in enumerate(ends[1:]) if place < end), None)
    note = ends[0] - len(HEADING)
    if place < ends[0] or any(ends[n] <= place < ends[n] + note for n in REPEATED):
        damaged = None
    assert found.notes == [{"lead": 3}]
    intact = [
        np.arange(starts[i], starts[i + 1]) for i in range(len(sizes)) if i != damaged
    ]  # fmt: skip
    assert found.damaged == 1
    assert np.array_equal(found.samples.position, np.concatenate(intact))
    assert np.array_equal(found.samples.applied, np.concatenate(intact) % 3)


def test_samples_can_be_placed_where_the_beginning_of_the_file_is_lost(written):
    path, sizes, ends = written
    lost = path.with_name("beginning.partial")
    lost.write_bytes(bytes(ends[0]) + path.read_bytes()[ends[0] :])
    found = recover(lost)
    assert found.notes == [{"lead": 3}]
    assert found.samples.position.size == sum(sizes)


def test_a_mark_within_a_note_begins_no_entry(tmp_path):
    path = tmp_path / "a.partial"
    file = PartialFile(path, {})
    file.samples(block(0, 3))
    file.close()
    content = path.read_bytes()
    place = content.index(MARK, len(HEADING) + 1)
    path.write_bytes(content[:place] + b"x" + MARK + bytes(20) + content[place:])
    found = recover(path)
    assert found.damaged == 1
    assert np.array_equal(found.samples.position, [0, 1, 2])


def test_what_is_no_partial_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        recover(tmp_path / "missing.partial")
    (tmp_path / "x.partial").write_bytes(b"something else")
    with pytest.raises(InputError, match="not a partial file"):
        recover(tmp_path / "x.partial")


def test_an_earlier_partial_file_is_set_aside_not_overwritten(tmp_path):
    path = tmp_path / "record.partial"
    for content in ("first", "second"):
        path.write_text(content)
        set_aside(path)
    assert not path.exists()
    assert [(tmp_path / f"record.{n}.partial").read_text() for n in (1, 2)] == ["first", "second"]
    set_aside(path)


def test_the_partial_file_of_a_run_that_goes_on_is_refused(tmp_path):
    path = tmp_path / "record.partial"
    with PartialFile(path, {}) as file:
        with pytest.raises(InputError, match="another run is writing it"):
            set_aside(path)
        file.samples(block(0, 5))
    assert recover(path).samples.position.size == 5
    set_aside(path)
    assert not path.exists()


def test_a_full_disk_is_reported(tmp_path, monkeypatch):
    file = PartialFile(tmp_path / "a.partial", {})

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("dea.acquisition.partial.os.fdatasync", full)
    # The thread that writes may meet it before the samples are given.
    with pytest.raises(OSError, match="cannot be written"), file:
        file.samples(block(0, 5))


def test_a_killed_host_leaves_what_it_had_synced(tmp_path):
    path = tmp_path / "a.partial"
    program = (
        "import sys, time; from pathlib import Path; import numpy as np;"
        "from dea.acquisition.partial import PartialFile\n"
        "from dea.acquisition import DrivenSamples\n"
        "file = PartialFile(Path(sys.argv[1]), {})\n"
        "for n in range(10**6):\n"
        "    file.samples(DrivenSamples(*[np.array([n])] * 8)); time.sleep(0.001)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program, str(path)]) as host:
        deadline = time.monotonic() + 20
        while not path.exists() or path.stat().st_size < 2000:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        host.kill()
    found = recover(path)
    assert found.samples.position.size > 10
    assert np.array_equal(found.samples.position, np.arange(found.samples.position.size))
