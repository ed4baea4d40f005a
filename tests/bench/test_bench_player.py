"""The device in time: any requests in any order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from dea.bench.player import OutputLimits, Player
from dea.modbus import DeviceState, Origin
from served_bench import RememberingPlant

LOW, HIGH = 0, 1000
COUNTS = st.lists(st.integers(0, 65535), min_size=1, max_size=55)


def player(**options):
    return Player(
        RememberingPlant(), OutputLimits(LOW, HIGH, zero=0, ramp_step=100),
        **{"fifo_length": 120, "ring_length": 300, "watchdog_time": 1.0} | options,
    )  # fmt: skip


class AnyUse(RuleBasedStateMachine):
    """Any order of commands, samples and silences."""

    def __init__(self):
        super().__init__()
        self.player, self.now = player(), 0.0
        self.fed, self.blocks = [], 0

    @rule(counts=COUNTS, skip=st.integers(-1, 2))
    def feed(self, counts, skip):
        sequence = self.player.sequence + skip
        waiting = self.player.fifo_level
        accepted = self.player.load(sequence, counts)
        appended = self.player.fifo_level - waiting
        if skip == 1 and accepted:
            assert appended == len(counts)
            self.fed += counts
        else:
            assert appended == 0

    @rule()
    def start(self):
        allowed = self.player.state == DeviceState.IDLE and not self.player.watchdog.latched
        allowed &= self.player.applied == 0
        already = self.player.state == DeviceState.RUNNING
        assert self.player.start() == (allowed or already)

    @rule()
    def stop(self):
        self.player.stop()

    @rule()
    def reset(self):
        self.player.reset()

    @rule()
    def clear(self):
        self.player.clear()
        self.fed = []

    @rule(count=st.integers(0, 65535))
    def hold(self, count):
        self.player.hold(count)

    @rule(samples=st.integers(0, 90))
    def pass_time(self, samples):
        self.player.advance(samples)

    @rule()
    def drain(self):
        self.player.drain()

    @rule()
    def speak(self):
        self.player.watchdog.heard(self.now)

    @rule(seconds=st.floats(0.0, 2.0))
    def be_silent(self, seconds):
        self.now += seconds
        silent = self.now - self.player.watchdog.last_heard > self.player.watchdog.timeout
        driven = self.player.driven or self.player.state != DeviceState.IDLE
        self.player.watch(self.now)
        if silent and driven:
            assert self.player.applied == 0
            assert self.player.watchdog.latched
            assert self.player.fifo_level == 0

    @invariant()
    def the_output_stays_within_its_limits(self):
        assert all(LOW <= count <= HIGH for count in self.player.plant.applied[-200:])

    @invariant()
    def the_ring_holds_what_was_measured(self):
        plant = self.player.plant
        assert self.player.ring.end == len(plant.applied)
        place = max(0, self.player.ring.end - self.player.ring.length)
        while place < self.player.ring.end:
            run = self.player.ring.run(place, 55)
            end = place + run.applied.size
            assert run.index == place
            assert run.applied.tolist() == plant.applied[place:end]
            assert run.displacement.tolist() == plant.displacement[place:end]
            place = end

    @invariant()
    def a_trip_is_latched(self):
        assert (self.player.state == DeviceState.TRIPPED) <= self.player.watchdog.latched


TestAnyUse = AnyUse.TestCase
TestAnyUse.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)


@given(st.lists(COUNTS, min_size=1, max_size=8), st.lists(st.integers(0, 3), max_size=8))
@settings(deadline=None, max_examples=50)
def test_every_block_is_played_once_and_in_order(blocks, repeats):
    device = player(fifo_length=10_000, ring_length=10_000)
    device.start()
    for number, block in enumerate(blocks, start=1):
        for _ in range(1 + (repeats[number - 1] if number <= len(repeats) else 0)):
            assert device.load(number, block)
        device.drain()
    wanted = np.clip(np.concatenate(blocks), LOW, HIGH)
    assert device.plant.applied == wanted.tolist()
    assert device.clamped == np.count_nonzero(np.concatenate(blocks) > HIGH)
    run = device.ring.run(0, wanted.size)
    assert run.origin == Origin.PLAYED
    assert run.position == 0
    assert run.applied.size == wanted.size


def test_an_empty_fifo_holds_the_output_and_says_so():
    device = player()
    device.start()
    device.load(1, [5, 6])
    device.advance(5)
    assert device.plant.applied == [5, 6, 6, 6, 6]
    assert device.underruns == 3
    assert [device.ring.run(k, 9).origin for k in (0, 2)] == [Origin.PLAYED, Origin.HELD]
    assert device.ring.run(0, 9).applied.tolist() == [5, 6]


def test_stop_ramps_down_in_steps():
    device = player()
    device.start()
    device.load(1, [350])
    device.drain()
    device.stop()
    assert device.state == DeviceState.RAMPING
    device.drain()
    assert device.plant.applied == [350, 250, 150, 50, 0, 0]
    assert device.state == DeviceState.IDLE


@pytest.mark.parametrize("length", [300, 400, 1000])
def test_samples_overwritten_before_they_are_read_are_counted(length):
    device = player(fifo_length=2000)
    device.start()
    device.load(1, [1] * length)
    device.drain()
    assert device.overruns == length - 300
    assert device.ring.run(0, 50).index == length - 300


def test_what_was_measured_before_the_start_is_missed_by_nobody():
    device = player(fifo_length=2000)
    device.advance(1000)
    device.start()
    device.load(1, [1] * 350)
    device.drain()
    assert device.overruns == 50


def test_start_is_refused_after_a_trip_until_reset():
    device = player()
    device.start()
    device.load(1, [500])
    device.drain()
    device.watch(now=1.5)
    assert device.applied == 0
    assert device.watchdog.trips == 1
    assert not device.start()
    assert device.reset()
    assert device.start()
