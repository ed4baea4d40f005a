"""Starting values for laws whose cost has many minima: lines and jumps of the residual."""

import numpy as np

from dea.discrepancy.problem import Problem
from dea.inputs import by_input

_LINES = 2
# Periods in a record at least: a wave of five harmonics that hardly repeats is any course in time.
_REPEATED = 6
_JUMPS = 3
_GRID = 8
# Bins beside a harmonic that its window spreads to.
_BESIDE = 2.0
_HARMONICS = 5
# Part of the highest power that a sharp line has at least, and how far it stands above the power
# around it: noise hardly reaches half of that.
_LEAST, _SHARP = 1e-6, 20.0
# Foreign lines at most.
_MOST = 4
# Bins on either side of a line that are its own, that it spreads to at most, and that it is
# compared with.
_LINE, _SPREAD, _AROUND = 3, 6, 30


def lines(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return frequencies (Hz) at which the residual, or its ratio to the input, has a line.

    Of several inputs the one with most power at a frequency counts there.
    """
    own = problem.records[_longest(problem)]
    frequency, power = _spectrum(problem.across_certified(residual)[own], problem.interval)
    driving = []
    for each in by_input(problem.u):
        drive = _spectrum(each[own], problem.interval)[1]
        surroundings = np.convolve(drive, np.ones(9) / 9, "same")
        driving.append(surroundings / (surroundings.max() or 1.0))
    ratio = power / (np.max(driving, axis=0) + 1e-3)
    nothing = np.zeros(power.size, bool)
    return (
        *_peaks(frequency, power, power, nothing),
        *_peaks(frequency, power, ratio, nothing),
    )


def foreign_lines(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return the frequencies (Hz) of lines that are no harmonics of a periodic input.

    Where the input repeats, whatever is missing repeats with it, and a wave of any shape with the
    input's period would explain it. Elsewhere the sharpest lines come first: what the simulation
    lacks besides is broad, and may yet be higher.
    """
    longest = _longest(problem)
    own, period = problem.records[longest], problem.periods[longest]
    frequency, power = _spectrum(problem.across_certified(residual)[own], problem.interval)
    if not period:
        sharpness = power / (_around(power) + 1e-300)
        noise = (power <= _LEAST * power.max()) | (sharpness <= _SHARP)
        sharp = _peaks(frequency, power, sharpness, noise)
        if len(sharp) == _LINES and _is_harmonic(sharp[0], sharp[1], frequency[1]):
            sharp.reverse()
        return tuple(dict.fromkeys((*sharp, *lines(problem, residual))))[:_MOST]
    orders = frequency * period * problem.interval
    harmonic = np.abs(orders - np.round(orders)) <= _BESIDE * orders[1]
    return tuple(_peaks(frequency, power, power, harmonic))


def _is_harmonic(line: float, fundamental: float, bin_width: float) -> bool:
    """Return whether a line is one of the first harmonics of another one."""
    order = round(line / fundamental)
    return 1 < order <= _HARMONICS and abs(line - order * fundamental) <= _BESIDE * bin_width


def _around(power: np.ndarray) -> np.ndarray:
    """Return the power of noise around each bin, but not beside it, where a line spreads to.

    It is the median, which other lines near by hardly change, over that of an exponential
    distribution with a mean of one.
    """
    from scipy.ndimage import median_filter

    there = np.ones(2 * _AROUND + 1, bool)
    there[_AROUND - _LINE : _AROUND + _LINE + 1] = False
    level: np.ndarray = median_filter(power, footprint=there, mode="reflect") / np.log(2.0)
    return level


def _longest(problem: Problem) -> int:
    """Return the number of the longest record, in which a line is sharpest.

    Where records join, its phase jumps.
    """
    lengths = [own.stop - own.start for own in problem.records]
    return lengths.index(max(lengths))


def _spectrum(signal: np.ndarray, interval: float) -> tuple[np.ndarray, np.ndarray]:
    window = np.hanning(signal.size)
    power = np.abs(np.fft.rfft((signal - signal.mean()) * window)) ** 2
    return np.fft.rfftfreq(signal.size, interval), power


def _peaks(
    frequency: np.ndarray, power: np.ndarray, prominence: np.ndarray, without: np.ndarray
) -> list[float]:
    """Return the frequencies of the highest peaks of a prominence, none of them ``without``."""
    beside = np.pad(prominence, 1)
    peaked = (prominence >= beside[:-2]) & (prominence >= beside[2:])
    left = np.where(without | ~peaked, 0.0, prominence)
    # The first bins hold trends, which no wave repeats.
    left[:_REPEATED] = 0.0
    found = []
    for _ in range(_LINES):
        peak = int(np.argmax(left))
        if left[peak] > 0.0:
            found.append(float(frequency[peak] + _offset(power, peak) * frequency[1]))
        left[max(0, peak - _SPREAD) : peak + _SPREAD + 1] = 0.0
    return found


def _offset(power: np.ndarray, peak: int) -> float:
    """Return how many bins the true line is from ``peak`` (parabola through the log power)."""
    if not 0 < peak < power.size - 1:
        return 0.0
    left, middle, right = np.log(power[peak - 1 : peak + 2] + 1e-300)
    curvature = left - 2.0 * middle + right
    return float(np.clip(0.5 * (left - right) / curvature, -0.5, 0.5)) if curvature < 0 else 0.0


def jumps(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return instants (s) at which mean, or coupling to the output, of the residual changes most.

    They count from the start of the record that each is found in. Cumulative sums find them (Page
    1954); a coarse grid over the longest record catches what they miss.
    """
    simulated, seen = problem.y - residual, problem.across_certified(residual)
    found: list[float] = []
    for own in problem.records:
        left, driven = seen[own], simulated[own] - simulated[own].mean()
        for weighted in (left, left * driven):
            n = weighted.size
            k = np.arange(1, n)
            score = np.abs(np.cumsum(weighted - weighted.mean())[:-1]) / np.sqrt(k * (n - k) / n)
            for _ in range(_JUMPS):
                at = int(np.argmax(score))
                found.append((at + 1) * problem.interval)
                score[max(0, at - n // 20) : at + n // 20] = 0.0
    own = problem.records[_longest(problem)]
    grid = (np.arange(_GRID) + 0.5) / _GRID * (own.stop - own.start) * problem.interval
    return (*found, *(float(instant) for instant in grid))
