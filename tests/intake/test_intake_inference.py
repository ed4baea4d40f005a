"""What is inferred from a record whose system is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.configuration.identification import Validation
from dea.discrepancy.problem.split import split
from dea.errors import InputError
from dea.intake.bandwidth import band, samples_held, samples_to_average
from dea.intake.dynamics import _settling, linear_dynamics
from dea.intake.settings import infer_settings
from dea.narx import NarxModel
from dea.store import Record
from dea.warm_up import LONGEST_WARM_UP


def excitation(size, pole):
    return lfilter([1 - pole], [1, -pole], np.random.default_rng(0).standard_normal(size))


def of_pole(u, pole, delay):
    return lfilter([0.0] * delay + [1 - pole], [1, -pole], u)


def test_the_band_of_band_limited_noise_is_found():
    rate, highest = 100.0, 5.0
    spectrum = np.fft.rfft(np.random.default_rng(1).standard_normal(20_000))
    spectrum[np.fft.rfftfreq(20_000, 1 / rate) > highest] = 0.0
    signal = np.fft.irfft(spectrum)
    assert band(signal, rate)[1] == pytest.approx(highest, rel=0.05)
    assert samples_to_average(signal, rate) == 1
    assert samples_to_average(np.interp(np.arange(0, 20_000, 0.1), range(20_000), signal), 1e3) in (
        9,
        10,
    )


@pytest.mark.parametrize("held", [2.0, 3.3, 10.0])
def test_a_sensor_that_is_read_more_slowly_than_the_record_is_told(held):
    """Its values come at a rate of its own; one of fifty is lost, so that the one before stays."""
    y = np.cumsum(np.random.default_rng(3).standard_normal(4000))
    newest = np.floor((np.arange(4000) + 0.4) / held).astype(int)
    newest -= newest % 50 == 17
    assert samples_held(y[newest]) == pytest.approx(held, rel=0.02)


@pytest.mark.parametrize("step", [0.0, 0.02, 0.1, 0.5])
def test_a_slow_signal_that_is_rounded_is_not_read_slowly(step):
    t = np.arange(4000) / 100
    noise = 0.01 * np.random.default_rng(4).standard_normal(t.size)
    for y in (np.sin(t), np.abs((t % 8.0) - 4.0), np.sin(t) + noise, noise, 0.0 * t):
        rounded = step * np.round(y / step) if step else y
        assert samples_held(rounded) == 1.0


@pytest.mark.parametrize("delay", [0, 1, 2, 7])
def test_the_delay_of_a_first_order_system_is_found(delay):
    u = excitation(1500, 0.5)
    y = of_pole(u, 0.8, delay) + 1e-3 * np.random.default_rng(2).standard_normal(u.size)
    found = linear_dynamics(u, y)
    assert found.u_lags[0][0] == delay
    assert found.y_lags == 1
    assert found.error < 0.02


@pytest.mark.parametrize("pole", [0.5, 0.9, 0.98])
def test_the_settling_time_is_that_of_the_pole(pole):
    u = excitation(4000, 0.5)
    found = linear_dynamics(u, of_pole(u, pole, 1))
    assert found.settling == pytest.approx(np.log(0.02) / np.log(pole), abs=2)
    assert found.slowest == pytest.approx(-1.0 / np.log(pole), abs=0.6)


def test_an_unstable_model_settles_never():
    """Without a warning, which would be an error here."""
    model = NarxModel.from_terms({"y(t-1)": 1.5, "u(t-1)": 1.0, "1": 1.0})
    assert _settling(model, 3000, 1) == 3000


def signals(size, rate, missing=()):
    u = excitation(size, 0.7)
    y = of_pole(u, 0.8, 1) + 0.1 * of_pole(u, 0.8, 1) ** 2
    y[list(missing)] = np.nan
    return Record(np.arange(size) / rate, u, y, rate, "V", "mm", "drive", "position")


@pytest.mark.parametrize("size", [60, 200, 1000, 20_000])
@pytest.mark.parametrize("rate", [0.1, 1000.0])
def test_every_segment_and_window_lies_inside_the_record(size, rate):
    sections = infer_settings(signals(size, rate)).sections
    duration = size / rate
    segment = sections["identification"]["length"]
    assert segment <= sections["orders"]["start"] + 1e-6 * duration
    assert sections["orders"]["start"] + sections["orders"]["length"] <= duration * (1 + 1e-6)
    for first, last in sections["validation"]["windows"]:
        assert segment <= first * (1 + 1e-6)
        assert last <= duration * (1 + 1e-6)
        assert (last - first) * rate > 2 * sections["validation"]["max_lag"]
    assert 0 < sections["gfrf"]["lowest"] < sections["gfrf"]["highest"] <= 0.5


@pytest.mark.parametrize(
    ("size", "rate"), [(60_000, 3.0), (30_000, 7.0), (200_000, 60.0), (100_000, 75.0)]
)
def test_windows_are_of_one_length_where_their_ends_are_no_short_decimals(size, rate):
    found = infer_settings(signals(size, rate)).sections["validation"]
    assert Validation.model_validate(found).windows == found["windows"]


def test_windows_with_a_gap_are_passed_over():
    sections = infer_settings(signals(1200, 1.0, range(850, 870))).sections
    assert all(last <= 850 or first >= 870 for first, last in sections["validation"]["windows"])


def test_an_input_of_steps_has_windows_in_which_it_moves_and_no_blocks_drawn():
    record = signals(600, 1.0)
    steps = np.repeat(np.random.default_rng(3).uniform(size=4), 150)
    sections = infer_settings(record._replace(u=steps, y=of_pole(steps, 0.9, 1))).sections
    assert sections["identification"]["resamples"] == 0
    for first, last in sections["validation"]["windows"]:
        assert np.ptp(steps[int(first) : int(last)]) > 0


def test_an_input_that_no_longer_moves_is_refused():
    record = signals(600, 1.0)
    u = np.where(np.arange(600) < 300, record.u, 0.0)
    with pytest.raises(InputError, match="constant from sample 400 on"):
        infer_settings(record._replace(u=u))


@pytest.mark.parametrize("pole", [0.9, 0.98, 0.995])
def test_a_diagnosis_can_split_the_record_at_the_slowest_time(pole):
    """The slowest time is that of the device where the record is long enough, else shorter."""
    record = signals(600, 50.0)
    sections = infer_settings(record._replace(y=of_pole(record.u, pole, 1))).sections
    slowest, warm_up = (sections["split"][key] for key in ("slowest_time", "warm_up"))
    assert slowest == pytest.approx(min(-0.02 / np.log(pole), 600 / 50.0 / 10), rel=0.1)
    assert split(record.u, 0.02, slowest, warm_up).certify.any()
    # What the diagnosis would shorten is not promised.
    assert warm_up == pytest.approx(LONGEST_WARM_UP * 600 / 50.0)
