"""How a trial's readings are spoilt: by noise of several kinds, and by a wrong time stamp."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from dea.arrays import Array
from dea.seeds import generator


class NoiseKind(StrEnum):
    """The kinds of noise, each of the same RMS.

    ``COLOURED`` is a first-order autoregressive process, ``FLICKER`` has a density that falls as
    1/f over two decades (a sum of first-order processes, A. van der Ziel, Physica 16 (1950) 359),
    ``DRIFTING`` holds half its power in a slow process, ``QUANTISED`` comes from a coarse
    converter, and ``SHIFTED`` is white noise on readings with a wrong time stamp.
    """

    WHITE = "white"
    COLOURED = "coloured"
    FLICKER = "flicker"
    DRIFTING = "drifting"
    QUANTISED = "quantised"
    SHIFTED = "shifted"


@dataclass(frozen=True)
class Noise:
    """The noise of one trial.

    Attributes
    ----------
    kind
        Its kind.
    rms
        In the output's unit.
    correlation
        Of coloured and drifting noise, in samples.
    shift
        Time by which readings are taken later than stamped, in sub-steps; negative for earlier.
    """

    kind: NoiseKind
    rms: float
    correlation: float = field(default=0.0)
    shift: int = field(default=0)

    @property
    def step(self) -> float:
        """The resolution of quantised readings: nine tenths of the noise's RMS come from it."""
        return 0.9 * self.rms * float(np.sqrt(12.0)) if self.kind == NoiseKind.QUANTISED else 0.0


class NoiseSource:
    """Draws the noise of a record piece by piece; how it is cut changes nothing.

    Parameters
    ----------
    noise
        What to draw.
    seed
        Of the generators.
    """

    def __init__(self, noise: Noise, seed: int) -> None:
        self._noise = noise
        parts = _parts(noise)
        self._weights = np.array([weight for weight, _ in parts])
        self._poles = [float(np.exp(-1.0 / time)) if time else 0.0 for _, time in parts]
        self._rngs = [generator(seed, "trial noise", str(i)) for i in range(len(parts))]
        self._memory = np.array([rng.standard_normal() for rng in self._rngs])

    def next(self, samples: int) -> Array:
        """Return the noise of the next ``samples`` readings."""
        from scipy.signal import lfilter

        total = np.zeros(samples)
        if not samples:
            return total
        for i, (pole, rng) in enumerate(zip(self._poles, self._rngs, strict=True)):
            drawn = np.sqrt(1.0 - pole * pole) * rng.standard_normal(samples)
            course, _ = lfilter([1.0], [1.0, -pole], drawn, zi=[pole * self._memory[i]])
            self._memory[i] = course[-1]
            total += self._weights[i] * course
        return self._noise.rms * total

    def read(self, truth: Array) -> Array:
        """Return the next readings of ``truth``."""
        noisy = truth + self.next(truth.size)
        step = self._noise.step
        return np.rint(noisy / step) * step if step else noisy


def _parts(noise: Noise) -> list[tuple[float, float]]:
    """Return weight and correlation (samples; 0 for white) of the processes that make it up."""
    if noise.kind == NoiseKind.COLOURED:
        return [(1.0, noise.correlation)]
    if noise.kind == NoiseKind.FLICKER:
        times = np.geomspace(1.0, 100.0, 7)
        return [(float(np.sqrt(1.0 / times.size)), float(time)) for time in times]
    if noise.kind == NoiseKind.DRIFTING:
        return [(float(np.sqrt(0.5)), 0.0), (float(np.sqrt(0.5)), noise.correlation)]
    if noise.kind == NoiseKind.QUANTISED:
        return [(float(np.sqrt(1.0 - 0.81)), 0.0)]
    return [(1.0, 0.0)]
