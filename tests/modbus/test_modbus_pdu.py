from pathlib import Path

import pytest

from dea.modbus import ReadWriteRequest, Register, Window, read_device

DESCRIPTION = Path(__file__).parents[2] / "config/devices/virtual_bench.yaml"


def decoded(read, written, promised=None):
    """A request for ``read`` registers that writes ``written``, as a server decodes it."""
    request = ReadWriteRequest(read_count=read, write_registers=[7] * written)
    data = bytearray(request.encode())
    if promised is not None:
        data[6:8] = promised.to_bytes(2, "big")
    found = ReadWriteRequest()
    found.decode(bytes(data))
    return found


@pytest.mark.parametrize(("read", "written"), [(1, 1), (125, 1), (1, 121)])
def test_a_request_within_the_standards_limits_is_valid(read, written):
    request = decoded(read, written)
    assert request.valid
    assert request.write_registers == [7] * written


@pytest.mark.parametrize(("read", "written"), [(0, 1), (126, 1), (1, 0), (1, 122)])
def test_a_request_beyond_them_is_not(read, written):
    assert not decoded(read, written).valid


def test_a_request_whose_counts_disagree_is_not():
    assert not decoded(1, 3, promised=2).valid


def test_a_window_may_hold_one_register():
    window = Window([Register("level", 12, table="input")])
    assert (window.address, window.size, window.table) == (12, 1, "input")
    assert window.decode([345]) == {"level": 345}


def test_a_description_says_where_its_device_listens():
    device = read_device(DESCRIPTION)
    assert (device.host, device.port) == ("127.0.0.1", 5020)
