import numpy as np
import pytest

from dea.errors import InputError
from dea.store.resampling import resample, usual_interval


def straight(time):
    """Signals that linear interpolation gives back exactly."""
    return 2.0 * time + 1.0, 3.0 - time


def test_jitter_is_interpolated_away():
    rng = np.random.default_rng(1)
    time = 0.1 * np.arange(200) + rng.uniform(-0.02, 0.02, 200)
    u, y = straight(time)
    found = resample(time, u, y, 0.1)
    expected = straight(found.time + time[0])
    np.testing.assert_allclose(found.time, 0.1 * np.arange(found.time.size), atol=1e-12)
    np.testing.assert_allclose(found.u[:-1], expected[0][:-1])
    np.testing.assert_allclose(found.y[:-1], expected[1][:-1])
    assert not found.missing.any()


def test_a_gap_and_a_missing_value_are_flagged_and_nothing_else():
    time = 0.5 * np.arange(100)
    u, y = straight(time)
    y[70] = np.nan
    kept = np.r_[0:20, 30:100]
    found = resample(time[kept], u[kept], y[kept], 0.5)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), [*range(20, 30), 70])
    np.testing.assert_array_equal(np.isnan(found.y), found.missing)
    there = ~found.missing
    np.testing.assert_allclose(found.y[there], straight(time)[1][there])


def test_close_samples_are_averaged():
    time = 0.001 * np.arange(1000)
    u, y = np.random.default_rng(2).normal(size=(2, 1000))
    found = resample(time, u, y, 0.01)
    np.testing.assert_allclose(found.u, [u[i : i + 10].mean() for i in range(0, 1000, 10)])
    np.testing.assert_allclose(found.y, [y[i : i + 10].mean() for i in range(0, 1000, 10)])
    np.testing.assert_allclose(found.time, 0.01 * np.arange(100), atol=1e-12)


@pytest.mark.parametrize("interval", [0.02, 1 / 610.35, 3.0])
def test_the_usual_interval_survives_jitter_and_gaps(interval):
    rng = np.random.default_rng(3)
    time = interval * (np.arange(500) + rng.uniform(-0.1, 0.1, 500))
    kept = np.delete(time, [*range(40, 60), 200, 203])
    assert usual_interval(kept) == pytest.approx(interval, rel=2e-4)


def test_times_that_fall_back_are_refused():
    with pytest.raises(InputError, match="sample 3 is at 1 s, the one before it at 2 s"):
        resample(np.array([0.0, 1.0, 2.0, 1.0, 3.0]), np.arange(5.0), np.arange(5.0), 1.0)
