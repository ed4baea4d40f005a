"""Readings that cannot be right are flagged, on the samples they happened to."""

import numpy as np
import pytest
from made_device import described

from dea.acquisition.record import record_dataset
from dea.acquisition.samples import DrivenSamples, Quality
from dea.acquisition.sensor_flags import STUCK_SAMPLES, flag_sensor

STEPS = np.arange(200)
MOVING = 1000 + 7 * STEPS % 501


def device(**displacement):
    registers = {
        "output": {"address": 0, "scale": 0.001, "limits": [0, 4], "unit": "V", "access": "write"},
        "displacement": {"address": 1, "unit": "mm"} | displacement,
    }
    return described(registers)


def samples(displacement, requested=None, quality=0):
    asked = 2000 + 10 * STEPS if requested is None else requested
    zero = np.zeros(STEPS.size)
    return DrivenSamples(
        STEPS, STEPS, asked, asked, displacement, zero.astype(int) + quality, zero, zero
    )


def flagged(target, given, flag):
    return np.flatnonzero(flag_sensor(target, given).quality & flag).tolist()


def test_what_moves_is_not_flagged():
    assert not flag_sensor(device(range=[0, 10]), samples(MOVING)).quality.any()


def test_a_reading_that_stands_still_while_the_output_moves_is_stuck():
    reading = MOVING.copy()
    reading[60 : 60 + 2 * STUCK_SAMPLES] = 4321
    stuck = flagged(device(), samples(reading), Quality.STUCK)
    assert stuck == list(range(60, 60 + 2 * STUCK_SAMPLES))


def test_a_reading_that_stands_still_for_a_moment_or_with_the_output_is_not():
    reading = MOVING.copy()
    reading[60 : 60 + STUCK_SAMPLES - 1] = 4321
    assert flagged(device(), samples(reading), Quality.STUCK) == []
    reading[60:120] = 4321
    still = np.full(STEPS.size, 2000)
    assert flagged(device(), samples(reading, still), Quality.STUCK) == []


@pytest.mark.parametrize("end", [0, 65535])
def test_a_reading_at_an_end_of_the_range_is_saturated(end):
    reading = MOVING.copy()
    reading[[7, 9]] = end
    assert flagged(device(range=[0, 10]), samples(reading), Quality.SATURATED) == [7, 9]


@pytest.mark.parametrize(
    ("kind", "end", "found"),
    [("uint16", 65535, [7]), ("uint16", 0, []), ("int16", -32768, [7]), ("int16", 32767, [7])],
)
def test_a_scaled_count_is_saturated_where_it_can_go_no_further(kind, end, found):
    reading = MOVING.copy()
    reading[7] = end
    assert flagged(device(type=kind, scale=0.01), samples(reading), Quality.SATURATED) == found


def test_a_sample_that_was_never_read_says_nothing_of_the_sensor():
    lost = samples(np.zeros(STEPS.size, int), quality=int(Quality.LOST))
    assert (flag_sensor(device(range=[0, 10]), lost).quality == Quality.LOST).all()


def test_a_float_sensor_keeps_its_digits():
    reading = 0.123456 + 1e-6 * STEPS
    record = record_dataset(device(type="float32"), samples(reading), lead=0, length=STEPS.size)
    assert np.array_equal(record.displacement, reading)
    assert record.displacement_counts.dtype == float
    assert not record.quality.any()
    reading[5] = np.nan
    assert flagged(device(type="float32"), samples(reading), Quality.SATURATED) == [5]
