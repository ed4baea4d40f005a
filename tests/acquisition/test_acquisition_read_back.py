"""Read-backs of the output against what was asked for."""

import numpy as np
import pytest
from made_device import ECHO, STEP, module
from memory_link import MemoryLink

from dea.acquisition import ReadBackError
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import Echo, ReadBack

READ_BACK = {"applied_output": ECHO, "state": {"address": 2}}


def checked(volts, reading, *, state=2, at=(2, 4)):
    """Read ``reading`` (V) after two of the samples ``volts`` were played; check it after four."""
    link = MemoryLink(
        module(limits=(0, 10), **READ_BACK), applied_output=round(reading / STEP), state=state
    )
    read_back = ReadBack(Panel(link), np.rint(np.array(volts) / STEP), 0.05)
    for position in at:
        read_back(position)
    return read_back


# volts[k] is applied after k + 1 samples: between two and four samples, 5 to 7 V are.
PLAYED = [9.0, 5.0, 6.0, 7.0, 2.0]


@pytest.mark.parametrize("reading", [4.5, 5.0, 7.0, 7.5])
def test_a_reading_may_be_any_value_played_around_it(reading):
    assert not checked(PLAYED, reading).pending


@pytest.mark.parametrize("reading", [0.0, 4.4, 7.6])
def test_a_reading_that_was_not_played_around_it_is_an_error(reading):
    with pytest.raises(ReadBackError, match="while 5 to 7 V are played"):
        checked(PLAYED, reading)


@pytest.mark.parametrize(("volts", "state"), [(0.9, 2), (5.0, 1), (5.0, 3)])
def test_a_reading_near_zero_or_of_a_device_that_does_not_play_says_nothing(volts, state):
    assert checked([volts] * 5, 0.0, state=state).pending


def test_a_reading_is_compared_only_with_the_output_clear_of_zero():
    assert checked([3.0, 1.1, 1.1, 0.9, 3.0], 0.0).pending
    with pytest.raises(ReadBackError):
        checked([3.0, 1.1, 1.1, 1.1, 0.0], 0.0)


def test_a_read_back_one_sample_late_is_trusted_but_its_sample_flagged():
    panel = Panel(MemoryLink(module(limits=(0, 10), applied_output=ECHO)))
    echo = Echo(panel, "applied_output", 0.05)  # 0.5 V
    asked = [1000, 1400, 2000, 2600, 3200]
    assert [echo(now, before) for before, now in zip([1000, *asked], asked, strict=False)] == [
        True, True, False, False, False,
    ]  # fmt: skip
    assert [echo(count, 1000) for count in (4000, 5000)] == [False, False]
    with pytest.raises(ReadBackError, match="cannot say whether the output is at zero"):
        echo(6000, 1000)


def test_of_played_samples_those_applied_beyond_the_tolerance_are_not_right():
    """Half a volt is tolerated; the read-back counts tenths of a volt."""
    register = ECHO | {"scale": 0.1}
    panel = Panel(MemoryLink(module(limits=(0, 10), applied_output=register)))
    counts = np.array([4000, 4000, 4000, 4000, 4000, 0])
    applied = np.array([40, 36, 44, 34, 46, 0])
    right = Echo(panel, "applied_output", 0.05).right(counts, applied)
    assert right.tolist() == [True, True, True, False, False, True]
