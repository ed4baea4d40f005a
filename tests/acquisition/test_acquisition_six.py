"""Six actuators at once, each on a connection of its own."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from dea.acquisition import AcquisitionSettings, Quality, acquire


def test_six_actuators_at_once_keep_their_samples_apart(serve_bench, tmp_path):
    benches = [serve_bench() for _ in range(6)]
    settings = AcquisitionSettings(ramp_rate=20.0)
    time = np.arange(2000) * 0.02

    def drive(number):
        volts = 2.4 + 1.2 * np.sin((0.5 + 0.1 * number) * 2 * np.pi * time)
        partial = tmp_path / f"dea{number}.partial"
        return volts, acquire(benches[number].endpoint, volts, partial, settings).record

    with ThreadPoolExecutor(6) as pool:
        results = list(pool.map(drive, range(6)))
    for bench, (volts, record) in zip(benches, results, strict=True):
        index = record.device_index.values
        assert np.array_equal(record.voltage_counts, np.rint(volts / 15 * 65535))
        assert np.array_equal(record.voltage_counts, bench.applied[index])
        assert np.array_equal(record.displacement_counts, bench.displacement[index])
        assert np.array_equal(np.diff(index), np.ones(index.size - 1))
        # The plant of this test measures any count, the ends of the converter's range among them.
        ends = np.isin(record.displacement_counts, [0, 65535])
        assert np.array_equal(record.quality, np.where(ends, Quality.SATURATED, Quality.GOOD))
        assert bench.applied[-1] == 0
