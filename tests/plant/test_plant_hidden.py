"""The hidden laws: each does what its name says, however the signal is cut."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from dea.excitation import design
from dea.plant import forces
from dea.plant.film import SUBSTEP
from dea.plant.hidden import EFFECTS
from dea.plant.hidden.refit import Yardstick
from dea.plant.parameters import read_plain
from dea.plant.rig import Rig
from dea.plant.signal_law import SignalLaw

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
PLAIN = read_plain(CONFIG)
COUNTS = PLAIN.output_converter.to_counts(
    design("gaussian", duration=60.0, sampling_rate=50.0, low=0.6, high=3.6, seed=1)
)
YARDSTICK = Yardstick(PLAIN, COUNTS)
CONDITIONS = YARDSTICK.conditions()
CATALOGUE = {
    "input path": 6,
    "force balance": 7,
    "parameter in time": 3,
    "output path": 4,
    "outside": 10,
}

# Laws that have a size and nothing else.
SHAPELESS = {"transport_delay", "electrode_lag", "sticking_sensor", "input_dependent_delay"}


def law(name, size=None, seed=0):
    effect = EFFECTS[name]
    size = np.sqrt(effect.smallest * effect.largest) if size is None else size
    return effect.build(size, CONDITIONS, np.random.default_rng(seed))


def through(stage, signal):
    changed = np.array(signal, dtype=float)
    stage.advance(changed)
    return changed


def test_every_place_has_its_effects():
    ports = [effect.port for effect in EFFECTS.values()]
    assert {port: ports.count(port) for port in ports} == CATALOGUE
    assert all(effect.smallest < effect.largest for effect in EFFECTS.values())


@pytest.mark.parametrize("name", EFFECTS)
def test_a_hidden_effect_disturbs_the_reading_the_same_however_it_is_cut(name):
    rng = np.random.default_rng(1)
    whole = Rig(PLAIN, 3, [law(name)])
    applied, measured = whole.advance(COUNTS)
    pieces = Rig(PLAIN, 3, [law(name)])
    cuts = np.sort(rng.integers(0, COUNTS.size, 40))
    answers = [pieces.advance(piece) for piece in np.split(COUNTS, cuts)]
    np.testing.assert_array_equal(measured, np.concatenate([answer[1] for answer in answers]))
    np.testing.assert_array_equal(applied, COUNTS)
    assert whole.fault == 0
    _, plain = Rig(PLAIN, 3).advance(COUNTS)
    assert np.abs(measured.astype(int) - plain.astype(int)).max() > 20


@pytest.mark.parametrize("name", EFFECTS)
def test_a_law_is_a_function_of_its_size_and_seed(name):
    first, same = (Rig(PLAIN, 3, [law(name, seed=4)]).respond(COUNTS) for _ in range(2))
    np.testing.assert_array_equal(first, same)
    others = [Rig(PLAIN, 3, [law(name, seed=seed)]).respond(COUNTS) for seed in range(5, 9)]
    drawn = any(not np.array_equal(first, other) for other in others)
    assert drawn == (name not in SHAPELESS)


def test_two_effects_act_together():
    alone = Rig(PLAIN, 0, [law("transport_delay", 0.3)]).respond(COUNTS)
    both = Rig(PLAIN, 0, [law("transport_delay", 0.3), law("output_saturation", 0.5)])
    limit = CONDITIONS.top - 0.5 * CONDITIONS.travel
    reading = both.respond(COUNTS)
    assert reading.max() < limit + 0.05 * CONDITIONS.travel
    low = alone < limit - 0.2 * CONDITIONS.travel
    np.testing.assert_allclose(reading[low], alone[low], rtol=1e-3)


def test_the_plain_actuator_alone_has_no_strength():
    assert YARDSTICK.strength([]) < 1e-6


def changed_plain(**factors):
    film = PLAIN.film
    changed = {name: getattr(film, name) * factor for name, factor in factors.items()}
    counts = np.concatenate([np.repeat(COUNTS[:1], 100), COUNTS])
    return Rig(replace(PLAIN, film=film._replace(**changed)), 0).respond(counts)[100:]


def test_a_change_of_free_parameters_is_absorbed_by_the_refit():
    reading = changed_plain(permittivity=1.1, damping=1.3)
    noise = PLAIN.sensor.noise
    assert np.std(reading - YARDSTICK.plain) / noise > 5.0
    assert YARDSTICK.unexplained(reading) / noise < 0.3


@pytest.mark.parametrize("name", ["slew_limit", "transport_delay", "charge_leakage"])
def test_strength_agrees_with_an_independent_refit(name):
    counts = np.concatenate([np.repeat(COUNTS[:1], 100), COUNTS])
    reading = Rig(PLAIN, 0, [law(name)]).respond(counts)[100:]

    def left(parameters):
        permittivity, stiffness, damping = np.exp(parameters)
        model = changed_plain(permittivity=permittivity, yeoh_1=stiffness, damping=damping)
        slope, offset = np.polyfit(model, reading, 1)
        return 1e6 * (reading - slope * model - offset)

    fit = least_squares(left, np.zeros(3), x_scale=[0.1, 0.1, 0.3], max_nfev=15)
    expected = np.sqrt(2.0 * fit.cost / reading.size) * 1e-6 / PLAIN.sensor.noise
    assert YARDSTICK.strength([law(name)]) == pytest.approx(expected, rel=0.1)


def test_what_a_strong_effect_hides_of_a_weak_one_does_not_count():
    stop, clip = law("end_stop", 0.7), law("output_saturation", 0.2)
    alone = YARDSTICK.linear_strength([clip])
    both = [law("end_stop", 0.7), law("output_saturation", 0.2)]
    assert alone > 3.0
    assert YARDSTICK.linear_strength(both, [stop]) < 0.05 * alone


def test_strength_is_infinite_where_the_film_is_pulled_in():
    assert YARDSTICK.strength([law("gain_drift", 5.0)]) == np.inf


# Input path


def test_the_dead_zone_passes_nothing_below_and_everything_at_the_top():
    stage = law("dead_zone", 0.3)
    passed = through(stage, [CONDITIONS.low, CONDITIONS.high])
    assert passed[0] < 0.02
    assert passed[1] == pytest.approx(CONDITIONS.high, rel=1e-6)


def test_the_ceiling_lets_low_commands_through():
    passed = through(law("input_saturation", 0.3), np.linspace(0.0, 10.0, 1001))
    limit = CONDITIONS.high - 0.3 * (CONDITIONS.high - CONDITIONS.low)
    assert passed[-1] == pytest.approx(limit, rel=0.01)
    np.testing.assert_allclose(passed[:150], np.linspace(0.0, 10.0, 1001)[:150], rtol=1e-3)


def test_the_rate_is_limited():
    passed = through(law("slew_limit", 2.0), np.repeat([0.0, 3.0], [10, 5000]))
    rates = np.diff(passed) / SUBSTEP
    expected = (CONDITIONS.high - CONDITIONS.low) / 2.0
    assert expected / 1.3 < rates.max() < expected * 1.3
    assert passed[-1] == pytest.approx(3.0, rel=1e-3)


@given(delay=st.integers(1, 600), seed=st.integers(0, 9))
@settings(deadline=None, max_examples=20)
def test_the_delay_is_pure(delay, seed):
    signal = np.random.default_rng(seed).random(2000)
    passed = through(law("transport_delay", delay * SUBSTEP), signal)
    np.testing.assert_array_equal(passed[delay:], signal[:-delay])
    np.testing.assert_array_equal(passed[:delay], signal[0])


def test_the_electrodes_diffuse_without_loss():
    size = 0.2
    passed = through(law("electrode_lag", size), np.repeat([0.0, 1.0], [1, 4000]))
    assert passed[-1] == pytest.approx(1.0, rel=1e-4)
    assert (np.diff(passed) >= 0.0).all()
    # The mean delay of a diffusion line is a fixed share of its time.
    assert (1.0 - passed).sum() * SUBSTEP == pytest.approx(size, rel=0.4)
    early = passed[1 + round(0.002 / SUBSTEP)]
    assert early > 1.0 - np.exp(-0.002 / size)  # faster at first than a single lag


def test_leakage_takes_a_share_of_a_sustained_voltage():
    passed = through(law("charge_leakage", 0.3), np.full(60_000, CONDITIONS.high))
    assert passed[0] == CONDITIONS.high
    assert passed[-1] / CONDITIONS.high == pytest.approx(1.0 / 1.3, rel=0.05)


# Force balance


def resist(force_law, path):
    """Force along a path that is followed slowly, one sub-step a point."""
    stacked = forces.stack([force_law])
    felt = []
    last = path[0]
    for y in path:
        v = (y - last) / SUBSTEP
        forces.update_memory(stacked, y, v, SUBSTEP)
        felt.append(forces.total_force(stacked, y, v))
        last = y
    return np.array(felt)


def sweep(*places, points=400):
    ends = [CONDITIONS.rest, *(CONDITIONS.bottom + place * CONDITIONS.travel for place in places)]
    pieces = [np.linspace(start, end, points, endpoint=False) for start, end in pairwise(ends)]
    return np.concatenate([*pieces, [ends[-1]]])


def test_creep_relaxes_as_a_power_of_time():
    size = 0.3
    stacked = forces.stack([law("viscoelastic_creep", size)])
    y = CONDITIONS.rest + 1e-4
    times, felt = np.array([0.1, 1.0, 10.0, 100.0]), []
    elapsed = 0
    for time in times:
        while elapsed < round(time / SUBSTEP):
            forces.update_memory(stacked, y, 0.0, SUBSTEP)
            elapsed += 1
        felt.append(forces.total_force(stacked, y, 0.0))
    assert felt[1] == pytest.approx(size * CONDITIONS.stiffness * 1e-4, rel=0.02)
    slopes = np.diff(np.log(felt)) / np.diff(np.log(times))
    assert (slopes < -0.08).all()
    assert slopes.max() - slopes.min() < 0.12


def test_hysteresis_does_not_depend_on_rate():
    slow = resist(law("rate_independent_hysteresis"), sweep(0.8, 0.2, 0.9, 0.4, points=4000))
    quick = resist(law("rate_independent_hysteresis"), sweep(0.8, 0.2, 0.9, 0.4, points=100))
    np.testing.assert_allclose(slow[::40], quick, rtol=1e-9, atol=1e-15)


def test_hysteresis_remembers_reversals_and_forgets_smaller_ones():
    outer = resist(law("rate_independent_hysteresis"), sweep(0.9, 0.1, 0.6))
    inner = resist(law("rate_independent_hysteresis"), sweep(0.9, 0.1, 0.5, 0.3, 0.45, 0.35, 0.6))
    assert inner[-1] == pytest.approx(outer[-1], rel=1e-9)


@given(
    places=st.lists(st.floats(0.0, 1.0), min_size=2, max_size=12),
    amount=st.floats(0.01, 2.0),
)
@settings(deadline=None, max_examples=40)
def test_hysteresis_takes_energy_around_any_closed_path(places, amount):
    path = sweep(*places, places[0], *places[1:], places[0], points=60)
    felt = resist(law("rate_independent_hysteresis", amount), path)
    start = 60
    around = slice(start, start + 60 * len(places) + 1)
    work = np.trapezoid(felt[around], path[around])
    assert work > -1e-3 * np.abs(felt).max() * CONDITIONS.travel


def test_friction_opposes_sliding_with_a_steady_force():
    size = 0.05
    sliding = size * CONDITIONS.stiffness * CONDITIONS.travel
    felt = resist(law("coulomb_friction", size), sweep(1.0, 0.0, points=2000))
    assert felt[1500:1990].mean() == pytest.approx(sliding, rel=0.5)
    assert felt[3500:3990].mean() == pytest.approx(-sliding, rel=0.5)
    assert np.abs(felt).max() < 1.6 * sliding + 0.01 * CONDITIONS.travel / SUBSTEP / 2000 * 2


def test_the_stop_is_felt_only_beyond_its_place():
    path = sweep(0.0, 1.0)
    felt = resist(law("end_stop", 0.4), path)
    place = CONDITIONS.top - 0.4 * CONDITIONS.travel
    assert (felt[path < place] == 0.0).all()
    assert (np.diff(felt[path > place]) > 0.0).all()
    assert felt[-1] > 0.5 * CONDITIONS.stiffness * CONDITIONS.travel


def test_stiffening_grows_faster_than_any_line():
    path = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 200)
    felt = resist(law("strain_stiffening", 0.5), path)
    assert (np.diff(felt, 2) > 0.0).all()
    assert felt[-1] == pytest.approx(0.5 * CONDITIONS.stiffness * CONDITIONS.travel, rel=1e-6)


def test_softening_grows_with_the_path_and_not_with_time():
    still = resist(law("cyclic_softening", 0.2), np.full(2000, CONDITIONS.top))
    assert (still == 0.0).all()
    moved = resist(law("cyclic_softening", 0.2), sweep(*[1.0, 0.0] * 30, 1.0))
    peaks = moved[800::800]
    assert (np.diff(np.abs(peaks)) > 0.0).all()
    assert peaks[-1] < 0.0


def test_the_second_mass_rings_at_its_own_frequency():
    force_law = law("second_mode", 0.1)
    mass, spring = force_law.constants[:2]
    frequency = np.sqrt(spring / mass) / (2.0 * np.pi)
    assert 0.6 <= frequency <= 2.0
    stacked = forces.stack([force_law])
    felt = []
    for _ in range(20_000):
        forces.update_memory(stacked, CONDITIONS.rest + 1e-5, 0.0, SUBSTEP)
        felt.append(forces.total_force(stacked, CONDITIONS.rest + 1e-5, 0.0))
    crossings = np.count_nonzero(np.diff(np.sign(felt)))
    assert crossings / 2.0 / 20.0 == pytest.approx(frequency, rel=0.1)


# Parameters in time, output path, outside


@pytest.mark.parametrize("seed", range(8))
def test_gain_drifts_steadily_and_stays_small(seed):
    ones = np.ones(round(CONDITIONS.duration / SUBSTEP))
    gain = through(law("gain_drift", 0.2, seed), ones) ** 2
    assert gain[0] == pytest.approx(1.0, abs=0.01)
    assert 0.1 < np.abs(gain - 1.0).max() <= 0.2 + 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_a_step_fault_happens_once_in_the_middle(seed):
    fault = law("step_fault", 0.2, seed)
    counts = np.full(COUNTS.size, COUNTS.mean(), np.uint16)
    reading = Rig(PLAIN, 0, [fault]).respond(counts)
    change = np.abs(np.diff(reading[50:]))
    when = (50 + int(np.argmax(change))) / counts.size
    assert 0.28 < when < 0.72
    assert reading[-1] != pytest.approx(reading[50], rel=1e-3)
    np.testing.assert_allclose(reading[50:800], reading[50], rtol=1e-3)


def test_the_sensor_lags_by_its_size_at_low_frequency():
    time = np.arange(40_000) * SUBSTEP
    lagged = through(law("sensor_lag", 0.15), time)
    assert (time - lagged)[-1] == pytest.approx(0.15, rel=0.02)


def test_the_sensor_takes_a_step_up_as_the_cube_of_time():
    step = np.ones(40)
    step[0] = 0.0
    taken = through(law("sensor_lag", 0.5), step)
    start = slice(12, 40)
    order = np.polyfit(np.log(np.arange(40)[start]), np.log(taken[start]), 1)[0]
    assert order == pytest.approx(3.0, abs=0.4)


def test_the_reading_ends_at_its_limit():
    y = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 500)
    read = through(law("output_saturation", 0.3), y)
    limit = CONDITIONS.top - 0.3 * CONDITIONS.travel
    assert read.max() <= limit
    np.testing.assert_allclose(
        read[y < limit - 0.2 * CONDITIONS.travel], y[y < limit - 0.2 * CONDITIONS.travel], rtol=1e-6
    )


@pytest.mark.parametrize("seed", range(8))
def test_a_nonlinear_sensor_errs_as_a_function_of_the_place_alone(seed):
    y = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 500)
    stage = law("sensor_nonlinearity", 0.3, seed)
    there, back = through(stage, y), through(stage, y[::-1])
    np.testing.assert_array_equal(there, back[::-1])
    line = np.polyval(np.polyfit(y, there, 1), y)
    assert np.abs(there - line).max() > 0.01 * CONDITIONS.travel


def test_a_disturbance_repeats_and_does_not_care_for_the_input():
    still = np.zeros(200_000)
    wave = through(law("periodic_disturbance", 0.1, 3), still)
    np.testing.assert_array_equal(
        wave + 1.0, through(law("periodic_disturbance", 0.1, 3), still + 1)
    )
    spectrum = np.abs(np.fft.rfft(wave * np.hanning(wave.size)))
    assert spectrum.max() > 20.0 * np.median(spectrum)


def test_the_sticking_sensor_jumps():
    y = np.linspace(0.0, CONDITIONS.travel, 5000)
    read = through(law("sticking_sensor", 0.1), y)
    assert np.abs(read - y).max() <= 0.1 * CONDITIONS.travel * 1.01
    assert 9 <= np.count_nonzero(np.diff(read)) <= 11


def test_the_loaded_delay_grows_with_the_command():
    delay = 0.2
    for share in (0.0, 0.5, 1.0):
        level = CONDITIONS.low + share * (CONDITIONS.high - CONDITIONS.low)
        ramp = level + 1e-6 * np.arange(3000)
        passed = through(law("input_dependent_delay", delay), ramp)
        behind = (ramp - passed)[-1] / 1e-6 * SUBSTEP
        assert behind == pytest.approx(delay * share, abs=0.01)


def test_the_telegraph_has_two_levels():
    levels = np.unique(through(law("telegraph_contact", 0.2), np.ones(60_000)))
    np.testing.assert_allclose(levels, [0.8, 1.0])


def test_the_gain_remembers_the_last_peak():
    up = np.linspace(CONDITIONS.low, CONDITIONS.high, 100)
    low = np.linspace(CONDITIONS.low, 0.5 * (CONDITIONS.low + CONDITIONS.high), 100)
    wave = np.concatenate([up, up[::-1], low, low[::-1], low])
    passed = through(law("peak_memory", 0.3), wave)
    assert passed[250] != pytest.approx(passed[450], rel=1e-3)


def test_a_stage_knows_its_side():
    assert isinstance(law("sensor_lag"), SignalLaw)
    assert law("sensor_lag").output
    assert not law("dead_zone").output
