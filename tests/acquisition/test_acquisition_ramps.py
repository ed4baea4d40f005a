"""The host's ramps begin at the present output, end at the target and keep the rate."""

from pathlib import Path

import numpy as np
import pytest

from dea.acquisition.safety import SafeOutput
from dea.acquisition.voltage_plan import plan_sequence
from dea.modbus import parse_device, to_counts, to_physical

RATE, RAMP_RATE = 200.0, 40.0  # Hz, V/s
STEP = RAMP_RATE / RATE  # V
COUNT = 15.0 / 65535  # V

OUTPUT = {"address": 0, "access": "read_write", "range": [0, 15], "limits": [0, 10], "unit": "V"}
ECHO = {"address": 1, "range": [0, 15], "unit": "V"}


def device(**registers):
    return parse_device(
        {
            "name": "module",
            "endpoint": {"host": "127.0.0.1", "port": 502},
            "unit_id": 1,
            "sampling_rate": RATE,
            "registers": registers,
        },
        source=Path("module.yaml"),
    )


class ModuleLink:
    """A link to a module without commands: it applies what is written to its first register."""

    def __init__(self, device, volts):
        self.device = device
        self.count = int(to_counts(device["output"], volts))
        self.written = []
        self.check = self.on_connect = None

    def read(self, address, count, table):
        return [self.count] * count

    def write(self, address, words, *, retry=True):
        assert (address, len(words)) == (0, 1)
        (self.count,) = words
        self.written.append(self.count)

    def close(self):
        pass


def volts(device, counts):
    return to_physical(device["output"], np.asarray(counts))


@pytest.mark.parametrize("start", [6.0, 1.3, 0.0])
@pytest.mark.parametrize("case", ["echo", "output read back", "no read-back"])
def test_the_way_to_zero_begins_where_the_output_is(case, start):
    output = OUTPUT | ({"access": "write"} if case != "output read back" else {})
    registers = {"output": output} | ({"applied_output": ECHO} if case == "echo" else {})
    link = ModuleLink(device(**registers), start)
    safe = SafeOutput(link, ramp_rate=RAMP_RATE)
    if case == "no read-back":
        safe.panel.last_output = link.count
    safe.to_zero()
    path = volts(link.device, [int(to_counts(link.device["output"], start)), *link.written])
    assert path[-1] == 0.0
    steps = -np.diff(path)
    assert (steps >= 0.0).all()
    assert (steps <= STEP + COUNT).all()


def test_the_way_to_zero_ends_at_once_where_nothing_was_ever_asked_for():
    link = ModuleLink(device(output=OUTPUT | {"access": "write"}), 0.0)
    SafeOutput(link, ramp_rate=RAMP_RATE).to_zero()
    assert link.written == [0]


@pytest.mark.parametrize(("first", "last"), [(3.0, 8.0), (9.0, 0.5), (0.0, 0.0)])
def test_an_excitation_is_reached_from_zero_and_left_to_zero(first, last):
    module = device(output=OUTPUT)
    excitation = np.array([first, 5.0, last])
    plan = plan_sequence(module, excitation, RAMP_RATE)
    played = volts(module, plan.counts)
    inside = slice(plan.lead, plan.lead + plan.length)
    np.testing.assert_allclose(played[inside], excitation, atol=COUNT)
    assert played[-1] == 0.0
    lead = np.diff([0.0, *played[: plan.lead + 1]])
    tail = -np.diff(played[plan.lead + plan.length - 1 :])
    for steps in (lead, tail):
        assert (steps >= 0.0).all()
        assert (steps <= STEP + COUNT).all()
    assert plan.lead == max(round(first / STEP) - 1, 0)
