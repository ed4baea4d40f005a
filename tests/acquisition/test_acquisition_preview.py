"""What a dry run says of an excitation, against numbers worked out by hand."""

import re

import numpy as np
import pytest
from made_device import OUTPUT, STEP, described

from dea.acquisition.preview import preview
from dea.acquisition.voltage_plan import OutputPlan, plan_sequence

# 100 samples a second, up to 2 V in steps of 0.5 V.
PLAN = OutputPlan(np.array([500, 1000, 1500, 2000, 1500, 1200, 700, 200, 0]), 2, 4)
assert STEP == 0.001


def told(**safety):
    output = {"output": OUTPUT | {"limits": [0, 4]}}
    device = described(output, sampling_rate=100, safety=safety)
    return dict(re.split("  +", line, maxsplit=1) for line in preview(device, PLAN).splitlines())


def test_duration_voltage_and_rate_are_those_of_the_samples():
    found = told()
    assert found["duration"] == "0.09 s, 9 samples with ramps"
    assert found["output"] == "0 to 2 V, limits (0.0, 4.0)"
    assert found["largest rate"] == "50 V/s"
    assert "amplifier_gain is not described" in found["high voltage"]


def test_high_voltage_field_charge_and_current_follow_from_gain_and_film():
    """1600 V over 40 um; 3 nF hold 4.8 uC of them, and take 120 uA for 40 kV/s."""
    found = told(amplifier_gain=800.0, film={"thickness": 40.0, "capacitance": 3.0})
    assert found["high voltage"] == "1600 V, changing by up to 40000 V/s"
    assert found["field"] == "40 V/um"
    assert found["charge"] == "4.8 uC"
    assert found["current"] == "120 uA at most, charging"


def test_without_a_film_neither_field_nor_charge_is_told():
    assert told(amplifier_gain=800.0).keys() == {
        "duration", "output", "largest rate", "high voltage",
    }  # fmt: skip


def test_a_drive_begins_at_zero_volts_and_not_at_the_count_zero():
    """Count 0 of a module over both signs is its lowest voltage."""
    output = {"address": 0, "range": [-10, 10], "limits": [0, 4], "unit": "V", "access": "write"}
    device = described({"output": output}, sampling_rate=50, safety={"max_rate": 25.0})
    plan = plan_sequence(device, np.linspace(0.4, 2.0, 5), ramp_rate=20.0)
    found = dict(re.split("  +", line, maxsplit=1) for line in preview(device, plan).splitlines())
    lowest, highest = re.match(r"(\S+) to (\S+) V", found["output"]).groups()
    assert abs(float(lowest)) < 1e-3
    assert float(highest) == pytest.approx(2.0, abs=1e-3)
    assert float(found["largest rate"].split()[0]) < 25.0
