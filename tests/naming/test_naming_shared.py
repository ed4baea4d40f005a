"""The time of what methods share counts for each of them, and once."""

import time

import numpy as np
import pytest
from numba import njit

from benchmarks.naming import shared
from benchmarks.naming.shared import Shared


@pytest.fixture
def clock(monkeypatch):
    """A processor's clock that is put on by hand."""
    now = [0.0]
    # What other tests compiled for would leave a rounding error in the sums.
    monkeypatch.setattr(shared, "_compiling", shared._Compiling())
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


@pytest.mark.slow
def test_compiling_is_no_method_s_time():
    own = Shared()

    def compiled():
        function = njit(lambda x: np.sort(x)[::-1] + np.linalg.norm(x))
        return function(np.arange(3.0))

    start = time.process_time()
    seconds = own.timed(lambda: own.once("value", compiled))[1]
    whole = time.process_time() - start
    assert whole > 0.1
    assert 0.0 <= seconds < 0.2 * whole


def test_what_a_value_needs_is_not_in_its_own_time(clock):
    own = Shared()

    def singles():
        return own.once("singles", lambda: own.once("nominal", lambda: clock(3.0)) + clock(10.0))

    assert own.timed(singles)[1] == 13.0
    assert own.timed(lambda: own.once("singles", int))[1] == 10.0
    assert own.timed(lambda: own.once("nominal", int))[1] == 3.0
