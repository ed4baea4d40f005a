import numpy as np
import pytest

from dea.errors import InputError
from dea.store.resampling import resample, rounding, usual_interval


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
    with pytest.raises(InputError, match="sample 2 is at 1 s, the one before it at 1 s"):
        resample(np.array([0.0, 1.0, 1.0, 2.0, 3.0]), np.arange(5.0), np.arange(5.0), 1.0)


def test_times_since_1970_are_told_in_all_their_digits():
    time = 1_700_000_000.0 + np.array([0.0, 1.0, 1.0, 2.0])
    with pytest.raises(InputError, match="sample 2 is at 1700000001 s, the one before it at 17000"):
        resample(time, np.arange(4.0), np.arange(4.0), 1.0)


def test_fewer_than_three_whole_samples_are_refused():
    time = np.arange(5.0)
    u, y = straight(time)
    y[:3] = np.nan
    with pytest.raises(InputError, match="2 samples have both input and output"):
        resample(time, u, y, 1.0)
    y[2] = straight(time)[1][2]
    assert np.isfinite(resample(time, u, y, 1.0).y).sum() == 3


def test_each_of_several_inputs_is_interpolated_for_itself():
    time = 100.0 + np.r_[0.0:0.5:0.1, 0.54, 0.6:3.0:0.1]
    slopes, starts = np.array([2.0, -1.0, 0.5]), np.array([1.0, 7.0, 0.0])
    u = starts + slopes * time[:, None]
    found = resample(time, u, straight(time)[1], 0.1)
    assert found.u.shape == (30, 3)
    np.testing.assert_allclose(found.u, starts + slopes * (100.0 + found.time[:, None]))


@pytest.mark.parametrize("inputs", [1, 2])
def test_an_interval_of_several_samples_is_missing_where_more_than_half_of_them_are(inputs):
    """Of the others output and input are means of straight lines through what is there."""
    time = 7.0 + 0.001 * np.arange(200)
    u = np.stack([straight(time)[0], 5.0 - 4.0 * time], axis=1)[:, :inputs].squeeze()
    y = np.random.default_rng(4).normal(size=200)
    lost = {20: 6, 60: 5, 100: 1, 140: 4, 160: 10}
    kept = np.delete(np.arange(200), [n for at, count in lost.items() for n in at + np.r_[:count]])
    found = resample(time[kept], u[kept], y[kept], 0.01)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), [2, 16])
    expected = np.interp(time, time[kept], y[kept]).reshape(20, 10).mean(axis=1)
    np.testing.assert_allclose(found.y[~found.missing], expected[~found.missing])
    assert np.isnan(found.y[found.missing]).all()
    np.testing.assert_allclose(found.u, u.reshape(20, 10, *u.shape[1:]).mean(axis=1))


@pytest.mark.parametrize("lost", [[4], [3, 4], [0, 1]])
def test_an_average_stays_at_its_time_where_some_of_its_samples_are_missing(lost):
    time = 0.02 * np.arange(200)
    y = time.copy()
    y[5:195].reshape(-1, 5)[:, lost] = np.nan
    found = resample(time, time, y, 0.1)
    assert not found.missing.any()
    np.testing.assert_allclose(found.y, 0.04 + 0.1 * np.arange(40))


@pytest.mark.parametrize("gap", [(1, 4), (20, 31), (96, 99)])
def test_a_gap_may_follow_the_first_sample_and_precede_the_last(gap):
    time = 3.0 + 0.5 * np.arange(100)
    kept = np.r_[0 : gap[0], gap[1] : 100]
    found = resample(time[kept], *(signal[kept] for signal in straight(time)), 0.5)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), np.arange(*gap))


def test_beside_a_gap_one_close_sample_is_enough_and_elsewhere_a_distant_one():
    """Steps of 1.4 are no gap; a sample 0.2 from its place stands for it."""
    steps = np.arange(100.0)
    steps[[50, 60]] += 0.4, -0.4
    steps[[19, 31]] += -0.2, 0.2
    time = 3.0 + 0.5 * np.delete(steps, np.r_[20:31])
    found = resample(time, *straight(time), 0.5)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), np.r_[20:31])
    expected = straight(3.0 + 0.5 * np.arange(100))[1]
    np.testing.assert_allclose(found.y[~found.missing], expected[~found.missing])


def test_times_closer_than_the_samples_are_missing_but_those_of_a_sample():
    time = 0.5 * np.arange(20)
    found = resample(time, *straight(time), 0.2)
    np.testing.assert_allclose(found.time, 0.2 * np.arange(48), atol=1e-12)
    np.testing.assert_array_equal(np.flatnonzero(~found.missing), np.arange(0, 48, 5))


@pytest.mark.parametrize(("samples", "interval"), [(1251, 1.0), (1252, 1.00004)])
def test_four_digits_are_kept_that_move_the_last_sample_by_a_twentieth_at_most(samples, interval):
    """They move it by 0.00004 for each sample after the first."""
    time = 3.0 + 1.00004 * np.arange(samples)
    assert usual_interval(time) == pytest.approx(interval, rel=1e-9)


def test_every_sample_counts_as_a_step_of_its_own_however_short():
    time = np.arange(60.0)
    time[31:] -= 0.7
    slope = np.polyfit(np.arange(60), time, 1)[0]
    assert usual_interval(time) == pytest.approx(float(f"{slope:.4g}"), rel=1e-9)


@pytest.mark.parametrize("start", [0.0, -50.0, 1e4])
def test_the_usual_interval_is_the_slope_over_the_steps_wherever_time_starts(start):
    steps = np.delete(np.arange(40.0), [7, 8, 20])
    time = 0.1 * steps + np.random.default_rng(8).uniform(-0.01, 0.01, steps.size)
    slope = np.polyfit(steps, time, 1)[0]
    assert usual_interval(start + time) == pytest.approx(slope, rel=1e-3)


def test_of_several_times_that_fall_back_the_first_is_named():
    with pytest.raises(InputError, match="sample 2 is at 0 s, the one before it at 1 s"):
        resample(np.array([0.0, 1.0, 0.0, 3.0, 2.0]), np.arange(5.0), np.arange(5.0), 1.0)


def test_neighbours_may_be_as_far_apart_and_one_sample_as_far_off_as_is_allowed():
    """At an interval of 5 s neighbours may be 8 s apart, one sample 1.25 s off."""
    time = np.r_[0.0:41.0:5.0, 48.0, 53.0:94.0:5.0]
    assert not resample(time, *straight(time), 5.0).missing.any()
    time = np.r_[0.0:41.0:5.0, 56.25, 60.0:101.0:5.0]
    found = resample(time, *straight(time), 5.0)
    np.testing.assert_array_equal(found.time[found.missing], [45.0, 50.0])


@pytest.mark.parametrize(("signal", "lost"), [("time", 30), ("u", 40), ("y", 50)])
def test_a_value_missing_from_any_column_leaves_its_sample_out(signal, lost):
    columns = {"time": np.arange(80.0)}
    columns["u"] = np.stack(straight(columns["time"]), axis=1)
    columns["y"] = straight(columns["time"])[1]
    columns[signal][(lost, 1) if signal == "u" else lost] = np.nan
    found = resample(*columns.values(), 1.0)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), [lost])
    np.testing.assert_allclose(found.u, np.stack(straight(found.time), axis=1))


@pytest.mark.parametrize("jitter", [0.0, 0.1])
@pytest.mark.parametrize("inputs", [1, 2])
def test_an_input_is_kept_where_another_signal_is_missing(inputs, jitter):
    rng = np.random.default_rng(5)
    time = np.arange(80.0) + np.r_[0.0, rng.uniform(-jitter, jitter, 79)]
    u = rng.normal(size=(80, inputs)).squeeze()
    y = rng.normal(size=80)
    whole = resample(time, u, y, 1.0)
    lost = y.copy()
    lost[20:31] = np.nan
    found = resample(time, u, lost, 1.0)
    np.testing.assert_allclose(found.u, whole.u, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(np.flatnonzero(found.missing), np.r_[20:31])
    if inputs == 2:
        u = u.copy()
        u[50:53, 1] = np.nan
        found = resample(time, u, lost, 1.0)
        np.testing.assert_allclose(found.u[:, 0], whole.u[:, 0], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(np.flatnonzero(found.missing), np.r_[20:31, 50:53])


def test_samples_are_averaged_with_the_inputs_of_those_without_output():
    time = 0.001 * np.arange(200)
    u, y = np.random.default_rng(6).normal(size=(2, 200))
    y[23:26], y[61:69] = np.nan, np.nan
    found = resample(time, u, y, 0.01)
    np.testing.assert_allclose(found.u, u.reshape(20, 10).mean(axis=1))
    np.testing.assert_array_equal(np.flatnonzero(found.missing), [6])


def test_times_may_stand_twice_in_rows_of_different_signals_and_not_of_one():
    time = np.r_[0:10.0, 9.0, 10:20.0]
    u, y = straight(time)
    u[9], y[10] = np.nan, np.nan
    np.testing.assert_allclose(resample(time, u, y, 1.0).u, straight(np.arange(20.0))[0])
    u[9] = 0.0
    with pytest.raises(InputError, match="sample 10 is at 9 s, the one before it at 9 s"):
        resample(time, u, y, 1.0)


@pytest.mark.parametrize(("interval", "ends"), [(0.02, "1.7e\\+09"), (1e-9, "1.7e\\+09")])
def test_a_time_that_is_far_off_is_refused_before_memory_is_asked_for(interval, ends):
    """A logger whose clock was set after its first five samples."""
    time = 0.02 * np.arange(600)
    time[5:] += 1.7e9
    with pytest.raises(InputError, match=rf"time: .*600 were measured; .*ends at {ends}"):
        resample(time, time, time, interval)


def test_a_long_pause_is_a_gap():
    time = np.concatenate([0.02 * np.arange(300), 3600.0 + 0.02 * np.arange(300)])
    assert resample(time, time, time, 0.02).missing.sum() == 180_000 - 300


@pytest.mark.parametrize("to", [0.01, 1.0, 0.0125])
@pytest.mark.parametrize("rate", [60.0, 75.0, 140.8, 128.0, 150.0])
@pytest.mark.parametrize("rounded", [np.floor, np.round])
def test_the_rate_behind_rounded_times_is_found(rate, to, rounded):
    time = to * rounded((0.37 + np.arange(600) / rate) / to)
    found = rounding(time)
    assert found.to == pytest.approx(to)
    assert found.rate == pytest.approx(rate, rel=2 * min(to, 1 / rate) * rate / 600)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("lost", [1, 5, 20, 120])
def test_missing_samples_are_no_rounding(lost, seed):
    gone = np.random.default_rng(seed).choice(600, lost, replace=False)
    assert rounding(0.01 * np.delete(np.arange(600), gone)) is None


@pytest.mark.parametrize(
    "time",
    [
        0.02 * np.arange(600),
        np.round(np.arange(600) / 30, 2),  # steps of 3 and 4: jitter
        np.arange(600) / 75 + np.random.default_rng(0).uniform(-2e-3, 2e-3, 600),
        np.floor(np.arange(60) / 50),  # one change alone
        -np.floor(np.arange(600) / 50),
        np.zeros(600),
    ],
)
def test_times_that_tell_each_sample_are_not_taken_for_rounded(time):
    assert rounding(time) is None
