"""A guardian that does nothing any more, and files of its locks that are removed."""

import os
import signal
import time
from dataclasses import replace

import numpy as np
import pytest
from plain_module import PlainModule

from dea.acquisition import AcquisitionSettings, StoppedError, acquire, by_hand, duty
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.acquisition.recorder import GuardianLostError
from dea.errors import InputError
from dea.progress import heard_by

pytestmark = pytest.mark.slow

SETTINGS = AcquisitionSettings(
    mode="polled", ramp_rate=20.0, timeout=0.3, retries=0, reconnect_time=3.0, stall_time=0.6
)
PATIENCE = SETTINGS.stall_time + 2 * SETTINGS.timeout  # s


@pytest.fixture
def module():
    made = PlainModule()
    yield made
    made.stop()


def drive(module, partial, action, volts, settings=SETTINGS):
    """Drive at three volts, and act once there."""
    done = []

    def watch(samples, _):
        if not done and module.volts > 2.9:
            done.append(True)
            action()

    return acquire(module.description(), volts, partial, settings, watch=watch)


def guardian_of(module):
    notice = duty.look(duty.duty_file(module.description()))
    assert notice.alive
    return notice.process


def test_a_guardian_that_is_stopped_is_replaced_and_the_output_taken_to_zero(module, tmp_path):
    stopped = []

    def stop():
        os.kill(guardian_of(module), signal.SIGSTOP)
        stopped.append(time.monotonic())

    with pytest.raises(GuardianLostError, match="gave no sign of life for"):
        drive(module, tmp_path / "a.partial", stop, np.full(75, 3.0))
    assert module.volts == 0.0
    times, volts = module.path()
    last_driven = times[np.flatnonzero(volts)[-1]]
    assert last_driven - times[np.flatnonzero(volts > 2.9)[-1]] < 1.0  # the ramp
    assert time.monotonic() - stopped[0] < PATIENCE + 8.0
    assert duty.look(duty.duty_file(module.description())).phase == duty.Phase.AT_ZERO


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
        assert any("is killed and replaced" in line for line in told)
    finally:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


def test_silence_is_that_of_a_guardian_which_must_be_active(module):
    device = module.description()
    with duty.Duty(device) as guardian:
        for phase, active in [
            (duty.Phase.CHECKING, False),
            (duty.Phase.DRIVING, True),
            (duty.Phase.TO_ZERO, True),
            (duty.Phase.ALARM, True),
            (duty.Phase.AT_ZERO, False),
        ]:
            guardian.put(phase, 1.0)
            time.sleep(0.05)
            notice = duty.look(duty.duty_file(device))
            assert (notice.silent >= 0.05) == active
            assert notice.silent < 5.0
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
