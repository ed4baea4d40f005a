"""The period of an input, where it has one."""

import numpy as np

# Correlation of the input with itself a period later, from which it repeats; and the part of the
# record that a period may take.
_REPEATS, _LONGEST = 0.98, 0.5


def period_of(u: np.ndarray) -> int:
    """Return the period of ``u`` (n,) in samples; zero where it does not repeat.

    The correlation is that of the overlapping parts. The first maximum after it has once fallen
    below half counts, so that neighbouring samples are no period.
    """
    centred = u - u.mean()
    size = u.size
    longest = int(_LONGEST * size)
    if longest < 2 or not centred.any():
        return 0
    spectrum = np.abs(np.fft.rfft(centred, 2 * size)) ** 2
    products = np.fft.irfft(spectrum)[:longest]
    energy = np.concatenate([[0.0], np.cumsum(centred**2)])
    lag = np.arange(longest)
    both = np.sqrt(energy[size - lag] * (energy[size] - energy[lag]))
    correlation = products / np.maximum(both, 1e-300)
    fallen = np.flatnonzero(correlation < 0.5)
    if not fallen.size:
        return 0
    later = np.flatnonzero(correlation[fallen[0] :] >= _REPEATS)
    if not later.size:
        return 0
    first = fallen[0] + later[0]
    around = correlation[first : first + max(2, first // 20)]
    return int(first + np.argmax(around))
