"""What of an excitation is allowed, and how it is reached from zero and left to zero."""

import numpy as np
import pytest
from made_device import STEP, described, module

from dea.acquisition.voltage_plan import check_excitation, plan_sequence
from dea.errors import InputError
from dea.modbus import to_physical


@pytest.mark.parametrize(
    ("volts", "counts"), [(-10.0, -10_000), (4.0, 4000), (4.0004, 4000), (-10.0004, -10_000)]
)
def test_the_limits_themselves_are_allowed(volts, counts):
    assert check_excitation(module(), np.array([0.0, volts])).tolist() == [0, counts]


@pytest.mark.parametrize("volts", [-10.001, 4.001, -10.0006, 4.0006])
def test_a_count_beyond_the_limits_is_not(volts):
    with pytest.raises(InputError, match=f"sample 1 .* {volts:g} V, outside -10 to 4 V"):
        check_excitation(module(), np.array([0.0, volts]))


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_voltage_that_no_count_stands_for_is_refused_from_half_a_count_on(sign):
    everything = module(limits=(-40, 40))
    edge = 32767 if sign > 0 else -32768
    near, far = STEP * (edge + sign * 0.4), STEP * (edge + sign * 0.6)
    assert check_excitation(everything, np.array([near])).tolist() == [edge]
    with pytest.raises(InputError, match=r"outside -32\.768 to 32\.767 V"):
        check_excitation(everything, np.array([far]))


@pytest.mark.parametrize(("volts", "worst"), [([-11.5, 0, 5], 0), ([-10.5, 0, 5.1, 4.1], 2)])
def test_the_sample_farthest_outside_is_told(volts, worst):
    with pytest.raises(InputError, match=f"sample {worst} "):
        check_excitation(module(), np.array(volts, float))


RATE, RAMP_RATE = 200.0, 40.0  # Hz, V/s
COUNT = 15.0 / 65535  # V
OUTPUT = {"address": 0, "access": "read_write", "range": [0, 15], "limits": [0, 10], "unit": "V"}


@pytest.mark.parametrize(("first", "last"), [(3.0, 8.0), (9.0, 0.5), (0.0, 0.0)])
def test_an_excitation_is_reached_from_zero_and_left_to_zero(first, last):
    device = described({"output": OUTPUT}, sampling_rate=RATE)
    step = RAMP_RATE / RATE
    excitation = np.array([first, 5.0, last])
    plan = plan_sequence(device, excitation, RAMP_RATE)
    played = to_physical(device["output"], plan.counts)
    inside = slice(plan.lead, plan.lead + plan.length)
    np.testing.assert_allclose(played[inside], excitation, atol=COUNT)
    assert played[-1] == 0.0
    lead = np.diff([0.0, *played[: plan.lead + 1]])
    tail = -np.diff(played[plan.lead + plan.length - 1 :])
    for steps in (lead, tail):
        assert (steps >= 0.0).all()
        assert (steps <= step + COUNT).all()
    assert plan.lead == max(round(first / step) - 1, 0)


def test_a_ramp_beyond_the_largest_rate_is_refused_where_the_sequence_holds_none():
    """From wherever the drive breaks off, the output is taken to zero at the rate of the ramp."""
    device = described({"output": OUTPUT}, sampling_rate=RATE, safety={"max_rate": 5.0})
    from_zero = 1.8 - 1.8 * np.cos(2 * np.pi * 0.2 * np.arange(0, 5, 1 / RATE))
    with pytest.raises(InputError, match=r"ramped by 5\.01 V/s") as caught:
        plan_sequence(device, from_zero, 5.01)
    assert caught.value.field == "safety.max_rate"
    assert plan_sequence(device, from_zero, 5.0).length == from_zero.size
