"""Hidden lags, delays, slew limits and leakage, against what their laws are known to do."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, through

from dea.plant.film import SUBSTEP
from dea.plant.hidden import EFFECTS
from dea.plant.hidden.effect import Port
from dea.plant.hidden.forms.delays import _jittered
from dea.plant.signal_law import SignalLaw

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
    elif form == "sampled_and_held":
        assert mean == pytest.approx(defining["delay"], rel=0.34)  # depends on when it samples
    elif form == "joined_samples":
        # The step meets a sample, and half a line is over on average.
        early = 0.5 * (defining["delay"] - SUBSTEP)
        assert mean == pytest.approx(defining["delay"] - early, rel=1e-9)
    elif form == "bucket_brigade":
        assert mean == pytest.approx(defining["delay"], rel=0.05)  # and, less, this
    elif form == "coaxial_cable":  # half of it is there in time, its mean never is
        assert int(np.argmax(taken > 0.5)) == pytest.approx(0.2 / SUBSTEP, abs=2)
    elif form == "laminar_tube":
        assert mean == pytest.approx(0.2, rel=0.02)
    elif defining:
        assert mean == pytest.approx(next(iter(defining.values())), rel=0.02, abs=2e-3)


SIGNAL_FORMS = [
    (effect.name, form.name)
    for effect in EFFECTS.values()
    if effect.port is not Port.FORCE
    for form in effect.forms
    if isinstance(built(effect.name, form.name, 0.2)[0], SignalLaw)
]


@pytest.mark.parametrize(("effect", "form"), SIGNAL_FORMS)
def test_a_law_does_not_depend_on_how_the_signal_is_cut(effect, form):
    signal = np.random.default_rng(1).uniform(0.5, 12.0, 2000)
    signal[:500] = 0.0  # a value that a memory has at its beginning, too
    whole = through(built(effect, form, 0.2)[0], signal)
    for cut in (1, 7, 500):
        law = built(effect, form, 0.2)[0]
        pieces = [through(law, signal[k : k + cut]) for k in range(0, signal.size, cut)]
        np.testing.assert_array_equal(whole, np.concatenate(pieces))


@pytest.mark.parametrize("milliseconds", [1, 37, 200])
def test_the_pure_delay_shifts(milliseconds):
    signal = np.random.default_rng(2).random(2000)
    passed = through(built("transport_delay", "pure_delay", milliseconds * SUBSTEP)[0], signal)
    np.testing.assert_array_equal(passed[milliseconds:], signal[:-milliseconds])


def test_the_held_sample_is_between_one_period_and_two_late():
    ramp = np.arange(5000) * SUBSTEP
    law, defining = built("transport_delay", "sampled_and_held", 0.3)
    passed = through(law, ramp)
    assert np.unique(np.diff(np.flatnonzero(np.diff(passed)))).size == 1
    late = (ramp - passed)[1000:]
    period = 0.2
    assert [late.min(), late.max()] == pytest.approx([period, 2 * period], abs=2 * SUBSTEP)
    assert late.mean() == pytest.approx(defining["delay"], abs=2 * SUBSTEP)


def test_joined_samples_are_one_period_late():
    ramp = np.arange(5000) * SUBSTEP
    law, defining = built("transport_delay", "joined_samples", 0.3)
    late = (ramp - through(law, ramp))[1000:]
    assert defining["delay"] == 0.3
    np.testing.assert_allclose(late, 0.3, rtol=1e-9)


def test_the_laminar_stream_arrives_as_danckwerts_says():
    taken, defining = response("transport_delay", "laminar_tube", 0.3)
    assert not defining  # neither its first arrival nor its mean is a delay
    np.testing.assert_allclose(taken[:130], 0.0, atol=1e-12)
    # A share 1 - (T/2t)² has arrived by t: its root is a straight line in 1/t.
    time = np.arange(1, taken.size + 1) * SUBSTEP
    between = (taken > 0.15) & (taken < 0.9)
    line = np.polyfit(1.0 / time[between], np.sqrt(1.0 - taken[between]), 1)
    assert line[0] == pytest.approx(0.5 * 0.3, rel=0.15)
    assert line[1] == pytest.approx(0.0, abs=0.06)


@pytest.mark.parametrize("seed", range(4))
def test_what_a_line_reflects_arrives_at_odd_multiples(seed):
    taken, defining = response("transport_delay", "reflecting_line", 0.3, seed)
    assert (1.0 - taken).sum() * SUBSTEP == pytest.approx(defining["delay"], abs=2e-3)
    moments = np.flatnonzero(np.abs(np.diff(taken, prepend=0.0)) > 1e-6)
    np.testing.assert_allclose(moments + 1, 300 * (2 * np.arange(moments.size) + 1), atol=1)
    heights = np.diff(taken, prepend=0.0)[moments]
    np.testing.assert_allclose(heights[1:] / heights[:-1], heights[1] / heights[0], rtol=1e-6)
    assert 0.03 <= abs(heights[1] / heights[0]) <= 0.1
    assert heights[0] >= 0.9


def test_the_jittered_delay_varies_within_a_fifth_of_its_mean():
    ramp = np.arange(60_000) * SUBSTEP
    law, defining = built("transport_delay", "jittered_delay", 0.3)
    late = (ramp - through(law, ramp))[1000:]
    assert np.abs(late - defining["delay"]).max() <= 0.2 * defining["delay"] + SUBSTEP
    assert np.std(late) > 0.005


def test_a_varying_delay_lies_between_sub_steps():
    ramp = np.arange(100) * SUBSTEP
    mean, depth = 3.5 * SUBSTEP, 1.0 * SUBSTEP
    # A sine that stands at a quarter of its height.
    still = [mean, depth, 0.0, np.arcsin(0.25)]
    passed = through(SignalLaw(_jittered, still, np.zeros(10)), ramp)
    np.testing.assert_allclose(ramp[10:] - passed[10:], 3.75 * SUBSTEP, rtol=1e-9)


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


@pytest.mark.parametrize("seed", range(3))
def test_the_lead_s_inductance_hardly_overshoots_and_does_as_scipy_says(seed):
    from scipy.signal import TransferFunction, step

    taken, defining = response("electrode_lag", "lead_inductance", 0.2, seed)
    over = np.log(taken.max() - 1.0)
    damping = -over / np.hypot(np.pi, over)
    assert 0.79 < damping < 0.96
    angular = 2.0 * damping / defining["lag"]
    time = np.arange(1500) * SUBSTEP
    circuit = TransferFunction([angular**2], [1.0, 2.0 * damping * angular, angular**2])
    np.testing.assert_allclose(taken[:1499], step(circuit, T=time)[1][1:], atol=5e-3)


DISC_STEPS = np.arange(20, 2000, 40)


@pytest.fixture(scope="module")
def charged_discs():
    """Return the mean charge at ``DISC_STEPS`` of discs with a mean delay of 0.4 s.

    Of rings that pass charge to each other, the outermost through its contact, which has from half
    to a twentieth of the disc's resistance.
    """
    rings = 40
    edges = np.linspace(0.0, 1.0, rings + 1)
    areas, step = np.diff(edges**2), 1.0 / rings
    between = 2.0 * edges[1:-1] / step  # circumference over distance, as twice the area without pi
    inside = np.diag(between, 1) + np.diag(between, -1)
    inside -= np.diag(inside.sum(axis=1))
    charged = []
    for ratio in np.geomspace(2.0, 20.0, 24):
        flow = inside.copy()
        flow[-1, -1] -= 2.0 / (1.0 / ratio + 0.5 * step)
        rates, shapes = np.linalg.eigh(flow / np.sqrt(np.outer(areas, areas)))
        weights = (np.sqrt(areas) @ shapes) ** 2
        pace = weights @ (-1.0 / rates) * SUBSTEP / 0.4
        charged.append(1.0 - np.exp(np.outer(DISC_STEPS, rates * pace)) @ weights)
    return np.array(charged)


@pytest.mark.parametrize("seed", range(3))
def test_the_disc_is_charged_as_rings_of_a_circle_are(seed, charged_discs):
    taken, defining = response("electrode_lag", "rim_contact", 0.4, seed)
    assert defining["lag"] == pytest.approx(0.4)
    misfits = np.abs(charged_discs - taken[DISC_STEPS - 1]).max(axis=1)
    assert misfits.min() < 3e-3
    assert misfits.max() > 1.5e-2


def test_the_thermometer_has_one_pole():
    left = 1.0 - response("sensor_lag", "bare_thermometer", 0.2)[0][:1000]
    np.testing.assert_allclose(left[1:] / left[:-1], np.exp(-SUBSTEP / 0.2), rtol=1e-4)


def test_the_insulated_face_warms_as_the_series_of_carslaw_and_jaeger():
    taken, defining = response("sensor_lag", "buried_sensor", 0.4)
    # The mean delay of a slab of thickness L and diffusivity a is L²/2a.
    seconds = 2.0 * defining["lag"]
    time = np.arange(100, 2000, 50) * SUBSTEP
    order = 2 * np.arange(60)[:, None] + 1
    signs = (-1.0) ** np.arange(60)[:, None]
    series = signs / order * np.exp(-((order * np.pi / 2.0) ** 2) * time / seconds)
    expected = 1.0 - 4.0 / np.pi * series.sum(axis=0)
    np.testing.assert_allclose(taken[99:1999:50], expected, atol=0.012)


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


UNEVEN = {"class_a_follower", "stepping_motor"}  # quick upwards, or in steps


@pytest.mark.parametrize(
    "form", [form.name for form in EFFECTS["slew_limit"].forms if form.name not in UNEVEN]
)
@pytest.mark.parametrize("seed", range(3))
def test_the_rate_is_limited_and_the_target_reached(form, seed):
    law, defining = built("slew_limit", form, 2.0, seed)
    passed = through(law, np.repeat([1.0, 4.0, 1.0], [10, 6000, 6000]))
    rates = np.diff(passed) / SUBSTEP
    np.testing.assert_allclose(passed[:10], 1.0, atol=1e-9)  # it starts at rest
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


def test_the_follower_falls_at_its_rate_and_rises_at_once():
    law, defining = built("slew_limit", "class_a_follower", 2.0)
    passed = through(law, np.repeat([1.0, 4.0, 1.0], [10, 3000, 3000]))
    np.testing.assert_allclose(passed[:10], 1.0, atol=1e-9)
    assert passed[40] == pytest.approx(4.0, abs=0.01)
    falling = np.diff(passed[3010:])
    np.testing.assert_allclose(falling[:1900], -defining["rate"] * SUBSTEP, rtol=1e-9)
    assert passed[-1] == pytest.approx(1.0, abs=1e-6)


def test_the_servo_moves_at_its_rate_and_ends_exponentially():
    law, defining = built("slew_limit", "rate_limited_servo", 2.0)
    passed = through(law, np.repeat([1.0, 4.0], [10, 6000]))
    speeds, error = np.diff(passed[10:]) / SUBSTEP, 4.0 - passed[10:-1]
    full = speeds > (1.0 - 1e-6) * defining["rate"]
    assert full[:1500].all()
    ending = ~full & (error > 1e-6)
    np.testing.assert_allclose(
        speeds[ending] / error[ending], speeds[ending][-1] / error[ending][-1]
    )
    assert 0.08 < 1.0 / (speeds[ending] / error[ending])[0] < 0.31


@pytest.mark.parametrize("size", [0.1, 2.0])
def test_the_motor_steps_so_many_times_a_second(size):
    law, defining = built("slew_limit", "stepping_motor", size)
    passed = through(law, np.repeat([1.0, 4.0, 1.0], [10, 6000, 6000]))
    steps = np.abs(np.diff(passed))
    step = law._constants[0]
    assert 0.0003 * CONDITIONS.span <= step <= 0.001 * CONDITIONS.span
    np.testing.assert_allclose(steps / step, np.rint(steps / step), atol=1e-6)
    middle = (passed > 1.5) & (passed < 3.5)
    line = np.polyfit(np.flatnonzero(middle[:6000]) * SUBSTEP, passed[:6000][middle[:6000]], 1)
    assert line[0] == pytest.approx(defining["rate"], rel=0.03)
    assert np.abs(passed[[6000, -1]] - [4.0, 1.0]).max() <= 0.5 * step + 1e-9


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


@pytest.mark.parametrize(
    "form", ["space_charge", "schottky_emission", "hopping", "tunnelling", "poole_frenkel"]
)
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
    elif form == "hopping":  # sinh 2x = 2 sinh x cosh x
        steep = np.arccosh(0.5 * np.exp(second))
        assert 1.0 < steep < 2.5
        assert np.exp(first) == pytest.approx(2.0 * np.cosh(0.5 * steep), rel=0.01)
    elif form == "tunnelling":  # ln(I/E²) is a straight line in 1/E: Fowler and Nordheim's plot
        slopes = (np.array([first, second]) - 2 * np.log(2)) / [0.5, 0.25]
        assert slopes[0] == pytest.approx(slopes[1], rel=0.02)
        assert slopes[0] > 2.0
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


def test_interfaces_polarise_with_two_times():
    law = built("charge_leakage", "interfacial_polarisation", 0.3)[0]
    kept = through(law, np.full(200_000, 2.0))
    assert kept[0] == pytest.approx(2.0, rel=2e-3)
    assert kept[-1] == pytest.approx(2.0 * (1.0 - 0.3), rel=1e-2)
    double = through(
        built("charge_leakage", "interfacial_polarisation", 0.3)[0], np.full(9000, 4.0)
    )
    np.testing.assert_allclose(double, 2.0 * kept[:9000], rtol=1e-9)
    # Equally spaced values of two exponentials obey a recursion of second order about their end.
    left = np.diff(kept[:60_000:500])
    design = np.column_stack([left[1:-1], left[:-2]])
    recursion, residual, *_ = np.linalg.lstsq(design, left[2:], rcond=None)
    times = -0.5 / np.log(np.roots([1.0, *-recursion]))
    assert residual.max() < 1e-12
    assert 5.0 < times.max() / times.min() < 25.1
