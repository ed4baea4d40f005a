import time
from dataclasses import replace

import numpy as np
import pytest

from dea.acquisition import (
    AcquisitionSettings,
    BrokenRecordError,
    Link,
    LinkError,
    Quality,
    acquire,
)

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


def test_the_samples_behind_their_deadline_are_flagged_and_no_others(serve_bench, tmp_path):
    bench = serve_bench(virtual_clock=False, sampling_rate=10.0)
    delays = iter([0.0, 0.3])

    def watch(samples, log):
        time.sleep(next(delays, 0.0))

    volts = np.full(20, 2.4)
    settings = replace(POLLED, late_after=0.1)
    result = acquire(bench.endpoint, volts, tmp_path / "a.partial", settings, watch=watch)
    # At 50 V/s no ramp sample precedes the excitation.
    late = result.link.jitter.values[: volts.size] > settings.late_after
    flagged = (result.record.quality.values & Quality.LATE) != 0
    assert 0 < late.sum() < volts.size
    assert np.array_equal(flagged, late)


@pytest.mark.parametrize("read_write_multiple", [True, False])
def test_a_polled_write_without_a_reply_is_not_repeated(
    serve_bench, tmp_path, monkeypatch, read_write_multiple
):
    bench = serve_bench()
    device = replace(bench.endpoint, read_write_multiple=read_write_multiple)
    attempt, written = Link._attempt, []

    def lose_a_reply(link, request):
        words = getattr(request, "write_registers", None) or request.registers
        address = getattr(request, "write_address", request.address)
        if words and address == device["output"].address and link.check is not None:
            written.append(words[0])
            if len(written) == 5:
                raise LinkError("no reply")
        return attempt(link, request)

    monkeypatch.setattr(Link, "_attempt", lose_a_reply)
    counts = np.arange(10) + 5000
    volts = device["output"].offset + device["output"].scale * counts
    settings = replace(POLLED, paced=False, ramp_rate=100.0)  # which needs no sample of ramp
    with pytest.raises(BrokenRecordError, match="samples 4 to 4: never driven or read"):
        acquire(device, volts, tmp_path / "a.partial", settings)
    assert written == counts[:5].tolist()
