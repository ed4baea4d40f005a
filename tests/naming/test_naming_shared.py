"""The time of what methods share counts for each of them, and once."""

import pytest
from benchmarks.naming import shared
from benchmarks.naming.shared import Shared


@pytest.fixture
def clock(monkeypatch):
    """A processor's clock that is put on by hand."""
    now = [0.0]
    monkeypatch.setattr(shared.time, "process_time", lambda: now[0])

    def spend(seconds):
        now[0] += seconds
        return seconds

    return spend


def test_a_value_is_computed_once_and_charged_to_each_who_uses_it(clock):
    own = Shared()

    def nominal():
        return own.once("nominal", lambda: clock(3.0))

    def singles():
        return own.once("singles", lambda: nominal() + clock(10.0))

    def first():
        nominal(), nominal()
        return clock(1.0)

    def second():
        nominal(), singles(), singles()
        return clock(2.0)

    assert own.timed(first) == (1.0, 4.0)
    assert own.timed(second) == (2.0, 15.0)
    assert own.timed(second) == (2.0, 15.0)
    assert own.timed(first) == (1.0, 4.0)


def test_what_a_value_needs_is_not_in_its_own_time(clock):
    own = Shared()

    def singles():
        return own.once("singles", lambda: own.once("nominal", lambda: clock(3.0)) + clock(10.0))

    assert own.timed(singles)[1] == 13.0
    assert own.timed(lambda: own.once("singles", int))[1] == 10.0
    assert own.timed(lambda: own.once("nominal", int))[1] == 3.0
