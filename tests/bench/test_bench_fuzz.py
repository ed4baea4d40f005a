"""Whatever arrives, the bench goes on serving: no crash, no wedge, no unhandled exception."""

import json
import random
import socket
import struct
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pyModbusTCP.utils import crc16

from dea.acquisition import AcquisitionSettings, acquire
from dea.modbus import read_device
from modbus_frames import frame

pytestmark = pytest.mark.faults

ROOT = Path(__file__).parents[2]
DESCRIPTION = ROOT / "config/devices/virtual_bench.yaml"
BATCH = 40  # frames at most on one connection
LARGEST = 253  # bytes of a PDU
KNOWN = (3, 4, 6, 16, 23)
READ_IDENTITY = struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 0, 8)


@pytest.fixture
def bench():
    """The bench in a process of its own: the process and its port."""
    command = [
        sys.executable, "-m", "dea.bench", "--actuator", "dea1", "--port", "0",
        "--clock", "virtual", "--until-stdin-closes",
    ]  # fmt: skip
    with subprocess.Popen(
        command, cwd=ROOT, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as process:  # fmt: skip
        yield process, json.loads(process.stdout.readline())["port"]
        if process.poll() is None:
            process.terminate()


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=5)


def request(rng):
    """A request of a known function with numbers that may be anything."""
    address, count = (
        rng.choice([rng.randrange(0x10000), rng.randrange(330)]),
        rng.randrange(0x10000),
    )
    few = rng.choice([0, 1, 2, 62, rng.randrange(126)])
    words = rng.randbytes(2 * few)
    match rng.choice(KNOWN):
        case 3 | 4 as code:
            return struct.pack(">BHH", code, address, rng.choice([count, few]))
        case 6:
            return struct.pack(">BHH", 6, address, count)
        case 16:
            said = rng.choice([count, few])
            return (
                struct.pack(">BHHB", 16, address, said, rng.choice([2 * few, 255]) & 0xFF) + words
            )
        case _:
            said, size = rng.choice([count, few]), rng.choice([2 * few, rng.randrange(256)])
            wanted = rng.choice([124, count])
            return struct.pack(">BHHHHB", 23, 200, wanted, address, said, size) + words


def answerable(rng):
    """A whole frame whose content may be nonsense; the bench owes it one reply."""
    pdu = request(rng)[:LARGEST]
    match rng.randrange(8):
        case 0:
            return frame(pdu, unit=rng.randrange(256))
        case 1:
            return frame(bytes([rng.randrange(256)]) + pdu[1:])
        case 2:
            return frame((pdu + rng.randbytes(rng.randrange(260)))[:LARGEST])
        case 3:  # claim the outputs
            return frame(struct.pack(">BHHBI", 16, 71, 2, 4, rng.randrange(1, 2**32)))
        case 4:  # start, stop, reset, clear, or no command
            return frame(struct.pack(">BHH", 6, 70, rng.randrange(6)))
        case _:
            return frame(pdu, transaction=rng.randrange(0x10000))


def hopeless(rng):
    """Bytes after which nothing on the connection can be a frame."""
    whole = frame(request(rng))
    return rng.choice(
        [
            rng.randbytes(rng.randrange(1, 300)),
            frame(request(rng), protocol=rng.randrange(1, 0x10000)),
            frame(request(rng), length=rng.choice([0, 1, 255, 0xFFFF])),
            whole[: rng.randrange(len(whole))],
        ]
    )


def flood(port, rng, most):
    """Send up to ``most`` frames over one connection and return their number.

    The bench owes a reply to each; the flood waits for them, or leaves, or ends in what is none.
    """
    frames = [answerable(rng) for _ in range(rng.randint(1, most))]
    data = b"".join(frames)
    with connect(port) as connection:
        manner = rng.choice(["listens", "listens in single bytes", "leaves", "hopeless"])
        if manner == "listens in single bytes":
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            for byte in data[:200]:
                connection.send(bytes([byte]))
            data = data[200:]
        if manner == "hopeless":
            data += hopeless(rng)
        connection.sendall(data)
        if manner.startswith("listens"):
            for _ in frames:
                header = receive(connection, 6)
                receive(connection, int.from_bytes(header[4:], "big"))
    return len(frames)


def receive(connection, size):
    data = b""
    while len(data) < size:
        more = connection.recv(size - len(data))
        assert more, "the bench has hung up on whole frames"
        data += more
    return data


def assert_answers(connection):
    connection.sendall(READ_IDENTITY)
    assert receive(connection, 25)[9:18] == b"dea-bench"


def test_malformed_frames_neither_crash_nor_wedge_the_bench(bench, request, tmp_path):
    process, port = bench
    count, rng = request.config.getoption("--fuzz-frames"), random.Random(5)
    silent = [connect(port) for _ in range(20)]
    for number, connection in enumerate(silent):  # slow clients, in the midst of a frame
        connection.sendall(READ_IDENTITY[: number % 12])
    with connect(port) as patient:
        while count > 0:
            count -= flood(port, rng, most=BATCH)
            assert_answers(patient)
    with connect(port) as fresh:
        assert_answers(fresh)
    for number, connection in enumerate(silent):
        connection.sendall(READ_IDENTITY[number % 12 :])
        assert b"dea-bench" in receive(connection, 25)
        connection.close()
    assert_drives(port, tmp_path)
    process.terminate()
    assert process.wait(10) == 0
    assert process.stderr.read() == ""


def rtu_frame(pdu, unit=1):
    data = bytes([unit]) + pdu
    return data + crc16(data).to_bytes(2, "little")


def rtu_nonsense(rng):
    """Bytes that may be a frame of RTU, or wrong in content, unit, checksum, or altogether."""
    pdu = request(rng)[:LARGEST]
    return rng.choice(
        [
            rtu_frame(pdu),
            rtu_frame(pdu, unit=rng.randrange(256)),
            rtu_frame(bytes([rng.randrange(256)]) + pdu[1:]),
            rtu_frame(pdu)[:-1],
            rng.randbytes(rng.randrange(1, 300)),
        ]
    )


def test_malformed_rtu_frames_neither_crash_nor_wedge_the_bench(serve_bench, request, caplog):
    rtu = replace(read_device(DESCRIPTION), framing="rtu_over_tcp")
    port, rng = serve_bench(description=rtu).endpoint.port, random.Random(6)
    read_identity = rtu_frame(READ_IDENTITY[7:])
    with connect(port) as patient:
        for _ in range(request.config.getoption("--fuzz-frames") // 50):
            with connect(port) as connection, suppress(ConnectionError):
                for _ in range(rng.randrange(10)):
                    connection.sendall(rtu_nonsense(rng))
            patient.sendall(read_identity)
            assert receive(patient, 21)[3:12] == b"dea-bench"
    assert not [record for record in caplog.records if record.name == "asyncio"]


def assert_drives(port, folder):
    """Acquire a record, once the watchdog has ended whatever the flood has begun."""
    time.sleep(1.5)
    device = replace(read_device(DESCRIPTION), port=port)
    volts = np.linspace(1.1, 3.7, 200)
    settings = AcquisitionSettings(ramp_rate=20.0)
    record = acquire(device, volts, folder / "r.partial", settings, reset=True).record
    assert not record.quality.any()
    assert np.array_equal(record.voltage_counts, np.rint(volts / 15 * 65535))
