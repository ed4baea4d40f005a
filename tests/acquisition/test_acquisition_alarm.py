"""The alarm is repeated, and what holds one of its writers holds up that one alone."""

import os
import syslog
import threading

import pytest

from dea.acquisition import alarm
from dea.acquisition.alarm import BELL, Alarm

JOIN = 5.0  # s


@pytest.fixture
def heard(monkeypatch):
    """What the log and standard error get, as they get it; ``held`` keeps the latter waiting."""
    lines, held = {"log": [], "error": []}, threading.Event()
    held.set()
    monkeypatch.setattr(syslog, "syslog", lambda level, line: lines["log"].append(line))

    def write(descriptor, text):
        assert descriptor == 2
        held.wait(JOIN)
        lines["error"].append(text.decode())

    monkeypatch.setattr(os, "write", write)
    monkeypatch.setattr(alarm, "INTERVAL", 0.0)
    return lines, held


def ended(raised, where):
    raised._writers[where].join(JOIN)
    assert not raised._writers[where].is_alive()


def test_it_is_repeated_on_every_way(heard):
    lines, _ = heard
    raised = Alarm("dea1")
    for _ in range(2):
        assert raised("output is not zero")
        for where in ("log", "standard error"):
            ended(raised, where)
    assert lines["log"] == ["ALARM: dea1: output is not zero"] * 2
    assert lines["error"] == [f"{BELL}ALARM: dea1: output is not zero\n"] * 2


def test_a_terminal_that_is_stopped_holds_up_neither_the_log_nor_who_raises_it(heard):
    lines, held = heard
    held.clear()
    raised = Alarm("dea1")
    for _ in range(3):
        assert raised("output is not zero")
        ended(raised, "log")
    assert len(lines["log"]) == 3
    held.set()
    ended(raised, "standard error")
    assert len(lines["error"]) == 1, "one writer waits, however often it is raised"


def test_it_is_not_raised_again_within_the_interval(heard, monkeypatch):
    monkeypatch.setattr(alarm, "INTERVAL", 60.0)
    raised = Alarm("dea1")
    assert raised("output is not zero")
    assert not raised("output is not zero")


def test_a_host_that_starts_no_threads_raises_no_error(monkeypatch):
    """It would end the guardian, which goes on trying."""

    def refuse(self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    assert Alarm("module")("the output stays on")
