"""Excitations without a fixed form, within what a device may be driven with."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

if TYPE_CHECKING:
    from dea.store import Record

# Segments of an excitation, and sines of its multisine.
_SEGMENTS, _LINES = 8, 10
_PER_SEGMENT = ("length", "level", "amplitude", "rest")
# Gene below which a segment is a rest.
_REST = 0.2
# Length of the shortest segment relative to the longest.
_SHORTEST = 0.1
# Part of the sampling rate up to which sines are put.
_HIGHEST = 0.125
# Part by which rounding may make a change of the input look too fast.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Limits:
    """What an excitation must obey.

    Parameters
    ----------
    low, high
        Range of the input.
    rate
        Largest change of the input per s.
    output_low, output_high
        Range that the predicted output must stay in.
    sampling_rate
        In Hz.
    """

    low: float
    high: float
    rate: float
    output_low: float
    output_high: float
    sampling_rate: float

    @classmethod
    def of(
        cls, records: "Sequence[Record]", output_margin: float, rate: float | None = None
    ) -> Self:
        """Return what records allow: their ranges, and their rate unless another is given.

        The range of the output is wider on both sides by ``output_margin`` times its width.
        """
        u = np.concatenate([each.u for each in records])
        y = np.concatenate([each.y for each in records])
        sampling_rate = records[0].sampling_rate
        fastest = max(float(np.abs(np.diff(each.u)).max()) for each in records) * sampling_rate
        low, high = float(np.nanmin(y)), float(np.nanmax(y))
        margin = output_margin * (high - low)
        return cls(
            float(u.min()), float(u.max()), rate or fastest, low - margin, high + margin,
            sampling_rate,
        )  # fmt: skip

    def obeyed(self, u: np.ndarray) -> np.ndarray:
        """Return the input (n,) cut to the range, and where it changes too fast, slowed down."""
        step = self.rate / self.sampling_rate
        result = np.clip(u, self.low, self.high).tolist()
        for k in range(1, len(result)):
            before = result[k - 1]
            result[k] = min(max(result[k], before - step), before + step)
        return np.array(result)

    def allows(self, u: np.ndarray) -> bool:
        """Return whether an input (n,) stays in the range and changes slowly enough."""
        fastest = np.abs(np.diff(u)).max(initial=0.0) * self.sampling_rate
        inside = np.all((u >= self.low) & (u <= self.high))
        return bool(inside and fastest <= self.rate * (1.0 + _ROUNDING))

    def holds(self, y: np.ndarray) -> bool:
        """Return whether a predicted output stays in its range."""
        return bool(np.all((y >= self.output_low) & (y <= self.output_high)))


def genes() -> int:
    """Return the number of genes of an excitation, each between zero and one."""
    return len(_PER_SEGMENT) * _SEGMENTS + 2 * _LINES


def express(values: np.ndarray, duration: float, limits: Limits) -> np.ndarray:
    """Return the input, in the range and slow enough, that the ``values`` of the genes stand for.

    It consists of segments: holds of a level, with a multisine of an amplitude of their own about
    it, and rests at the lowest input. The sines have frequencies and phases of their own.
    """
    samples = round(duration * limits.sampling_rate)
    parts = values[: len(_PER_SEGMENT) * _SEGMENTS].reshape(_SEGMENTS, len(_PER_SEGMENT)).T
    length, level, amplitude, rest = parts
    share = np.cumsum(_SHORTEST + (1.0 - _SHORTEST) * length)
    ends = np.round(samples * share / share[-1]).astype(int)
    counts = np.diff(ends, prepend=0)
    resting = rest < _REST
    span = limits.high - limits.low
    middle = np.repeat(limits.low + span * np.where(resting, 0.0, level), counts)
    reach = np.repeat(0.5 * span * np.where(resting, 0.0, amplitude), counts)
    frequencies, phases = values[len(_PER_SEGMENT) * _SEGMENTS :].reshape(2, _LINES)
    lowest, highest = 1.0 / duration, _HIGHEST * limits.sampling_rate
    hertz = lowest * (highest / lowest) ** frequencies
    time = np.arange(samples)[:, None] / limits.sampling_rate
    sines = np.sin(2.0 * np.pi * (time * hertz + phases)).sum(axis=1)
    return limits.obeyed(middle + reach * sines / np.abs(sines).max())
