"""Our client and our bench against implementations of Modbus that are not our own."""

import re
import shutil
import socket
import struct
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from pyModbusTCP.client import ModbusClient
from pyModbusTCP.server import DataBank, ModbusServer
from pyModbusTCP.utils import decode_ieee, long_list_to_word, word_list_to_long

from dea.acquisition import AcquisitionSettings, Link, acquire
from dea.acquisition.panel import Panel
from dea.modbus import parse_device, read_device

HERE = Path(__file__).parent
DEVICES = HERE.parents[1] / "config/devices"
ORDERS = ["abcd", "cdab", "badc", "dcba"]  # bytes of a 32-bit number, a the most significant
WORD_ORDER = {"abcd": "big", "cdab": "little", "badc": "big", "dcba": "little"}
BYTE_ORDER = {"abcd": "big", "cdab": "big", "badc": "little", "dcba": "little"}
PATTERN = 0x01020304
POLLED = AcquisitionSettings(mode="polled", ramp_rate=50.0, timeout=1.0, paced=False)

needs_libmodbus = pytest.mark.skipif(
    not (shutil.which("gcc") and Path("/usr/include/modbus/modbus.h").exists()),
    reason="needs a compiler and libmodbus: apt-get install gcc libc6-dev libmodbus-dev",
)
needs_mbpoll = pytest.mark.skipif(
    not shutil.which("mbpoll"), reason="needs mbpoll: apt-get install mbpoll"
)


@pytest.fixture(scope="session")
def libmodbus_binary(tmp_path_factory):
    binary = tmp_path_factory.mktemp("libmodbus") / "server"
    source = HERE / "libmodbus_server.c"
    subprocess.run(["gcc", "-Wall", "-Werror", source, "-o", binary, "-lmodbus"], check=True)
    return binary


@pytest.fixture
def libmodbus(libmodbus_binary):
    """Port of a server by libmodbus."""
    with subprocess.Popen([libmodbus_binary], stdout=subprocess.PIPE, text=True) as process:
        yield int(process.stdout.readline())
        process.terminate()


class Module(DataBank):
    """A plain analogue module: what register 0 is set to is measured, times three."""

    def on_holding_registers_change(self, address, from_value, to_value, srv_info):
        if address == 0:
            self.set_input_registers(0, [3 * to_value % 65536])
            self.set_holding_registers(1, [3 * to_value % 65536])


@pytest.fixture
def py_modbus_tcp():
    """Port of a server by pyModbusTCP."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    server = ModbusServer("127.0.0.1", port, no_block=True, data_bank=Module())
    server.start()
    yield port
    server.stop()


def analogue_module(port, **changes):
    """The ready description, with the endpoint of a server."""
    module = read_device(DEVICES / "analogue_module.yaml")
    return replace(module, host="127.0.0.1", port=port, quarantine=0.2, **changes)


@pytest.mark.parametrize(
    "server", [pytest.param("libmodbus", marks=needs_libmodbus), "py_modbus_tcp"]
)
@pytest.mark.parametrize("paced", [False, True])
def test_our_client_drives_a_plain_module(server, request, tmp_path, paced):
    volts = 2.0 + 1.5 * np.sin(np.arange(60 if paced else 300) * 0.1)
    module = analogue_module(request.getfixturevalue(server))
    result = acquire(module, volts, tmp_path / "r.partial", replace(POLLED, paced=paced))
    record = result.record
    assert np.array_equal(record.voltage_counts, np.rint(volts / 10 * 65535))
    assert np.array_equal(record.displacement_counts, 3 * record.voltage_counts.values % 65536)
    assert np.array_equal(np.diff(record.device_index), np.ones(volts.size - 1))
    peer = ModbusClient("127.0.0.1", module.port, auto_close=True)
    assert peer.read_holding_registers(0, 1) == [0]


@pytest.mark.parametrize(
    "server", [pytest.param("libmodbus", marks=needs_libmodbus), "py_modbus_tcp"]
)
def test_our_client_drives_a_module_by_function_code_23(server, request, tmp_path):
    volts = 2.0 + 1.5 * np.sin(np.arange(300) * 0.1)
    module = analogue_module(request.getfixturevalue(server), read_write_multiple=True)
    registers = dict(module.registers)
    registers["displacement"] = replace(registers["displacement"], table="holding", address=1)
    module = replace(module, registers=registers)
    record = acquire(module, volts, tmp_path / "r.partial", POLLED).record
    asked, measured = record.voltage_counts.values, record.displacement_counts.values
    assert np.array_equal(asked, np.rint(volts / 10 * 65535))
    # libmodbus's module measures after its reply, so that a reply holds the measurement before.
    late = 1 if server == "libmodbus" else 0
    assert np.array_equal(measured[late:], 3 * asked[: asked.size - late] % 65536)


def patterns(port, first, access="read"):
    """A device with a 32-bit number in each of the four orders, from address ``first`` on."""
    registers = {
        order: {
            "address": first + 2 * place, "type": "uint32", "access": access,
            "word_order": WORD_ORDER[order], "byte_order": BYTE_ORDER[order],
        }
        for place, order in enumerate(ORDERS)
    }  # fmt: skip
    return parse_device(
        {
            "name": "patterns", "endpoint": {"host": "127.0.0.1", "port": port}, "unit_id": 1,
            "sampling_rate": 50, "registers": registers,
        }
    )  # fmt: skip


@pytest.fixture
def panel():
    """Open a panel on a device."""
    links = []

    def open_panel(device):
        links.append(Link(device))
        links[-1].open()
        return Panel(links[-1])

    yield open_panel
    for link in links:
        link.close()


@needs_libmodbus
def test_a_pattern_in_every_order_is_read_from_libmodbus(libmodbus, panel):
    read = panel(patterns(libmodbus, 100))
    assert [read.get(order) for order in ORDERS] == [PATTERN] * 4


@needs_libmodbus
def test_a_pattern_in_every_order_is_written_to_libmodbus(libmodbus, panel):
    written = panel(patterns(libmodbus, 110, "read_write"))
    for place, order in enumerate(ORDERS):
        written.set(order, PATTERN + place)
    written.link.close()  # the server has one connection at a time
    peer = ModbusClient("127.0.0.1", libmodbus, auto_close=True)
    found = word_list_to_long(peer.read_holding_registers(120, 8))
    assert found == [PATTERN + place for place in range(4)]


def test_a_pattern_in_every_order_to_and_from_py_modbus_tcp(py_modbus_tcp, panel):
    here = panel(patterns(py_modbus_tcp, 100, "read_write"))
    peer = ModbusClient("127.0.0.1", py_modbus_tcp, auto_close=True)
    for place, order in enumerate(ORDERS):
        here.set(order, PATTERN)
        words = peer.read_holding_registers(100 + 2 * place, 2)
        letters = {1: "a", 2: "b", 3: "c", 4: "d"}
        assert "".join(letters[byte] for byte in struct.pack(">2H", *words)) == order
        assert here.get(order) == PATTERN


@pytest.fixture(params=ORDERS)
def ordered_bench(request, serve_bench):
    """The bench, its registers in one of the four orders, and that order."""
    content = yaml.safe_load((DEVICES / "virtual_bench.yaml").read_text())
    content |= {"word_order": WORD_ORDER[request.param], "byte_order": BYTE_ORDER[request.param]}
    return serve_bench(description=parse_device(content)), request.param


def swapped(words, order):
    """Exchange words between plain big-endian order and another; its own inverse."""
    if BYTE_ORDER[order] == "little":
        words = [int.from_bytes(word.to_bytes(2, "little"), "big") for word in words]
    return words[::-1] if WORD_ORDER[order] == "little" else words


def test_py_modbus_tcp_drives_our_bench_in_every_order(ordered_bench):
    bench, order = ordered_bench
    device, token = bench.endpoint, PATTERN
    master = ModbusClient("127.0.0.1", device.port, unit_id=device.unit_id)

    def read(name, number):
        return master.read_holding_registers(device[name].address, number)

    def write(name, words):
        return master.write_multiple_registers(device[name].address, words)

    def plain(number):
        """A 16-bit value as the device's byte order has it."""
        return swapped([number], order)

    assert decode_ieee(word_list_to_long(swapped(read("device_rate", 2), order))[0]) == 50.0
    assert write("claim", swapped(long_list_to_word([token]), order))
    assert bench.device.owner == token
    assert write("command", plain(1))
    for count in (1000, 5000, 9000):
        assert write("output", plain(count))
        assert read("applied_output", 1) == plain(count)
        index = word_list_to_long(swapped(read("device_index", 2), order))[0]
        assert bench.applied[index] == count
        assert read("displacement", 1) == plain(int(bench.displacement[index]))
    assert write("command", plain(2))
    while read("state", 1) != plain(0):
        assert read("state", 1) in (plain(0), plain(1))
    assert read("applied_output", 1) == [0]
    assert write("claim", [0, 0])
    assert bench.device.owner == 0
    master.close()


def test_our_client_drives_our_bench_in_every_order(ordered_bench, tmp_path):
    bench, _ = ordered_bench
    volts = 2.0 + 1.5 * np.sin(np.arange(300) * 0.1)
    record = acquire(
        bench.endpoint, volts, tmp_path / "r.partial", replace(POLLED, mode="buffered")
    )
    counts = record.record.voltage_counts.values
    assert np.array_equal(counts, np.rint(volts / 15 * 65535))
    assert np.array_equal(counts, bench.applied[record.record.device_index.values])


def mbpoll(port, *arguments):
    """What mbpoll prints for each value read, by address."""
    words = ["mbpoll", "-m", "tcp", "-p", str(port), "-a", "1", "-0", "-1", "-o", "2"]
    done = subprocess.run(
        [*words, *map(str, arguments)], capture_output=True, text=True, timeout=20, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return re.findall(r"^\[\d+\]:\s+(\S+)", done.stdout, re.MULTILINE)


@needs_mbpoll
def test_mbpoll_reads_our_bench(serve_bench):
    device = serve_bench().endpoint
    words = mbpoll(device.port, "-t", "4:hex", "-r", 0, "-c", 8, "127.0.0.1")
    assert bytes.fromhex("".join(w[2:] for w in words)).rstrip(b"\0") == b"dea-bench"
    address = device["device_rate"].address
    assert mbpoll(device.port, "-t", "4:float", "-B", "-r", address, "127.0.0.1") == ["50"]
    assert mbpoll(device.port, "-t", 3, "-r", 8, "127.0.0.1") == ["1"]


@needs_mbpoll
@pytest.mark.parametrize("order", ["abcd", "cdab"])  # mbpoll has no others
def test_mbpoll_reads_and_writes_32_bits_of_our_bench(serve_bench, order):
    content = yaml.safe_load((DEVICES / "virtual_bench.yaml").read_text())
    bench = serve_bench(description=parse_device(content | {"word_order": WORD_ORDER[order]}))
    device, flags = bench.endpoint, ["-B"] if WORD_ORDER[order] == "big" else []
    rate = device["device_rate"].address
    assert mbpoll(device.port, "-t", "4:float", *flags, "-r", rate, "127.0.0.1") == ["50"]
    claim = ("-t", "4:int", *flags, "-r", device["claim"].address, "127.0.0.1", PATTERN)
    mbpoll(device.port, *claim)
    assert bench.device.owner == PATTERN
