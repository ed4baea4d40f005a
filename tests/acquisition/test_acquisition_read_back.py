"""Read-backs of the output against what was asked for."""

import numpy as np
import pytest
from made_device import ECHO, OUTPUT, STEP, described, module
from memory_link import MemoryLink

from dea.acquisition import ReadBackError
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import Echo, ReadBack
from dea.acquisition.retrying_link import LinkError

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


def echo_of(tolerance=0.05, limits=(0, 10), **changes):
    panel = Panel(MemoryLink(module(limits=limits, applied_output=ECHO | changes)))
    return Echo(panel, "applied_output", tolerance)


def test_three_wrong_read_backs_in_a_row_are_too_many_and_two_are_not():
    echo = echo_of()
    assert [echo(5000, 0), echo(5000, 0)] == [False, False]
    assert echo(5000, 5000) is True
    assert [echo(5000, 0), echo(5000, 0)] == [False, False]
    with pytest.raises(ReadBackError, match="it reads 0 V while 5 to 5 V were asked for"):
        echo(5000, 0)


def test_a_read_back_may_be_one_sample_late_and_no_more():
    echo = echo_of()
    assert [echo(count, 1000) for count in (1000, 4000, 4000)] == [True, False, False]
    assert echo(4000, 1000) is False
    with pytest.raises(ReadBackError, match="it reads 1 V while 4 to 4 V"):
        echo(4000, 1000)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_read_back_may_be_off_by_the_tolerance_and_no_more(sign):
    echo = echo_of(limits=(-6, 4))  # 0.5 V
    assert echo(2000, 2000 + sign * 499) is True
    assert echo(2000, 2000 + sign * 501) is False
    assert echo.right(np.array([2000, 2000]), 2000 + sign * np.array([499, 501])).tolist() == [
        True, False,
    ]  # fmt: skip


@pytest.mark.parametrize(("own", "tolerance"), [(0.2, 0.5), (0.7, 0.7)])
def test_the_larger_of_both_tolerances_counts(own, tolerance):
    panel = Panel(MemoryLink(module(limits=(-6, 4), applied_output=ECHO | {"tolerance": own})))
    assert Echo(panel, "applied_output", 0.05).tolerance == pytest.approx(tolerance)


def test_counts_of_output_and_read_back_mean_volts_of_their_own():
    """The output counts millivolts, the read-back tenths of a volt from 2 V on."""
    echo = echo_of(tolerance=0.01, scale=0.1, offset=2.0)
    assert [echo(5000, 30), echo(5000, 32)] == [True, False]
    np.testing.assert_array_equal(echo.right(np.array([5000, 3000]), np.array([30, 10])), [1, 1])


def test_a_reading_is_checked_once():
    read_back = checked(PLAYED, 6.0)
    read_back.panel.link.values["applied_output"] = 0
    for position in (0, 1, 2, 3):
        read_back(position)
    assert not read_back.pending


def test_a_device_without_a_state_or_a_read_back_is_not_checked():
    for registers in ({}, {"applied_output": ECHO}, {"state": {"address": 2}}):
        panel = Panel(MemoryLink(module(limits=(0, 10), **registers)))
        read_back = ReadBack(panel, np.full(5, 5000), 0.05)
        assert not read_back.pending
        for position in (2, 4):
            read_back(position)


def test_before_the_first_sample_zero_is_applied():
    read_back = checked([9.0] * 5, 0.0, at=(0,))
    assert read_back.volts.tolist() == [0.0, 9.0, 9.0, 9.0, 9.0, 9.0]
    read_back(1)
    with pytest.raises(ReadBackError, match="it reads 0 V while 9 to 9 V are played"):
        read_back(2)


def test_a_reading_that_was_not_taken_is_followed_by_another():
    """A device that does not answer, or does not play, is asked again."""
    read_back = checked(PLAYED, 6.0, at=())
    values, answers = read_back.panel.link.values, dict(read_back.panel.link.values)

    def silent():
        raise LinkError("no answer")

    values["applied_output"] = silent
    read_back(2)
    values.update(answers)
    read_back(3)
    assert read_back.pending
    read_back(4)
    assert not read_back.pending


QUARTERS = {"scale": 0.25}  # V, which add up exactly


def quarters(**output):
    """A module that counts quarters of a volt."""
    registers = {"output": OUTPUT | QUARTERS | output, "applied_output": ECHO | QUARTERS}
    return described(registers | {"state": {"address": 2}}, sampling_rate=100)


def test_a_deviation_of_the_tolerance_itself_is_no_error():
    """One volt, four counts."""
    made = quarters(limits=[0, 8])
    for applied, right in ((16, True), (24, True), (15, False), (25, False)):
        echo = Echo(Panel(MemoryLink(made)), "applied_output", 0.125)
        assert echo(20, applied) is right
        assert echo.right(np.array([20]), np.array([applied])).tolist() == [right]
    for applied in (16, 24):
        read_back = ReadBack(
            Panel(MemoryLink(made, applied_output=applied, state=2)), np.full(5, 20), 0.125
        )
        read_back(2)
        read_back(4)
        assert not read_back.pending
    zeros = ReadBack(Panel(MemoryLink(made, applied_output=0, state=2)), np.full(5, 8), 0.125)
    zeros(2)
    zeros(4)
    assert zeros.pending  # twice the tolerance is not clear of zero


def test_an_output_without_limits_has_no_share_of_their_span_as_tolerance():
    panel = Panel(MemoryLink(quarters()))
    assert Echo(panel, "applied_output", 0.125).tolerance == 0.0
    assert ReadBack(panel, np.full(5, 20), 0.125).tolerance == 0.0
