"""A guardian that does nothing any more, and files of its locks that are removed."""

import fcntl
import os
import signal
import subprocess
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from plain_module import guardian_of

from dea.acquisition import (
    AcquisitionSettings,
    StoppedError,
    ZeroNotVerifiedError,
    acquire,
    by_hand,
    duty,
    recorder,
)
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.acquisition.recorder import GuardianLostError
from dea.errors import InputError
from dea.progress import heard_by

SETTINGS = AcquisitionSettings(
    mode="polled", ramp_rate=20.0, timeout=0.3, retries=0, reconnect_time=3.0, stall_time=0.6
)
PATIENCE = SETTINGS.patience  # s


def drive(module, partial, action, volts, settings=SETTINGS):
    """Drive at three volts, and act once there."""
    done = []

    def watch(samples, _):
        if not done and module.volts > 2.9:
            done.append(True)
            action()

    return acquire(module.description(), volts, partial, settings, watch=watch)


def test_a_guardian_that_is_stopped_is_replaced_and_the_output_taken_to_zero(module, tmp_path):
    stopped = []

    def stop():
        os.kill(guardian_of(module), signal.SIGSTOP)
        stopped.append(time.monotonic())

    with pytest.raises(GuardianLostError, match="gave no sign of life and was killed"):
        drive(module, tmp_path / "a.partial", stop, np.full(75, 3.0))
    assert module.volts == 0.0
    times, volts = module.path()
    last_driven = times[np.flatnonzero(volts)[-1]]
    assert last_driven - times[np.flatnonzero(volts > 2.9)[-1]] < 1.0  # the ramp
    assert time.monotonic() - stopped[0] < PATIENCE + 8.0
    assert duty.look(duty.duty_file(module.description())).phase == duty.Phase.AT_ZERO


def test_a_guardian_that_is_stopped_is_found_though_its_files_are_gone(
    module, tmp_path, duty_folder
):
    def stop():
        os.kill(guardian_of(module), signal.SIGSTOP)
        for file in duty_folder.glob("dea_*"):
            file.unlink()

    with pytest.raises(GuardianLostError, match="gave no sign of life and was killed"):
        drive(module, tmp_path / "a.partial", stop, np.full(75, 3.0))
    assert module.volts == 0.0


def kill_and_hold_the_lock(module, seconds):
    """Kill the guardian of a module; return the timer that gives its lock free again."""
    path = duty.duty_file(module.description())
    os.kill(guardian_of(module), signal.SIGKILL)
    while duty.look(path).alive:
        time.sleep(0.001)
    handle = os.open(path, os.O_RDWR)
    fcntl.flock(handle, fcntl.LOCK_EX)
    timer = threading.Timer(seconds, os.close, (handle,))
    timer.start()
    return timer


def test_a_lock_that_is_held_for_a_while_holds_no_replacement_up(module, tmp_path):
    """As by somebody who looks, or a start that is refused after the crash."""
    held = []
    with pytest.raises(GuardianLostError):
        drive(
            module, tmp_path / "a.partial",
            lambda: held.append(kill_and_hold_the_lock(module, 1.0)), np.full(75, 3.0),
        )  # fmt: skip
    held[0].join()
    assert module.volts == 0.0


def test_a_replacement_waits_for_its_lock_as_long_as_it_takes_with_an_alarm(module, tmp_path):
    held, impatient = [], replace(SETTINGS, reconnect_time=0.5)
    with pytest.raises(ZeroNotVerifiedError, match="another program has the lock"):
        drive(
            module, tmp_path / "a.partial",
            lambda: held.append(kill_and_hold_the_lock(module, 6.0)), np.full(75, 3.0), impatient,
        )  # fmt: skip
    assert module.volts > 2.9
    held[0].join()
    deadline = time.monotonic() + 15
    while module.volts:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_a_process_that_has_the_number_of_a_dead_guardian_is_not_killed(module):
    device = module.description()
    with subprocess.Popen(["sleep", "30"]) as other:
        with duty.Duty(device) as guardian:
            guardian.put(duty.Phase.DRIVING, 2.0)
            path = duty.duty_file(device)
            content = bytearray(path.read_bytes())
            content[:8] = other.pid.to_bytes(8, "little")
            path.write_bytes(content)
            assert not duty.end(path, duty.look(path))
        assert other.poll() is None
        other.kill()


def test_a_file_of_another_layout_says_what_it_holds(module):
    device = module.description()
    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.AT_ZERO, 0.0)
    path = duty.duty_file(device)
    content = path.read_bytes()
    for size in (0, 7, 30, 38):
        path.write_bytes(content[:size])
        assert duty.look(path).counts is None
        assert by_hand.status(device)


@pytest.mark.parametrize("ordered", [False, True])
def test_of_a_file_of_another_layout_the_volts_count(module, ordered):
    """An order leaves such a file as it is."""
    device = module.description()
    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.DRIVING, 2.5)
    path = duty.duty_file(device)
    path.write_bytes(path.read_bytes()[:38])
    if ordered:
        duty.order(path, duty.Order.ZERO)
    assert path.stat().st_size == 38
    assert duty.look(path).counts is None
    with duty.Duty(device) as guardian:
        assert guardian.left == 2.5


def test_a_guardian_that_has_given_a_sign_of_life_since_is_not_killed(module, tmp_path):
    """As one that was stopped and goes on just before it is ended."""
    kept = []

    def judge():
        path = duty.duty_file(module.description())
        judged = duty.look(path)
        time.sleep(0.2)
        kept.append(duty.end(path, judged))

    assert drive(module, tmp_path / "a.partial", judge, np.full(75, 3.0)).record.sizes["time"] == 75
    assert kept == [False]


def test_what_was_asked_for_counts_and_not_the_volts_that_another_description_made_of_it(module):
    device = module.description()
    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.DRIVING, 2.5)
    output = device["output"]
    scaled = replace(
        device,
        registers={
            **device.registers,
            "output": replace(output, scale=800 * output.scale, limits=(0.0, 3200.0)),
        },
    )
    with duty.Duty(scaled) as guardian:
        assert guardian.left == pytest.approx(2000.0, rel=1e-3)
    narrow = replace(
        device, registers={**device.registers, "output": replace(output, limits=(0.0, 1.0))}
    )
    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.DRIVING, 2.5)
    with duty.Duty(narrow) as guardian:
        assert guardian.left == 1.0


def test_zero_by_hand_replaces_a_guardian_that_is_stopped(module, tmp_path):
    told, process = [], os.fork()
    if process == 0:  # the recorder, which is stopped together with its guardian
        try:
            drive(module, tmp_path / "a.partial", lambda: None, np.full(5000, 3.0))
        finally:
            os._exit(0)
    try:
        deadline = time.monotonic() + 20
        while module.volts < 2.9:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        os.kill(process, signal.SIGSTOP)
        os.kill(guardian_of(module), signal.SIGSTOP)
        with heard_by(told.append):
            evidence = by_hand.zero(module.description(), SETTINGS)
        assert "zero" in evidence
        assert module.volts == 0.0
        assert any("was killed, another follows" in line for line in told)
    finally:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


@pytest.mark.parametrize("phase", [duty.Phase.CHECKING, duty.Phase.DRIVING, duty.Phase.AT_ZERO])
def test_silence_is_the_time_since_the_last_sign_of_life(module, phase):
    device = module.description()
    with duty.Duty(device) as guardian:
        guardian.put(phase, 1.0)
        time.sleep(0.05)
        assert 0.05 <= duty.look(duty.duty_file(device)).silent < 5.0
        guardian.beat()
        after = duty.look(duty.duty_file(device))
        assert after.silent < 0.05
        assert (after.phase, after.requested) == (phase, 1.0)
    assert duty.look(duty.duty_file(device)).silent == 0.0


def test_status_tells_of_the_silence(module, monkeypatch):
    monkeypatch.setattr(by_hand, "SILENT", 0.05)
    device = module.description()
    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.DRIVING, 2.0)
        assert "sign of life" not in by_hand.status(device)
        time.sleep(0.1)
        assert "has given no sign of life for 0 s: `zero` replaces it" in by_hand.status(device)


def test_locks_whose_files_are_removed_are_made_anew(module, tmp_path, duty_folder):
    refused = []

    def remove():
        for file in duty_folder.glob("dea_*"):
            file.unlink()
        time.sleep(1.5)  # the guardian looks every second
        assert guardian_of(module) > 0
        with pytest.raises(InputError, match="is driven by another program") as refusal:
            acquire(module.description(), np.full(5, 3.0), tmp_path / "b.partial", SETTINGS)
        refused.append(refusal)

    patient = replace(SETTINGS, stall_time=5.0)
    record = drive(module, tmp_path / "a.partial", remove, np.full(250, 3.0), patient).record
    assert refused
    assert record.sizes["time"] == 250
    assert module.volts == 0.0


def test_a_guardian_whose_lock_another_program_has_taken_goes_to_zero(
    module, tmp_path, duty_folder
):
    def take_over():
        for file in duty_folder.glob("dea_lock_*"):
            file.unlink()
        held.__enter__()

    held = endpoint_lock(module.description())
    try:
        with pytest.raises(StoppedError, match="another program has taken the output over"):
            drive(module, tmp_path / "a.partial", take_over, np.full(250, 3.0))
    finally:
        held.__exit__(None, None, None)
    assert module.volts == 0.0


def test_a_notice_is_never_seen_half_written(module):
    device = module.description()
    path, seen, ended = duty.duty_file(device), [], threading.Event()

    def watch():
        while not ended.is_set():
            data = path.read_bytes()
            seen.append(duty._notice(data, alive=True))

    with duty.Duty(device) as guardian:
        guardian.put(duty.Phase.DRIVING, 2.5)
        watcher = threading.Thread(target=watch)
        watcher.start()
        for _ in range(20_000):
            guardian.put(duty.Phase.DRIVING, 2.5)
        ended.set()
        watcher.join()
    assert {(each.phase, each.counts) for each in seen} == {(duty.Phase.DRIVING, seen[0].counts)}


def test_zero_writes_no_voltage_that_a_stuck_read_back_claims(module, tmp_path):
    drive(module, tmp_path / "a.partial", lambda: None, np.full(10, 1.0))
    before = len(module.path()[1])
    module.read_back = lambda count: 65535
    with pytest.raises(ZeroNotVerifiedError):
        by_hand.zero(module.description(), replace(SETTINGS, reconnect_time=0.3))
    module.read_back = lambda count: count
    assert (np.asarray(module.path()[1][before:]) == 0.0).all()
    assert by_hand.zero(module.description(), SETTINGS)


def test_the_recorder_raises_the_alarm_where_no_guardian_can(module, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(recorder, "GUARDIANS", 0)

    def kill():
        os.kill(guardian_of(module), signal.SIGKILL)

    with pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off"):
        drive(module, tmp_path / "a.partial", kill, np.full(75, 3.0))
    assert "ALARM: plain module: no guardian can take the output to zero" in capfd.readouterr().err
    by_hand.zero(module.description(), SETTINGS)
    assert module.volts == 0.0


@pytest.mark.parametrize(
    ("told", "settings", "silent", "is_tried"),
    [
        (5.0, {}, 7.9, False),
        (5.0, {}, 8.1, True),
        # A notice of an earlier version tells no patience: that of the settings counts.
        (0.0, {"timeout": 4.0}, 3.1, False),
    ],
)
def test_a_guardian_is_ended_by_hand_only_where_it_is_silent_for_longer_than_its_recorder_waits(
    told, settings, silent, is_tried, monkeypatch, tmp_path
):
    now = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now)
    tried = []
    monkeypatch.setattr(by_hand, "end", lambda path, notice: tried.append(notice) or True)
    notice = duty.Notice(7, True, duty.Phase.DRIVING, 1, 3.0, 0.0, now - silent, 3000, told)
    watched = by_hand._Watched(tmp_path, AcquisitionSettings(**settings))
    assert not watched.ended(notice), "twice the same: this process may have stood still itself"
    assert watched.ended(notice) is is_tried
    assert bool(tried) is is_tried


def test_a_guardian_that_cannot_be_ended_is_told_after_the_sixth_attempt(monkeypatch, tmp_path):
    now = time.monotonic()
    notice = duty.Notice(7, True, duty.Phase.DRIVING, 1, 3.0, 0.0, now - 60.0, 3000, 1.0)
    monkeypatch.setattr(by_hand, "end", lambda path, notice: False)
    monkeypatch.setattr(by_hand, "look", lambda path: notice)
    watched = by_hand._Watched(tmp_path, AcquisitionSettings())
    for _ in range(6):
        assert not watched.ended(notice)
    with pytest.raises(InputError, match="cannot be ended from here"):
        watched.ended(notice)
