from dataclasses import replace

import numpy as np
import pytest

from dea.acquisition import AcquisitionSettings, ReadBackError, acquire

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
