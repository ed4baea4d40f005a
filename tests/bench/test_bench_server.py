"""The bench as any Modbus master meets it, byte by byte and through pymodbus's client."""

import socket
import time

import numpy as np
import pytest
from pymodbus.client import ModbusTcpClient

from dea.modbus import checksum, encode
from modbus_frames import frame

READ_IDENTITY = bytes.fromhex("0300000008")


class Master:
    """A pymodbus client with the names of the description."""

    def __init__(self, bench, token=0):
        self.device, self.sequence = bench.endpoint, 0
        self.client = ModbusTcpClient("127.0.0.1", port=self.device.port, timeout=2, retries=0)
        assert self.client.connect()
        if token:
            assert not self.set("claim", token).isError()

    def get(self, name):
        register = self.device[name]
        reply = self.client.read_holding_registers(register.address, count=register.size)
        return reply.registers if register.count > 1 else int(
            self.client.convert_from_registers(reply.registers, {
                "uint16": self.client.DATATYPE.UINT16, "uint32": self.client.DATATYPE.UINT32,
            }[register.type])
        )  # fmt: skip

    def set(self, name, value):
        register = self.device[name]
        return self.client.write_registers(register.address, encode(register, value))

    def exchange(self, sequence, samples, index=0, spoil=0):
        """Send a block; return the reply's words by register name."""
        device = self.device
        padded = [*samples, *[0] * (device["block_samples"].count - len(samples))]
        words = [*encode(device["block_sequence"], sequence),
                 *encode(device["block_read_index"], index), len(samples), *padded]  # fmt: skip
        words = [*encode(device["block_crc"], checksum(words) ^ spoil), *words]
        first, last = device["reply_crc"], device["reply_samples"]
        reply = self.client.readwrite_registers(
            read_address=first.address, read_count=last.end - first.address,
            write_address=device["block_crc"].address, values=words,
        )  # fmt: skip
        if reply.isError():
            return reply
        registers = [r for n, r in device.registers.items() if n.startswith("reply_")]
        return {r.name: reply.registers[r.address - first.address : r.end - first.address]
                for r in registers}  # fmt: skip


@pytest.fixture
def bench(serve_bench):
    return serve_bench()


@pytest.fixture
def open_socket(bench):
    sockets = []

    def connect():
        sockets.append(socket.create_connection(("127.0.0.1", bench.endpoint.port), timeout=2))
        return sockets[-1]

    yield connect
    for each in sockets:
        each.close()


def reply(connection):
    """Transaction id and PDU of the next reply; None where the bench has hung up."""
    data = b""
    while len(data) < 6 or len(data) < 6 + int.from_bytes(data[4:6], "big"):
        try:
            more = connection.recv(6 - len(data) if len(data) < 6 else 300)
        except ConnectionResetError:
            return None
        if not more:
            return None
        data += more
    return int.from_bytes(data[:2], "big"), data[7:]


def alive(open_socket):
    connection = open_socket()
    connection.sendall(frame(READ_IDENTITY))
    return b"dea-bench" in reply(connection)[1]


def soon(condition):
    """Return whether a condition comes true, on a machine that may be busy."""
    until = time.monotonic() + 10.0
    while not condition() and time.monotonic() < until:
        time.sleep(0.01)
    return condition()


def test_two_requests_in_one_segment_are_both_answered_in_order(open_socket):
    connection = open_socket()
    connection.sendall(frame(READ_IDENTITY, 1) + frame(bytes.fromhex("0300080001"), 2))
    transaction, pdu = reply_of_length(connection, 1 + 1 + 16)
    assert (transaction, pdu[2:11]) == (1, b"dea-bench")
    transaction, pdu = reply_of_length(connection, 1 + 1 + 2)
    assert (transaction, pdu[2:]) == (2, b"\0\1")


def reply_of_length(connection, length):
    data = b""
    while len(data) < 7 + length:
        data += connection.recv(7 + length - len(data))
    return int.from_bytes(data[:2], "big"), data[7:]


def test_a_request_in_single_bytes_is_answered(open_socket):
    connection = open_socket()
    for byte in frame(READ_IDENTITY):
        connection.sendall(bytes([byte]))
    assert b"dea-bench" in reply(connection)[1]


@pytest.mark.parametrize(
    ("request_pdu", "code"),
    [
        (bytes.fromhex("0300000000"), 3),  # no registers
        (bytes.fromhex("030000007e"), 3),  # 126 registers
        (bytes.fromhex("0301fa0001"), 2),  # past the map
        (bytes.fromhex("03ffff0002"), 2),  # past the last address
        (bytes.fromhex("03"), 3),  # cut short
        (bytes.fromhex("0100000001"), 1),  # coils
        (bytes.fromhex("1800640001"[:10]), 1),  # read FIFO queue
        (bytes.fromhex("55"), 1),  # no such function
        (bytes.fromhex("0600000001"), 2),  # the identity is read only
        (bytes.fromhex("0600460001"), 7),  # a command from somebody who owns nothing
    ],
)
def test_what_cannot_be_done_is_refused(open_socket, request_pdu, code):
    connection = open_socket()
    connection.sendall(frame(request_pdu))
    assert reply(connection) == (7, bytes([request_pdu[0] | 0x80, code]))
    connection.sendall(frame(READ_IDENTITY))
    assert b"dea-bench" in reply(connection)[1]


def test_an_unknown_unit_is_answered_as_a_gateway_would(open_socket):
    connection = open_socket()
    connection.sendall(frame(READ_IDENTITY, unit=9))
    assert reply(connection)[1] == bytes([0x83, 0x0B])


@pytest.mark.parametrize(
    "garbage",
    [frame(READ_IDENTITY, protocol=1), frame(READ_IDENTITY, length=0),
     frame(READ_IDENTITY, length=1), frame(READ_IDENTITY, length=60000), b"GET / HTTP/1.1\r\n\r\n"],
)  # fmt: skip
def test_what_is_no_modbus_ends_the_connection_and_nothing_else(open_socket, garbage):
    connection = open_socket()
    connection.sendall(garbage)
    assert reply(connection) is None
    assert alive(open_socket)


def test_a_client_that_never_reads_is_dropped(bench, open_socket):
    deaf = open_socket()
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    flood = frame(bytes.fromhex("0300c8007c")) * 1_000_000
    with pytest.raises((ConnectionResetError, BrokenPipeError)):
        deaf.sendall(flood)
    assert alive(open_socket)
    assert len(bench.server.connections) == 1


def test_a_flood_leaves_the_others_their_turn(open_socket):
    flood = open_socket()
    flood.sendall(frame(bytes.fromhex("0300280001")) * 20_000)
    before = time.monotonic()
    assert alive(open_socket)
    assert time.monotonic() - before < 0.5


def test_many_idle_clients_do_not_keep_out_the_rest(bench, open_socket):
    idle = [open_socket() for _ in range(80)]
    assert soon(lambda: len(bench.server.connections) == 64)
    for each in idle[:5]:
        each.close()
    assert alive(open_socket)


def test_one_master_owns_the_outputs_and_others_read(bench):
    owner, other = Master(bench, token=11), Master(bench)
    assert (owner.get("owner"), other.get("owner")) == (2, 1)
    assert other.set("claim", 12).isError()
    assert other.set("command", 1).isError()
    assert other.set("output", 100).isError()
    assert other.exchange(1, [100]).isError()
    assert not owner.set("command", 1).isError()
    assert not owner.set("output", 100).isError()
    assert other.get("applied_output") == 100
    assert other.exchange(0, [])["reply_samples"][:1] == [100]
    again = Master(bench, token=11)  # the owner over a second connection
    assert not again.set("output", 0).isError()
    assert not again.set("command", 2).isError()
    assert not again.set("claim", 0).isError()
    assert not other.set("claim", 12).isError()


def test_outputs_are_not_given_up_while_driven(bench):
    owner = Master(bench, token=11)
    owner.set("command", 1)
    owner.set("output", 100)
    assert owner.set("claim", 0).isError()
    assert bench.device.owner == 11


def test_a_repeated_block_is_played_once(bench):
    owner = Master(bench, token=1)
    owner.set("command", 1)
    for _ in range(3):
        assert owner.exchange(1, [10, 20, 30])["reply_sequence"] == [0, 1]
    owner.exchange(2, [40])
    owner.exchange(0, [])
    assert bench.plant.applied == [10, 20, 30, 40]


def test_an_index_names_the_same_samples_each_time(bench):
    owner = Master(bench, token=1)
    owner.set("command", 1)
    owner.exchange(1, list(range(1, 51)))
    first, second = (owner.exchange(0, [], index=7) for _ in range(2))
    assert first == second
    assert first["reply_index"] == [0, 7]
    assert first["reply_samples"][0:86:2] == bench.plant.applied[7:]
    assert first["reply_samples"][1:86:2] == bench.plant.displacement[7:]


def test_a_reply_that_is_read_from_before_its_first_register_is_the_same(bench):
    owner = Master(bench, token=1)
    owner.set("command", 1)
    owner.exchange(1, list(range(1, 51)))
    whole = [word for words in owner.exchange(0, []).values() for word in words]
    read = owner.client.read_holding_registers(195, count=100).registers
    assert read == [0] * 5 + whole[:95]


def test_a_damaged_block_is_not_played(bench):
    owner = Master(bench, token=1)
    owner.set("command", 1)
    assert owner.exchange(1, [10], spoil=0x100)["reply_sequence"] == [0, 0]
    assert bench.plant.applied == []
    assert owner.get("refused_blocks") == 1


def test_a_block_too_long_for_the_fifo_is_left_to_the_host(bench):
    owner = Master(bench, token=1)
    for number in range(1, 10):  # the device is idle, so that nothing leaves the FIFO
        assert owner.exchange(number, [1] * 55)["reply_sequence"] == [0, number]
    assert owner.exchange(10, [1] * 55)["reply_sequence"] == [0, 9]
    assert owner.get("fifo_level") == 9 * 55


def test_the_bench_clamps_whatever_the_host_asks(bench):
    owner = Master(bench, token=1)
    owner.set("command", 1)
    owner.exchange(1, [65535, 100])
    owner.set("output", 65535)
    assert max(bench.plant.applied) == bench.player.limits.high < 65535
    assert owner.get("clamped") == 2


@pytest.mark.parametrize("virtual_clock", [True, False])
def test_the_watchdog_ends_a_silent_master(serve_bench, virtual_clock):
    bench = serve_bench(virtual_clock=virtual_clock, watchdog_time=0.3)
    owner, other = Master(bench, token=1), Master(bench)
    owner.set("command", 1)
    owner.exchange(1, [3000] * 55)
    owner.exchange(2, [3000] * 55)
    spoken, limit = time.monotonic(), 0.3
    while other.get("watchdog_trips") == 0:
        assert time.monotonic() - spoken < limit + 1.0
        time.sleep(0.01)
    assert other.get("applied_output") == 0
    assert other.get("state") == 3
    assert other.get("watchdog_latched") == 1
    assert other.get("trip_reason") == 1
    assert other.get("fifo_level") == 0
    newcomer = Master(bench, token=2)  # the silent one has lost the outputs
    assert newcomer.set("command", 1).isError()
    assert not newcomer.set("command", 3).isError()
    assert not newcomer.set("command", 1).isError()


def test_a_master_that_only_reads_does_not_feed_the_watchdog(serve_bench):
    bench = serve_bench(virtual_clock=True, watchdog_time=0.2)
    owner, other = Master(bench, token=1), Master(bench)
    owner.set("command", 1)
    owner.set("output", 3000)
    until = time.monotonic() + 0.6
    while time.monotonic() < until:
        other.get("state")
        time.sleep(0.02)
    assert bench.player.applied == 0
    assert bench.player.watchdog.trips == 1


def test_random_frames_neither_crash_nor_wedge_it(bench, open_socket):
    random = np.random.default_rng(4)
    for _ in range(300):
        connection = open_socket()
        for _ in range(10):
            pdu = random.bytes(int(random.integers(1, 250)))
            if random.random() < 0.7:
                pdu = bytes([random.choice([3, 4, 6, 16, 23])]) + pdu[1:]
            connection.sendall(frame(pdu))
        connection.close()
    assert alive(open_socket)
    assert not any(bench.plant.applied)


def test_an_exception_to_function_code_23_says_that_nothing_was_written(bench):
    master = Master(bench, token=7)
    master.set("command", 1)
    master.set("output", 5000)
    before = master.get("sample_index")
    reply = master.client.readwrite_registers(
        read_address=60_000, read_count=1, write_address=master.device["output"].address,
        values=[6000],
    )  # fmt: skip
    assert reply.exception_code == 2
    assert master.get("applied_output") == 5000
    assert master.get("sample_index") == before


def test_a_polled_master_misses_nothing_that_it_has_read(bench):
    master = Master(bench, token=7)
    master.set("command", 1)
    for count in range(1000, 1000 + 40 * 250, 40):
        master.set("output", min(count, 9000))
    assert master.get("overruns") == 0
