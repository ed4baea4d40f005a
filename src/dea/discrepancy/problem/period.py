"""The period of an input, where it has one."""

import numpy as np

from dea.autocovariance import autocovariance
from dea.discrepancy.problem.parabola import vertex
from dea.inputs import by_input

# Correlation of the input with itself a period later, from which it repeats; and the part of the
# record that a period may take.
_REPEATS, _LONGEST = 0.98, 0.5


def period_of(u: np.ndarray) -> int:
    """Return the period of ``u`` (n,) in samples; zero where it does not repeat.

    The correlation is that of the overlapping parts. The first maximum after it has once fallen
    below half counts, so that neighbouring samples are no period. Several inputs (n, inputs) repeat
    where each of them does that moves.
    """
    longest = int(_LONGEST * len(u))
    if longest < 2 or not _moving(u):
        return 0
    correlation = _correlation(u, longest)
    fallen = np.flatnonzero(correlation < 0.5)
    if not fallen.size:
        return 0
    later = np.flatnonzero(correlation[fallen[0] :] >= _REPEATS)
    if not later.size:
        return 0
    first = fallen[0] + later[0]
    around = correlation[first : first + max(2, first // 20)]
    return int(first + np.argmax(around))


def exact_period(u: np.ndarray, period: int) -> float:
    """Return the period of ``u`` (n,), which is about so many samples, to a part of a sample.

    It is told by the vertex of a parabola through the correlation with itself as many periods later
    as there are lags.
    """
    repeats = max((int(_LONGEST * len(u)) - 2) // period, 1)
    # The whole number of samples is off by half of one at the most.
    off = repeats // 2 + 1
    correlation = _correlation(u, repeats * period + off + 2)
    first = repeats * period - off
    peak = first + int(np.argmax(correlation[first:-1]))
    return float(peak + vertex(*correlation[peak - 1 : peak + 2])) / repeats


def _moving(u: np.ndarray) -> list[np.ndarray]:
    """Return the inputs that do not stand still throughout."""
    return [each for each in by_input(u) if (each - each.mean()).any()]


def _correlation(u: np.ndarray, longest: int) -> np.ndarray:
    """Return the least correlation of the inputs that move with themselves, at lags below that."""
    least: np.ndarray = np.min([_of_one(each, longest) for each in _moving(u)], axis=0)
    return least


def _of_one(u: np.ndarray, longest: int) -> np.ndarray:
    """Return the correlation of an input with itself at lags below ``longest``."""
    centred = u - u.mean()
    size = u.size
    products = autocovariance(centred, longest)
    energy = np.concatenate([[0.0], np.cumsum(centred**2)])
    lag = np.arange(longest)
    both = np.sqrt(energy[size - lag] * (energy[size] - energy[lag]))
    result: np.ndarray = products / np.maximum(both, 1e-300)
    return result
