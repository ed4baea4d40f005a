"""What counts as zero, and the way there: from the voltage asked for last, at its rate."""

import numpy as np
import pytest
from made_device import ECHO, STEP, described, module
from memory_link import MemoryLink

from dea.acquisition import LinkError, ZeroNotVerifiedError
from dea.acquisition.output import Output
from dea.acquisition.retrying_link import DeviceRefusedError
from dea.acquisition.zero import LONGEST_STEP, READINGS, WayToZero, ZeroEvidence
from dea.errors import InputError
from dea.modbus import Command, DeviceState, to_physical


def way(link, ramp_rate=1.0, requested=0.0):
    return WayToZero(Output(link), ramp_rate=ramp_rate, requested=requested)


@pytest.mark.parametrize("counts", [-1, 0, 1])
def test_one_count_is_zero_to_the_read_back(clock, counts):
    link = MemoryLink(module(applied_output=ECHO), applied_output=counts)
    Output(link).take()
    assert way(link)() == ZeroEvidence.READ_BACK
    assert link.written[-1] == ("output", [0])


@pytest.mark.parametrize("counts", [-5000, -2, 2, 5000])
def test_more_than_one_count_is_driven(clock, counts):
    link = MemoryLink(module(applied_output=ECHO), applied_output=counts)
    with pytest.raises(InputError, match=f"the output is not zero: {STEP * counts:g} V"):
        Output(link).take()
    assert link.written == []
    with pytest.raises(ZeroNotVerifiedError, match=f"the output reads {STEP * counts:g} V after"):
        way(link)()


LATCH = {"applied_output": ECHO, "watchdog_latched": {"address": 5}}
RESETTABLE = LATCH | {"state": {"address": 2}, "command": {"address": 3, "access": "read_write"}}


def test_a_latch_that_no_register_resets_is_refused():
    link = MemoryLink(module(**LATCH), applied_output=0, watchdog_latched=1)
    with pytest.raises(InputError, match="latched") as caught:
        Output(link, reset=True).take()
    assert caught.value.field == "registers.command"
    assert link.written == []


@pytest.mark.parametrize("before", [0, 3000])
def test_a_device_that_is_driven_when_its_latch_is_reset_is_refused(before):
    """One whose output comes back with the reset, too."""
    reset = ("command", [Command.RESET])
    link = MemoryLink(
        module(**RESETTABLE), state=DeviceState.TRIPPED, watchdog_latched=1,
        applied_output=lambda: 3000 if reset in link.written else before,
    )  # fmt: skip
    with pytest.raises(InputError, match="the output is not zero: 3 V"):
        Output(link, reset=True).take()
    assert (reset in link.written) == (before == 0)


def test_a_read_back_of_floats_shows_zero_and_no_number_does_not(clock):
    echo = {"address": 10, "type": "float32", "unit": "V", "tolerance": 0.01}
    link = MemoryLink(module(applied_output=echo), applied_output=0.005)
    output = Output(link)
    output.take()
    assert output.driven() == 0.0
    link.values["applied_output"] = 0.5
    assert output.driven() == pytest.approx(0.5)
    link.values["applied_output"] = np.nan
    with pytest.raises(LinkError, match="reads differently"):
        WayToZero(output, ramp_rate=1.0, requested=0.0)()


def test_the_way_to_zero_takes_its_time(clock):
    link = MemoryLink(module(), output=0)
    assert way(link, 2.0, requested=4.0)() == ZeroEvidence.ANSWERED
    # 4 V at 2 V/s; the last step needs no pause after it.
    assert clock.now == pytest.approx(2.0, abs=0.021)


@pytest.mark.parametrize(("seconds", "ends"), [(0.0, True), (9.0, True), (np.inf, False)])
def test_a_ramp_of_the_device_is_waited_for_twice_as_long_as_it_may_take(clock, seconds, ends):
    """Its limits are 10 V from zero at most, and its rate is 2 V/s."""
    device = module(applied_output=ECHO, state={"address": 2}, command={"address": 3})
    link = MemoryLink(device, applied_output=0, state=lambda: 1 if clock.now < seconds else 0)
    if ends:
        way(link, 2.0)()
        assert clock.now == pytest.approx(seconds, abs=0.1)
    else:
        with pytest.raises(ZeroNotVerifiedError, match="does not end its ramp"):
            way(link, 2.0)()
        assert 10.0 < clock.now < 15.0
    assert link.written == [("command", [Command.STOP])]


def test_a_tripped_device_is_at_zero_already(clock):
    device = module(applied_output=ECHO, state={"address": 2}, command={"address": 3})
    link = MemoryLink(device, applied_output=0, state=3)
    way(link, 2.0)()
    assert link.written == []


RATE, RAMP_RATE = 200.0, 40.0  # Hz, V/s
COUNT = 15.0 / 65535  # V
SPANNED = {"address": 0, "access": "read_write", "range": [0, 15], "limits": [0, 10], "unit": "V"}
SPANNED_ECHO = {"address": 1, "range": [0, 15], "unit": "V"}


def device(**registers):
    return described(registers, sampling_rate=RATE, quarantine=0.3)


class ModuleLink:
    """A link to a module that applies what is written; ``fails`` says with what, and when."""

    def __init__(self, device, clock, *, reads=1.0, takes=0.001, fails=lambda now: None):
        self.device, self.clock, self.reads, self.takes = device, clock, reads, takes
        self.fails, self.count, self.written = fails, 0, []
        self.check = self.on_connect = None
        self.silent = 0  # readings that are not answered

    def read(self, address, count, table):
        if self.silent:
            self.silent -= 1
            raise LinkError("no reply")
        return [round(self.reads * self.count)] * count

    def write(self, address, words, table="holding", *, retry=True):
        self.clock.sleep(self.takes)
        if (failure := self.fails(self.clock.now)) is not None:
            raise failure
        (self.count,) = words
        self.written.append((self.clock.now, self.count))

    def rest(self, seconds):
        self.clock.sleep(seconds)

    def close(self):
        pass


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
    path = np.append(start, to_physical(link.device["output"], counts))
    assert path[-1] == 0.0
    return np.diff(times, prepend=0.0), -np.diff(path)


CASES = {
    "echo": {"output": SPANNED | {"access": "write"}, "applied_output": SPANNED_ECHO},
    "output read back": {"output": SPANNED},
    "no read-back": {"output": SPANNED | {"access": "write"}},
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


@pytest.mark.parametrize("silent", [0, 1, READINGS - 1])
def test_where_nobody_knows_the_ramp_begins_at_the_first_reading_that_is_answered(clock, silent):
    link = ModuleLink(device(**CASES["echo"]), clock)
    link.count, link.silent = round(6.0 / COUNT), silent
    to_zero(link, None)
    passed, fallen = steps(link, 6.0)
    assert (fallen[1:] <= RAMP_RATE * passed[1:] + COUNT).all()
    assert fallen[0] <= RAMP_RATE * LONGEST_STEP + COUNT
    assert len(link.written) >= 6.0 * RATE / RAMP_RATE - 2


def test_an_output_that_cannot_be_read_is_taken_to_zero_all_the_same(clock):
    link = ModuleLink(device(**CASES["echo"]), clock)
    link.count, link.silent = round(6.0 / COUNT), 10**9
    way = WayToZero(Output(link), ramp_rate=RAMP_RATE, requested=None)
    for _ in range(READINGS - 1):
        with pytest.raises(LinkError):
            way()
        assert not link.written
    with pytest.raises(LinkError):  # nothing shows that it is there
        way()
    assert link.count == 0


def test_a_network_that_comes_back_late_is_asked_for_the_reading_first(clock):
    link = ModuleLink(device(**CASES["echo"]), clock)
    link.count, link.silent = round(6.0 / COUNT), 3 * READINGS
    link.fails = lambda _: LinkError("gone") if link.silent else None
    to_zero(link, None)
    _, fallen = steps(link, 6.0)
    assert (fallen <= RAMP_RATE * LONGEST_STEP + COUNT).all()


@pytest.mark.parametrize("reads", [0.001, 0.0], ids=["in kilovolts", "stuck at zero"])
def test_the_ramp_begins_at_what_was_asked_for_whatever_is_read(clock, reads):
    link = ModuleLink(device(**CASES["echo"]), clock, reads=reads)
    to_zero(link, 6.0)
    passed, fallen = steps(link, 6.0)
    assert (fallen <= RAMP_RATE * passed + COUNT).all()
    assert len(link.written) >= 6.0 * RATE / RAMP_RATE - 2


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


def test_an_output_that_stays_driven_ends_the_attempt_and_not_the_quarantine_alone(clock):
    link = ModuleLink(device(**CASES["echo"]), clock)
    link.read = lambda address, count, table: [9000] * count
    way = WayToZero(Output(link), ramp_rate=RAMP_RATE, requested=0.0)
    with pytest.raises(ZeroNotVerifiedError, match="though zero is written again and again"):
        way()
    assert clock.now < 4.0 * link.device.quarantine


@pytest.mark.parametrize(("reads", "shown"), [(0, True), (9000, False)])
def test_a_read_back_that_has_disagreed_may_have_been_right(clock, reads, shown):
    """A device that acknowledges every write and holds its output looks the same."""
    link = ModuleLink(device(**CASES["echo"]), clock)
    link.read = lambda address, count, table: [reads] * count
    output = Output(link)
    output.trusted = False
    way = WayToZero(output, ramp_rate=RAMP_RATE, requested=3.0)
    if shown:
        assert way() == ZeroEvidence.UNTRUSTED
    else:
        with pytest.raises(ZeroNotVerifiedError, match="which has disagreed"):
            way()
        assert link.written[-1][1] == 0


def test_a_sign_of_life_that_is_not_answered_does_not_keep_the_output_up(clock):
    """Its time-outs together last longer than its period."""
    alive = {"address": 4, "access": "write"}
    safety = {"heartbeat": {"name": "alive", "period": 0.5}}
    target = described({"output": SPANNED | {"access": "write"}, "alive": alive}, safety=safety)
    link = ModuleLink(target, clock)
    plain = link.write

    def write(address, words, table="holding", *, retry=True):
        if address == 4:
            clock.sleep(2.0)
            raise LinkError("no reply")
        plain(address, words, table, retry=retry)

    link.write = write
    WayToZero(Output(link), ramp_rate=RAMP_RATE, requested=3.0)()
    assert link.written[-1][1] == 0
    assert clock.now < 10.0
