"""Hidden drifts, faults and disturbances, against what their names say."""

import re
from collections import Counter

import numpy as np
import pytest
from made_conditions import CONDITIONS, OFFSET, SAMPLES, TIME, built, held, resist, through

from dea.plant.film import SUBSTEP
from dea.plant.forces import ForceLaw
from dea.plant.hidden import EFFECTS, Use
from dea.plant.hidden.effect import Port

INSIDE = [effect for effect in EFFECTS.values() if effect.port is not Port.OUTSIDE]
# Its authors at the beginning, and its year in brackets.
PUBLICATION = re.compile(r"[A-ZÅ][\w'-]+[\w .'-]*[,;] .*\((\w+, )?(1[89]|20)\d\d\)")


def forms(effect):
    return [form.name for form in EFFECTS[effect].forms]


def test_every_effect_has_forms_of_both_uses_and_each_form_one_publication():
    names = Counter(form.name for effect in EFFECTS.values() for form in effect.forms)
    assert max(names.values()) == 1
    for effect in EFFECTS.values():
        for form in effect.forms:
            assert PUBLICATION.match(form.source), form.source
    for effect in INSIDE:
        uses = Counter(form.use for form in effect.forms)
        assert uses[Use.TUNING] >= 4
        assert uses[Use.REPORTING] >= 2
    foreign = [effect for effect in EFFECTS.values() if effect.port is Port.OUTSIDE]
    assert min(Counter(effect.forms[0].use for effect in foreign).values()) >= 5


def course(effect, form, size=0.2, seed=0):
    """Return what a law on a signal makes of ones, or adds to nothing."""
    law = built(effect, form, size, seed, OFFSET)[0]
    if effect == "gain_drift":
        return through(law, np.ones(SAMPLES)) ** OFFSET.power - 1.0
    if isinstance(law, ForceLaw):
        return held(law, OFFSET.rest, OFFSET.duration)
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
    # A sine about a level obeys y[k+1] + y[k-1] = 2 cos(w) y[k] + constant.
    design = np.column_stack([tide[1:-1], np.ones(tide.size - 2)])
    fit, *_ = np.linalg.lstsq(design, tide[:-2] + tide[2:], rcond=None)
    np.testing.assert_allclose(design @ fit, tide[:-2] + tide[2:], atol=1e-4 * np.ptp(tide))


def test_drifts_that_are_straight_autocatalytic_or_in_two_parts():
    for effect, form in (("gain_drift", "linear_gain"), ("baseline_drift", "steady_zero")):
        np.testing.assert_allclose(np.diff(course(effect, form)[::1000], 2), 0.0, atol=1e-9)
    # A logistic curve from p0: the logit is a straight line for the right p0 and height.
    grown = np.abs(course("gain_drift", "autocatalytic_gain")[::1000])
    bends = []
    for first in np.linspace(0.0, 0.05, 51) * 0.2:
        if (grown + first).max() >= 0.2:
            continue
        logit = np.log((grown + first)[5:-8] / (0.2 - grown - first)[5:-8])
        line = np.polyval(np.polyfit(np.arange(logit.size), logit, 1), np.arange(logit.size))
        bends.append(np.abs(logit - line).max() / np.ptp(logit))
    assert min(bends) < 5e-3
    for effect, form, height in (
        ("gain_drift", "passing_gain", 0.2),
        ("baseline_drift", "differential_expansion", None),
    ):
        passing = np.abs(course(effect, form)[::500])
        crest = int(np.argmax(passing[:80]))
        assert 0 < crest < 80
        assert passing[119] < 0.9 * passing[crest]
        if height:
            assert passing[crest] == pytest.approx(height, rel=1e-3)
        # Two exponentials (and a constant): the steps obey a recursion of second order.
        steps = np.diff(course(effect, form)[::500])
        recursion = np.linalg.lstsq(np.column_stack([steps[1:-1], steps[:-2]]), steps[2:])
        assert recursion[1].max() < 1e-6 * np.ptp(steps) ** 2
    creep = course("baseline_drift", "creeping_mount")[1000::1000]
    design = np.column_stack([np.arange(1, 60) ** (1 / 3), np.arange(1, 60)])
    fit, residual, *_ = np.linalg.lstsq(design, creep)
    assert residual.max() < 1e-6 * np.ptp(creep) ** 2
    assert 0.2 < fit[0] * 60 ** (1 / 3) / creep[-1] < 0.85


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
    if form == "thickened_oil":  # felt in motion alone
        course = resist(law, 5.0 + TIME)
    elif isinstance(law, ForceLaw):
        course = held(law, 5.0, CONDITIONS.duration)
    elif form == "plugged_line":  # the lag behind a steady motion
        course = through(law, 5.0 + TIME) - (5.0 + TIME)
    elif form == "blocked_valve":  # felt at the highest commands alone
        course = through(law, np.full(SAMPLES, CONDITIONS.high)) / CONDITIONS.high - 1.0
    else:
        course = through(law, np.full(SAMPLES, 2.5)) / 2.5 - 1.0
    moment = defining["time"]
    assert 0.3 * CONDITIONS.duration <= moment <= 0.7 * CONDITIONS.duration
    before, after = moment - 1.2 > TIME, moment + 8.0 < TIME
    np.testing.assert_allclose(course[before], 0.0, atol=1e-2)
    np.testing.assert_allclose(course[after], course[-1], rtol=1e-2)
    assert abs(course[-1]) > 0.05


def test_biases_are_added_where_they_are():
    for form, height, output in (
        ("biased_sensor", 0.2 * CONDITIONS.travel, True),
        ("biased_command", 0.1 * CONDITIONS.span, False),
    ):
        law = built("step_fault", form, 0.2)[0]
        assert law.output is output
        wave = 2.5 + np.sin(TIME)
        added = through(law, wave) - wave  # whatever the signal
        assert abs(added[-1]) == pytest.approx(height)
        assert np.count_nonzero(np.abs(np.diff(added)) > 1e-6) < 110


@pytest.mark.parametrize("seed", range(4))
def test_a_biased_command_stays_within_its_range(seed):
    law, defining = built("step_fault", "biased_command", 1.0, seed)
    wave = 2.5 + 1.5 * np.sin(2.0 * np.pi * TIME)
    shifted = through(law, wave)
    before = defining["time"] > TIME
    np.testing.assert_array_equal(shifted[before], wave[before])
    assert CONDITIONS.low <= shifted.min()
    assert shifted.max() <= CONDITIONS.high
    middle = shifted[-1000:].mean() - wave[-1000:].mean()
    assert 0.2 * CONDITIONS.span < abs(middle) < 0.5 * CONDITIONS.span


def test_a_cleared_electrode_recovers_in_part():
    law, defining = built("step_fault", "clearing_electrode", 0.2, conditions=OFFSET)
    gain = through(law, np.ones(SAMPLES)) ** OFFSET.power - 1.0
    start = int(np.argmax(gain < 0.0))
    assert start * SUBSTEP == pytest.approx(defining["time"], abs=2 * SUBSTEP)
    assert gain[start] == pytest.approx(-0.2, rel=1e-2)
    assert 0.34 < gain[-1] / gain[start] < 0.71
    left = (gain[-1] - gain[start:])[:500]
    np.testing.assert_allclose(left[1:] / left[:-1], left[1] / left[0], rtol=1e-5)


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


@pytest.mark.slow
@pytest.mark.parametrize("form", forms("periodic_disturbance"))
def test_a_disturbance_of_slow_readings_is_below_half_their_rate(form):
    slow = CONDITIONS._replace(rate=5.0)
    drawn = [
        built("periodic_disturbance", form, 0.1, seed, slow)[1]["frequency"] for seed in range(20)
    ]
    assert max(drawn) < 2.5
    assert max(drawn) > 1.0


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


def lines_of(form, seed):
    """Return the frequencies and heights of the lines of a disturbance, strongest first."""
    law, defining = built("periodic_disturbance", form, 0.1, seed)
    wave = through(law, np.zeros(SAMPLES))
    window = np.hanning(SAMPLES)
    spectrum = np.abs(np.fft.rfft(wave * window, 4 * SAMPLES)) / window.sum() * 2.0
    peaks = np.flatnonzero((spectrum[1:-1] > spectrum[:-2]) & (spectrum[1:-1] > spectrum[2:])) + 1
    peaks = peaks[np.argsort(-spectrum[peaks])]
    frequencies = np.fft.rfftfreq(4 * SAMPLES, SUBSTEP)
    return frequencies[peaks], spectrum[peaks], defining["frequency"]


def test_a_ripple_falls_in_lines_and_its_harmonics_fall_with_their_order():
    law, defining = built("periodic_disturbance", "capacitor_ripple", 0.1, 3)
    wave = through(law, np.zeros(SAMPLES))
    assert np.abs(wave).max() == pytest.approx(0.1 * CONDITIONS.span, rel=0.02)
    jumps = np.flatnonzero(np.diff(wave) > 0.0)
    period = 1.0 / defining["frequency"]
    assert np.diff(jumps).mean() * SUBSTEP == pytest.approx(period, rel=0.02)
    falling = np.diff(wave)[np.diff(wave) < 0.0]
    np.testing.assert_allclose(falling, -0.2 * CONDITIONS.span / period * SUBSTEP, rtol=1e-6)


# Seeds at which a record resolves the sidebands.
@pytest.mark.parametrize("seed", [0, 4, 14])
def test_the_meshing_has_two_equal_sidebands(seed):
    frequencies, heights, main = lines_of("gear_meshing", seed)
    assert frequencies[0] == pytest.approx(main, abs=0.01)
    assert heights[0] == pytest.approx(0.1 * CONDITIONS.travel, rel=0.1)
    sides = np.sort(frequencies[1:3])
    assert sides.mean() == pytest.approx(main, abs=0.01)
    assert 0.04 < (sides[1] - main) / main < 0.21
    assert heights[2] == pytest.approx(heights[1], rel=0.1)
    assert 0.15 < heights[1] / heights[0] < 0.55


@pytest.mark.parametrize("seed", range(3))
def test_the_whirl_is_below_half(seed):
    frequencies, heights, main = lines_of("oil_whirl", seed)
    assert frequencies[0] == pytest.approx(main, abs=0.01)
    assert 0.41 < frequencies[1] / frequencies[0] < 0.49
    assert 0.35 < heights[1] / heights[0] < 0.85
