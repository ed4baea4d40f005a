from dataclasses import replace

import numpy as np
import pytest
from memory_link import MemoryLink

from dea.acquisition import AcquisitionSettings, LinkSettings, Quality, ReadBackError, acquire
from dea.acquisition.buffered import Reply, _Playback
from dea.acquisition.laws import Laws
from dea.acquisition.panel import Panel
from dea.acquisition.read_back import Echo
from dea.acquisition.samples import BrokenRecordError
from dea.modbus import DeviceState, Origin, read_device
from served_bench import DESCRIPTION

FAST = AcquisitionSettings(ramp_rate=20.0, timeout=0.5, reconnect_time=2.0)


def sine(samples=700):
    return 2.4 + 1.2 * np.sin(np.arange(samples) * 0.1)


def assert_equals_what_was_measured(record, bench, volts):
    index = record.device_index.values
    assert np.array_equal(np.diff(index), np.ones(index.size - 1))
    assert index.size == volts.size
    assert np.array_equal(record.voltage_counts, bench.applied[index])
    assert np.array_equal(record.displacement_counts, bench.displacement[index])
    assert np.array_equal(record.voltage_counts, np.rint(volts / 15 * 65535))
    assert not record.quality.any()


@pytest.mark.parametrize("read_write_multiple", [True, False])
def test_every_sample_is_in_its_place(serve_bench, tmp_path, read_write_multiple):
    bench, volts = serve_bench(), sine()
    device = replace(bench.endpoint, read_write_multiple=read_write_multiple)
    record = acquire(device, volts, tmp_path / "a.partial", FAST).record
    assert_equals_what_was_measured(record, bench, volts)
    assert bench.applied[-1] == 0
    assert bench.device.owner == 0


def test_at_wall_time(serve_bench, tmp_path):
    bench, volts = serve_bench(virtual_clock=False, watchdog_time=1.0), sine(100)
    record = acquire(bench.endpoint, volts, tmp_path / "a.partial", FAST).record
    assert_equals_what_was_measured(record, bench, volts)
    assert bench.player.underruns == 0
    assert bench.applied[-1] == 0


def test_a_device_whose_fifo_is_full_hears_from_the_host_well_within_its_watchdog(
    serve_bench, tmp_path
):
    bench = serve_bench(virtual_clock=False, watchdog_time=1.0, fifo_length=170)
    link = acquire(bench.endpoint, sine(160), tmp_path / "a.partial", FAST).link
    silent = np.diff(link.send_time.values)
    assert silent.max() < 0.4
    assert silent.size < 200  # 3.5 s, and zero before and after; it is not asked without need


def moved(device, **addresses):
    registers = {
        name: replace(register, address=addresses.get(name, register.address))
        for name, register in device.registers.items()
    }
    return replace(device, registers=registers)


@pytest.mark.parametrize(("virtual_clock", "samples"), [(True, 700), (False, 700), (False, 100)])
def test_a_wrong_register_of_the_applied_output_is_told(
    serve_bench, tmp_path, virtual_clock, samples
):
    bench = serve_bench(virtual_clock=virtual_clock, sampling_rate=200.0)
    device = moved(bench.endpoint, applied_output=55)  # refused blocks: always zero
    with pytest.raises(ReadBackError, match=r"registers\.applied_output: it reads 0 V while"):
        acquire(device, sine(samples), tmp_path / "a.partial", FAST)
    assert bench.applied[-1] == 0


def test_an_output_that_stays_near_zero_cannot_be_told_from_a_wrong_register(serve_bench, tmp_path):
    bench, volts = serve_bench(), 0.05 * sine(200)
    device = moved(bench.endpoint, applied_output=55)
    record = acquire(device, volts, tmp_path / "a.partial", FAST).record
    assert record.sizes["time"] == 200


class Exchange:
    """The block registers of a device that has measured nothing yet."""

    capacity = 55

    def __init__(self, panel):
        pass

    def __call__(self, *asked):
        return answer(0, 0, Origin.REST, [])


def answer(index, position, origin, applied, state=DeviceState.RUNNING):
    values = np.array(applied, int)
    end = index + values.size
    return Reply(0, index, position, end, origin, state, 0, values, values)


def playing(monkeypatch, counts):
    """Return the progress of a sequence on a device that has measured nothing yet."""
    monkeypatch.setattr("dea.acquisition.buffered.BlockExchange", Exchange)
    link = MemoryLink(read_device(DESCRIPTION), fifo_length=512, watchdog_time=1.0, boot=7)
    link.settings = LinkSettings(reconnect_time=2.0)
    panel = Panel(link)
    return _Playback(panel, np.array(counts), Laws(panel), Echo(panel, "applied_output", 0.05))


def test_the_output_written_last_is_the_last_of_the_block_that_the_device_has_accepted(monkeypatch):
    """Its way to zero begins there if the device cannot be read any more."""
    playback = playing(monkeypatch, range(100, 170))
    accepted = []

    def exchange(sequence, block, index):
        accepted[:] = [sequence or accepted[0], *block]
        return replace(answer(0, 0, Origin.REST, []), sequence=accepted[0])

    exchange.capacity = Exchange.capacity
    playback.exchange = exchange
    written = []
    for _ in range(3):
        playback.feed()
        written.append(playback.panel.last_output)
    assert written == [154, 169, 169]


def test_an_output_that_is_not_the_one_asked_for_is_flagged_where_it_is_played(monkeypatch):
    playback = playing(monkeypatch, [10000, 10000, 20000])
    played = playback.collect(answer(0, 0, Origin.PLAYED, [10000, 4000]))
    assert played.quality.tolist() == [0, Quality.CLAMPED]
    held = playback.collect(answer(2, 2, Origin.HELD, [4000]))
    assert held.quality.tolist() == [Quality.HELD]


def test_an_empty_fifo_at_zero_volts_is_held_between_samples_that_are_played(monkeypatch):
    """Before the first, the device rests."""
    playback = playing(monkeypatch, [5, 0, 6])
    assert playback.collect(answer(0, 0, Origin.REST, [0, 0])) is None
    assert playback.collect(answer(2, 0, Origin.PLAYED, [5, 0])).quality.tolist() == [0, 0]
    held = playback.collect(answer(4, 2, Origin.REST, [0, 0, 0]))
    assert held.quality.tolist() == [Quality.HELD] * 3
    assert held.position.tolist() == [1] * 3
    assert held.device_index.tolist() == [4, 5, 6]
    last = playback.collect(answer(7, 2, Origin.PLAYED, [6]))
    assert (last.position.tolist(), last.quality.tolist()) == ([2], [0])


def test_a_device_that_is_stopped_at_zero_volts_ends_the_record(monkeypatch):
    playback = playing(monkeypatch, [5, 0, 6])
    playback.collect(answer(0, 0, Origin.PLAYED, [5, 0]))
    with pytest.raises(BrokenRecordError, match="took its output to zero") as caught:
        playback.collect(answer(2, 2, Origin.REST, [0, 0], DeviceState.IDLE))
    assert (caught.value.first, caught.value.count) == (2, 1)


def test_what_was_played_before_a_trip_is_kept_and_then_ends_the_record(monkeypatch):
    playback = playing(monkeypatch, [5, 0, 6])
    assert playback.collect(answer(0, 0, Origin.PLAYED, [])) is None
    kept = playback.collect(answer(0, 0, Origin.PLAYED, [5, 0], DeviceState.TRIPPED))
    assert (kept.position.tolist(), kept.quality.tolist()) == ([0, 1], [0, 0])
    with pytest.raises(BrokenRecordError, match="took its output to zero") as caught:
        playback.collect(answer(2, 2, Origin.PLAYED, [], DeviceState.TRIPPED))
    assert (caught.value.first, caught.value.count) == (2, 1)


def test_a_device_that_only_rests_after_its_start_stands_still(monkeypatch):
    playback = playing(monkeypatch, [5, 0, 6])
    playback.moved -= playback.panel.link.settings.reconnect_time + 1.0
    with pytest.raises(BrokenRecordError, match="stands still"):
        playback.collect(answer(0, 0, Origin.REST, [0, 0], DeviceState.IDLE))
