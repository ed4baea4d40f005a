"""Hidden foreign effects, against what their names say."""

import numpy as np
import pytest
from made_conditions import (
    CONDITIONS,
    OFFSET,
    SAMPLES,
    TIME,
    built,
    held,
    resist,
    steady,
    through,
)  # fmt: skip
from scipy.optimize import curve_fit

from dea.plant.film import SUBSTEP
from dea.plant.hidden.forms.foreign import _telegraph
from dea.plant.signal_law import SignalLaw


def test_heating_changes_the_gain_slowly_and_more_at_high_commands():
    warm = through(built("thermal_feedback", "thermal_feedback", 0.5)[0], np.full(200_000, 4.0))
    cool = through(built("thermal_feedback", "thermal_feedback", 0.5)[0], np.full(200_000, 2.0))
    assert warm[0] == 4.0
    assert abs(warm[-1] / 4.0 - 1.0) > 4.0 * abs(cool[-1] / 2.0 - 1.0) > 0.0


def test_heating_lasts_many_periods_of_the_band():
    law = built("thermal_feedback", "thermal_feedback", 0.5)[0]
    gain = through(law, np.full(SAMPLES, CONDITIONS.high)) / CONDITIONS.high

    def heated(t, time, power):
        return 0.5 * (1.0 - np.exp(-t / time)) ** power

    (time, power), _ = curve_fit(heated, TIME, np.abs(gain**2 - 1.0), [15.0, 2.0])
    np.testing.assert_allclose(np.abs(gain**2 - 1.0), heated(TIME, time, power), atol=1e-3)
    assert 8.0 * CONDITIONS.time <= time <= 30.0 * CONDITIONS.time
    assert 1.5 <= power <= 3.0


def test_the_held_reading_jumps():
    y = np.linspace(0.0, CONDITIONS.travel, 5000)
    read = through(built("send_on_delta", "send_on_delta", 0.1)[0], y)
    assert np.abs(read - y).max() <= 0.101 * CONDITIONS.travel
    assert 9 <= np.count_nonzero(np.diff(read)) <= 11


def test_the_contact_has_two_levels():
    levels = np.unique(
        through(built("telegraph_contact", "telegraph_contact", 0.2)[0], np.ones(60_000))
    )
    np.testing.assert_allclose(levels, [0.8, 1.0])


def test_the_contact_is_good_at_first_and_changes_at_the_times_drawn():
    passed = through(SignalLaw(_telegraph, [0.8, 0.01, 0.03, 0.08], [0.0]), np.ones(100))
    expected = np.repeat([1.0, 0.8, 1.0, 0.8], [10, 20, 50, 20])
    # Sums of milliseconds may pass a time one step late.
    assert np.count_nonzero(passed != expected) <= 3


def test_delays_grow_with_command_and_with_time():
    for share in (-0.5, 0.0, 0.5, 1.0, 1.5):
        ramp = CONDITIONS.low + share * CONDITIONS.span + 1e-6 * np.arange(3000)
        law = built("input_dependent_delay", "input_dependent_delay", 0.2)[0]
        late = (ramp - through(law, ramp))[-1] / 1e-6 * SUBSTEP
        assert late == pytest.approx(0.2 * min(max(share, 0.0), 1.0), rel=0.11, abs=2e-3)
    late = TIME - through(built("drifting_clock", "drifting_clock", 0.5)[0], TIME)
    assert late[-1] == pytest.approx(0.5, rel=0.01)
    assert (np.diff(late[1000:]) > -2 * SUBSTEP).all()


@pytest.mark.parametrize("name", ["held_readings", "lost_commands"])
def test_gaps_hold_the_last_value(name):
    ramp = np.arange(60_000.0)
    passed = through(built(name, name, 0.5)[0], ramp)
    assert set(np.unique(passed)) <= set(ramp)
    frozen = np.diff(passed) == 0.0
    assert 0.02 < frozen.mean() < 0.6
    assert (passed <= ramp).all()


def test_the_supply_modulates_and_the_chaos_does_not_repeat():
    ones = np.ones(SAMPLES)
    modulated = through(built("modulated_gain", "modulated_gain", 0.1)[0], ones) ** 2 - 1.0
    lines = np.abs(np.fft.rfft(modulated * np.hanning(SAMPLES)))
    assert lines.max() > 100.0 * np.median(lines)
    chaos = through(built("unmeasured_input", "unmeasured_input", 0.1)[0], ones) ** 2 - 1.0
    lines = np.abs(np.fft.rfft(chaos * np.hanning(SAMPLES)))
    assert np.sort(lines)[-20] > 0.2 * lines.max()
    assert 0.05 < chaos.std() < 0.2


def test_gains_remember_a_peak_and_know_the_direction():
    up, low = np.linspace(1.0, 4.0, 100), np.linspace(1.0, 2.5, 100)
    wave = np.concatenate([up, up[::-1], low, low[::-1], low])
    passed = through(built("peak_memory", "peak_memory", 0.3)[0], wave)
    assert passed[250] != pytest.approx(passed[450], rel=1e-3)
    steps = np.repeat(np.linspace(1.0, 4.0, 300), 20)  # held between samples, as commands are
    turned = np.concatenate([steps, steps[::-1]])
    gain = through(built("direction_gain", "direction_gain", 0.3)[0], turned) / turned
    assert abs(gain[5900] ** 2 - gain[11_900] ** 2) == pytest.approx(0.6, rel=0.02)


def test_readings_are_contaminated_seldom_and_speckle_grows_with_the_signal():
    spikes = through(built("outliers", "outliers", 0.1)[0], np.zeros(SAMPLES))
    assert 0.01 < np.mean(spikes != 0.0) < 0.15
    kurtosis = np.mean(spikes**4) / np.mean(spikes**2) ** 2
    assert kurtosis > 10.0
    low, high = (
        through(built("speckle", "speckle", 0.1)[0], np.full(SAMPLES, y)).std()
        for y in (CONDITIONS.bottom + 1.0, CONDITIONS.bottom + 4.0)
    )
    assert high == pytest.approx(4.0 * low, rel=1e-6)
    assert low == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize("size", [0.005, 0.03, 0.12])
@pytest.mark.parametrize("seed", range(3))
def test_a_buckled_strip_leaves_its_device_three_places_within_the_commands(size, seed):
    stiffness, travel = CONDITIONS.stiffness, CONDITIONS.travel
    places = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 20_001)
    law, _ = built("bistable_snap", "bistable_snap", size, seed)
    push = stiffness * places + resist(law, places)
    # Where the strip's middle balances, two more places do, one on either side.
    level = stiffness * law.constants[1]
    balanced = np.flatnonzero(np.diff(np.sign(push - level)))
    assert balanced.size == 3
    assert np.gradient(push)[balanced[1]] < 0.0
    assert (np.gradient(push)[balanced[[0, 2]]] > 0.0).all()
    assert 0.25 * stiffness * travel < level - stiffness * CONDITIONS.bottom
    assert level < stiffness * (CONDITIONS.bottom + 0.65 * travel)


def test_commands_are_rounded_to_equal_levels():
    levels = np.unique(
        np.round(through(built("coarse_commands", "coarse_commands", 0.1)[0], TIME / 15.0), 9)
    )
    np.testing.assert_allclose(np.diff(levels), 0.1 * CONDITIONS.span, rtol=1e-6)
    ramp = TIME / 15.0
    wrong = through(built("coarse_commands", "coarse_commands", 0.1)[0], ramp) - ramp
    assert np.abs(wrong).max() <= 0.05 * CONDITIONS.span + 1e-9


def test_the_supply_s_noise_forgets_exponentially():
    products, spread = np.zeros(3), []
    for seed in range(12):
        law = built("unsteady_supply", "unsteady_supply", 0.1, seed)[0]
        noise = through(law, np.zeros(SAMPLES))
        spread.append(noise.std())
        kept = [np.mean(noise[:-lag] * noise[lag:]) / np.mean(noise**2) for lag in (60, 120, 240)]
        products += np.log(kept) / 12
    assert np.mean(spread) == pytest.approx(0.1 * CONDITIONS.span, rel=0.15)
    assert products[1] / products[0] == pytest.approx(2.0, rel=0.15)
    assert products[2] / products[1] == pytest.approx(2.0, rel=0.15)


def test_drag_is_the_square_of_the_speed_and_opposes_it():
    law = built("quadratic_drag", "quadratic_drag", 0.1)[0]
    speeds = np.array([-20.0, 5.0, 10.0, 20.0])
    largest = 0.1 * CONDITIONS.stiffness * CONDITIONS.travel
    np.testing.assert_allclose(steady(law, speeds), largest * np.array([-4.0, 0.25, 1.0, 4.0]))


def test_the_pumped_stiffness_is_a_sine_in_time_and_a_line_in_place():
    def felt(y):
        law = built("pumped_stiffness", "pumped_stiffness", 0.1, conditions=OFFSET)[0]
        return held(law, OFFSET.rest + y, OFFSET.duration)

    np.testing.assert_allclose(felt(4.0), 2.0 * felt(2.0), atol=1e-12)
    wave = felt(4.0)
    assert np.abs(wave).max() == pytest.approx(0.1 * CONDITIONS.stiffness * 4.0, rel=1e-3)
    inside = np.abs(wave[1:-1]) > 0.1
    factor = (wave[2:] + wave[:-2])[inside] / wave[1:-1][inside]
    np.testing.assert_allclose(factor, factor[0], rtol=1e-6)
    assert np.count_nonzero(np.diff(np.sign(wave))) > 20
