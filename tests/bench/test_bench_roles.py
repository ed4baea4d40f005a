"""Who may do what: roles in certificates, silent masters, requests split over TLS records."""

import random
import socket
import ssl
import struct
import time
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
import pytest

import dea.bench.server
from certificates import certificate, utf8
from dea.acquisition import AcquisitionSettings, acquire
from dea.bench.connection import MAX_CONNECTIONS
from dea.modbus import Tls, encode, read_device
from served_bench import DESCRIPTION

READ_IDENTITY = struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 0, 8)
VOLTS = np.full(60, 2.0)
FAST = AcquisitionSettings(ramp_rate=20.0, timeout=1.0, reconnect_time=1.0)


@pytest.fixture
def secured(serve_bench, tmp_path):
    """Serve a bench that asks for certificates; return it and a function that connects a master."""
    device = certificate(tmp_path, "device")
    masters = {
        name: certificate(tmp_path, name, role=role)
        for name, role in {
            "operator": utf8("operator"),
            "reader": utf8("reader"),
            "nobody": None,
            "malformed": b"operator",
        }.items()
    }
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.load_cert_chain(*device)
    for file, _ in masters.values():
        context.load_verify_locations(file)
    context.verify_mode = ssl.CERT_REQUIRED
    description = replace(read_device(DESCRIPTION), framing="tls")
    bench = serve_bench(description=description, tls=context)

    def master(name):
        client = ssl.create_default_context(cafile=str(device[0]))
        client.load_cert_chain(*masters[name])
        plain = socket.create_connection(("127.0.0.1", bench.endpoint.port), timeout=5)
        return client.wrap_socket(plain, server_hostname="127.0.0.1")

    files = {name: Tls(str(device[0]), None, *map(str, pair)) for name, pair in masters.items()}
    return bench, master, files


def ask(link, pdu):
    """Send a request and return the PDU of its reply."""
    link.sendall(struct.pack(">HHHB", 7, 0, len(pdu) + 1, 1) + pdu)
    length = struct.unpack(">HHHB", read(link, 7))[2]
    return read(link, length - 1)


def read(link, count):
    data = b""
    while len(data) < count:
        data += link.recv(count - len(data))
    return data


def written(bench, name, value):
    register = bench.description[name]
    words = encode(register, value)
    return struct.pack(">BHHB", 16, register.address, len(words), 2 * len(words)) + struct.pack(
        f">{len(words)}H", *words
    )


def test_an_operator_drives_and_records(secured, tmp_path):
    bench, _, files = secured
    device = replace(bench.endpoint, tls=files["operator"])
    record = acquire(device, VOLTS, tmp_path / "a.partial", FAST).record
    assert np.array_equal(record.voltage_counts, bench.applied[record.device_index.values])


@pytest.mark.parametrize("name", ["reader", "nobody", "malformed"])
def test_who_is_no_operator_reads_and_writes_nothing(secured, name):
    bench, master, _ = secured
    with master(name) as link:
        assert ask(link, READ_IDENTITY[7:])[:1] == b"\x03"
        assert ask(link, written(bench, "claim", 7)) == b"\x90\x01"
    with master("operator") as link:
        assert ask(link, written(bench, "claim", 7))[0] == 16


def test_whatever_a_reader_sends_the_output_stays_at_zero(secured):
    bench, master, _ = secured
    rng = random.Random(20170601)
    description = bench.description
    writable = [r for r in description.registers.values() if r.access != "read" and r.size <= 4]
    for _ in range(8):
        with master("reader") as link:
            for _ in range(60):
                register = rng.choice(writable)
                address, size = register.address, register.size
                words = rng.choice([rng.randbytes(2 * size), struct.pack(">H", 1) * size])
                code = rng.choice([6, 16, 23, rng.randrange(128)])
                pdu = {
                    6: struct.pack(">BH", 6, address) + words[:2],
                    16: struct.pack(">BHHB", 16, address, size, len(words)) + words,
                    23: struct.pack(
                        ">BHHHHB", 23, 0, 4, register.address, register.size, len(words)
                    )
                    + words,
                }.get(code, bytes([code]) + rng.randbytes(rng.randrange(1, 40)))
                answered = ask(link, pdu)
                assert answered[0] & 0x80 or answered[0] in (3, 4)
    assert bench.device.owner == 0
    assert not bench.applied.any()


def test_a_request_split_over_records_is_answered(secured):
    _, master, _ = secured
    with master("reader") as link:
        for place in (1, 6, 7, 8, 11):
            for part in (READ_IDENTITY[:place], READ_IDENTITY[place:]):
                link.sendall(part)
                time.sleep(0.02)
            assert len(read(link, 9 + 16)) == 25
        link.sendall(READ_IDENTITY * 3)  # and three in one record
        assert len(read(link, 3 * 25)) == 75


def test_silent_connections_lock_nobody_out(serve_bench, tmp_path):
    bench = serve_bench()
    with ExitStack() as stack:
        for _ in range(MAX_CONNECTIONS):
            link = socket.create_connection(("127.0.0.1", bench.endpoint.port), timeout=5)
            stack.enter_context(link)
        record = acquire(bench.endpoint, VOLTS, tmp_path / "a.partial", FAST).record
    assert record.sizes["time"] == VOLTS.size


def test_the_owner_keeps_its_place_however_long_it_is_silent(serve_bench):
    bench = serve_bench(watchdog_time=30.0)
    address = ("127.0.0.1", bench.endpoint.port)
    with ExitStack() as stack:
        owner = stack.enter_context(socket.create_connection(address, timeout=5))
        assert ask(owner, written(bench, "claim", 7))[0] == 16
        for _ in range(MAX_CONNECTIONS + 5):
            other = stack.enter_context(socket.create_connection(address, timeout=5))
            assert ask(other, READ_IDENTITY[7:])[:1] == b"\x03"
        assert ask(owner, READ_IDENTITY[7:])[:1] == b"\x03"
        assert len(bench.server.connections) <= MAX_CONNECTIONS


def test_an_owner_that_reconnects_over_lost_connections_is_let_in(serve_bench, monkeypatch):
    monkeypatch.setattr(dea.bench.connection, "MAX_CONNECTIONS", 4)
    bench = serve_bench(watchdog_time=30.0)
    address = ("127.0.0.1", bench.endpoint.port)
    with ExitStack() as stack:
        for _ in range(6):
            link = stack.enter_context(socket.create_connection(address, timeout=5))
            assert ask(link, written(bench, "claim", 7))[0] == 16
        assert len(bench.server.connections) == 4


def test_a_master_that_is_silent_for_long_is_dropped(serve_bench, monkeypatch):
    monkeypatch.setattr(dea.bench.server, "MAX_SILENCE", 0.2)
    bench = serve_bench()
    with socket.create_connection(("127.0.0.1", bench.endpoint.port), timeout=5) as link:
        assert ask(link, READ_IDENTITY[7:])[:1] == b"\x03"
        assert link.recv(1) == b""
