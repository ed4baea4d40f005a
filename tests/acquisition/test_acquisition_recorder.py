"""A recorder whose guardians end one after another."""

from types import SimpleNamespace

import numpy as np
import pytest

from dea.acquisition import ZeroNotVerifiedError, recorder
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
    made = SimpleNamespace(counts=np.ones(5))
    made._replace = lambda counts: made
    return made


def test_guardians_that_cannot_start_end_in_an_alarm_and_not_in_silence(job, monkeypatch):
    started, slept = [], []
    monkeypatch.setattr(recorder, "launch", lambda: started.append(1) or Ended())
    monkeypatch.setattr(recorder.time, "sleep", slept.append)
    with pytest.raises(ZeroNotVerifiedError, match="switch the amplifier off"):
        Recorder(job, LinkLog(), lambda: None).end(None)
    assert len(started) == 1 + GUARDIANS
    assert slept == sorted(slept)
    assert sum(slept) > 2.0


def test_a_replacement_that_the_host_cannot_start_is_told(job, monkeypatch):
    wires = iter([Ended()])

    def launch():
        try:
            return next(wires)
        except StopIteration:
            raise OSError("no process can be started") from None

    monkeypatch.setattr(recorder, "launch", launch)
    with pytest.raises(ZeroNotVerifiedError, match="no process can be started"):
        Recorder(job, LinkLog(), lambda: None).end(None)
