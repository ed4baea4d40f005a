"""Starting values from the residual, what parameters are charged, and how much is spent."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.discrepancy.budget import Budget
from dea.discrepancy.fitting.candidates import best_of_each_set, judged
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.period import exact_period, period_of
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.search.hints import _around, foreign_lines, jumps, lines

INTERVAL, SAMPLES = 0.02, 3000
T = np.arange(SAMPLES) * INTERVAL  # 60 s: bins of 1/60 Hz


def recorded(u, y, seen=None):
    seen = np.ones(y.size, bool) if seen is None else seen
    return Problem(u, y, INTERVAL, seen, np.zeros(y.size, bool), ~seen)


@pytest.mark.parametrize("frequency", [1.3, 1.3083, 7.77])
def test_lines_are_found_between_the_bins(frequency):
    rng = np.random.default_rng(1)
    u = rng.standard_normal(SAMPLES)
    trend = 5.0 + 20.0 * np.sin(2 * np.pi * T / 60.0)
    residual = trend + np.sin(2 * np.pi * frequency * T + 0.3) + 0.3 * np.sin(2 * np.pi * 3.1 * T)
    found = lines(recorded(u, residual), residual + 1e-3 * rng.standard_normal(SAMPLES))
    assert found[0] == pytest.approx(frequency, abs=0.1 / 60)
    assert found[1] == pytest.approx(3.1, abs=0.1 / 60)


def test_lines_at_the_ends_of_the_spectrum_are_found_in_any_unit():
    rng = np.random.default_rng(7)
    u = rng.standard_normal(SAMPLES)
    slow = np.sin(2 * np.pi * 7.2 / 60.0 * T)
    residual = 2.0 * slow + 0.3 * (-1.0) ** np.arange(SAMPLES)
    found = lines(recorded(u, residual), residual)
    assert found[:2] == pytest.approx([7.2 / 60.0, 0.5 / INTERVAL], abs=0.3 / 60)
    assert found[1] == pytest.approx(0.5 / INTERVAL, rel=1e-12)
    tiny = 1e-6 * residual
    assert lines(recorded(u, tiny), tiny) == pytest.approx(found, rel=1e-6)


def test_an_input_at_rest_hides_no_line_of_the_ratio():
    rng = np.random.default_rng(2)
    u, still = rng.standard_normal(SAMPLES), np.full(SAMPLES, 2.0)
    residual = np.sin(2 * np.pi * 1.3 * T) + 0.1 * rng.standard_normal(SAMPLES)
    found = lines(recorded(still, residual), residual)
    assert len(found) == 4
    assert found[2:] == found[:2]  # the ratio to nothing that moves is the residual itself
    both = np.column_stack([u, still])
    assert lines(recorded(both, residual), residual) == lines(recorded(u, residual), residual)


def test_a_course_that_hardly_repeats_is_no_line():
    """Five harmonics of four periods are any course in time."""
    rng = np.random.default_rng(7)
    u, noise = rng.standard_normal(SAMPLES), 0.3 * rng.standard_normal(SAMPLES)
    slow, fast = (np.sin(2 * np.pi * periods / 60.0 * T) for periods in (4.1, 9.0))
    problem = recorded(u, slow + noise)
    assert min(foreign_lines(problem, slow + noise)) >= 6.0 / 60.0
    both = 3.0 * slow + fast + noise
    assert foreign_lines(problem, both)[0] == pytest.approx(9.0 / 60.0, abs=0.3 / 60)


@pytest.mark.parametrize("seed", range(6))
def test_a_hump_is_no_line_and_leaves_the_lines_of_a_modulated_wave(seed):
    """A slow random motion, higher than the wave and its sidebands, is as wide as several lines."""
    rng = np.random.default_rng(seed)
    u = rng.standard_normal(SAMPLES)
    hump = lfilter([1.0], np.poly([0.99, 0.99]), rng.standard_normal(SAMPLES))
    wave = np.sin(2 * np.pi * 0.9 * T + 0.7 * np.sin(2 * np.pi * 0.2 * T))
    residual = 3.0 * hump / hump.std() + wave
    found = foreign_lines(recorded(u, residual), residual)
    assert found[0] == pytest.approx(0.9, abs=0.3 / 60)
    assert abs(found[1] - 0.9) == pytest.approx(0.2, abs=0.3 / 60)


def test_what_a_periodic_input_repeats_is_no_foreign_line():
    u = np.sign(np.sin(2 * np.pi * 0.2 * T + 0.1))
    own = np.sin(2 * np.pi * 0.6 * T) + 0.5 * np.cos(2 * np.pi * 1.4 * T)
    foreign = 0.2 * np.sin(2 * np.pi * 2.713 * T)
    problem = recorded(u, own + foreign)
    assert problem.periods == (250,)
    assert lines(problem, own + foreign)[0] == pytest.approx(0.6, abs=0.1 / 60)
    assert foreign_lines(problem, own + foreign)[0] == pytest.approx(2.713, abs=0.1 / 60)
    noise = np.random.default_rng(3).standard_normal(SAMPLES)
    aperiodic = recorded(noise, own)
    assert set(lines(aperiodic, own)) <= set(foreign_lines(aperiodic, own))


def few_periods(seed, period=980, lines=9):
    """Return an input of 3.06 periods, and what a device answers to it in another way."""
    rng = np.random.default_rng(seed)
    orders, phases = np.arange(1, lines + 1), rng.uniform(0.0, 2.0 * np.pi, (2, lines))
    angles = 2.0 * np.pi * np.outer(np.arange(SAMPLES) / period, orders)
    sizes = rng.uniform(0.3, 1.0, lines)
    return np.cos(angles + phases[0]).sum(axis=1), (sizes * np.cos(angles + phases[1])).sum(axis=1)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("order", [5.25, 14.5, 43.07])
def test_a_wave_is_told_from_an_input_of_few_periods(seed, order):
    """No bin is far from a harmonic of the input, but the wave is not at one and stands out."""
    u, own = few_periods(seed)
    frequency = order / (980 * INTERVAL)
    wave = sum(np.cos(2 * np.pi * k * frequency * T + k) / k for k in (1, 2, 3))
    residual = 0.1 * own + 1.5 * wave + 0.05 * np.random.default_rng(seed).standard_normal(SAMPLES)
    problem = recorded(u, residual)
    assert problem.periods == (980,)
    assert foreign_lines(problem, residual)[0] == pytest.approx(frequency, abs=0.2 / 60)


@pytest.mark.parametrize("period", [50.3, 97.4, 150.45, 980.3, 1400.6])
@pytest.mark.parametrize("seed", range(3))
def test_what_an_input_repeats_is_no_foreign_line_whatever_its_period(seed, period):
    """The period is mostly no whole number of samples."""
    rng = np.random.default_rng(seed)
    angle = 2.0 * np.pi * np.arange(SAMPLES) / period
    for u in (np.sin(angle), sum(np.cos(k * angle + k * k) for k in range(1, 8))):
        bent = np.clip(u, -0.5, 0.7) - 0.4 * u + 0.1 * u**2
        residual = bent + 0.002 * rng.standard_normal(SAMPLES)
        for frequency in foreign_lines(recorded(u, residual), residual):
            order = frequency * period * INTERVAL
            assert abs(order - round(order)) * SAMPLES / period > 0.1


@pytest.mark.parametrize("period", [50.3, 97.4, 980.3, 1400.6, 1497.3])
def test_a_period_is_told_to_a_part_of_a_sample(period):
    u = np.sin(2.0 * np.pi * np.arange(SAMPLES) / period)
    assert exact_period(u, period_of(u)) == pytest.approx(period, abs=0.01)


@pytest.mark.parametrize("spacing", [0, 1, 6])
def test_the_noise_around_a_line_is_the_median_beside_it(spacing):
    rng = np.random.default_rng(spacing)
    power = rng.exponential(size=400)
    power[200] = 1e6
    highest = np.array([power[max(0, i - spacing) : i + spacing + 1].max() for i in range(400)])
    beside, far = 3 + spacing, 30 + 10 * spacing
    step = max(spacing // 3, 1)
    side = range(beside + 1, far + 1, step)
    expected = np.median([highest[200 + sign * k] for k in side for sign in (-1, 1)])
    drawn = np.median(rng.exponential(size=(20_001, 2 * spacing + 1)).max(axis=1))
    assert _around(power, spacing)[200] == pytest.approx(expected / drawn, rel=0.03)


def test_the_period_is_that_of_each_record():
    """One excitation that is played twice is no periodic input; nor do joints hide a period."""
    hum = np.sin(2 * np.pi * 3.137 * T)
    once = np.random.default_rng(3).standard_normal(SAMPLES)
    twice = replace(recorded(np.tile(once, 2), np.tile(hum, 2)), lengths=(SAMPLES, SAMPLES))
    assert twice.periods == (0, 0)
    assert foreign_lines(twice, np.tile(hum, 2))[0] == pytest.approx(3.137, abs=0.1 / 60)

    u = np.sign(np.sin(2 * np.pi * 0.2 * T + 0.1))
    own = np.sin(2 * np.pi * 0.6 * T) + 0.2 * np.sin(2 * np.pi * 2.713 * T)
    cut = np.r_[0:2050, 0:SAMPLES]
    joined = replace(recorded(u[cut], own[cut]), lengths=(2050, SAMPLES))
    assert joined.periods == (250, 250)
    assert foreign_lines(joined, own[cut])[0] == pytest.approx(2.713, abs=0.1 / 60)


def test_of_lines_that_the_input_does_not_have_the_sharpest_comes_first():
    rng = np.random.default_rng(5)
    u = rng.standard_normal(SAMPLES)
    broad = lfilter([1.0], [1.0, -1.94, 0.95], rng.standard_normal(SAMPLES))
    sharp = 0.1 * broad.std() * np.sin(2 * np.pi * 17.0 * T)
    problem = recorded(u, broad + sharp)
    assert abs(lines(problem, broad + sharp)[0] - 17.0) > 1.0
    assert foreign_lines(problem, broad + sharp)[0] == pytest.approx(17.0, abs=0.2 / 60)


def test_a_line_is_weighed_by_what_the_input_has_around_it():
    """A strong answer to a strong input is no line; a weak one where there is no input is."""
    rng = np.random.default_rng(2)
    slow = np.cumsum(rng.standard_normal(SAMPLES))
    u = slow - np.convolve(slow, np.ones(100) / 100, "same")
    residual = 0.3 * u + 0.1 * u.std() * np.sin(2 * np.pi * 17.0 * T)
    found = lines(recorded(u, residual), residual)
    assert found[2] == pytest.approx(17.0, abs=0.2 / 60)


@pytest.mark.parametrize("at", [60, 700, 1500, 2400])
def test_a_jump_of_the_mean_is_found_where_it_is(at):
    rng = np.random.default_rng(3)
    residual = np.where(np.arange(SAMPLES) < at, 0.0, 1.0) + 0.05 * rng.standard_normal(SAMPLES)
    found = jumps(recorded(np.zeros(SAMPLES), np.sin(T) + residual), residual)
    assert found[0] == pytest.approx(at * INTERVAL, abs=1.01 * INTERVAL)
    assert len(found) == 2 * 3 + 8
    # The neighbourhood of an instant, a twentieth of the record on either side, holds no other.
    assert np.diff(np.sort(found[:3])).min() >= SAMPLES // 20 * INTERVAL - 1e-9
    np.testing.assert_allclose(found[-8:], 60.0 * np.arange(1, 16, 2) / 16)


def test_a_change_that_passes_is_found_at_both_ends():
    samples = np.arange(SAMPLES)
    residual = 1.0 * ((samples >= 800) & (samples < 2200))
    residual += 0.01 * np.random.default_rng(3).standard_normal(SAMPLES)
    found = jumps(recorded(np.zeros(SAMPLES), np.sin(T) + residual), residual)
    assert sorted(found[:2]) == pytest.approx(
        [800 * INTERVAL, 2200 * INTERVAL], abs=1.01 * INTERVAL
    )


def test_a_jump_counts_from_the_start_of_its_own_record():
    """The mean of the second record differs from that of the first, which is no jump."""
    second = np.arange(SAMPLES) >= 2000
    residual = 4.0 * second + (np.arange(SAMPLES) >= 2400)
    residual = residual + 0.05 * np.random.default_rng(3).standard_normal(SAMPLES)
    problem = recorded(np.zeros(SAMPLES), np.sin(T) + residual)
    found = jumps(replace(problem, lengths=(2000, SAMPLES - 2000)), residual)
    assert found[6] == pytest.approx(400 * INTERVAL, abs=1.01 * INTERVAL)
    assert max(found) <= 2000 * INTERVAL


def test_a_jump_shortly_before_the_end_is_found_among_noise():
    noise = np.random.default_rng(5).standard_normal(SAMPLES)
    residual = noise + np.where(np.arange(SAMPLES) < 2985, 0.0, 2.5)
    found = jumps(recorded(np.zeros(SAMPLES), np.sin(T) + residual), residual)
    assert found[0] == pytest.approx(2985 * INTERVAL, abs=3 * INTERVAL)


def test_a_jump_of_the_coupling_to_the_output_is_found_where_it_is():
    rng = np.random.default_rng(4)
    simulated = 3.0 + np.sin(2 * np.pi * 1.7 * T)
    after = np.arange(SAMPLES) >= 1900
    residual = 0.3 * after * (simulated - 3.0) + 0.01 * rng.standard_normal(SAMPLES)
    found = jumps(recorded(np.zeros(SAMPLES), simulated + residual), residual)
    assert found[3] == pytest.approx(1900 * INTERVAL, abs=0.6)


def test_a_residual_that_grows_by_itself_is_no_jump_of_the_coupling():
    rng = np.random.default_rng(6)
    simulated = 3.0 + np.sin(2 * np.pi * 1.7 * T)
    loud = np.where(np.arange(SAMPLES) < 800, 0.0, 1.0) * rng.standard_normal(SAMPLES)
    residual = loud + (np.arange(SAMPLES) >= 1900) * (simulated - 3.0)
    found = jumps(recorded(np.zeros(SAMPLES), simulated + residual), residual)
    assert found[3] == pytest.approx(1900 * INTERVAL, abs=0.6)


def fitted(residual, parameters):
    return Fit(
        SimpleNamespace(attached=()), np.zeros(parameters), residual,
        np.zeros((residual.size, parameters)), 0.0,
    )  # fmt: skip


def test_a_parameter_that_its_prior_holds_is_charged_in_part():
    """With one column of the Jacobian, the matrix that maps the record to its fit is known."""
    seen = np.arange(SAMPLES) < 2000
    residual = np.where(seen, 0.3, 50.0)
    jacobian = np.zeros((SAMPLES, 3))
    jacobian[:4, 0] = 1.0
    plain = recorded(residual, residual, seen)
    found = judged(plain, replace(fitted(residual, 3), jacobian=jacobian))
    told = 4.0 / plain.noise**2
    assert found.freedom == pytest.approx(told / (1.0 + told))


def test_a_parameter_is_charged_as_by_the_bayesian_information_criterion():
    """n log(error^2) + k log n ranks as the error times the charge does."""
    seen = np.arange(SAMPLES) < 2000
    residual = np.where(seen, 0.3, 50.0)
    told = replace(fitted(residual, 7), jacobian=1e6 * np.eye(SAMPLES, 7))
    found = judged(recorded(residual, residual, seen), told)
    assert found.rmse == pytest.approx(0.3)
    assert 2000 * np.log(found.error**2) == pytest.approx(2000 * np.log(0.3**2) + 7 * np.log(2000))
    assert found.finished
    assert not judged(recorded(residual, residual, seen), fitted(residual, 7), False).finished


def test_of_each_set_the_candidate_of_least_error_is_kept():
    def candidate(labels, error, finished=True):
        return SimpleNamespace(labels=labels, error=error, finished=finished)

    one, other = candidate(("a", "b"), 2.0), candidate(("b", "a"), 1.0)
    single, screened = candidate(("a",), 1.5), candidate(("a", "b"), 0.5, False)
    assert best_of_each_set([one, other, single, screened]) == [screened, other, single]


def test_a_long_record_gets_half_of_the_fits():
    budget = Budget(
        starts=5, finished=6, beam=1, kept=3, screening=4, shakes=4, exchanges=3,
        restarted=9, effects=3, last_steps=21, long_record=1000,
    )  # fmt: skip
    assert budget.of(1000, False) is budget
    long = budget.of(1001, False)
    halved = (long.starts, long.finished, long.beam, long.kept, long.screening)
    assert halved == (2, 3, 1, 1, 2)
    assert (long.shakes, long.exchanges, long.restarted) == (1, 0, 4)
    assert (long.effects, long.last_steps) == (3, 21)
    assert (budget.room, long.room) == (0.0, 0.12)
    assert long.tolerance == pytest.approx(10 * budget.tolerance)
    none = Budget(shakes=0, restarted=0, long_record=10).of(11, False)
    assert (none.shakes, none.restarted) == (0, 0)
    assert budget.of(1000, True) is budget
    decimated = budget.of(1001, True)
    assert (decimated.starts, decimated.finished, decimated.beam, decimated.kept) == (2, 6, 1, 1)
    assert (decimated.screening, decimated.last_steps) == (4, 42)
    assert decimated.tolerance == budget.tolerance


def test_no_hint_comes_from_certified_samples():
    """A step and a line that the certified block alone shows."""
    rng = np.random.default_rng(9)
    seen = np.ones(SAMPLES, bool)
    seen[1200:1800] = False
    quiet = 0.05 * rng.standard_normal(SAMPLES)
    shown = quiet + np.where(seen, 0.0, 5.0 * np.sin(2 * np.pi * 7.77 * T))
    shown[1500:1800] += 3.0
    u = rng.standard_normal(SAMPLES)
    found = [
        (
            lines(problem, residual),
            foreign_lines(problem, residual),
            jumps(problem, residual),
        )
        for residual in (quiet, shown)
        for problem in [recorded(u, np.sin(T) + residual, seen)]
    ]
    assert found[0] == found[1]


def test_a_step_in_the_certified_block_is_looked_for_inside_it():
    seen = np.ones(SAMPLES, bool)
    seen[1200:1800] = False
    noise = 0.01 * np.random.default_rng(9).standard_normal(SAMPLES)
    residual = noise + (np.arange(SAMPLES) >= 1700)
    found = jumps(recorded(np.zeros(SAMPLES), residual, seen), residual)
    assert 1200 * INTERVAL < found[0] < 1800 * INTERVAL


@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_each_instant_is_told_once_in_any_unit(unit):
    residual = unit * (0.3 * (T > 20.0) - 0.2 * (T > 41.0))
    found = jumps(recorded(np.zeros(SAMPLES), unit * np.sin(T) + residual), residual)
    assert found[0] == pytest.approx(20.0, abs=0.1)
    assert min(abs(np.diff(sorted(found[:2])))) > 1.0


@pytest.mark.parametrize("samples", [35, 60, 110, 130])
def test_a_short_record_has_lines_too(samples):
    rng = np.random.default_rng(7)
    residual = np.sin(2.0 * np.pi * np.arange(samples) / 5.0) + 0.01 * rng.standard_normal(samples)
    problem = recorded(rng.standard_normal(samples), residual)
    assert foreign_lines(problem, residual)[0] == pytest.approx(0.2 / INTERVAL, rel=0.05)
