"""A recorder whose guardians end one after another."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_device import module

from dea.acquisition import AcquisitionSettings, ZeroNotVerifiedError, recorder
from dea.acquisition.link_log import LinkLog
from dea.acquisition.recorder import GUARDIANS, Recorder


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


@pytest.fixture
def job():
    made = SimpleNamespace(
        counts=np.ones(5), device=module(limits=(0, 10)), settings=AcquisitionSettings()
    )
    made._replace = lambda counts: made
    return made


def test_guardians_that_cannot_start_end_in_an_alarm_and_not_in_silence(job, monkeypatch):
    started, slept = [], []
    monkeypatch.setattr(recorder, "launch", lambda **_: started.append(1) or Ended())
    monkeypatch.setattr(recorder.time, "sleep", slept.append)
    with pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off"):
        Recorder(job, LinkLog(), lambda: None).end(None)
    assert len(started) == 1 + GUARDIANS
    assert slept == sorted(slept)
    assert sum(slept) > 2.0


def test_a_replacement_that_the_host_cannot_start_is_told(job, monkeypatch):
    wires = iter([Ended()])

    def launch(**_):
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


def test_a_guardian_that_never_reports_is_replaced_by_one_from_a_new_nursery(job, monkeypatch):
    """As where the nursery has been stopped."""
    asked = []

    def launch(*, anew=False):
        asked.append(anew)
        return Mute()

    monkeypatch.setattr(recorder, "launch", launch)
    monkeypatch.setattr(recorder, "HIRING", 0.02)
    monkeypatch.setattr(recorder, "PAUSE", 0.0)
    with pytest.raises(ZeroNotVerifiedError, match="no guardian has begun"):
        Recorder(job, LinkLog(), lambda: None).end(None)
    assert asked == [False] + [True] * GUARDIANS
