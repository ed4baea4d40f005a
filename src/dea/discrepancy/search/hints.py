"""Starting values for laws whose cost has many minima: lines and jumps of the residual."""

import numpy as np

from dea.discrepancy.problem.parabola import vertex
from dea.discrepancy.problem.period import exact_period
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.spectrum import spectrum
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
# Harmonics of a periodic input that it is compared with on either side, and bins from one within
# which it is at it.
_HARMONICS_AROUND, _AT_HARMONIC = 10, 0.15
# How far such a line stands above the power just beside it.
_NARROW = 10.0


def lines(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return frequencies (Hz) at which the residual, or its ratio to the input, has a line.

    Of several inputs the one with most power at a frequency counts there.
    """
    own = problem.records[_longest(problem)]
    frequency, power = spectrum(problem.across_certified(residual)[own], problem.interval)
    driving = []
    for each in by_input(problem.u):
        drive = spectrum(each[own], problem.interval)[1]
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

    The sharpest lines come first: what else the simulation lacks is broad, even if it is higher.
    Where the input repeats, every missing effect repeats with it, so that a wave of any shape with
    the input's period would explain it. Therefore no line may be at a harmonic of the input, and
    one that does not stand out among the harmonics must be more than two bins away from them.
    """
    longest = _longest(problem)
    own, period = problem.records[longest], problem.periods[longest]
    frequency, power = spectrum(problem.across_certified(residual)[own], problem.interval)
    if not period:
        sharp = _sharpest(frequency, power, np.zeros(power.size, bool), 0)
        return tuple(dict.fromkeys((*sharp, *lines(problem, residual))))[:_MOST]
    spacing = (own.stop - own.start) / exact_period(problem.u[own], period)

    def harmonic(places: np.ndarray, within: float) -> np.ndarray:
        """Return which places, in bins, are at a harmonic of the input, or near to one."""
        result: np.ndarray = np.abs(places - spacing * np.round(places / spacing)) <= within
        return result

    # Beside few periods a slow motion that does not repeat stands out as well, but is broad.
    flanks = np.pad(power, _LINE + 1, mode="symmetric")
    broad = power < _NARROW * np.maximum(flanks[: -2 * _LINE - 2], flanks[2 * _LINE + 2 :])
    at_harmonic = harmonic(_places(power), _AT_HARMONIC)
    sharp = _sharpest(frequency, power, at_harmonic | broad, round(spacing))
    near = harmonic(np.arange(power.size), _BESIDE)
    beside = _peaks(frequency, power, power, near)
    return tuple(dict.fromkeys((*sharp, *beside)))[:_MOST]


def _sharpest(
    frequency: np.ndarray, power: np.ndarray, without: np.ndarray, spacing: int
) -> list[float]:
    """Return the frequencies of the sharpest lines, a fundamental before its harmonic."""
    sharpness = power / (_around(power, spacing) + 1e-300)
    without = without | (sharpness <= _SHARP) | (power <= _LEAST * power.max())
    sharp = _peaks(frequency, power, sharpness, without, _HARMONICS + 1)
    if not sharp:
        return []
    below = (f for f in sharp[1:] if _is_harmonic(sharp[0], f, frequency[1]))
    fundamental = min(below, default=sharp[0])
    return list(dict.fromkeys((fundamental, *sharp)))[:_LINES]


def _is_harmonic(line: float, fundamental: float, bin_width: float) -> bool:
    """Return whether a line is one of the first harmonics of another one."""
    order = round(line / fundamental)
    return 1 < order <= _HARMONICS and abs(line - order * fundamental) <= _BESIDE * bin_width


def _around(power: np.ndarray, spacing: int) -> np.ndarray:
    """Return the power of noise around each bin, but not beside it, where a line spreads to.

    It is the median, which other lines near by hardly change, over that of an exponential
    distribution with a mean of one. Where lines stand ``spacing`` bins apart, it is that of the
    highest power within that distance.
    """
    from scipy.ndimage import maximum_filter1d

    far = _AROUND + _HARMONICS_AROUND * spacing
    # The highest power over a stretch is nearly that over the next one.
    side = np.arange(_LINE + spacing + 1, far + 1, max(spacing // 3, 1))
    width = 2 * spacing + 1
    highest = np.pad(maximum_filter1d(power, width), far, mode="symmetric")
    places = far + np.arange(power.size)[:, np.newaxis] + np.concatenate([-side, side])
    level: np.ndarray = np.median(highest[places], axis=1) / -np.log1p(-(0.5 ** (1.0 / width)))
    return level


def _longest(problem: Problem) -> int:
    """Return the number of the longest record, in which a line is sharpest.

    Where records join, its phase jumps.
    """
    lengths = [own.stop - own.start for own in problem.records]
    return lengths.index(max(lengths))


def _peaks(
    frequency: np.ndarray,
    power: np.ndarray,
    prominence: np.ndarray,
    without: np.ndarray,
    count: int = _LINES,
) -> list[float]:
    """Return the frequencies of the highest peaks of a prominence, none of them ``without``."""
    places, beside = _places(power), np.pad(prominence, 1)
    peaked = (prominence >= beside[:-2]) & (prominence >= beside[2:])
    left = np.where(without | ~peaked, 0.0, prominence)
    # The first bins hold trends, which no wave repeats.
    left[:_REPEATED] = 0.0
    found = []
    for _ in range(count):
        peak = int(np.argmax(left))
        if left[peak] > 0.0:
            found.append(float(places[peak] * frequency[1]))
        left[max(0, peak - _SPREAD) : peak + _SPREAD + 1] = 0.0
    return found


def _places(power: np.ndarray) -> np.ndarray:
    """Return where a line would be, in bins, whose highest bin is each one.

    That is the vertex of the parabola through the logarithm of the power there and on either side.
    """
    level = np.log(np.maximum(power, 1e-300))
    beside = vertex(level[:-2], level[1:-1], level[2:])
    result: np.ndarray = np.arange(power.size) + np.pad(beside, 1)
    return result


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
