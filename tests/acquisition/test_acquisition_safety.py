"""Before any voltage, and on every way out."""

import os
import signal
import socket
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from pymodbus.client import ModbusTcpClient

from dea.acquisition import (
    AcquisitionSettings,
    BrokenRecordError,
    Interrupted,
    ZeroNotVerifiedError,
    acquire,
    by_hand,
)
from dea.acquisition.interrupts import Interruption
from dea.acquisition.partial import PartialFile, recover
from dea.acquisition.reported import reported
from dea.errors import InputError
from dea.modbus import encode

FAST = AcquisitionSettings(ramp_rate=20.0, timeout=0.3, retries=2, reconnect_time=0.5)
VOLTS = 2.4 + 1.2 * np.sin(np.arange(700) * 0.1)


def started(bench):
    """Whether any voltage was ever applied."""
    return bool(np.any(bench.applied))


@pytest.fixture
def partial(tmp_path):
    return tmp_path / "record.partial"


@pytest.mark.parametrize("volts", [[1.0, 3.9], [-0.1], [np.nan], [np.inf], [100.0], []])
def test_an_excitation_outside_the_limits_is_never_begun(serve_bench, partial, volts):
    bench = serve_bench()
    with pytest.raises(InputError) as caught:
        acquire(bench.endpoint, np.array(volts), partial, FAST)
    assert caught.value.remedy
    assert not started(bench)
    assert not partial.exists()


@pytest.mark.parametrize("volts", [3.9, 100.0])  # beyond the limits, and beyond the converter
def test_the_voltage_the_range_and_where_it_is_given_are_told(serve_bench, partial, volts):
    with pytest.raises(InputError, match=f"sample 1 .* {volts:g} V, outside 0 to 3.76 V") as caught:
        acquire(serve_bench().endpoint, np.array([1.0, volts]), partial, FAST)
    assert caught.value.field == "registers.output.limits"


@pytest.mark.parametrize("mode", ["buffered", "polled"])
def test_an_endpoint_that_does_not_answer(serve_bench, partial, mode):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    device = replace(serve_bench().endpoint, port=port)
    with pytest.raises(InputError, match=f"127.0.0.1:{port} does not answer") as caught:
        acquire(device, VOLTS, partial, replace(FAST, mode=mode))
    assert caught.value.field == "endpoint"
    assert not partial.exists()


def changed(device, name, **changes):
    return replace(
        device, registers=device.registers | {name: replace(device[name], **changes)}
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("identity", {"expect": "other"}, "registers.identity"),
        ("version", {"address": 34}, "registers.version"),
        ("device_rate", {"expect": 100.0}, "registers.device_rate"),
        ("device_rate", {"word_order": "little"}, "registers.device_rate"),
        ("output", {"range": (0.0, 10.0)}, "registers.output_range_high"),
        ("displacement", {"range": (0.0, 5.0)}, "registers.displacement_range_high"),
        ("output", {"limits": (0.0, 4.5)}, "clamps at 3.76 V"),
    ],
)
def test_a_register_map_that_does_not_match(serve_bench, partial, name, changes, message):
    bench = serve_bench()
    with pytest.raises(InputError, match=message) as caught:
        acquire(changed(bench.endpoint, name, **changes), VOLTS, partial, FAST)
    assert caught.value.file == bench.endpoint.source
    assert caught.value.remedy
    assert not started(bench)
    assert not partial.exists()


def test_a_sampling_rate_that_is_not_the_devices(serve_bench, partial):
    bench = serve_bench()
    with pytest.raises(InputError, match=r"registers\.device_rate"):
        acquire(replace(bench.endpoint, sampling_rate=100.0), VOLTS, partial, FAST)
    assert not started(bench)


def test_a_wrong_unit_id(serve_bench, partial):
    bench = serve_bench()
    with pytest.raises(InputError, match="unit_id"):
        acquire(replace(bench.endpoint, unit_id=9), VOLTS, partial, FAST)
    assert not started(bench)


class Master:
    """Somebody else at the bench."""

    def __init__(self, bench):
        self.device = bench.endpoint
        self.client = ModbusTcpClient("127.0.0.1", port=self.device.port, timeout=1, retries=0)
        self.client.connect()

    def set(self, name, value):
        register = self.device[name]
        self.client.write_registers(register.address, encode(register, value))

    def get(self, name):
        return self.client.read_holding_registers(self.device[name].address).registers[0]


def test_a_start_is_refused_while_another_owns_the_outputs(serve_bench, partial):
    bench = serve_bench()
    Master(bench).set("claim", 5)
    with pytest.raises(InputError, match="another master owns"):
        acquire(bench.endpoint, VOLTS, partial, FAST)
    assert not started(bench)


def drive(bench):
    """Have another master put a voltage on the output."""
    master = Master(bench)
    for name, value in (("claim", 5), ("command", 1), ("output", 5000)):
        master.set(name, value)


@pytest.fixture
def tripped(serve_bench):
    """A bench whose watchdog has tripped: another master fell silent while driving."""
    bench = serve_bench(watchdog_time=0.1)
    drive(bench)
    time.sleep(0.3)
    bench.player.watchdog.timeout = 5.0
    return bench


def test_a_start_is_refused_while_the_output_is_driven(serve_bench, partial):
    bench = serve_bench()
    drive(bench)
    with pytest.raises(InputError, match=r"the output is not zero: 1\.14"):
        acquire(bench.endpoint, VOLTS, partial, FAST)


def test_a_start_is_refused_after_a_trip_until_it_is_reset(tripped, partial):
    with pytest.raises(InputError, match="watchdog has latched"):
        acquire(tripped.endpoint, VOLTS, partial, FAST)
    result = acquire(tripped.endpoint, VOLTS, partial, FAST, reset=True)
    assert result.record.sizes["time"] == VOLTS.size


def test_taking_an_output_to_zero_by_hand_leaves_a_trip_to_be_found(tripped):
    by_hand.zero(tripped.endpoint, FAST)
    assert tripped.player.applied == 0
    assert tripped.player.watchdog.latched


class OnceDrivenError(Exception):
    """Raised by a watcher in mid-drive."""


def when_driven(bench, action):
    """A watcher that acts once the output is well away from zero."""
    done = []

    def watch(samples, _):
        if not done and samples.applied.max() > 5000:
            done.append(True)
            action()

    return watch


@pytest.mark.parametrize("mode", ["buffered", "polled"])
def test_an_exception_ends_at_zero(serve_bench, partial, mode):
    bench = serve_bench()

    def fail():
        raise OnceDrivenError

    settings = replace(FAST, mode=mode, paced=False)
    with pytest.raises(OnceDrivenError):
        acquire(bench.endpoint, VOLTS, partial, settings, watch=when_driven(bench, fail))
    assert bench.applied.max() > 5000
    assert bench.player.applied == 0
    assert bench.device.owner == 0
    assert partial.exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_at_zero(serve_bench, partial, number):
    bench = serve_bench()
    # Where these tests run with nohup, SIGHUP would stay ignored.
    handler = signal.signal(number, signal.default_int_handler)
    before = signal.getsignal(number)
    kill = when_driven(bench, lambda: os.kill(os.getpid(), number))
    with pytest.raises(Interrupted, match=number.name) as caught:
        acquire(bench.endpoint, VOLTS, partial, FAST, watch=kill)
    assert f"in {partial}: recover it" in caught.value.__notes__[-1]
    assert bench.applied.max() > 5000
    assert bench.player.applied == 0
    assert signal.getsignal(number) == before
    signal.signal(number, handler)


def test_a_signal_after_the_last_sample_says_where_the_record_is(serve_bench, partial, monkeypatch):
    close = PartialFile.close

    def closed(file):
        close(file)
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(PartialFile, "close", closed)
    with pytest.raises(Interrupted) as caught:
        acquire(serve_bench().endpoint, VOLTS, partial, FAST)
    assert f"in {partial}: recover it" in caught.value.__notes__[-1]
    assert recover(partial).samples.position.size > VOLTS.size


def test_a_refusal_says_nothing_of_samples(serve_bench, partial):
    bench = serve_bench()
    partial.write_bytes(b"of an earlier run")
    with pytest.raises(InputError) as caught:
        acquire(replace(bench.endpoint, unit_id=9), VOLTS, partial, FAST)
    assert not hasattr(caught.value, "__notes__")


def test_what_a_signal_has_cost_is_said_in_the_same_line(capsys):
    signalled = Interrupted("SIGINT")
    signalled.add_note("The film is at rest.")
    signalled.add_note("Every sample is in a.partial: recover it.")
    with pytest.raises(SystemExit), reported():
        raise signalled
    assert capsys.readouterr().err == (
        "ended by SIGINT; the output is at zero. The film is at rest. "
        "Every sample is in a.partial: recover it.\n"
    )


def test_a_program_that_was_started_with_nohup_outlives_its_terminal():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Interruption() as interruption:
            os.kill(os.getpid(), signal.SIGHUP)
            interruption.check()
            assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
            assert signal.getsignal(signal.SIGTERM) != signal.SIG_DFL
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_second_signal_does_not_stop_the_way_to_zero(serve_bench, partial):
    bench = serve_bench(virtual_clock=False)  # where the ramp takes its time

    def twice():
        threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGTERM)).start()
        os.kill(os.getpid(), signal.SIGINT)

    settings = replace(FAST, timeout=2.0)
    with pytest.raises(Interrupted, match="SIGINT"):
        acquire(bench.endpoint, VOLTS, partial, settings, watch=when_driven(bench, twice))
    assert bench.player.applied == 0
    assert bench.device.owner == 0


def test_a_lost_connection_is_taken_up_again_to_reach_zero(serve_bench, partial):
    bench = serve_bench()

    def cut():
        bench._loop.call_soon_threadsafe(
            lambda: [c.transport.abort() for c in list(bench.server.connections)]
        )
        time.sleep(0.05)
        raise OnceDrivenError

    with pytest.raises(OnceDrivenError):
        acquire(bench.endpoint, VOLTS, partial, FAST, watch=when_driven(bench, cut))
    assert bench.player.applied == 0


def test_a_device_that_is_gone_is_said_to_be_left_to_its_watchdog(serve_bench, partial):
    bench = serve_bench()
    with pytest.raises(ZeroNotVerifiedError, match="watchdog"):
        acquire(bench.endpoint, VOLTS, partial, FAST, watch=when_driven(bench, bench.stop))


def at_wall_time(serve_bench):
    """A bench that has not played everything long before a watcher acts."""
    return serve_bench(virtual_clock=False, sampling_rate=200.0)


def trip(bench):
    """Have the device's watchdog find its owner silent."""
    bench._loop.call_soon_threadsafe(bench.player.watch, time.monotonic() + 1000.0)


@pytest.mark.parametrize("on_break", ["stop", "restart"])
def test_a_trip_breaks_the_record_and_no_restart_clears_the_latch(serve_bench, partial, on_break):
    bench = at_wall_time(serve_bench)
    tripping = when_driven(bench, lambda: trip(bench))
    settings = replace(FAST, on_break=on_break)
    with pytest.raises(BrokenRecordError, match="undriven, the device took its output to zero"):
        acquire(bench.endpoint, VOLTS, partial, settings, watch=tripping)
    assert bench.player.applied == 0
    assert bench.player.watchdog.trips == 1
    assert bench.player.watchdog.latched


def test_a_broken_record_is_begun_again_where_the_settings_say_so(serve_bench, partial):
    bench = at_wall_time(serve_bench)
    settings = replace(FAST, on_break="restart", reconnect_time=5.0)
    restart = when_driven(bench, bench.restart)
    result = acquire(bench.endpoint, VOLTS, partial, settings, watch=restart)
    index = result.record.device_index.values
    assert result.record.sizes["time"] == VOLTS.size
    assert np.array_equal(result.record.displacement_counts, bench.boots()[-1][1][index])
    assert partial.with_name("record.1.partial").exists()
    assert int(result.link.errors.sel(kind=result.link.error_kind == "restarted").sum()) == 1
