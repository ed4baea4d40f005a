import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dea.errors import InputError
from dea.excitation import KINDS, _smooth, design

STUDY = {"duration": 600.0, "sampling_rate": 50.0, "low": 1.1, "high": 3.75, "seed": 3}


@settings(deadline=None, max_examples=60)
@given(
    kind=st.sampled_from(sorted(KINDS)),
    duration=st.floats(40.0, 300.0),
    low=st.floats(-5.0, 5.0),
    width=st.floats(0.1, 10.0),
    seed=st.integers(0, 2**32),
)
def test_every_design_keeps_its_length_range_and_seed(kind, duration, low, width, seed):
    asked = {
        "duration": duration,
        "sampling_rate": 50.0,
        "low": low,
        "high": low + width,
        "seed": seed,
    }
    signal = design(kind, **asked)
    assert signal.shape == (round(50.0 * duration),)
    assert signal.min() >= low
    assert signal.max() <= low + width
    assert np.ptp(signal) > 0.3 * width
    np.testing.assert_array_equal(signal, design(kind, **asked))


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_another_seed_gives_another_sequence(kind):
    first = design(kind, **STUDY)
    other = design(kind, **{**STUDY, "seed": 4})
    assert np.abs(first - other).max() > 0.1


def power_above(signal, frequency):
    spectrum = np.abs(np.fft.rfft(signal - signal.mean())) ** 2
    frequencies = np.fft.rfftfreq(signal.size, 1.0 / STUDY["sampling_rate"])
    return spectrum[frequencies > frequency].sum() / spectrum.sum()


def test_the_gaussian_is_gaussian_and_band_limited():
    signal = design("gaussian", **{**STUDY, "duration": 1800.0})
    assert power_above(signal, 1.0) < 1e-3
    spread = (signal - signal.mean()) / signal.std()
    assert abs(signal.mean() - 2.425) < 1e-3
    assert signal.std() == pytest.approx((3.75 - 1.1) / 6.0, rel=0.01)
    assert abs(np.mean(spread**3)) < 0.1
    assert np.mean(spread**4) == pytest.approx(3.0, abs=0.15)
    assert np.mean((signal == 1.1) | (signal == 3.75)) < 0.006


def test_bursts_rest_between_noise():
    signal = design("bursts", **STUDY, active=20.0, rest=10.0)
    rests = signal[: 20 * 1500].reshape(20, 1500)[:, 1050:1490]
    np.testing.assert_allclose(rests, 1.1)
    assert (signal.reshape(20, 1500)[:, :1000].std(axis=1) > 0.2).all()


def test_the_multisine_is_flat_and_repeats():
    signal = design("multisine", **{**STUDY, "duration": 120.0}, period=20.0, band=0.8)
    np.testing.assert_array_equal(signal[:1000], signal[1000:2000])
    lines = np.abs(np.fft.rfft(signal[:1000]))[1:]
    np.testing.assert_allclose(lines[:16], lines[0])
    assert lines[16:].max() < 1e-9 * lines[0]
    assert np.isclose(signal.max(), 3.75) or np.isclose(signal.min(), 1.1)


def test_the_staircase_rests_between_its_levels():
    signal = design("staircase", **STUDY, levels=4, hold=5.0, rest=5.0, rise=0.2)
    middles = signal[125 + 250 :: 500][:4]
    np.testing.assert_allclose(sorted(middles), np.linspace(1.1, 3.75, 5)[1:])
    np.testing.assert_allclose(signal[200::500], 1.1)


@pytest.mark.parametrize("band", [1.0, 0.4])
def test_the_binary_sequence_has_its_power_in_the_band(band):
    assert power_above(design("binary", **STUDY, band=band), 2.0 * band) < 1e-3


@pytest.mark.parametrize(("band", "clock"), [(1.0, 25), (0.5, 50), (0.4, 62)])
def test_the_binary_sequence_may_switch_every_half_period_of_its_band(band, clock):
    signal = design("binary", **STUDY, band=band)
    # The window spans two clock periods: the middle is crossed exactly where the bit changes.
    above = signal > 0.5 * (1.1 + 3.75) + 1e-9
    rises = np.flatnonzero(~above[:-1] & above[1:])
    assert np.gcd.reduce(np.diff(rises)) == clock


def test_triangles_climb_at_three_rates():
    signal = design("triangle", **STUDY, slowest=20.0, fastest=5.0)
    slopes = np.abs(np.diff(signal)) * 50.0 / (3.75 - 1.1)
    rates, counts = np.unique(slopes.round(2), return_counts=True)
    common = rates[counts > 0.05 * slopes.size]
    np.testing.assert_allclose(common, [2.0 / 20.0, 2.0 / 10.0, 2.0 / 5.0], atol=1e-9)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"kind": "gausian"}, "kind"),
        ({"bnad": 1.0}, "bnad"),
        ({"low": 4.0}, "low"),
        ({"low": 3.75}, "low"),
        ({"low": float("nan")}, "low"),
        ({"high": "2"}, "low"),
        ({"duration": 0.01}, "duration"),
        ({"duration": float("nan")}, "duration"),
        ({"band": 30.0}, "band"),
        ({"band": 25.0}, "band"),
        ({"band": 0.0}, "band"),
        ({"band": "1"}, "band"),
        ({"band": [1.0]}, "band"),
        ({"band": float("inf")}, "band"),
        ({"kind": "multisine", "period": 1e4}, "period"),
        ({"kind": "multisine", "band": 0.01}, "band"),
        ({"kind": "bursts", "active": 0.0}, "active"),
        ({"kind": "staircase", "hold": 0.0}, "hold"),
        ({"kind": "staircase", "levels": 0}, "levels"),
        ({"kind": "staircase", "levels": 10**9}, "levels"),
        ({"kind": "staircase", "levels": 2.5}, "levels"),
        ({"kind": "staircase", "rise": 1e7}, "rise"),
        ({"kind": "binary", "band": 1e-300}, "band"),
        ({"kind": "binary", "band": 1e-9}, "band"),
        ({"kind": "triangle", "fastest": 40.0}, "fastest"),
    ],
)
def test_a_wrong_setting_is_named(change, field):
    asked = {"kind": "gaussian", **STUDY, **change}
    with pytest.raises(InputError) as error:
        design(asked.pop("kind"), **asked)
    assert error.value.field == field


@pytest.mark.parametrize(
    ("kind", "long"),
    [
        ("bursts", {"active": 1e7}), ("bursts", {"rest": 1e7}),
        ("staircase", {"hold": 1e7}), ("staircase", {"rest": 1e7, "hold": 2.0}),
    ],
)  # fmt: skip
def test_what_lasts_longer_than_the_sequence_lasts_as_long(kind, long):
    whole = STUDY["duration"] + 1.0
    shorter = {name: min(seconds, whole) for name, seconds in long.items()}
    np.testing.assert_array_equal(design(kind, **STUDY, **long), design(kind, **STUDY, **shorter))


def test_levels_may_be_a_whole_float():
    counts = (design("staircase", **STUDY, levels=levels) for levels in (3, 3.0))
    np.testing.assert_array_equal(*counts)


def test_a_staircase_takes_no_more_room_than_its_samples():
    """All of the hundred thousand levels, held for that long, would take a terabyte."""
    long = STUDY | {"duration": 2e4}
    signal = design("staircase", **long, levels=100_000, hold=2e4, rest=1.0)
    assert signal.size == 1_000_000
    assert np.unique(signal[100:]).size == 1


@pytest.mark.parametrize("field", ["rest", "rise"])
def test_a_time_may_be_zero_and_is_refused_below(field):
    assert design("staircase", **STUDY, **{field: 0.0}).size == 30_000
    with pytest.raises(InputError, match="is negative, or not a finite number"):
        design("staircase", **STUDY, **{field: -1.0})


@pytest.mark.parametrize("width", [1, 2, 5, 8])
def test_a_smoothed_step_rises_within_its_width_and_alike_on_both_sides(width):
    rise = _smooth(np.repeat([0.0, 1.0], [20, 20]), width)[19 : 20 + width]
    assert rise[0] == 0.0
    assert rise[-1] == pytest.approx(1.0)
    assert np.all(np.diff(rise) > 0.0)
    np.testing.assert_allclose(rise + rise[::-1], 1.0)


@pytest.mark.parametrize("kind", ["gaussian", "bursts", "multisine", "binary"])
@pytest.mark.parametrize("settings", [{}, {"band": 0.0}])
def test_a_band_is_within_half_the_sampling_rate_and_positive_whoever_gives_it(kind, settings):
    rate = 50.0 if settings else 1.5
    with pytest.raises(InputError) as caught:
        design(kind, duration=100.0, sampling_rate=rate, low=0.0, high=1.0, seed=1, **settings)
    assert caught.value.field == "band"


@pytest.mark.parametrize(
    ("change", "field"),
    [({"seed": None}, "seed"), ({"seed": 1.0}, "seed"), ({"duration": 1e308}, "duration")],
)
def test_what_leaves_no_sequence_is_named(change, field):
    with pytest.raises(InputError) as caught:
        design("gaussian", **STUDY | change)
    assert caught.value.field == field
