"""The level of white noise in a residual, and whether it is coloured noise alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.signal import lfilter, periodogram
from scipy.stats import kurtosis, norm

from dea.discrepancy.evidence.colour import (
    follows_energy,
    is_coloured_noise,
    is_like_gaussian,
    is_white,
    part_repeated,
    predictable,
)
from dea.discrepancy.problem.noise import at_a_limit, quantisation, white_level
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules
from dea.missing import runs

MOST = Rules().may_follow()

PIECE = 64  # samples whose levels are compared


def level_of(power):
    """Return the deviation of white noise with this median of its periodogram."""
    return np.sqrt(np.median(power) / np.log(2.0))


def upper_half(residual):
    """Return SciPy's periodogram above half the band, without the last line."""
    t = np.arange(residual.size)
    left = residual - np.polyval(np.polyfit(t, residual, 2), t)
    power = periodogram(left, window=np.hanning(left.size), detrend=False)[1] / 2.0
    return power[power.size // 2 : -1]


# White noise


@pytest.mark.parametrize("samples", [24, 25, 200, 701])
def test_the_level_of_one_block_is_that_of_its_periodogram(samples):
    residual = 3.0 * np.random.default_rng(samples).standard_normal(samples)
    power = upper_half(residual)
    low, high = power[: power.size // 2], power[power.size // 2 :]
    levels = level_of(low), level_of(high)
    alike = max(levels) ** 2 < 1.5 * min(levels) ** 2
    expected = level_of(power) if alike else min(levels)
    assert white_level(residual, [slice(0, samples)]) == pytest.approx(expected, rel=1e-9)


def test_a_trend_up_to_a_parabola_is_no_noise():
    rng = np.random.default_rng(1)
    noise, t = rng.standard_normal(600), np.arange(600.0)
    blocks = [slice(0, 300), slice(300, 600)]
    parabola, cubic = 1e9 * (t / 600 - 0.4) ** 2, 1e10 * (t / 600 - 0.4) ** 3
    level = white_level(noise, blocks)
    assert white_level(noise + parabola, blocks) == pytest.approx(level, rel=1e-4)
    assert white_level(noise + cubic, blocks) > 2.0 * level


@pytest.mark.parametrize(("ratio", "alike"), [(1.35, True), (1.65, False)])
@pytest.mark.parametrize("upper", [True, False])
def test_of_two_quarter_bands_the_lower_one_counts_where_one_is_larger_by_half(ratio, alike, upper):
    n = 20_000
    spectrum = np.fft.rfft(np.random.default_rng(2).standard_normal(n))
    above = np.fft.rfftfreq(n) > 0.375
    spectrum[above == upper] *= np.sqrt(ratio)
    found = white_level(np.fft.irfft(spectrum, n), [slice(0, n)]) ** 2
    both = brentq(lambda m: np.exp(-m) + np.exp(-m / ratio) - 1.0, 0.1, 3.0) / np.log(2.0)
    assert found == pytest.approx(both if alike else 1.0, rel=0.04)


@pytest.mark.parametrize(("quiet", "found"), [(0.2, 0.2), (0.45, 0.725)])
def test_the_quietest_quarter_counts_where_it_is_below_half_of_the_whole(quiet, found):
    """Halves of power ``quiet`` and 1 have a whole of the mean; a quarter is half of the quiet."""
    rng = np.random.default_rng(3)
    residual = rng.standard_normal(400 * PIECE)
    residual[: residual.size // 2] *= np.sqrt(quiet)
    level = white_level(residual, [slice(0, residual.size)]) ** 2
    assert level == pytest.approx(found, rel=0.08)


@pytest.mark.parametrize(("samples", "several"), [(12 * PIECE, True), (12 * PIECE - 1, False)])
def test_twelve_pieces_tell_whether_noise_varies_with_time(samples, several):
    residual = np.random.default_rng(4).standard_normal(12 * PIECE)
    residual[: 6 * PIECE] *= 0.1
    found = white_level(residual, [slice(0, samples)])
    pieces = [level_of(upper_half(part)) ** 2 for part in residual.reshape(12, PIECE)]
    if several:
        assert found == pytest.approx(np.sqrt(np.quantile(pieces, 0.25)), rel=1e-9)
    else:
        assert 0.5 < found < 1.0


def test_pieces_lie_within_blocks():
    """Twelve blocks of one piece, and what lies between them."""
    rng = np.random.default_rng(5)
    residual = rng.standard_normal((12, 100))
    residual[:6] *= 0.1
    residual[:, PIECE:] = 1e3
    blocks = [slice(start, start + PIECE) for start in range(0, 1200, 100)]
    pieces = [level_of(upper_half(part[:PIECE])) ** 2 for part in residual]
    found = white_level(residual.ravel(), blocks)
    assert found == pytest.approx(np.sqrt(np.quantile(pieces, 0.25)), rel=1e-9)


def test_of_a_block_that_is_not_finite_the_pieces_that_are_count():
    """The second of two blocks is quiet, and one of its 13 pieces is not finite."""
    residual = np.random.default_rng(13).standard_normal((26, PIECE))
    residual[13:] *= 0.1
    residual[20, 5] = np.nan
    half = 13 * PIECE
    pieces = [level_of(upper_half(part)) ** 2 for part in np.delete(residual, 20, axis=0)]
    found = white_level(residual.ravel(), [slice(0, half), slice(half, 2 * half)])
    assert found == pytest.approx(np.sqrt(np.quantile(pieces, 0.25)), rel=1e-9)


def test_what_is_not_finite_is_left_out():
    residual = np.random.default_rng(6).standard_normal(600)
    residual[420] = np.inf
    blocks = [slice(0, 200), slice(200, 400), slice(400, 600)]
    assert white_level(residual, blocks) == white_level(residual, blocks[:2])
    finite = np.delete(residual, 420)
    assert white_level(residual, blocks[2:]) == pytest.approx(np.std(finite))


def test_a_block_of_24_samples_counts():
    rng = np.random.default_rng(7)
    residual = np.concatenate([rng.standard_normal(60), 100.0 * rng.standard_normal(24)])
    blocks = [slice(0, 60), slice(60, 84)]
    assert white_level(residual, blocks) != white_level(residual, blocks[:1])
    assert white_level(residual, blocks[1:]) != np.std(residual)


# Rounding


def test_differences_of_floating_point_are_no_steps():
    y = 0.1 * np.array([-20.0, 3.0, 7.0, 8.0, 12.0])
    noisy = np.concatenate([y, y * (1.0 + 1e-15), y - 1e-12])
    assert quantisation(noisy) == pytest.approx(0.1 / np.sqrt(12.0), rel=1e-9)
    assert quantisation(np.array([0.0, 1e-6, 1.0])) == pytest.approx(1e-6 / np.sqrt(12.0))


# Coloured noise


N, BLOCK = 2500, 50
BLOCKS = [slice(k, k + BLOCK) for k in range(0, N, BLOCK)]
FIFTHS = [slice(k, k + N // 5) for k in range(0, N, N // 5)]


def record_of(u, residual):
    halves = np.arange(N) // 125 % 2 == 0
    y = residual + lfilter([0.2], [1.0, -0.8], np.atleast_2d(u.T)[0])
    return Problem(u, y, 0.02, halves, ~halves, np.zeros(N, bool))


def shuffled(values, levels=1.0):
    """The same values in every block, in an order of its own, times the block's level."""
    rng = np.random.default_rng(8)
    rows = [rng.permutation(values) for _ in BLOCKS]
    return (np.array(rows) * np.broadcast_to(levels, len(BLOCKS))[:, None]).ravel()


def is_noise(residual, blocks=BLOCKS):
    u = np.random.default_rng(9).standard_normal(N)
    return is_coloured_noise(record_of(u, residual), residual, blocks, MOST)


def test_blocks_hardly_longer_than_the_memory_do_not_hide_that_noise_is_noise():
    """A block of 21 samples leaves one innovation of a model of order 20, which has no spread."""
    rng = np.random.default_rng(3)
    spectrum = np.zeros(21)
    spectrum[[0, 20]] = 1.0, -0.7
    residual = lfilter([1.0], spectrum, rng.standard_normal(N))
    blocks = [slice(0, 21), slice(21, 43), *(slice(k, k + 250) for k in range(250, N, 250))]
    assert is_noise(residual, blocks)


@pytest.mark.parametrize(("excess", "noise"), [(-1.0, True), (0.92, True), (1.08, False)])
def test_noise_has_an_excess_kurtosis_of_no_more_than_one(excess, noise):
    quantiles = norm.ppf((np.arange(BLOCK) + 0.5) / BLOCK)

    def stretched(power):
        return np.sign(quantiles) * np.abs(quantiles) ** power

    power = brentq(lambda p: kurtosis(stretched(p)) - excess, 0.3, 3.0)
    residual = shuffled(stretched(power))
    assert kurtosis(residual) == pytest.approx(excess)
    assert is_noise(residual) is noise


@pytest.mark.parametrize(("spread", "noise"), [(0.33, True), (0.37, False)])
def test_noise_has_levels_that_spread_by_a_third(spread, noise):
    """The logarithms of the levels of the blocks deviate by ``spread``."""
    levels = np.exp(spread * (-1.0) ** np.arange(len(BLOCKS)))
    assert is_noise(shuffled(np.linspace(-1.0, 1.0, BLOCK), levels)) is noise


def test_two_blocks_tell_whether_noise_is_as_large_everywhere():
    residual = shuffled(np.linspace(-1.0, 1.0, BLOCK))
    halves = [slice(0, N // 2), slice(N // 2, N)]
    assert is_noise(residual, halves) is True
    assert is_noise(residual, halves[:1]) is False


def hidden(share, offset=0.0):
    """White noise, and a window of the input's past with so large a share of its power."""
    u = np.random.default_rng(10).standard_normal(N)
    past = lfilter(np.r_[np.zeros(20), np.hanning(100)], [1.0], u)
    past *= np.sqrt(share) / past.std()
    noise = np.sqrt(1.0 - share) * shuffled(np.linspace(-np.sqrt(3.0), np.sqrt(3.0), BLOCK))
    residual = past + noise + offset
    return record_of(u, residual), residual


@pytest.mark.parametrize("share", [0.4, 0.75])
def test_what_follows_the_inputs_past_is_predicted_whatever_the_lags(share):
    problem, residual = hidden(share)
    assert predictable(problem, residual) == pytest.approx(1.0 - np.sqrt(1.0 - share), abs=0.04)


@pytest.mark.parametrize("first", [N - 100, N - 40])
def test_what_follows_the_inputs_past_is_predicted_in_records_of_any_length(first):
    problem, residual = hidden(0.75)
    joined = replace(problem, lengths=(first, N - first))
    assert predictable(joined, residual) == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize(("share", "noise"), [(0.3, True), (0.45, False)])
def test_a_fifth_of_coloured_noise_may_be_predicted_or_what_is_allowed(share, noise):
    problem, residual = hidden(share)
    part = predictable(problem, residual)
    assert (part <= 0.2) is noise
    for most, allowed in ((0.2, noise), (part, True), (part - 1e-9, False)):
        assert is_coloured_noise(problem, residual, BLOCKS, most) is allowed
    assert is_coloured_noise(problem, residual, BLOCKS, MOST) is noise


def test_offsets_of_input_and_residual_predict_nothing():
    whole = predictable(*hidden(0.75))
    problem, residual = hidden(0.75, offset=0.4)
    far = replace(problem, u=problem.u + 30.0)
    assert predictable(far, residual) == pytest.approx(whole, abs=1e-6)


def test_the_past_of_every_input_counts():
    problem, residual = hidden(0.75)
    u = np.column_stack([np.random.default_rng(11).standard_normal(N), problem.u])
    assert predictable(replace(problem, u=u), residual) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize(("lag", "found"), [(5, True), (124, True), (130, False)])
def test_the_past_reaches_from_now_back_to_a_twentieth_of_the_record(lag, found):
    u = np.random.default_rng(12).standard_normal(N)
    residual = u + np.concatenate([np.zeros(lag), u[: N - lag]])
    part = predictable(record_of(u, residual), residual)
    assert part > 0.9 if found else part < 0.5


def slow(rng, memory, samples=N):
    """Gaussian noise of a deviation of one that remembers so many samples."""
    a = np.exp(-1.0 / memory)
    white = rng.standard_normal(samples + 10 * memory)
    return np.sqrt(1.0 - a**2) * lfilter([1.0], [1.0, -a], white)[10 * memory :]


def moving(y, residual):
    """A record whose simulation moves by ``y``, driven by a command that nothing follows."""
    halves = np.arange(N) // 125 % 2 == 0
    u = np.random.default_rng(13).standard_normal(N)
    return Problem(u, y + residual, 0.02, halves, ~halves, np.zeros(N, bool))


def repeated(seed, period, residual):
    """A record of a command that repeats, and what is left of it."""
    u = np.random.default_rng(seed).standard_normal(period)
    halves = np.arange(N) // 125 % 2 == 0
    return Problem(np.resize(u, N), residual, 0.02, halves, ~halves, np.zeros(N, bool))


@pytest.mark.parametrize("period", [97, 500, 1000])
@pytest.mark.parametrize("share", [0.3, 0.9])
def test_what_repeats_with_the_command_is_predicted_whatever_its_law(share, period):
    """A waveform that no past of the command tells, and white noise; of k periods k - 1 tell it."""
    rng = np.random.default_rng(15)
    wave = np.resize(rng.standard_normal(period), N)
    residual = np.sqrt(share) * wave + np.sqrt(1.0 - share) * rng.standard_normal(N)
    others = N / period - 1.0
    told = share**2 / (share + (1.0 - share) / others)
    part = predictable(repeated(16, period, residual), residual)
    assert part == pytest.approx(1.0 - np.sqrt(1.0 - told), abs=0.05)


@pytest.mark.parametrize("memory", [2, 50, 1000])
@pytest.mark.parametrize("period", [97, 500, 1000])
def test_noise_beside_a_command_that_repeats_is_not_predicted(memory, period):
    found = []
    for seed in range(12):
        residual = slow(np.random.default_rng(seed), memory)
        found.append(part_repeated(repeated(17, period, residual), residual))
    assert np.mean(np.array(found) > MOST) < 0.1


@pytest.mark.parametrize("seed", range(4))
def test_what_a_changing_parameter_leaves_is_no_noise(seed):
    """It is the motion times a course that nothing tells, beside white noise of the sensor."""
    rng = np.random.default_rng(seed)
    y, course = slow(rng, 60), slow(rng, 15)
    residual = 1.5 * y * course + rng.standard_normal(N)
    of_another = np.roll(y, N // 2)
    assert follows_energy(moving(y, residual), residual, MOST)
    assert not follows_energy(moving(of_another, residual), residual, MOST)
    assert not is_coloured_noise(moving(y, residual), residual, FIFTHS, MOST)


@pytest.mark.parametrize("bursts", [False, True])
def test_noise_of_its_own_seldom_follows_the_energy_of_the_motion(bursts):
    rng, taken, count = np.random.default_rng(14), 0, 120
    for trial in range(count):
        y = slow(rng, (5, 40, 200)[trial % 3])
        if bursts:
            y *= np.arange(N) // 400 % 2
        residual = slow(rng, (2, 20, 150)[trial // 3 % 3]) + 0.3 * rng.standard_normal(N)
        taken += follows_energy(moving(y, residual), residual, MOST)
    assert taken <= 0.04 * count


@pytest.mark.parametrize("seed", range(4))
def test_what_a_few_pushes_leave_is_no_noise(seed):
    """They are slow, so that the innovations are those of the sensor's white noise."""
    rng = np.random.default_rng(seed)
    pushes = np.zeros(N)
    pushes[rng.choice(N, 5, replace=False)] = rng.choice([-1.0, 1.0], 5)
    heard = lfilter([1.0], [1.0, -1.96, 0.9625], pushes)
    residual = 8.0 * heard / np.abs(heard).max() + rng.standard_normal(N)
    problem = moving(slow(rng, 60), residual)
    assert not is_like_gaussian(residual, FIFTHS)
    assert not is_coloured_noise(problem, residual, FIFTHS, MOST)
    # The same energy at the same frequencies, spread over the record.
    turned = np.exp(2j * np.pi * rng.random(N // 2 + 1))
    spread = np.fft.irfft(np.abs(np.fft.rfft(residual)) * turned, N)
    assert is_coloured_noise(moving(slow(rng, 60), spread), spread, FIFTHS, MOST)


@pytest.mark.parametrize("memory", [2, 30, 600])
def test_gaussian_noise_is_seldom_told_from_itself(memory):
    rng, count = np.random.default_rng(16), 60
    told = 0
    for _ in range(count):
        residual = slow(rng, memory) + 0.2 * rng.standard_normal(N)
        told += not is_like_gaussian(residual, FIFTHS)
    assert told <= 0.05 * count


def test_samples_that_are_not_seen_do_not_tell_what_noise_follows():
    rng = np.random.default_rng(15)
    y = slow(rng, 60)
    residual = slow(rng, 20)
    problem = replace(moving(y, residual), certify=np.arange(N) // 500 == 2)
    problem = replace(
        problem, fit=problem.fit & ~problem.certify, select=problem.select & ~problem.certify
    )
    assert not follows_energy(problem, residual, MOST)
    hidden_there = np.where(problem.certify, 30.0 * y, residual)
    spoilt = replace(problem, y=y + hidden_there)
    assert not follows_energy(spoilt, hidden_there, MOST)


def seen_in_part():
    """A record that is seen but for a tenth in its middle."""
    problem = record_of(np.zeros(N), np.zeros(N))
    return problem.seeing(np.abs(np.arange(N) - N / 2) > N / 20)


@pytest.mark.parametrize(
    ("colour", "slow", "period", "white"),
    [
        (0.0, 0.0, 1, True),
        (0.3, 0.0, 1, False),
        (0.0, 0.5, 600, False),  # the sine has an eighth of the power
        (0.0, 1.0, 139, False),
    ],
)
def test_white_noise_may_change_its_level(colour, slow, period, white):
    """Not so noise of a colour, or what changes slowly beneath it."""
    rng = np.random.default_rng(13)
    noise = lfilter([1.0], [1.0, -colour], rng.standard_normal(N))
    level = 1.0 + 0.9 * np.sin(2.0 * np.pi * 7.0 * np.arange(N) / N)
    beneath = slow * np.sin(2.0 * np.pi * np.arange(N) / period)
    assert is_white(seen_in_part(), level * noise + beneath) is white


def test_one_of_a_thousand_records_of_white_noise_fails():
    """So 300 of them hardly ever more than three times."""
    rng = np.random.default_rng(14)
    assert sum(not is_white(seen_in_part(), rng.laplace(size=N)) for _ in range(300)) <= 3


@pytest.mark.parametrize("pattern", ["every 20th", "every third", 0.05, 0.3, 0.5])
@pytest.mark.parametrize("slow", [0.0, 2.5])
def test_the_level_is_that_of_the_noise_whichever_samples_are_missing(pattern, slow):
    """A slow error beside white noise of 1; its gaps hold interpolated values."""
    samples, found = 3000, []
    blocks = [slice(first, first + 375) for first in range(0, samples, 375)]
    for seed in range(6):
        rng = np.random.default_rng(seed)
        known = np.ones(samples, bool)
        if isinstance(pattern, str):
            known[:: 20 if "20" in pattern else 3] = False
        else:
            known = rng.random(samples) >= pattern
        t = np.arange(samples)
        residual = rng.standard_normal(samples) + slow * np.sin(0.06 * t)
        residual = np.interp(t, t[known], residual[known])
        found.append(white_level(residual, blocks, known))
    assert np.mean(found) == pytest.approx(1.0, abs=0.07)


def test_short_gaps_do_not_cut_blocks():
    """Gaps of eight samples are bridged inside a block, not those of nine, nor at its ends."""
    seen = np.zeros(100, bool)
    seen[10:90] = True
    measured = np.ones(100, bool)
    for first, length in ((10, 1), (30, 8), (50, 9), (85, 8)):
        measured[first : first + length] = False
    problem = Problem(
        np.zeros(100), np.zeros(100), 0.02, seen & measured, seen & False, ~seen, measured=measured
    )
    assert runs(problem.bridged) == [slice(11, 50), slice(59, 85)]


def test_outputs_of_the_certified_block_choose_nothing():
    """Neither its noise nor its range reaches what a search compares candidates with."""
    rng = np.random.default_rng(5)
    certify = np.zeros(1000, bool)
    certify[400:600] = True
    y = rng.standard_normal(1000)
    problem = Problem(y, y, 0.02, ~certify, certify & False, certify)
    far = replace(problem, y=np.where(certify, 1e3 * y, y))
    np.testing.assert_array_equal(far.uncertified.y, problem.uncertified.y)
    blocks = problem.noise_blocks
    assert not any(certify[block].any() for block in blocks)
    assert white_level(far.y, blocks) == white_level(y, blocks)


def test_readings_that_a_limit_holds_are_told_from_those_of_a_coarse_converter():
    rng = np.random.default_rng(12)
    fine = np.sin(0.02 * np.arange(2000)) + 0.02 * rng.standard_normal(2000)
    held = np.minimum(fine, 0.5)
    found = at_a_limit(held)
    assert found.sum() == pytest.approx((fine > 0.5).sum(), rel=0.02)
    assert not found[held < 0.5].any()
    assert not at_a_limit(fine).any()
    at_rest = np.where(np.arange(2000) < 500, 0.0, np.round(fine, 1))
    assert not at_a_limit(np.abs(at_rest)).any()


def test_noise_that_a_limit_hides_and_rounding_count_in_the_level_of_a_problem():
    """The search asks it of every candidate, and the noise floor of the best of them."""
    rng = np.random.default_rng(13)
    clean = np.sin(0.02 * np.arange(2000))
    noise = 0.02 * rng.standard_normal(2000)
    reading = np.minimum(clean + noise, 0.5)
    seen = np.ones(2000, bool)
    problem = Problem(clean, reading, 0.02, seen, ~seen, ~seen)
    left = np.where(reading < 0.5, noise, 0.0)
    assert white_level(left, problem.noise_blocks) < 0.01
    assert problem.white_level(left) == pytest.approx(0.02, rel=0.15)
    assert problem.white_level(left, 3.0 * left) == problem.white_level(left)

    rounded = replace(problem, y=np.round(clean, 1))
    assert rounded.white_level(np.zeros(2000)) == pytest.approx(0.1 / np.sqrt(12.0))
