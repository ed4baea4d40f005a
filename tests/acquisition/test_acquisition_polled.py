from dataclasses import replace

import numpy as np
import pytest
from made_device import described
from memory_link import Clock

from dea.acquisition import (
    AcquisitionSettings,
    BrokenRecordError,
    LinkError,
    Quality,
    ReadBackError,
    acquire,
)
from dea.acquisition.laws import Laws, TripError
from dea.acquisition.link_log import LinkLog
from dea.acquisition.panel import Panel
from dea.acquisition.polled import drive
from dea.acquisition.voltage_plan import Planned
from dea.configuration.safety import Safety

POLLED = AcquisitionSettings(mode="polled", ramp_rate=50.0, timeout=0.5, reconnect_time=1.0)
PERIOD = 0.02  # s


@pytest.mark.parametrize("read_write_multiple", [True, False])
@pytest.mark.parametrize("virtual_clock", [True, False])
def test_every_sample_is_in_its_place(serve_bench, tmp_path, read_write_multiple, virtual_clock):
    # Slow at wall time, so that a busy machine is no cause for a late sample.
    rate = 50.0 if virtual_clock else 10.0
    bench = serve_bench(virtual_clock=virtual_clock, sampling_rate=rate)
    volts = 2.4 + 1.2 * np.sin(np.arange(300 if virtual_clock else 12) * 0.1)
    device = replace(bench.endpoint, read_write_multiple=read_write_multiple)
    settings = replace(POLLED, paced=not virtual_clock)
    result = acquire(device, volts, tmp_path / "a.partial", settings)
    index = result.record.device_index.values
    assert np.array_equal(np.diff(index), np.ones(index.size - 1))
    assert np.array_equal(result.record.voltage_counts, np.rint(volts / 15 * 65535))
    assert np.array_equal(result.record.voltage_counts, bench.applied[index])
    assert np.array_equal(result.record.displacement_counts, bench.displacement[index])
    assert bench.applied[-1] == 0
    assert (result.link.sizes["polled_sample"] > 0) == (not virtual_clock)


class Module:
    """A link to a plain module: its displacement counts the writes; ``holds`` holds one up."""

    def __init__(
        self, clock, *, holds=None, loses=None, reads=1.0, index=False, jumps=None, output=None,
        suspends=None,
    ):  # fmt: skip
        registers = {
            "output": {"address": 0, "range": [0, 10], "limits": [0, 4], "unit": "V",
                       "access": "read_write"} | (output or {}),
            "displacement": {"address": 5, "unit": "mm"},
        } | ({"device_index": {"address": 6}} if index else {})  # fmt: skip
        self.device = described(registers, sampling_rate=1 / PERIOD)
        self.clock, self.holds, self.loses, self.reads = clock, holds or {}, loses, reads
        self.log, self.check, self.written, self.settings = LinkLog(), None, [], POLLED
        self.suspends = suspends or {}  # s for which the computer sleeps after a write
        self.jumps = jumps or {}  # samples that the device has measured by itself before a write

    def write(self, address, words, table="holding", *, retry=True):
        assert not retry, "a polled write must not be repeated"
        self.clock.sleep(self.holds.get(len(self.written), 0.0))
        self.written.append((self.clock.now, *words))
        self.clock.suspended += self.suspends.get(len(self.written), 0.0)
        if len(self.written) == self.loses:
            raise LinkError("no reply")

    def read(self, address, count, table):
        number = len(self.written)
        self.log.samples.append(0)
        written = self.written[-1][1] if self.written else 0
        more = sum(count for before, count in self.jumps.items() if before < number)
        values = {0: round(self.reads * written), 5: number, 6: number + 70 + more}
        return [values.get(place, 0) for place in range(address, address + count)]

    def rest(self, seconds):
        self.clock.sleep(seconds)


@pytest.fixture
def clock(monkeypatch):
    made = Clock()
    for module in ("polled", "schedule", "rows"):
        monkeypatch.setattr(f"dea.acquisition.{module}.time", made)
    return made


def driven(module, counts, late_after=0.005):
    """Drive; return what was yielded, and the failure if there was one."""
    blocks, failure = [], None
    try:
        panel = Panel(module)
        sequence = Planned(counts, panel.zero)
        blocks += drive(panel, sequence, Laws(panel), late_after=late_after, tolerance=0.05)
    except (BrokenRecordError, ReadBackError) as error:
        failure = error
    return [np.concatenate(column) for column in zip(*blocks, strict=True)], failure


COUNTS = np.append(np.arange(0, 5001, 100), 5000 + 40 * np.arange(50))
LARGEST_STEP = 100


def test_a_computer_that_was_suspended_ends_the_drive(clock):
    """The device held its output meanwhile: what it measured is in nobody's record."""
    module = Module(clock, suspends={30: 600.0})
    _, failure = driven(module, COUNTS)
    assert isinstance(failure, BrokenRecordError)
    assert "held up for 600.0 s" in str(failure)
    assert len(module.written) == 30


def test_a_sample_that_is_written_late_is_flagged_and_the_one_behind_its_deadline(clock):
    module = Module(clock, holds={9: 0.03})  # which makes sample 10 late by half a period
    (_, _, requested, _, _, quality, *_), failure = driven(module, COUNTS)
    assert failure is None
    assert np.flatnonzero(quality).tolist() == [9, 10]
    assert (quality[9:11] == Quality.LATE).all()
    assert np.array_equal(requested, COUNTS)


def test_samples_whose_time_has_passed_are_left_out_and_never_sent_in_a_burst(clock):
    module = Module(clock, holds={9: 0.15})
    (position, index, requested, _, _, quality, *_), failure = driven(module, COUNTS)
    assert failure is None
    lost = np.flatnonzero(quality & Quality.LOST)
    assert lost.tolist() == list(range(10, 16))
    behind = np.flatnonzero(quality == Quality.LATE)
    assert behind[:2].tolist() == [9, 16]
    assert np.array_equal(position, np.arange(COUNTS.size))
    assert np.array_equal(index, position)
    assert np.array_equal(requested, COUNTS)
    written = np.array(module.written)
    assert np.array_equal(written[-20:, 1], COUNTS[-20:])
    assert np.diff(written[:, 0]).min() > 0.24 * PERIOD
    assert np.diff(written[:, 1]).max() <= LARGEST_STEP


@pytest.mark.parametrize("index", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_held_up_writes_exceed_the_rate_in_time_by_three_periods_at_most(clock, seed, index):
    rng = np.random.default_rng(seed)
    holds = zip(rng.choice(60, 12, replace=False), rng.uniform(0, 8 * PERIOD, 12), strict=True)
    module = Module(clock, holds=dict(holds), index=index)
    _, failure = driven(module, LARGEST_STEP * np.arange(100))
    assert failure is None
    times, counts = np.array(module.written).T
    periods = (times[None, :] - times[:, None]) / PERIOD
    before = np.concatenate([[0], counts[:-1]])
    changes = counts[None, :] - before[:, None]
    later = periods >= 0
    assert (changes[later] <= LARGEST_STEP * (periods[later] + 3)).all()


def test_only_what_follows_samples_left_out_is_approached(clock):
    """The ramp to the start of a loop may be faster than what the loop may ask for."""
    module = Module(clock, holds={9: 0.03})  # late, by less than a period
    sequence = Planned(COUNTS, 0)
    sequence.longest_step = LARGEST_STEP // 10
    panel = Panel(module)
    blocks = list(drive(panel, sequence, Laws(panel), late_after=0.005, tolerance=0.05))
    assert [count for _, count in module.written] == COUNTS.tolist()
    quality = np.concatenate([block.quality for block in blocks])
    assert np.flatnonzero(quality).tolist() == [9, 10]


def test_a_device_that_counts_its_samples_gets_them_all_and_later(clock):
    module = Module(clock, holds={9: 0.15}, index=True)
    (position, index, _, _, _, quality, *_), failure = driven(module, COUNTS)
    assert failure is None
    assert np.array_equal(position, np.arange(COUNTS.size))
    assert np.array_equal(np.diff(index), np.ones(COUNTS.size - 1))
    assert np.flatnonzero(quality).tolist() == [10]
    assert np.diff([now for now, _ in module.written]).min() > 0.24 * PERIOD


def test_what_a_device_measured_by_itself_meanwhile_is_flagged_and_the_record_goes_on(clock):
    module = Module(clock, holds={9: 0.15}, index=True, jumps={10: 3})
    (position, index, requested, _, _, quality, *_), failure = driven(module, COUNTS)
    assert failure is None
    assert np.array_equal(np.diff(index), np.ones(COUNTS.size + 2))
    held = np.flatnonzero(quality == Quality.HELD | Quality.LOST)
    assert held.tolist() == [10, 11, 12]
    assert position[held].tolist() == [9, 9, 9]
    assert requested[held].tolist() == [COUNTS[9]] * 3
    assert np.array_equal(np.delete(requested, held), COUNTS)
    assert np.diff([volts for _, volts in module.written]).max() <= LARGEST_STEP


@pytest.mark.parametrize("jump", [51, -1])
def test_a_device_that_went_on_for_long_or_measured_nothing_ends_the_record(clock, jump):
    module = Module(clock, index=True, jumps={10: jump})
    _, failure = driven(module, COUNTS)
    assert isinstance(failure, BrokenRecordError)
    assert failure.first == 10
    said = "the device measured 51 more" if jump > 0 else "nothing new"
    assert said in str(failure)


@pytest.mark.parametrize(("paced", "most"), [(True, 1.0 / PERIOD), (False, 1)])
def test_an_index_that_jumps_far_stands_for_no_more_samples_than_may_be_missed(clock, paced, most):
    panel = Panel(Module(clock, index=True, jumps={10: 20000}))
    panel.link.log.started = 0.0
    sequence, laws = Planned(COUNTS, panel.zero), Laws(panel)
    with pytest.raises(BrokenRecordError, match="the device measured 20000 more") as caught:
        list(drive(panel, sequence, laws, late_after=0.005, tolerance=0.05, paced=paced))
    assert caught.value.count == caught.value.samples.position.size <= most


def test_a_long_hold_up_ends_the_record(clock):
    module = Module(clock, holds={9: 5.0})
    samples, failure = driven(module, COUNTS)
    assert "samples 10 to 10: held up for 5.0 s" in str(failure)
    assert samples[0].size == 10
    assert len(module.written) == 10


def test_what_was_measured_before_a_failure_is_kept(clock):
    samples, failure = driven(Module(clock, loses=6), COUNTS)
    assert "samples 5 to 5: never driven or read" in str(failure)
    assert samples[0].tolist() == list(range(5))


def test_the_sample_at_which_the_safety_model_trips_is_kept(clock):
    class Tripping(Laws):
        def check(self, low, high):
            if high > 0.3:
                raise TripError("the current is too large")

    module = Module(clock)
    module.device = replace(module.device, safety=Safety())
    panel, blocks = Panel(module), []
    sequence, laws = Planned(COUNTS, panel.zero), Tripping(panel)
    with pytest.raises(TripError):
        blocks += drive(panel, sequence, laws, late_after=0.005, tolerance=0.05)
    requested = np.concatenate([block.requested for block in blocks])
    assert requested.tolist() == [count for _, count in module.written]
    assert requested[-1] * 10 / 65535 > 0.3 >= requested[-2] * 10 / 65535


@pytest.mark.parametrize("reads", [0.001, 0.0], ids=["in kilovolts", "stuck at zero"])
def test_a_read_back_that_is_not_what_was_asked_for_ends_the_record(clock, reads):
    samples, failure = driven(Module(clock, reads=reads), COUNTS)
    assert isinstance(failure, ReadBackError)
    wrong = np.flatnonzero(samples[5] == Quality.CLAMPED)
    asked = samples[2] * 10 / 65535
    # The first may still be that of the sample before; the next three may not.
    assert wrong.tolist() == list(range(samples[0].size - 4, samples[0].size))
    assert 0.2 < asked[wrong[0]] < 0.25  # V, beyond 5 % of the span of the limits


def test_every_sample_has_the_times_of_its_write_and_its_reading(clock):
    module = Module(clock, holds={9: 0.012})
    module.log.started = 0.0
    samples, _ = driven(module, COUNTS)
    write_time, read_time = samples[6], samples[7]
    assert write_time == pytest.approx(PERIOD * (1 + np.arange(COUNTS.size)))
    assert read_time[9] - write_time[9] == pytest.approx(0.012)


def test_zero_volts_of_a_bipolar_module_is_where_the_approach_begins(clock):
    """Its count 0 is -10 V, and the first deadlines have passed."""
    module = Module(clock, holds={0: 0.15}, output={"range": [-10, 10], "limits": [0, 4]})
    zero = 32768
    counts = zero + np.append(np.arange(100, 5001, 100), np.full(30, 5000))
    panel = Panel(module)
    list(drive(panel, Planned(counts, zero), Laws(panel), late_after=0.005, tolerance=0.05))
    written = np.array([count for _, count in module.written])
    assert np.abs(np.diff(written, prepend=zero)).max() <= LARGEST_STEP
