"""Starting values for laws whose cost has many minima: lines and jumps of the residual."""

import numpy as np

from dea.discrepancy.problem import Problem

_LINES = 2
_JUMPS = 3
_GRID = 8


def lines(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return frequencies (Hz) at which the residual, or its ratio to the input, has a line."""
    window = np.hanning(residual.size)
    power = np.abs(np.fft.rfft((residual - residual.mean()) * window)) ** 2
    drive = np.abs(np.fft.rfft((problem.u - problem.u.mean()) * window)) ** 2
    frequency = np.fft.rfftfreq(residual.size, problem.interval)
    surroundings = np.convolve(drive, np.ones(9) / 9, "same")
    found: list[float] = []
    for prominence in (power.copy(), power / (surroundings / surroundings.max() + 1e-3)):
        # The first bins hold trends.
        prominence[:4] = 0.0
        for _ in range(_LINES):
            peak = int(np.argmax(prominence))
            found.append(float(frequency[peak] + _offset(power, peak) * frequency[1]))
            prominence[max(0, peak - 6) : peak + 7] = 0.0
    return tuple(found)


def _offset(power: np.ndarray, peak: int) -> float:
    """Return how many bins the true line is from ``peak`` (parabola through the log power)."""
    if not 0 < peak < power.size - 1:
        return 0.0
    left, middle, right = np.log(power[peak - 1 : peak + 2] + 1e-300)
    curvature = left - 2.0 * middle + right
    return float(np.clip(0.5 * (left - right) / curvature, -0.5, 0.5)) if curvature < 0 else 0.0


def jumps(problem: Problem, residual: np.ndarray) -> tuple[float, ...]:
    """Return instants (s) at which mean, or coupling to the output, of the residual changes most.

    Cumulative sums find them (Page 1954); a coarse grid catches what they miss.
    """
    simulated = problem.y - residual
    found: list[float] = []
    for weighted in (residual, residual * (simulated - simulated.mean())):
        n = weighted.size
        k = np.arange(1, n)
        score = np.abs(np.cumsum(weighted - weighted.mean())[:-1]) / np.sqrt(k * (n - k) / n)
        for _ in range(_JUMPS):
            at = int(np.argmax(score))
            found.append(at * problem.interval)
            score[max(0, at - n // 20) : at + n // 20] = 0.0
    grid = (np.arange(_GRID) + 0.5) / _GRID * residual.size * problem.interval
    return (*found, *(float(instant) for instant in grid))
