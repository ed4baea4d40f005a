"""A trip binds every account of the computer, by whatever name it calls the device."""

import os
import stat
from dataclasses import replace
from pathlib import Path

import pytest

from dea.acquisition import by_hand, latch
from dea.errors import InputError
from dea.modbus import read_device
from dea.modbus.device import Safety

DEVICE = Path(__file__).parents[2] / "config/devices/virtual_bench.yaml"


@pytest.fixture
def device():
    return replace(read_device(DEVICE), port=45679)


def test_a_trip_is_found_by_another_name_and_from_another_account(device, monkeypatch, tmp_path):
    latch.latch(latch.latch_file(device), device.name, "the door is open")
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
        latch.latch(latch.latch_file(device), device.name, "the door is open")
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
    latch.latch(path, device.name, "the door is open")

    def full(*_, **__):
        raise OSError("No space left on device")

    monkeypatch.setattr("pathlib.Path.write_text", full)
    with pytest.raises(OSError, match="No space"):
        latch.latch(path, device.name, "the current is too large")
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
    latch.latch(latch.latch_file(served), served.name, "the door is open")
    assert "the door is open" in by_hand.status(served)
