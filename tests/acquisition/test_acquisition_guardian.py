"""What the guardian does when the recorder, the disk, the network or the module fails."""

import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from plain_module import guardian_of

from dea.acquisition import (
    AcquisitionSettings,
    BrokenRecordError,
    Quality,
    ReadBackError,
    StoppedError,
    ZeroNotVerifiedError,
    acquire,
    duty,
)
from dea.errors import InputError

ROOT = Path(__file__).parents[2]
RATE = 20.0  # V/s
SETTINGS = AcquisitionSettings(
    mode="polled", ramp_rate=RATE, timeout=0.3, retries=0, reconnect_time=3.0, stall_time=0.6
)
VOLTS = np.full(75, 3.0)
STEP = RATE / 50  # V
READ_INPUT = 4  # Modbus function code


def once_driven(module, action):
    """A watcher that acts once at three volts."""
    done = []

    def watch(samples, _):
        if not done and module.volts > 2.9:
            done.append(True)
            action()

    return watch


def drive(module, partial, action=lambda: None, **settings):
    settings = replace(SETTINGS, **settings)
    watch = once_driven(module, action)
    return acquire(module.description(), VOLTS, partial, settings, watch=watch)


def assert_at_zero_and_stays(module, seconds=1.0):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        assert module.volts == 0.0
        time.sleep(0.01)


def assert_ramped(module, but=()):
    """No step down is faster in time than the ramp, other than those from the volts ``but``."""
    times, volts = module.path()
    fallen, passed = -np.diff(volts), np.diff(times)
    free = np.isin(volts[:-1], but)
    assert (fallen[~free] <= np.maximum(RATE * passed[~free], STEP) + 0.01).all()


@pytest.fixture
def partial(tmp_path):
    return tmp_path / "record.partial"


def test_a_whole_record(module, partial):
    record = drive(module, partial).record
    driven = record.quality == Quality.GOOD  # on a busy machine a few may be late
    assert driven.sum() > 30
    assert np.allclose(record.voltage[driven], 3.0, atol=1e-3)
    assert_at_zero_and_stays(module, 0.2)
    assert_ramped(module)


def test_a_write_held_by_a_gateway_does_not_stay_on(module, partial):
    """It is carried out after the ramp to zero, during the quarantine."""

    def hold():
        module.hold_next = 0.7

    with pytest.raises(BrokenRecordError):
        drive(module, partial, hold)
    volts = module.path()[1]
    assert ((volts[1:] > 2.9) & (volts[:-1] == 0.0)).any(), "the gateway never carried it out"
    assert_at_zero_and_stays(module)


@pytest.mark.parametrize("code", [4, 5, 6, 11])
def test_exceptions_during_the_stop_are_outlasted(module, partial, code):
    def refuse():
        module.refuse_with = code
        threading.Timer(1.0, setattr, (module, "refuse_with", 0)).start()

    with pytest.raises(BrokenRecordError, match=f"exception {code}"):
        drive(module, partial, refuse)
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)


def test_a_lost_network_is_outlasted_though_the_caller_is_told_before(module, partial, capfd):
    def lose():
        module.deaf = True

    with pytest.raises(ZeroNotVerifiedError, match="no watchdog: switch the amplifier off"):
        drive(module, partial, lose, reconnect_time=0.5)
    assert module.volts > 2.9
    alarm = duty.look(duty.duty_file(module.description()))
    assert alarm.alive
    assert alarm.phase == duty.Phase.ALARM
    assert alarm.requested == pytest.approx(3.0, abs=0.01)
    module.deaf = False
    deadline = time.monotonic() + 5.0
    while module.volts:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)
    shown = capfd.readouterr().err
    assert "\aALARM: plain module: the output could not be shown to be at zero" in shown


def test_a_reading_that_is_not_answered_holds_the_output_no_longer_than_a_second(module, partial):
    """And the time to wait for a reply: no sample may be held up for longer."""
    usual = module._answer

    def mute():
        module._answer = lambda connection, frame: (
            None if frame[7] == READ_INPUT else usual(connection, frame)
        )

    with pytest.raises(BrokenRecordError, match="no valid reply"):
        drive(module, partial, mute, timeout=0.6, retries=5)
    times, volts = module.path()
    held = np.diff(times)[1:][volts[1:-1] > 2.9].max()
    assert held < 1.0 + 0.6 + 0.5
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)


@pytest.mark.parametrize("share", [0.001, 0.0], ids=["in kilovolts", "stuck at zero"])
def test_a_wrong_read_back_ends_at_zero_by_the_ramp(module, partial, share):
    module.read_back = lambda count: share * count
    with pytest.raises(ReadBackError, match=r"registers\.applied_output"):
        drive(module, partial)
    assert max(module.path()[1]) < 1.5, "noticed while the ramp is still low"
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)


def test_a_disk_that_hangs_takes_the_output_to_zero(module, partial, monkeypatch):
    released = threading.Event()
    sync = os.fdatasync

    def hang(handle):
        if module.volts > 2.9:
            released.wait(20)
        sync(handle)

    monkeypatch.setattr("dea.acquisition.partial.os.fdatasync", hang)
    threading.Timer(2.5, released.set).start()
    began = time.monotonic()
    with pytest.raises(StoppedError, match=r"the recorder is .* s behind"):
        drive(module, partial)
    assert began + 4.0 > time.monotonic()
    hung = next(now for now, volts in module.history if volts > 2.9)
    down = next(now for now, volts in module.history if now > hung and volts == 0.0)
    assert down < began + 2.3, "zero while the disk still hangs"
    assert_at_zero_and_stays(module, 0.2)


def test_a_second_acquisition_of_one_output_is_refused(module, partial, tmp_path):
    refused = []

    def again():
        try:
            acquire(module.description(), VOLTS, tmp_path / "second.partial", SETTINGS)
        except InputError as error:
            refused.append(str(error))

    drive(module, partial, again, stall_time=5.0)
    assert "is driven by another program on this computer (process" in refused[0]


def test_an_output_left_by_a_killed_guardian_is_taken_to_zero_by_another(module, partial):
    def kill():
        os.kill(guardian_of(module), signal.SIGKILL)

    with pytest.raises(Exception, match="the guardian's process was killed"):
        drive(module, partial, kill)
    assert_at_zero_and_stays(module, 0.2)
    assert_ramped(module)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGQUIT, signal.SIGINT])
def test_a_guardian_that_is_sent_a_signal_goes_to_zero(module, partial, number):
    def send():
        os.kill(guardian_of(module), number)

    with pytest.raises(StoppedError, match=f"the guardian was sent {number.name}"):
        drive(module, partial, send)
    assert_at_zero_and_stays(module, 0.2)
    assert_ramped(module)


@pytest.mark.parametrize("number", [signal.SIGUSR1, signal.SIGPIPE, signal.SIGTSTP])
def test_a_guardian_ignores_other_signals(module, partial, number):
    def send():
        os.kill(guardian_of(module), number)

    assert drive(module, partial, send).record.sizes["time"] == VOLTS.size


def command(module, folder, *arguments, stderr=subprocess.DEVNULL):
    """Start a command on the module, in a process group of its own."""
    device = folder / "device.yaml"
    scale = {"range": [0, 10], "unit": "V"}
    device.write_text(yaml.safe_dump({
        "name": "plain module", "unit_id": 1, "sampling_rate": 50, "quarantine": 0.5,
        "endpoint": {"host": "127.0.0.1", "port": module.port},
        "registers": {"output": {"address": 0, **scale, "limits": [0, 4], "access": "write"},
                      "applied_output": {"address": 1, **scale},
                      "displacement": {"address": 0, "table": "input", **scale, "unit": "mm"}},
    }))  # fmt: skip
    words = [sys.executable, "-m", "dea.acquisition", *arguments, "--device", str(device)]
    return subprocess.Popen(
        words, cwd=ROOT, stderr=stderr, start_new_session=True,
        preexec_fn=_as_from_a_terminal,
    )  # fmt: skip


def _as_from_a_terminal():
    """Hear SIGQUIT, which a shell lets the programs ignore that it runs in the background."""
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)


@pytest.fixture
def driving(module, tmp_path):
    """A program that drives the module, at three volts."""
    words = ["drive", "--mode", "polled", "--low", "2.9", "--high", "3.1", "--ramp-rate", "20",
             "--duration", "600", "--output", str(tmp_path / "record.nc")]  # fmt: skip
    with command(module, tmp_path, *words) as process:
        deadline = time.monotonic() + 30
        while module.volts < 2.8:
            assert time.monotonic() < deadline
            assert process.poll() is None
            time.sleep(0.02)
        yield process
        process.kill()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGUSR1, signal.SIGQUIT])
def test_a_recorder_that_dies_leaves_zero(module, driving, number):
    os.killpg(driving.pid, number)
    deadline = time.monotonic() + 3.0
    while module.volts:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert_at_zero_and_stays(module)
    assert_ramped(module)


def test_ctrl_c_ends_at_zero(module, driving):
    os.killpg(driving.pid, signal.SIGINT)
    assert driving.wait(15) == 130
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)


def test_a_stopped_recorder_leaves_zero_and_no_burst_when_it_goes_on(module, driving):
    os.killpg(driving.pid, signal.SIGSTOP)
    stopped = time.monotonic()
    while module.volts:
        assert time.monotonic() < stopped + 8.0  # 5 s of patience, then the ramp
        time.sleep(0.01)
    assert_at_zero_and_stays(module, 0.5)
    os.killpg(driving.pid, signal.SIGCONT)
    assert driving.wait(15) == 1
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)
    times, _ = module.path()
    assert np.diff(times[1:]).min() > 1e-3


def test_zero_takes_a_driven_output_to_zero(module, driving, tmp_path):
    with command(module, tmp_path, "zero") as process:
        assert process.wait(20) == 0
    assert_at_zero_and_stays(module, 0.3)
    assert_ramped(module)
    assert driving.wait(15) == 1


def test_ctrl_c_during_zero_ends_in_one_line_at_zero(module, tmp_path):
    module._count = 20000
    with command(module, tmp_path, "zero", stderr=subprocess.PIPE) as process:
        deadline = time.monotonic() + 30
        while not module.history:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=60)
    assert told == b"ended by SIGINT; the output is at zero\n"
    assert process.returncode == 130
    assert_at_zero_and_stays(module, 0.3)


def test_after_both_have_been_killed_a_start_is_refused_until_zero(module, driving, tmp_path):
    notice = duty.look(duty.duty_file(module.description()))
    driving.send_signal(signal.SIGSTOP)  # so that it hires no other one
    os.kill(notice.process, signal.SIGKILL)
    driving.kill()
    driving.wait()
    assert module.volts > 2.8
    assert duty.look(duty.duty_file(module.description())).abandoned
    with pytest.raises(InputError, match=r"an earlier guardian .* it had asked for [23]\."):
        acquire(module.description(), VOLTS, tmp_path / "second.partial", SETTINGS)
    with command(module, tmp_path, "zero") as process:
        assert process.wait(20) == 0
    assert_at_zero_and_stays(module, 0.2)
    assert_ramped(module)
