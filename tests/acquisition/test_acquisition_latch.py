"""A trip binds every account of the computer, by whatever name it calls the device."""

import errno
import json
import os
import stat
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from dea.acquisition import TripError, by_hand, first_trip, latch
from dea.errors import InputError
from dea.modbus import read_device
from dea.modbus.device import Safety

DEVICE = Path(__file__).parents[2] / "config/devices/virtual_bench.yaml"
WHEN = "2026-03-14T15:09:26Z"


@pytest.fixture
def device():
    return replace(read_device(DEVICE), port=45679)


def full(*_, **__):
    """Fail as a disk without room does."""
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_trip_is_found_by_another_name_and_from_another_account(device, monkeypatch, tmp_path):
    latch.latch(latch.latch_file(device), device.name, "the door is open", WHEN)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with pytest.raises(InputError, match="the door is open"):
        latch.refuse_latched(replace(device, host="localhost"))
    assert latch.acknowledge(replace(device, host="localhost"), "A. Person") == "the door is open"
    latch.refuse_latched(device)
    log = latch.latch_file(device).with_name(f"{latch.latch_file(device).name}.log")
    assert '"acknowledged_by": "A. Person"' in log.read_text()


def test_trip_and_log_outlive_a_restart_and_every_account_may_read_them(
    device, monkeypatch, tmp_path
):
    monkeypatch.delenv("DEA_DUTY")
    assert latch.latch_file(device).parent == Path("/var/tmp/dea")  # not emptied at a restart
    monkeypatch.setattr(latch, "FOLDER", tmp_path / "dea")
    before = os.umask(0o077)
    try:
        latch.refuse_latched(replace(device, safety=Safety()))
        latch.latch(latch.latch_file(device), device.name, "the door is open", WHEN)
        kept = [latch.latch_file(device).stat()]
        latch.acknowledge(device, "A. Person")
        kept += [file.stat() for file in (tmp_path / "dea").iterdir()]
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "dea").stat().st_mode) == 0o777
    assert [stat.S_IMODE(each.st_mode) for each in kept] == [0o1666, 0o1666]


@pytest.mark.parametrize("left", [b"", b'{"device": "be', b"[]", b'{"time": "now"}', b"\xff"])
def test_a_damaged_trip_counts_and_its_file_is_named(device, left):
    path = latch.latch_file(device)
    path.write_bytes(left)
    with pytest.raises(InputError, match=rf"{path.name} is damaged"):
        latch.refuse_latched(device)
    assert "is damaged" in latch.acknowledge(device, "A. Person")
    latch.refuse_latched(device)


def test_a_trip_that_cannot_be_written_whole_leaves_the_one_before(device, monkeypatch):
    path = latch.latch_file(device)
    latch.latch(path, device.name, "the door is open", WHEN)
    monkeypatch.setattr("pathlib.Path.write_text", full)
    with pytest.raises(OSError, match="No space"):
        latch.latch(path, device.name, "the current is too large", WHEN)
    assert latch.trip(device)["reason"] == "the door is open"


def test_a_folder_that_keeps_no_trip_is_refused_before_any_voltage(device, monkeypatch, tmp_path):
    monkeypatch.delenv("DEA_DUTY")
    (tmp_path / "file").touch()
    monkeypatch.setattr(latch, "FOLDER", tmp_path / "file" / "dea")
    latch.refuse_latched(device)  # without a safety model nothing trips
    with pytest.raises(InputError, match="a trip could not be kept there"):
        latch.refuse_latched(replace(device, safety=Safety()))


def test_the_status_names_the_trip(serve_bench):
    served = serve_bench().endpoint
    latch.latch(latch.latch_file(served), served.name, "the door is open", WHEN)
    assert "the door is open" in by_hand.status(served)


def test_a_trip_is_held_until_a_full_disk_takes_it(device, monkeypatch):
    took, room = latch.latch, threading.Event()
    tried = threading.Semaphore(0)

    def latch_when_there_is_room(*trip):
        tried.release()
        if not room.is_set():
            full()
        took(*trip)

    monkeypatch.setattr(first_trip, "latch", latch_when_there_is_room)
    monkeypatch.setattr(first_trip, "AGAIN", 0.01)
    monkeypatch.setattr(first_trip, "utc_now", iter([WHEN]).__next__)
    kept = first_trip.FirstTrip(device, latch.latch_file(device))
    kept.latch(TripError("the door is open"))
    for _ in range(3):
        assert tried.acquire(timeout=10)
    assert str(kept.pending) == "the door is open"
    assert "No space left" in str(kept.failure)
    with pytest.raises(InputError, match=rf"tripped at {WHEN}: the door is open"):
        latch.refuse_latched(device)
    room.set()
    kept._latching.join(10)
    assert kept.pending is None
    assert latch.held(device) is None
    assert latch.trip(device) == {"time": WHEN, "reason": "the door is open"}


def test_a_trip_that_memory_alone_has_held_is_acknowledged_too(device):
    latch.hold(device, "the door is open, and the current is too large", WHEN)
    latch.hold(device, "the door is open", WHEN)
    assert latch.acknowledge(device, "A. Person") == "the door is open"
    latch.refuse_latched(device)


def test_a_trip_of_the_time_in_which_one_is_acknowledged_stays(device, monkeypatch):
    path, log = latch.latch_file(device), latch._log
    latch.latch(path, device.name, "the door is open", WHEN)

    def meanwhile(*what):
        latch.latch(path, device.name, "the current is too large", WHEN)
        log(*what)

    monkeypatch.setattr(latch, "_log", meanwhile)
    assert latch.acknowledge(device, "A. Person") == "the door is open"
    assert latch.trip(device)["reason"] == "the current is too large"


def test_a_trip_whose_acknowledgement_cannot_be_kept_stays(device, monkeypatch):
    latch.latch(latch.latch_file(device), device.name, "the door is open", WHEN)
    with monkeypatch.context() as patched:
        patched.setattr("os.write", full)
        with pytest.raises(OSError, match="No space"):
            latch.acknowledge(device, "A. Person")
    assert latch.trip(device)["reason"] == "the door is open"


def test_a_trip_whose_acknowledgement_is_kept_in_part_stays(device, monkeypatch):
    path = latch.latch_file(device)
    latch.latch(path, device.name, "the door is open", WHEN)
    write = os.write
    with monkeypatch.context() as patched:
        patched.setattr("os.write", lambda handle, data: write(handle, data[:20]))
        with pytest.raises(OSError, match="No space"):
            latch.acknowledge(device, "A. Person")
    assert latch.trip(device)["reason"] == "the door is open"
    assert latch.acknowledge(device, "A. Person") == "the door is open"
    [line] = path.with_name(f"{path.name}.log").read_text().splitlines()
    assert json.loads(line)["acknowledged_by"] == "A. Person"


@pytest.mark.parametrize("ending", [KeyboardInterrupt, OSError])
def test_a_trip_binds_until_its_acknowledgement_is_kept(device, monkeypatch, ending):
    latch.latch(latch.latch_file(device), device.name, "the door is open", WHEN)
    bound = []

    def ended(*_, **__):
        bound.append(latch.trip(device))
        raise ending

    with monkeypatch.context() as patched:
        patched.setattr(latch, "_log", ended)
        with pytest.raises(ending):
            latch.acknowledge(device, "A. Person")
    assert [trip["reason"] for trip in bound] == ["the door is open"]
    assert latch.trip(device) == bound[0]
    assert latch.acknowledge(device, "A. Person") == "the door is open"
    assert latch.trip(device) is None


def test_a_trip_that_two_acknowledge_at_once_is_cleared_once(device, monkeypatch):
    path, log = latch.latch_file(device), latch._log
    latch.latch(path, device.name, "the door is open", WHEN)

    def meanwhile(*what):
        path.unlink()
        log(*what)

    monkeypatch.setattr(latch, "_log", meanwhile)
    assert latch.acknowledge(device, "A. Person") == "the door is open"
    assert latch.trip(device) is None


def test_a_full_disk_that_would_take_no_trip_is_refused_before_any_voltage(device, monkeypatch):
    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(InputError, match=r"could not be kept there \(No space left on device\)"):
        latch.refuse_latched(replace(device, safety=Safety()))


@pytest.mark.parametrize("nobody", ["", "  "])
def test_nobody_acknowledges_a_trip_without_a_name(device, nobody):
    latch.latch(latch.latch_file(device), device.name, "the door is open", WHEN)
    with pytest.raises(InputError, match="by: a trip is acknowledged by a person"):
        latch.acknowledge(device, nobody)
    assert latch.trip(device)["reason"] == "the door is open"
