from dataclasses import replace

import numpy as np
import pytest

from dea.acquisition import AcquisitionSettings, acquire

POLLED = AcquisitionSettings(mode="polled", ramp_rate=50.0, timeout=0.5, reconnect_time=1.0)


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
