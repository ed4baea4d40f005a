"""Random inputs that resemble a recorded one.

Theiler, Eubank, Longtin, Galdrikian and Farmer (1992), Physica D 58:77, phases drawn at random;
Schreiber and Schmitz (1996), Physical Review Letters 77:635, with the record's own values.
"""

import numpy as np

from dea.narx.checks import Array

_PASSES = 2  # of restoring spectrum and values in turn


def phase_randomised(u: Array, rng: np.random.Generator) -> Array:
    """Return an input with the spectrum of ``u`` and random phases, cut off at the range of ``u``.

    Its values are nearly Gaussian, whatever those of ``u`` are. It is periodic.
    """
    mean = u.mean()
    spectrum = np.abs(np.fft.rfft(u - mean))
    cut: Array = np.clip(mean + _with_phases(spectrum, u.size, rng), u.min(), u.max())
    return cut


def same_class(u: Array, rng: np.random.Generator) -> Array:
    """Return an input with the values of ``u`` in another order, and nearly its spectrum."""
    spectrum, ranked = np.abs(np.fft.rfft(u)), np.sort(u)
    shuffled = _with_phases(spectrum, u.size, rng)
    for last in range(_PASSES, -1, -1):
        surrogate = np.empty(u.size)
        surrogate[np.argsort(shuffled, kind="stable")] = ranked
        if last:
            transform = np.fft.rfft(surrogate)
            size = np.abs(transform)
            phase = np.divide(transform, size, out=np.ones_like(transform), where=size > 0.0)
            shuffled = np.fft.irfft(spectrum * phase, u.size)
    return surrogate


def _with_phases(spectrum: Array, samples: int, rng: np.random.Generator) -> Array:
    """Return a signal of this one-sided amplitude spectrum."""
    angles = np.exp(2j * np.pi * rng.uniform(size=spectrum.size))
    angles[0] = 1.0
    if samples % 2 == 0:
        angles[-1] = 1.0  # the highest line of an even number of samples is real
    signal: Array = np.fft.irfft(spectrum * angles, samples)
    return signal
