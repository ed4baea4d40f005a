"""The true responses of a plant, by probing its simulation with small tones.

Around its rest a plant answers A cos(w1 t) + A cos(w2 t) with lines at all sums of the tones; that
at w1 has the complex amplitude A H1(w1), that at w1 + w2 has A^2 H2(w1, w2). A tone alone gives
A^2 H2(w1, w1)/2 at 2 w1. Half the sum and half the difference of the answers to either sign keep
even and odd orders apart; orders above the wanted one weigh as A^2, and two amplitudes remove them
to the next order (Richardson). Every line is fitted by least squares together with all others.
"""

import itertools

import numpy as np
from numpy.typing import NDArray

from benchmarks.coverage.plants import Plant, simulate
from dea.arrays import Array

SETTLING = 3000  # samples
AMPLITUDE = 0.02
PERIODS = 3  # of the slowest line in what is analysed
ORDERS = 4  # up to which lines are fitted


def h1(plant: Plant, frequencies: Array, operating_point: float = 0.0) -> NDArray[np.complex128]:
    """Return H1 at frequencies in periods per sample."""
    return _probed(plant, np.stack([frequencies, frequencies], axis=1), operating_point, order=1)


def h2(plant: Plant, pairs: Array, operating_point: float = 0.0) -> NDArray[np.complex128]:
    """Return H2 at pairs of frequencies in periods per sample, shape (pairs, 2)."""
    return _probed(plant, pairs, operating_point, order=2)


def _probed(
    plant: Plant, pairs: Array, operating_point: float, order: int
) -> NDArray[np.complex128]:
    same = pairs[:, 0] == pairs[:, 1]
    gaps = np.abs(np.abs(pairs[:, 0]) - np.abs(pairs[:, 1]))[~same]
    slowest = min(np.abs(pairs).min(), gaps[gaps > 0].min(initial=np.inf))
    t = np.arange(SETTLING + int(np.ceil(PERIODS / slowest)), dtype=float)
    tones = np.cos(2 * np.pi * pairs[:, :1] * t)
    tones = tones + np.where(same[:, None], 0.0, np.cos(2 * np.pi * pairs[:, 1:] * t))
    amplitudes = np.array([1, -1, 0.5, -0.5])[:, None, None] * AMPLITUDE
    y = simulate(plant, operating_point + amplitudes * tones)[..., SETTLING:]
    sign = -1 if order == 1 else 1
    kept = np.stack([y[0] + sign * y[1], y[2] + sign * y[3]]) / 2
    found = np.empty(len(pairs), complex)
    for row, (f1, f2) in enumerate(pairs):
        alone = (f1,) if same[row] else (f1, f2)
        lines = _lines(kept[:, row], t[SETTLING:], alone, f1 if order == 1 else f1 + f2)
        large, small = lines / (AMPLITUDE * np.array([1, 0.5])) ** order
        found[row] = (4 * small - large) / 3 * (2 if order == 2 and same[row] else 1)
    return found


def _lines(y: Array, t: Array, tones: tuple[float, ...], wanted: float) -> NDArray[np.complex128]:
    """Return the complex amplitude of the line at ``wanted`` in each row of ``y``."""
    orders = itertools.product(range(-ORDERS, ORDERS + 1), repeat=len(tones))
    sums = (float(np.dot(order, tones)) for order in orders if sum(map(abs, order)) <= ORDERS)
    lines = np.array(sorted({round(abs(_folded(line)), 12) for line in sums} - {0.0}))
    phase = 2 * np.pi * np.outer(t, lines)
    columns = np.hstack([np.cos(phase), np.sin(phase), np.ones((len(t), 1))])
    solution = np.linalg.lstsq(columns, y.T, rcond=None)[0]
    at = int(np.argmin(np.abs(lines - abs(_folded(wanted)))))
    value: NDArray[np.complex128] = solution[at] - 1j * solution[len(lines) + at]
    return value if _folded(wanted) >= 0 else value.conj()


def _folded(frequency: float) -> float:
    """Return the frequency from -1/2 to 1/2 that samples cannot tell from this one."""
    return frequency - round(frequency)
