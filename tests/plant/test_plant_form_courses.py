"""Hidden drifts, faults, disturbances and foreign effects, against what their names say."""

from collections import Counter

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, held, resist, sweep, through

from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden import EFFECTS, Use
from dea.plant.hidden.effect import Port

SAMPLES = round(CONDITIONS.duration / SUBSTEP)
TIME = np.arange(SAMPLES) * SUBSTEP
INSIDE = [effect for effect in EFFECTS.values() if effect.port is not Port.OUTSIDE]


def forms(effect):
    return [form.name for form in EFFECTS[effect].forms]


def test_every_effect_has_forms_of_both_uses_and_each_form_one_publication():
    names = Counter(form.name for effect in EFFECTS.values() for form in effect.forms)
    assert max(names.values()) == 1
    for effect in INSIDE:
        uses = Counter(form.use for form in effect.forms)
        assert len(effect.forms) >= 3
        assert uses[Use.TUNING] >= 1
        assert uses[Use.REPORTING] >= 2
        assert all("(" in form.source for form in effect.forms)
    foreign = [effect for effect in EFFECTS.values() if effect.port is Port.OUTSIDE]
    assert len(foreign) >= 10
    assert min(Counter(effect.forms[0].use for effect in foreign).values()) >= 5


def course(effect, form, size=0.2, seed=0):
    """Return what a law on a signal makes of ones, or adds to nothing."""
    law = built(effect, form, size, seed)[0]
    if effect == "gain_drift":
        return through(law, np.ones(SAMPLES)) - 1.0
    if isinstance(law, ForceLaw):
        return held(law, CONDITIONS.rest, CONDITIONS.duration)
    return through(law, np.zeros(SAMPLES))


@pytest.mark.parametrize("effect", ["gain_drift", "baseline_drift"])
def test_a_drift_begins_at_nothing_and_is_slow(effect):
    for form in forms(effect):
        for seed in range(3):
            drift = course(effect, form, 0.2, seed)
            size = np.abs(drift).max()
            assert abs(drift[0]) < 1e-2 * size
            assert np.abs(np.diff(drift[:: round(1.0 / SUBSTEP)])).max() < 0.5 * size


def test_drifts_follow_their_laws():
    rate = np.diff(course("gain_drift", "ageing_gain")[::1000])
    np.testing.assert_allclose(rate[1:] / rate[:-1], rate[1] / rate[0], rtol=1e-3)
    root = course("gain_drift", "diffusing_gain")[5000::1000]
    assert np.polyfit(np.log(TIME[5000::1000]), np.log(np.abs(root)), 1)[0] == pytest.approx(
        0.5, abs=1e-3
    )
    inverse = 1.0 / np.gradient(course("gain_drift", "logarithmic_gain")[2000::1000])
    seconds = np.arange(inverse.size)
    line = np.polyval(np.polyfit(seconds[1:-1], inverse[1:-1], 1), seconds[1:-1])
    np.testing.assert_allclose(inverse[1:-1], line, rtol=0.03)
    tide = course("baseline_drift", "daily_swing")[::500]
    assert np.linalg.matrix_rank(np.column_stack([tide[:-2] + tide[2:], tide[1:-1]]), 0.05) >= 1
    # A sine about a level obeys y[k+1] + y[k-1] = 2 cos(w) y[k] + constant.
    design = np.column_stack([tide[1:-1], np.ones(tide.size - 2)])
    fit, *_ = np.linalg.lstsq(design, tide[:-2] + tide[2:], rcond=None)
    np.testing.assert_allclose(design @ fit, tide[:-2] + tide[2:], atol=1e-4 * np.ptp(tide))


@pytest.mark.parametrize(
    ("effect", "form"), [("gain_drift", "wandering_gain"), ("baseline_drift", "wandering_baseline")]
)
def test_a_wandering_course_reaches_its_size_and_differs_with_the_seed(effect, form):
    reach = {"gain_drift": 1.0, "baseline_drift": CONDITIONS.travel}[effect]
    drifts = [course(effect, form, 0.2, seed) for seed in range(4)]
    for drift in drifts:
        assert np.abs(drift).max() == pytest.approx(0.2 * reach, rel=1e-3)
    assert len({round(float(drift[-1]), 6) for drift in drifts}) == 4


@pytest.mark.parametrize("form", forms("step_fault"))
@pytest.mark.parametrize("seed", range(4))
def test_a_fault_happens_once_at_its_moment(form, seed):
    law, defining = built("step_fault", form, 0.2, seed)
    if isinstance(law, ForceLaw):
        course = held(law, 5.0, CONDITIONS.duration)
    else:
        course = through(law, np.ones(SAMPLES)) - 1.0
    moment = defining["time"]
    assert 0.3 * CONDITIONS.duration <= moment <= 0.7 * CONDITIONS.duration
    before, after = moment - 1.2 > TIME, moment + 8.0 < TIME
    np.testing.assert_allclose(course[before], 0.0, atol=1e-2)
    np.testing.assert_allclose(course[after], course[-1], rtol=1e-2)
    assert abs(course[-1]) > 0.05


def test_a_chamber_s_slipping_mount_changes_its_gain():
    chamber = CONDITIONS._replace(force=False, power=2.0)
    law, defining = built("step_fault", "slipped_mount", 0.2, 0, chamber)
    gain = through(law, np.ones(SAMPLES)) ** 2
    jump = int(np.argmax(np.abs(np.diff(gain)))) + 1
    assert jump * SUBSTEP == pytest.approx(defining["time"], abs=2 * SUBSTEP)
    assert np.unique(np.round(gain, 9)).size == 2


@pytest.mark.parametrize("form", forms("periodic_disturbance"))
@pytest.mark.parametrize("seed", range(3))
def test_a_disturbance_has_its_strongest_line_at_its_frequency(form, seed):
    law, defining = built("periodic_disturbance", form, 0.1, seed)
    if isinstance(law, ForceLaw):
        wave = held(law, 0.0, CONDITIONS.duration)
    else:
        wave = through(law, np.zeros(SAMPLES))
    spectrum = np.abs(np.fft.rfft((wave - wave.mean()) * np.hanning(SAMPLES), 8 * SAMPLES))
    found = np.fft.rfftfreq(8 * SAMPLES, SUBSTEP)[int(np.argmax(spectrum))]
    assert found == pytest.approx(defining["frequency"], abs=0.1 / 6.0)


def test_waves_are_what_their_names_say():
    law, defining = built("periodic_disturbance", "rectified_sine", 0.1)
    wave = through(law, np.zeros(SAMPLES))
    phase = defining["frequency"] * TIME % 1.0
    # Half the time nearly level, half a hump of height 2 x 0.1 travels.
    assert np.ptp(wave) == pytest.approx(0.2 * CONDITIONS.travel, rel=0.06)
    level = np.sort(
        [np.median(wave[np.abs(phase - p) < 0.01]) for p in np.linspace(0.02, 0.98, 48)]
    )
    assert level[20] - level[0] < 0.1 * np.ptp(wave)
    pulses = held(built("periodic_disturbance", "cogging", 0.1)[0], 0.0, CONDITIONS.duration)
    assert pulses.max() > 1.5 * -pulses.min()
    beat = through(built("periodic_disturbance", "beating_machines", 0.1)[0], np.zeros(SAMPLES))
    blocks = np.abs(beat).reshape(60, -1).max(axis=1)
    assert blocks.max() > 1.2 * blocks.min()


# Foreign effects


def test_heating_changes_the_gain_slowly_and_more_at_high_commands():
    warm = through(built("thermal_feedback", "thermal_feedback", 0.5)[0], np.full(200_000, 4.0))
    cool = through(built("thermal_feedback", "thermal_feedback", 0.5)[0], np.full(200_000, 2.0))
    assert warm[0] == 4.0
    assert abs(warm[-1] / 4.0 - 1.0) > 4.0 * abs(cool[-1] / 2.0 - 1.0) > 0.0


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


def test_delays_grow_with_command_and_with_time():
    for share in (0.0, 0.5, 1.0):
        ramp = CONDITIONS.low + share * CONDITIONS.span + 1e-6 * np.arange(3000)
        law = built("input_dependent_delay", "input_dependent_delay", 0.2)[0]
        late = (ramp - through(law, ramp))[-1] / 1e-6 * SUBSTEP
        assert late == pytest.approx(0.2 * share, rel=0.11, abs=2e-3)
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


def test_a_buckled_strip_pushes_both_ways():
    felt = resist(built("bistable_snap", "bistable_snap", 0.3)[0], sweep(11.0, start=1.0))
    largest = 0.3 * CONDITIONS.stiffness * CONDITIONS.travel
    assert felt.max() > 0.5 * largest
    assert felt.min() < -0.5 * largest
