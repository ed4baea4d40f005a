"""Hidden lags, delays, slew limits and leakage, against what their laws are known to do."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, through

from dea.plant.film import SUBSTEP
from dea.plant.hidden import EFFECTS

STEP = np.repeat([1.0, 2.0], [1000, 20_000])


def response(effect, form, size, seed=0):
    """Return the response to a unit step, without the level before it."""
    law, defining = built(effect, form, size, seed)
    passed = through(law, STEP)
    np.testing.assert_allclose(passed[:1000], 1.0, atol=1e-9)
    return passed[1000:] - 1.0, defining


LAGS = [
    (effect, form.name)
    for effect in ("electrode_lag", "sensor_lag", "transport_delay")
    for form in EFFECTS[effect].forms
]


@pytest.mark.parametrize(("effect", "form"), LAGS)
@pytest.mark.parametrize("seed", range(3))
def test_a_lag_settles_and_its_mean_delay_is_as_stated(effect, form, seed):
    taken, defining = response(effect, form, 0.2, seed)
    assert taken[-1] == pytest.approx(1.0, abs=2e-2)
    # The area above a step response is the mean delay (Elmore, J. Appl. Phys. 19 (1948) 55).
    mean = (1.0 - taken).sum() * SUBSTEP
    if form == "stretched_electrode":
        assert 0.1 < mean < 0.3  # depends on the level
    elif form == "jittered_delay":
        assert mean == pytest.approx(defining["delay"], rel=0.21)
    elif defining:
        assert mean == pytest.approx(next(iter(defining.values())), rel=0.02, abs=2e-3)


@pytest.mark.parametrize("cut", [1, 7, 500])
@pytest.mark.parametrize(("effect", "form"), [*LAGS, ("slew_limit", "trapezoidal_speed")])
def test_a_law_does_not_depend_on_how_the_signal_is_cut(effect, form, cut):
    signal = np.random.default_rng(1).random(2000)
    whole = through(built(effect, form, 0.2)[0], signal)
    law = built(effect, form, 0.2)[0]
    pieces = [through(law, signal[k : k + cut]) for k in range(0, signal.size, cut)]
    np.testing.assert_array_equal(whole, np.concatenate(pieces))


@pytest.mark.parametrize("milliseconds", [1, 37, 200])
def test_the_pure_delay_shifts(milliseconds):
    signal = np.random.default_rng(2).random(2000)
    passed = through(built("transport_delay", "pure_delay", milliseconds * SUBSTEP)[0], signal)
    np.testing.assert_array_equal(passed[milliseconds:], signal[:-milliseconds])


def test_the_jittered_delay_varies_within_a_fifth_of_its_mean():
    ramp = np.arange(60_000) * SUBSTEP
    law, defining = built("transport_delay", "jittered_delay", 0.3)
    late = (ramp - through(law, ramp))[1000:]
    assert np.abs(late - defining["delay"]).max() <= 0.2 * defining["delay"] + SUBSTEP
    assert np.std(late) > 0.005


def test_the_dispersed_edge_is_that_of_equal_tanks():
    taken, defining = response("transport_delay", "dispersed_plug_flow", 0.3)
    weights = np.diff(taken, prepend=0.0)
    time = np.arange(taken.size) * SUBSTEP
    variance = weights @ (time - weights @ time) ** 2
    tanks = defining["delay"] ** 2 / variance
    assert tanks == pytest.approx(round(tanks), rel=0.02)
    assert 24 < tanks < 61


def test_diffusion_begins_with_the_root_of_time():
    taken, _ = response("electrode_lag", "cable_diffusion", 1.0)
    # A single lag would begin with a straight line.
    early = np.arange(20, 120)
    assert np.polyfit(np.log(early), np.log(taken[early]), 1)[0] < 0.95


def test_two_stages_have_two_real_poles():
    taken, _ = response("electrode_lag", "two_stages", 0.2)
    left = 1.0 - taken[:1500]
    # A recursion of second order fits exactly; its roots are the poles' decays.
    recursion, residual, *_ = np.linalg.lstsq(
        np.column_stack([left[1:-1], left[:-2]]), left[2:], rcond=None
    )
    roots = np.roots([1.0, *-recursion])
    assert np.isreal(roots).all()
    times = -SUBSTEP / np.log(np.real(roots))
    assert times.sum() == pytest.approx(0.2, rel=0.03)
    assert residual.max() < 1e-12


def test_cole_and_cole_decay_as_a_power_in_the_wings():
    taken, _ = response("electrode_lag", "cole_cole", 0.05)
    left = 1.0 - taken
    # Slower than any single exponential: the local rate falls with time.
    rate = -np.gradient(np.log(left[5:1500]))
    assert rate[10] > 3.0 * rate[500]


def test_the_stretched_electrode_is_slower_at_the_top():
    law = built("electrode_lag", "stretched_electrode", 0.1)[0]
    up = through(law, np.repeat([3.8, 4.0], [100, 3000]))[100:]
    law = built("electrode_lag", "stretched_electrode", 0.1)[0]
    low = through(law, np.repeat([1.0, 1.2], [100, 3000]))[100:]
    assert (4.0 - up).sum() > 1.3 * (1.2 - low).sum()


def test_the_bessel_filter_is_that_of_scipy():
    from scipy.signal import bessel, step

    taken, _ = response("sensor_lag", "bessel_filter", 0.1)
    time = np.arange(1, 1000) * SUBSTEP
    _, expected = step(bessel(4, 10.0, analog=True, norm="delay"), T=np.append(0.0, time))
    np.testing.assert_allclose(taken[:999], expected[1:], atol=2e-3)


def test_the_integrating_converter_averages_over_its_window():
    signal = np.random.default_rng(3).random(3000)
    passed = through(built("sensor_lag", "integrating_converter", 0.05)[0], signal)
    expected = np.convolve(signal, np.full(100, 0.01), mode="valid")
    np.testing.assert_allclose(passed[99:], expected, atol=1e-9)


def test_the_seismic_element_begins_as_the_cube_of_time():
    taken, _ = response("sensor_lag", "seismic_element", 0.5)
    early = np.arange(12, 40)
    order = np.polyfit(np.log(early + 1), np.log(taken[early]), 1)[0]
    assert order == pytest.approx(3.0, abs=0.4)


def test_the_probe_responds_quickly_in_part():
    taken, _ = response("sensor_lag", "sheathed_probe", 0.5)
    assert 0.08 < taken[400] < 0.8
    rate = -np.gradient(np.log(1.0 - taken[:3000]))
    assert rate[5] > 3.0 * rate[2000]


@pytest.mark.parametrize("form", [form.name for form in EFFECTS["slew_limit"].forms])
@pytest.mark.parametrize("seed", range(3))
def test_the_rate_is_limited_and_the_target_reached(form, seed):
    law, defining = built("slew_limit", form, 2.0, seed)
    passed = through(law, np.repeat([1.0, 4.0, 1.0], [10, 6000, 6000]))
    rates = np.diff(passed) / SUBSTEP
    assert defining["rate"] == pytest.approx(CONDITIONS.span / 2.0)
    assert np.abs(rates).max() < 1.45 * defining["rate"]
    assert np.abs(rates).max() > 0.9 * defining["rate"]
    assert passed[5990] == pytest.approx(4.0, abs=0.02)
    assert passed[-1] == pytest.approx(1.0, abs=0.02)


def test_the_trapezoid_bounds_the_acceleration():
    law, defining = built("slew_limit", "trapezoidal_speed", 2.0)
    passed = through(law, np.repeat([1.0, 4.0], [10, 6000]))
    speeds = np.diff(passed) / SUBSTEP
    acceleration = np.diff(speeds) / SUBSTEP
    assert speeds.max() == pytest.approx(defining["rate"], rel=1e-6)
    start = acceleration[:200][acceleration[:200] > 0.0]
    np.testing.assert_allclose(start[:-1], start[0], rtol=1e-6)
    assert passed.max() < 4.0 + 1e-5


def test_the_orifice_slows_as_a_root_near_the_target():
    law, defining = built("slew_limit", "orifice_flow", 2.0)
    passed = through(law, np.repeat([1.0, 4.0], [10, 6000]))
    error, rate = 4.0 - passed[10:-1], np.diff(passed[10:]) / SUBSTEP
    near = (rate < 0.9 * defining["rate"]) & (error > 1e-3)
    order = np.polyfit(np.log(error[near]), np.log(rate[near]), 1)[0]
    assert order == pytest.approx(0.5, abs=0.05)


def test_the_foldback_tilts_the_rate_with_the_level():
    passed = through(
        built("slew_limit", "foldback_current", 2.0)[0], np.repeat([1.0, 4.0], [10, 6000])
    )
    rate, level = np.diff(passed[10:]) / SUBSTEP, passed[10:-1]
    moving = rate > 1e-6
    line = np.polyfit(level[moving][:-2], rate[moving][:-2], 1)
    assert line[0] < 0.0
    np.testing.assert_allclose(rate[moving][:-2], np.polyval(line, level[moving][:-2]), rtol=1e-6)


@pytest.mark.parametrize("form", ["space_charge", "schottky_emission", "poole_frenkel"])
def test_what_is_trapped_depends_on_the_field_as_the_law_says(form):
    lost = {}
    for level in (1.0, 2.0, 4.0):
        kept = through(built("charge_leakage", form, 1e-4)[0], np.full(100_000, level))
        assert kept[0] == level
        lost[level] = level - kept[-1]
    assert lost[4.0] == pytest.approx(1e-4 * 4.0, rel=0.01)
    first, second = np.log(lost[2.0] / lost[1.0]), np.log(lost[4.0] / lost[2.0])
    if form == "space_charge":  # the square of the field
        assert [first, second] == pytest.approx([2 * np.log(2)] * 2, rel=0.01)
    else:  # exponential in its root: ever steeper
        linear = np.log(2) if form == "poole_frenkel" else 0.0
        roots = (np.sqrt(2.0) - 1.0) * np.array([1.0, np.sqrt(2.0)])
        steep = (np.array([first, second]) - linear) / roots
        if form == "poole_frenkel":
            assert steep[0] == pytest.approx(steep[1], rel=0.02)
        assert second > first > linear


def test_absorption_falls_as_a_power_of_time():
    kept = through(
        built("charge_leakage", "curie_von_schweidler", 0.3)[0], np.repeat([0.0, 1.0], [1, 60_000])
    )
    current = -np.diff(kept[1:])
    times = np.array([1.0, 3.0, 10.0, 30.0])
    at = np.array([current[round(t / SUBSTEP)] for t in times])
    orders = -np.diff(np.log(at)) / np.diff(np.log(times))
    assert (orders > 0.4).all()
    assert (orders < 1.2).all()
