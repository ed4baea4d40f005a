"""The host's ramps begin at the voltage asked for last, end at the target and keep the rate."""

from pathlib import Path

import numpy as np
import pytest
from memory_link import Clock

from dea.acquisition.output import Output
from dea.acquisition.retrying_link import DeviceRefusedError, LinkError
from dea.acquisition.voltage_plan import plan_sequence
from dea.acquisition.zero import LONGEST_STEP, WayToZero
from dea.modbus import parse_device, to_physical

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
            "quarantine": 0.3,
            "registers": registers,
        },
        source=Path("module.yaml"),
    )


class ModuleLink:
    """A link to a module that applies what is written; ``fails`` says with what, and when."""

    def __init__(self, device, clock, *, reads=1.0, takes=0.001, fails=lambda now: None):
        self.device, self.clock, self.reads, self.takes = device, clock, reads, takes
        self.fails, self.count, self.written = fails, 0, []
        self.check = self.on_connect = None

    def read(self, address, count, table):
        return [round(self.reads * self.count)] * count

    def write(self, address, words, table="holding", *, retry=True):
        self.clock.sleep(self.takes)
        if (failure := self.fails(self.clock.now)) is not None:
            raise failure
        (self.count,) = words
        self.written.append((self.clock.now, self.count))

    def close(self):
        pass


@pytest.fixture
def clock(monkeypatch):
    made = Clock()
    monkeypatch.setattr("dea.acquisition.zero.time", made)
    return made


def volts(device, counts):
    return to_physical(device["output"], np.asarray(counts))


def to_zero(link, start):
    """Take the output to zero as often as it takes."""
    way = WayToZero(Output(link), ramp_rate=RAMP_RATE, requested=start)
    for _ in range(10_000):
        try:
            return way()
        except (LinkError, DeviceRefusedError):
            link.clock.sleep(0.02)
    raise AssertionError("it never arrives")


def steps(link, start):
    """Seconds and volts between writes, from ``start`` on; the first write is at time 0."""
    times, counts = np.array(link.written).T
    path = np.append(start, volts(link.device, counts))
    assert path[-1] == 0.0
    return np.diff(times, prepend=0.0), -np.diff(path)


CASES = {
    "echo": {"output": OUTPUT | {"access": "write"}, "applied_output": ECHO},
    "output read back": {"output": OUTPUT},
    "no read-back": {"output": OUTPUT | {"access": "write"}},
}


@pytest.mark.parametrize("start", [6.0, 1.0, 0.0])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("takes", [0.001, 0.03, 0.7])
def test_the_way_to_zero_begins_where_the_output_is(clock, case, start, takes):
    link = ModuleLink(device(**CASES[case]), clock, takes=takes)
    to_zero(link, start)
    passed, fallen = steps(link, start)
    assert (fallen >= 0.0).all()
    assert (fallen <= RAMP_RATE * passed + COUNT).all(), "faster in time than its rate"
    assert (fallen <= RAMP_RATE * LONGEST_STEP + COUNT).all()


@pytest.mark.parametrize("reads", [0.001, 0.0], ids=["in kilovolts", "stuck at zero"])
def test_the_ramp_begins_at_what_was_asked_for_whatever_is_read(clock, reads):
    link = ModuleLink(device(**CASES["echo"]), clock, reads=reads)
    to_zero(link, 6.0)
    passed, fallen = steps(link, 6.0)
    assert (fallen <= RAMP_RATE * passed + COUNT).all()
    assert len(link.written) >= 6.0 / STEP - 2


@pytest.mark.parametrize(
    "failure", [LinkError("gone"), *(DeviceRefusedError(code, 6) for code in (4, 5, 6, 11))]
)
def test_a_ramp_that_fails_for_a_while_is_continued_where_it_was(clock, failure):
    link = ModuleLink(
        device(**CASES["no read-back"]), clock,
        fails=lambda now: failure if 0.05 < now < 15.0 else None,
    )  # fmt: skip
    to_zero(link, 6.0)
    passed, fallen = steps(link, 6.0)
    assert clock.now > 15.0
    assert (fallen <= RAMP_RATE * LONGEST_STEP + COUNT).all(), "it jumped after the pause"
    assert (fallen <= RAMP_RATE * passed + COUNT).all()


@pytest.mark.parametrize("case", ["echo", "no read-back"])
def test_a_write_that_a_gateway_held_back_is_undone(clock, case):
    link = ModuleLink(device(**CASES[case]), clock)
    held = iter([9000])

    def late(now):
        """The gateway carries it out now, while another request passes."""
        if now > 0.15 and (count := next(held, None)):
            link.count = count
            link.written.append((now, count))
            raise LinkError("no reply")

    link.fails = late
    to_zero(link, 0.0)
    assert 9000 in [count for _, count in link.written]
    assert link.count == 0
    if case == "echo":  # where it is seen, the quarantine begins anew
        redriven = next(now for now, count in link.written if count == 9000)
        assert clock.now >= redriven + link.device.quarantine


def test_the_way_to_zero_ends_at_once_where_nothing_was_ever_asked_for(clock):
    link = ModuleLink(device(**CASES["no read-back"]), clock)
    to_zero(link, 0.0)
    assert {count for _, count in link.written} == {0}
    assert clock.now == pytest.approx(link.device.quarantine, abs=0.2)


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
    for step in (lead, tail):
        assert (step >= 0.0).all()
        assert (step <= STEP + COUNT).all()
    assert plan.lead == max(round(first / STEP) - 1, 0)
