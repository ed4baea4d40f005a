"""How long a guardian waits for the voltage that it has asked a controller for."""

import socket
import time
from pathlib import Path

import numpy as np
import pytest

from dea.acquisition import AcquisitionSettings
from dea.acquisition import guardian as guardians
from dea.acquisition.closed_loop import ControllerError
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.duty import Duty
from dea.acquisition.guardian import Guardian
from dea.acquisition.shared_file import SharedLock
from dea.acquisition.standby import Standby
from dea.acquisition.wire import Wire
from dea.modbus import read_device
from served_bench import DESCRIPTION


@pytest.fixture
def asking(monkeypatch):
    """Return a function that makes a guardian whose recorder says nothing, and the other end."""
    ends = []

    def start(*, paced):
        monkeypatch.setattr(Guardian, "_check", lambda _: None)
        ends.extend(Wire(end) for end in socket.socketpair())
        settings = AcquisitionSettings(mode="polled", paced=paced)
        job = DriveJob(
            read_device(DESCRIPTION), settings, np.zeros(2), False, 1, Path("latch"), 0.0
        )
        lock, duty = SharedLock(Path("lock")), Duty(job.device)
        duty.token = 0
        return Guardian(Standby(ends[-2], job, []), lock, duty), ends[-1]

    yield start
    for end in ends:
        end.close()


@pytest.mark.parametrize("paced", [True, False])
def test_an_answer_that_comes_in_time_is_taken(asking, paced):
    guardian, recorder = asking(paced=paced)
    recorder.post("count", 17)
    assert guardian._answer() == 17


def test_one_that_does_not_come_ends_the_drive_of_a_paced_device(asking, monkeypatch):
    monkeypatch.setattr(guardians, "ANSWER_TIME", 0.2)
    guardian, _ = asking(paced=True)
    begun = time.monotonic()
    with pytest.raises(ControllerError, match=r"gave no voltage for 0\.2 s"):
        guardian._answer()
    assert 0.2 <= time.monotonic() - begun < 5.0


def test_a_device_that_is_not_paced_waits_longer(asking, monkeypatch):
    monkeypatch.setattr(guardians, "ANSWER_TIME", 0.0)
    guardian, recorder = asking(paced=False)
    waited = []

    def wait(seconds):
        waited.append(seconds)
        if len(waited) == 20:
            recorder.post("count", 5)
        time.sleep(0.001)

    monkeypatch.setattr(guardian.wire, "wait", wait)
    assert guardian._answer() == 5
