"""Random inputs that resemble a recorded one.

Theiler, Eubank, Longtin, Galdrikian and Farmer (1992), Physica D 58:77, phases drawn at random;
Schreiber and Schmitz (1996), Physical Review Letters 77:635, with the record's own values; Prichard
and Theiler (1994), Physical Review Letters 73:951, of several inputs together.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array

_PASSES = 2  # of restoring spectrum and values in turn


def phase_randomised(u: Array, rng: np.random.Generator) -> Array:
    """Return an input with the spectrum of ``u`` and random phases, cut off at the range of ``u``.

    Its values are nearly Gaussian, whatever those of ``u`` are. It is periodic. Several inputs,
    the columns of ``u``, keep their cross spectra.
    """
    mean = u.mean(axis=0)
    drawn = _with_phases(_spectrum(u - mean), len(u), rng)
    cut: Array = np.clip(mean + drawn, u.min(axis=0), u.max(axis=0))
    return cut


def same_class(u: Array, rng: np.random.Generator) -> Array:
    """Return an input with the values of ``u`` in another order, and nearly its spectrum.

    Several inputs, the columns of ``u``, nearly keep their cross spectra too.
    """
    drawn = _with_phases(_spectrum(u), len(u), rng)
    if u.ndim == 1:
        return _reordered(u, drawn)
    return np.stack([_reordered(*each) for each in zip(u.T, drawn.T, strict=True)], axis=1)


def _reordered(u: Array, shuffled: Array) -> Array:
    """Return the values of ``u`` in nearly the order of ``shuffled``, and nearly its spectrum."""
    spectrum, ranked = np.abs(np.fft.rfft(u)), np.sort(u)
    for last in range(_PASSES, -1, -1):
        surrogate = np.empty(u.size)
        surrogate[np.argsort(shuffled, kind="stable")] = ranked
        if last:
            transform = np.fft.rfft(surrogate)
            shuffled = np.fft.irfft(spectrum * _phases(transform), u.size)
    return surrogate


def _spectrum(u: Array) -> NDArray[Any]:
    """Return the one-sided amplitudes, of several inputs with their phases against the first."""
    transform = np.fft.rfft(u, axis=0)
    if u.ndim == 1:
        amplitudes: NDArray[Any] = np.abs(transform)
        return amplitudes
    relative: NDArray[Any] = transform * _phases(transform[:, :1]).conj()
    return relative


def _phases(transform: NDArray[Any]) -> NDArray[Any]:
    size = np.abs(transform)
    found: NDArray[Any] = np.divide(transform, size, out=np.ones_like(transform), where=size > 0.0)
    return found


def _with_phases(spectrum: NDArray[Any], samples: int, rng: np.random.Generator) -> Array:
    """Return signals of this one-sided spectrum whose phases are all turned by the same angles."""
    angles = np.exp(2j * np.pi * rng.uniform(size=len(spectrum)))
    angles[0] = 1.0
    if samples % 2 == 0:
        angles[-1] = 1.0  # the highest line of an even number of samples is real
    turned = spectrum * (angles if spectrum.ndim == 1 else angles[:, None])
    signal: Array = np.fft.irfft(turned, samples, axis=0)
    return signal
