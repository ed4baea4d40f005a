"""The same acquisition over every framing, and certificates that do not match."""

import os
import pty
import select
import socket
import ssl
import threading
import time
import tty
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from certificates import certificate
from dea.acquisition import AcquisitionSettings, Link, LinkError, LinkSettings, acquire
from dea.errors import InputError
from dea.modbus import Serial, Tls, read_device
from served_bench import DESCRIPTION

FAST = AcquisitionSettings(ramp_rate=20.0, timeout=0.5, reconnect_time=1.0)
VOLTS = 2.4 + 1.2 * np.sin(np.arange(300) * 0.1)


@pytest.fixture
def tls_bench(serve_bench, tmp_path):
    def serve(address="127.0.0.1"):
        file, key = certificate(tmp_path, "device", address)
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        context.load_cert_chain(file, key)
        description = replace(read_device(DESCRIPTION), framing="tls")
        return serve_bench(description=description, tls=context), file

    return serve


def check(bench, device, folder):
    record = acquire(device, VOLTS, folder / "a.partial", FAST).record
    index = record.device_index.values
    assert index.size == VOLTS.size
    assert np.array_equal(record.displacement_counts, bench.displacement[index])
    assert np.array_equal(record.voltage_counts, bench.applied[index])
    assert bench.player.applied == 0


def test_over_tls(tls_bench, tmp_path):
    bench, file = tls_bench()
    check(bench, replace(bench.endpoint, tls=Tls(ca_file=str(file))), tmp_path)


def test_rtu_over_tcp(serve_bench, tmp_path):
    bench = serve_bench(description=replace(read_device(DESCRIPTION), framing="rtu_over_tcp"))
    check(bench, bench.endpoint, tmp_path)


@contextmanager
def terminal():
    """The handle of a pseudo-terminal, and the name of its other end, which passes bytes as is."""
    master, slave = pty.openpty()
    tty.setraw(slave)
    try:
        yield master, os.ttyname(slave)
    finally:
        os.close(master)
        os.close(slave)


@contextmanager
def serial_line(port):
    """The name of a pseudo-terminal whose other end talks to a TCP port."""
    ended = threading.Event()

    def pass_on():
        while not ended.is_set():
            ready, _, _ = select.select([master, plain], [], [], 0.05)
            if master in ready:
                plain.sendall(os.read(master, 512))
            if plain in ready:
                os.write(master, plain.recv(512))

    with terminal() as (master, name), socket.create_connection(("127.0.0.1", port)) as plain:
        thread = threading.Thread(target=pass_on)
        thread.start()
        try:
            yield name
        finally:
            ended.set()
            thread.join()


def test_over_a_serial_line(serve_bench, tmp_path):
    bench = serve_bench(description=replace(read_device(DESCRIPTION), framing="rtu_over_tcp"))
    with serial_line(bench.endpoint.port) as name:
        line = Serial(name, baudrate=115200, parity="N")
        check(bench, replace(bench.endpoint, framing="serial", serial=line), tmp_path)


@pytest.mark.parametrize("step", [-20.0, 3600.0])
def test_no_step_of_the_clock_changes_the_timeout_of_a_serial_line(serve_bench, monkeypatch, step):
    with terminal() as (_, name):
        line = Serial(name, parity="N")
        device = replace(serve_bench().endpoint, framing="serial", serial=line)
        link = Link(device, LinkSettings(timeout=0.5, retries=0, reconnect_time=0.0))
        link.open()
        now = time.time
        looks = iter([0.0])  # the clock is set after the first look
        monkeypatch.setattr(time, "time", lambda: now() + next(looks, step))
        begun = time.monotonic()
        with pytest.raises(LinkError, match="no valid reply"):
            link.read(0, 1)
        assert 0.5 <= time.monotonic() - begun < 5.0
        link.close()


def test_a_serial_line_that_does_not_exist(serve_bench, tmp_path):
    line = Serial(str(tmp_path / "ttyS9"))
    device = replace(serve_bench().endpoint, framing="serial", serial=line)
    with pytest.raises(InputError, match="ttyS9 does not answer: there is no such port") as caught:
        acquire(device, VOLTS, tmp_path / "a.partial", FAST)
    assert caught.value.field == "serial.port"
    assert "host" not in str(caught.value)


@pytest.mark.parametrize("case", ["unknown authority", "other address", "other name"])
def test_a_certificate_that_does_not_match(tls_bench, tmp_path, case):
    bench, file = tls_bench("127.0.0.9" if case == "other address" else "127.0.0.1")
    if case == "unknown authority":
        file, _ = certificate(tmp_path, "other")
    tls = Tls(ca_file=str(file), server_name="laser" if case == "other name" else None)
    with pytest.raises(
        InputError, match=r"certificate of virtual bench .* does not match"
    ) as caught:
        acquire(replace(bench.endpoint, tls=tls), VOLTS, tmp_path / "a.partial", FAST)
    assert caught.value.field == "tls"
    assert caught.value.file == DESCRIPTION
    assert not bench.applied.size


def test_a_certificate_file_that_is_missing(tls_bench, tmp_path):
    bench, _ = tls_bench()
    device = replace(bench.endpoint, tls=Tls(ca_file=str(tmp_path / "missing.pem")))
    with pytest.raises(InputError, match="certificate file cannot be read"):
        acquire(device, VOLTS, tmp_path / "a.partial", FAST)


def test_a_plain_client_does_not_get_through_tls(tls_bench, tmp_path):
    bench, _ = tls_bench()
    with pytest.raises(InputError, match="does not answer"):
        acquire(replace(bench.endpoint, framing="tcp"), VOLTS, tmp_path / "a.partial", FAST)
    assert not bench.applied.size
