"""A recorder whose guardians end one after another."""

import subprocess
import time
from types import SimpleNamespace

import numpy as np
import pytest
from made_device import module

from dea.acquisition import AcquisitionSettings, ZeroNotVerifiedError, recorder
from dea.acquisition.link_log import LinkLog
from dea.acquisition.recorder import GUARDIANS, Recorder
from dea.acquisition.wire import packed
from dea.errors import InputError


class Ended:
    """The wire to a process that has ended."""

    closed = True

    def post(self, *message):
        pass

    def take(self):
        return []

    def wait(self, seconds):
        pass

    def close(self):
        pass


class Job(SimpleNamespace):
    def _replace(self, **changes):
        return Job(**{**vars(self), **changes})


@pytest.fixture
def job():
    device, settings = module(limits=(0, 10)), AcquisitionSettings()
    return Job(counts=np.ones(5), device=device, settings=settings, replaces=False)


def test_guardians_that_cannot_start_end_in_an_alarm_and_not_in_silence(job, monkeypatch):
    started, slept = [], []
    monkeypatch.setattr(recorder, "launch", lambda *_, **__: started.append(1) or Ended())
    monkeypatch.setattr(recorder.time, "sleep", slept.append)
    with pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off"):
        Recorder(job, LinkLog(), lambda: None).end(None)
    assert len(started) == 1 + GUARDIANS
    assert slept == sorted(slept)
    assert slept[0] == 0.0, "the first one follows at once"
    assert sum(slept) > 2.0


def test_after_the_alarm_no_other_guardian_is_started(job, monkeypatch):
    """The person who is told is not kept waiting for what has failed already."""
    started = []
    monkeypatch.setattr(recorder, "launch", lambda *_, **__: started.append(1) or Ended())
    monkeypatch.setattr(recorder, "PAUSE", 0.0)
    told = pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off")
    with told, Recorder(job, LinkLog(), lambda: None) as followed:
        followed.end(None)
    assert len(started) == 1 + GUARDIANS


def test_a_replacement_that_the_host_cannot_start_is_told(job, monkeypatch):
    wires = iter([Ended()])

    def launch(*_, **__):
        try:
            return next(wires)
        except StopIteration:
            raise OSError("no process can be started") from None

    monkeypatch.setattr(recorder, "launch", launch)
    with pytest.raises(ZeroNotVerifiedError, match="no process can be started"):
        Recorder(job, LinkLog(), lambda: None).end(None)


class Mute(Ended):
    """The wire to a process that never says anything."""

    def __init__(self):
        self.closed = False

    def close(self):
        self.closed = True


class Refusing(Mute):
    """The wire to a guardian that refuses its job."""

    def __init__(self, *messages):
        super().__init__()
        self.messages = list(messages)

    def take(self):
        taken, self.messages = self.messages, []
        return taken


def test_a_replacement_that_is_refused_is_followed_by_another(job, monkeypatch):
    refusal = ("refused", packed(InputError("another acquisition drives the output")))
    wires = [Ended(), *(Refusing(refusal) for _ in range(3)), Refusing(("zero", "at zero", None))]
    monkeypatch.setattr(recorder, "launch", lambda *_, **__: wires.pop(0))
    monkeypatch.setattr(recorder, "PAUSE", 0.0)
    monkeypatch.setattr(LinkLog, "add", lambda self, other: None)
    followed = Recorder(job, LinkLog(), lambda: None)
    followed.end(None)
    assert followed.evidence == "at zero"
    assert not wires


def test_the_last_guardian_is_left_to_try_though_it_is_silent(job, monkeypatch):
    job.settings = AcquisitionSettings(stall_time=0.02, timeout=0.01)
    processes, wires = [], []

    def launch(*_, **__):
        process = subprocess.Popen(["sleep", "60"])
        processes.append(process)
        wires.append(Following(process))
        return wires[-1]

    class Following(Refusing):
        def __init__(self, process):
            super().__init__(("started", process.pid))
            self.process = process

        def take(self):
            self.closed = self.process.poll() is not None
            return super().take()

        def wait(self, seconds):
            time.sleep(0.005)

    monkeypatch.setattr(recorder, "launch", launch)
    monkeypatch.setattr(recorder, "PAUSE", 0.0)
    try:
        with pytest.raises(ZeroNotVerifiedError, match=r"no sign of life .* switch the amplifier"):
            Recorder(job, LinkLog(), lambda: None).end(None)
        assert [process.poll() for process in processes] == [-9, -9, None]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_guardian_that_never_reports_is_replaced_by_one_from_a_new_fork_server(job, monkeypatch):
    """As where the fork server has been stopped."""
    asked = []

    def launch(_, *, anew=False):
        asked.append(anew)
        return Mute()

    monkeypatch.setattr(recorder, "launch", launch)
    monkeypatch.setattr(recorder, "START_TIMEOUT", 0.02)
    monkeypatch.setattr(recorder, "RESTART_TIMEOUT", 0.02)
    monkeypatch.setattr(recorder, "PAUSE", 0.0)
    with pytest.raises(ZeroNotVerifiedError, match="no guardian has begun"):
        Recorder(job, LinkLog(), lambda: None).end(None)
    assert asked == [False] + [True] * GUARDIANS


@pytest.mark.parametrize("error", [ValueError("no number"), OSError("no memory")])
def test_whatever_a_guardian_fails_of_zero_is_awaited(job, monkeypatch, error):
    broken = ("broken", packed(error), None)
    wire = Refusing(broken, ("zero", "at zero", None))
    monkeypatch.setattr(recorder, "launch", lambda *_, **__: wire)
    monkeypatch.setattr(LinkLog, "add", lambda self, other: None)
    followed = Recorder(job, LinkLog(), lambda: None)
    followed.end(None)
    assert followed.evidence == "at zero"
