"""Whether a residual is coloured noise and nothing else."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.stats import chi2, kurtosis

from dea.autoregression import fit_autoregression, innovations
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.null import long_blocks, long_parts
from dea.discrepancy.evidence.regression import part_predicted
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.evidence.unknown_force import unknown_force
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit, at_prior_bounds
from dea.discrepancy.problem.period import exact_period
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import misfit
from dea.inputs import by_input
from dea.missing import runs

# Excess kurtosis of the innovations, and spread of the logarithms of their levels block by block,
# above which they do not come from one stationary source.
_KURTOSIS, _UNEVEN = 1.0, 0.35
_TELLING = 20  # innovations of a block that show its level
# Lags at which signs are compared; part of the samples that must have a partner at a lag for it to
# be used; probability with which the test rejects white noise.
_SIGNS, _PAIRS, _CHANCE = 50, 0.2, 1e-3
# Gaussian signals of a residual's spectrum, all of which it must exceed to be told from them.
_SURROGATES = 200
# Part of the record over which energies are averaged, and the shifts of the motion (the nearest by
# a twentieth of the record) all of which its energy at the right time must exceed.
_AVERAGED, _SHIFTS, _NEAREST = 200, 200, 20
# Lags of the input, up to this part of the longest record, and the weight of the ridge.
_LAGS, _LONGEST, _RIDGE = 24, 20, 1e-4


def is_coloured_noise(
    problem: Problem,
    residual: np.ndarray,
    blocks: Sequence[slice],
    most: float,
) -> bool:
    """Return whether a residual (n,) is stationary, Gaussian and follows from nothing known.

    An autoregression whitens it; what that leaves must be as large in every one of the
    ``blocks`` and without outliers. Where a slow residual and white noise are mixed, whitening
    leaves mostly the white noise. Therefore the residual itself is also compared with Gaussian ones
    of the same spectrum. Input and motion may predict a part of it of at most ``most``, and the
    energy of the motion the same part of its energy.
    """
    parts = long_parts(residual, blocks)
    if len(parts) < 2:  # nothing says whether it is as large everywhere
        return False
    colour = fit_autoregression(parts)
    white = [innovations(colour, part) for part in parts if part.size >= colour.order + _TELLING]
    if len(white) < 2:
        return False
    sharp, uneven = _shape(white)
    return (
        sharp <= _KURTOSIS
        and uneven <= _UNEVEN
        and predictable(problem, residual) <= most
        and not follows_energy(problem, residual, most)
        and is_like_gaussian(residual, long_blocks(blocks))
    )


def _shape(parts: Sequence[np.ndarray]) -> tuple[float, float]:
    """Return the excess kurtosis of a signal, and how much the logarithms of its levels spread."""
    levels = np.log([part.std() for part in parts])
    return float(kurtosis(np.concatenate(parts))), float(np.std(levels))


def leaves_coloured_noise(
    problem: Problem, fitted: Fit, blocks: Sequence[slice], most: float
) -> bool:
    """Return whether what a fit leaves is coloured noise that no smooth force would cause."""
    return is_coloured_noise(problem, fitted.residual, blocks, most) and follows_no_force(
        problem, fitted, most
    )


def coloured_level(evidence: Evidence, pool: Sequence[Candidate]) -> float:
    """Return the level of the coloured noise beyond the white one, in the output's unit.

    It is what the best finished candidate of a ``pool``, best first, leaves: 0 where that is white,
    too much of the energy of the residual of the simulation alone, or not known to be noise, which
    it is not where a parameter of the simulation is at the bound of its prior.
    """
    white, rules = evidence.noise_floor, evidence.rules
    best = next((c for c in pool if c.finished), None)
    if best is None or best.rmse <= rules.clean * white:
        return 0.0
    removed = rules.removes_energy(best.rmse, evidence.nominal_error)
    if not removed or at_prior_bounds(best.fit):
        return 0.0
    most = rules.may_follow(len(best.names))
    noise = leaves_coloured_noise(evidence.problem, best.fit, evidence.blocks, most)
    return misfit(best.rmse, white) if noise else 0.0


def follows_no_force(problem: Problem, fitted: Fit, most: float) -> bool:
    """Return whether no smooth force predicts more than a part of what a fit leaves."""
    force = unknown_force(problem, fitted)
    return force is None or force.part <= most


def is_white(problem: Problem, residual: np.ndarray) -> bool:
    """Return whether the signs of a residual (n,) follow one another at random where it is seen.

    Their autocorrelation at the first lags is tested (Ljung and Box 1978, Biometrika 65:297), which
    noise passes whose level changes.
    """
    signs = np.sign(residual - np.median(residual[problem.seen]))
    parts = [signs[run] for run in runs(problem.seen)]
    pairs = np.array([sum(max(part.size - k, 0) for part in parts) for k in range(1, _SIGNS + 1)])
    lags = 1 + np.flatnonzero(pairs > _PAIRS * problem.seen.sum())
    if not lags.size:
        return False
    products = [sum(float(part[k:] @ part[:-k]) for part in parts if part.size > k) for k in lags]
    statistic = np.sum(np.array(products) ** 2 / pairs[lags - 1])
    return bool(chi2.sf(statistic, lags.size) > _CHANCE)


def predictable(problem: Problem, residual: np.ndarray) -> float:
    """Return the part of a residual that input and motion predict on samples not fitted to.

    Where the input repeats, so is what the residual repeats with it, whatever the law.
    """
    flexible = 1.0 - residual_model(problem, residual).ratio
    return max(flexible, _follows_input(problem, residual), part_repeated(problem, residual))


def is_like_gaussian(residual: np.ndarray, blocks: Sequence[slice]) -> bool:
    """Return whether a residual (n,) is as even as Gaussian noise of its spectrum can be.

    Its kurtosis and the spread of its levels over the ``blocks`` are compared with those of signals
    with the same spectrum and random phases (Theiler et al. 1992, Physica D 58:77): what comes from
    a few events has larger ones. As much more is allowed as of innovations.
    """
    joined = np.concatenate([residual[block] for block in blocks])
    joined -= joined.mean()
    spectrum = np.abs(np.fft.rfft(joined))
    ends = np.cumsum([block.stop - block.start for block in blocks])[:-1]
    # The same phases for every residual, so that two of one record are compared alike.
    rng = np.random.default_rng(0)

    def surrogate() -> np.ndarray:
        turned = spectrum * np.exp(2j * np.pi * rng.random(spectrum.size))
        return np.fft.irfft(turned, joined.size)

    made = [_shape(np.split(surrogate(), ends)) for _ in range(_SURROGATES)]
    sharpest, most_uneven = np.max(made, axis=0)
    sharp, uneven = _shape(np.split(joined, ends))
    return bool(sharp <= sharpest + _KURTOSIS and uneven <= np.hypot(most_uneven, _UNEVEN))


def follows_energy(problem: Problem, residual: np.ndarray, most: float) -> bool:
    """Return whether a residual (n,) is large where the simulated output moves far or fast.

    What the device itself causes, as a parameter that changes with time does, need not be
    predictable from the motion, but is as large as it. The logarithms of both energies, averaged
    over a short time, are compared: more than ``most`` of the variance must be shared, and more
    than with the motion shifted round the record.
    """
    seen, n = problem.seen, residual.size
    window = np.ones(max(3, n // _AVERAGED))
    there = np.convolve(seen, window, "same")
    left = np.where(seen, residual - residual[seen].mean(), 0.0)
    energy = np.log(np.convolve(left**2, window, "same")[seen] / there[seen] + 1e-300)
    motion = problem.y - residual
    # The same shifts for every residual, so that two of one record are compared alike.
    shifts = np.random.default_rng(0).integers(n // _NEAREST, n - n // _NEAREST, _SHIFTS)

    def shared(signal: np.ndarray) -> bool:
        moved = np.convolve(signal**2, window, "same")
        moved = np.log(moved + 1e-12 * moved.mean() + 1e-300)
        if not np.ptp(moved) or not np.ptp(energy):
            return False
        here, *elsewhere = (
            np.corrcoef(energy, np.roll(moved, shift)[seen])[0, 1] for shift in (0, *shifts)
        )
        return bool(here > max(elsewhere) and here**2 > most)

    return shared(motion - motion.mean()) or shared(problem.rate_of(motion))


def _follows_input(problem: Problem, residual: np.ndarray) -> float:
    """Return the part of a residual that a long moving average of every input predicts.

    A dynamic error of the simulation shows there, whatever its time constants.
    """
    longest = max(own.stop - own.start for own in problem.records)
    lags = np.unique(np.round(np.geomspace(1, max(2, longest // _LONGEST), _LAGS)).astype(int)) - 1

    def past(u: np.ndarray) -> np.ndarray:
        return _past(u, lags)

    X = np.column_stack([problem.of_each_record(past, u) for u in by_input(problem.u)])
    return part_predicted(problem, residual, X, (_RIDGE,))


def part_repeated(problem: Problem, residual: np.ndarray) -> float:
    """Return the part of a residual that its other periods predict, where an input repeats.

    What is slower than a period is left out: of two periods that follow one another it is alike.
    """
    others = np.zeros(problem.size)
    for own, period in zip(problem.records, problem.periods, strict=True):
        if period:
            slow = uniform_filter1d(problem.across_certified(residual)[own], period)
            exact = exact_period(problem.u[own], period)
            others[own] = _of_other_periods(residual[own] - slow, problem.seen[own], exact)
    return part_predicted(problem, residual, others[:, None], (_RIDGE,)) if others.any() else 0.0


def _of_other_periods(signal: np.ndarray, seen: np.ndarray, period: float) -> np.ndarray:
    """Return the mean (n,) of a signal at the same phase of the other periods, where it is seen."""
    phase = np.rint(np.arange(signal.size) % period).astype(int) % round(period)
    own = np.where(seen, signal, 0.0)
    total, count = np.bincount(phase, own), np.bincount(phase, seen)
    mean: np.ndarray = (total[phase] - own) / np.maximum(count[phase] - seen, 1)
    return mean


def _past(u: np.ndarray, lags: np.ndarray) -> np.ndarray:
    """Return an input (n,) at its ``lags``, and what lies between them, as columns."""
    u = u - u.mean()
    late = np.minimum(lags, u.size)
    X = np.column_stack([np.concatenate([np.zeros(k), u[: u.size - k]]) for k in late])
    # Differences of running sums join the lags without leaving samples out between them.
    sums = np.cumsum(X, axis=0)
    return np.column_stack([X, np.diff(sums, axis=1)])
