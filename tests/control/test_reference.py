"""References stay in their reach, are smooth, and go where every minute of a record was."""

import numpy as np
import pytest

from dea.control import Reach, ReferenceShape, design_reference, reach_of
from dea.errors import InputError

RATE = 50.0
REACH = Reach(0.8, 1.2)
SHAPE = ReferenceShape(turn=20.0, hold=2.0, rise=0.6, frequency=0.5)


def reference(seed=1, seconds=60):
    return design_reference(REACH, round(seconds * RATE), RATE, seed, SHAPE)


def test_it_goes_from_end_to_end_and_no_further():
    wanted = reference()
    assert wanted.min() == pytest.approx(0.8)
    assert wanted.max() == pytest.approx(1.2)
    assert wanted.size == 3000
    assert np.array_equal(wanted, reference())
    assert not np.array_equal(wanted, reference(seed=2))


def test_steps_end_on_time_and_no_step_is_faster_than_least_jerk():
    steps = reference()[:1000]
    settled = steps.reshape(10, 100)[:, 31:]
    assert np.ptp(settled, axis=1).max() < 1e-12
    # The way of least jerk is at most 15/8 of its mean speed.
    assert np.abs(np.diff(steps)).max() * RATE <= 0.4 / 0.6 * 15 / 8 + 1e-9


def test_the_sine_and_the_noise_hold_only_their_frequencies():
    wanted = reference() - 1.0
    for part, highest in ((wanted[1050:1950], 0.75), (wanted[2050:2950], 1.5)):
        power = np.abs(np.fft.rfft(part * np.hanning(part.size))) ** 2
        frequencies = np.fft.rfftfreq(part.size, 1 / RATE)
        assert power[frequencies > highest].sum() < 1e-3 * power.sum()
    peak = np.abs(np.fft.rfft(wanted[1050:1950])).argmax()
    assert np.fft.rfftfreq(900, 1 / RATE)[peak] == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize(
    ("change", "field"),
    [({"turn": 2.0, "frequency": 0.2}, "frequency"), ({"turn": 0.005}, "turn"),
     ({"turn": 0.02, "hold": 0.02}, "frequency"), ({"turn": np.nan}, "turn"),
     ({"hold": 21.0}, "hold")],
)  # fmt: skip
def test_a_turn_in_which_nothing_fits_is_refused(change, field):
    with pytest.raises(InputError) as refused:
        design_reference(REACH, 600, RATE, 1, SHAPE._replace(**change))
    assert refused.value.field == field


def test_the_reach_is_common_to_every_minute():
    y = np.concatenate([np.linspace(0.5, 1.5, 3000), np.linspace(0.9, 2.0, 3000)])
    y[7] = np.nan
    reach = reach_of(y, RATE, (0.0, 1.0))
    assert reach.low == pytest.approx(0.9)
    assert reach.high == pytest.approx(1.5)
    assert reach_of(y, RATE, (0.5, 1.0)).stroke == pytest.approx(0.3)


def test_minutes_apart_have_no_reach():
    y = np.repeat([0.0, 1.0], 3000)
    with pytest.raises(InputError, match="no range in common"):
        reach_of(y, RATE, (0.0, 1.0))


def test_a_minute_without_a_reading_does_not_count():
    y = np.tile(np.linspace(0.0, 1.0, round(60 * RATE)), 4)
    gappy = y.copy()
    gappy[round(60 * RATE) : round(120 * RATE)] = np.nan
    assert reach_of(gappy, RATE, (0.0, 1.0)) == reach_of(y, RATE, (0.0, 1.0))
    with pytest.raises(InputError, match="it has no reading"):
        reach_of(np.full(y.size, np.nan), RATE, (0.0, 1.0))
    with pytest.raises(InputError, match="it has no reading"):
        reach_of(np.empty(0), RATE, (0.0, 1.0))
    with pytest.raises(InputError, match="sampling_rate"):
        reach_of(y, np.nan, (0.0, 1.0))
