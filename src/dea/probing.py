"""Probing signals: odd random-phase multisines played at chosen times of a longer excitation.

A line is a harmonic of the multisine's period. Only odd lines are excited, so that even distortions
of the system answer at even lines alone; some odd lines are left out, at which odd distortions show
(Pintelon and Schoukens, System Identification, 2nd ed., Wiley 2012, chapters 2 and 4).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.configuration.excitation import PASSAGE, is_whole
from dea.errors import InputError
from dea.given_numbers import is_count
from dea.seeds import generator

Signal = NDArray[np.float64]
Numbers = NDArray[np.int64]

_RATIO = 1.08  # of neighbouring lines, where they are not odd neighbours anyway
_GROUP = 4  # lines, of which one at random is left out
_BEYOND = 1 / 3  # amplitude above the band, so that its differences hardly reach the band


class Probed(NamedTuple):
    """An excitation with probing stretches, sample by sample.

    ``voltage`` (V); ``probing``, the number of the stretch, from 1, or 0 outside its whole periods;
    ``realisation``, the number of the multisine in it, from 1, or 0.
    """

    voltage: Signal
    probing: Numbers
    realisation: Numbers


@dataclass(frozen=True)
class Probing:
    """Stretches of multisines around a constant voltage.

    Parameters
    ----------
    times
        Where the stretches begin, in s.
    bias, rms
        Mean of the multisines and their root mean square about it, in V.
    lowest, highest
        First and last line in Hz; the period is 1/``lowest``.
    band
        Frequency in Hz above which lines have a third of the amplitude.
    realisations, periods
        Multisines of other phases in a stretch, and whole periods of each.
    settle
        Time in s that a multisine plays before its whole periods.

    Raises
    ------
    InputError
        If there is no realisation, no period or no line.
    """

    times: Sequence[float]
    bias: float
    rms: float
    lowest: float = 0.05
    highest: float = 20.0
    band: float = 1.0
    realisations: int = 4
    periods: int = 2
    settle: float = 10.0

    def __post_init__(self) -> None:
        for name in ("realisations", "periods"):
            count = getattr(self, name)
            if not is_count(count):
                raise _refused(name, f"it is {count!r}, not a whole number of 1 or more")
        if not 0.0 < self.lowest <= self.highest < np.inf:
            raise _refused(
                "lowest", f"{self.lowest:g} Hz is not above 0 and up to {self.highest:g}"
            )

    def lines(self, seed: int) -> Numbers:
        """Return the excited lines, ascending: odd, at nearly equal ratios, with some left out."""
        candidates, last = [], 0.0
        for line in range(1, round(self.highest / self.lowest) + 1, 2):
            if line >= _RATIO * last:
                candidates.append(line)
                last = float(line)
        rng = generator(seed, "probing", "lines")
        kept: list[int] = []
        for first in range(0, len(candidates), _GROUP):
            group = candidates[first : first + _GROUP]
            if len(group) == _GROUP:
                group.pop(int(rng.integers(1, _GROUP)))  # the lowest line is always excited
            kept += group
        return np.array(kept)

    def place(self, excitation: Signal, sampling_rate: float, seed: int) -> Probed:
        """Return ``excitation`` (V) with the stretches in place of what it played there.

        All stretches excite the same lines; the phases of every multisine are drawn anew.

        Raises
        ------
        InputError
            If the lines do not fit the sampling rate, or the stretches the excitation.
        """
        period = sampling_rate / self.lowest
        if not is_whole(period):
            raise _refused("lowest", f"its period is {period:g} samples, not a whole number")
        if self.settle < PASSAGE:
            raise _refused(
                "settle", f"{self.settle:g} s are shorter than the passage of {PASSAGE:g} s into it"
            )
        if not self.highest < 0.5 * sampling_rate:
            raise _refused("highest", f"{self.highest:g} Hz is not below half the sampling rate")
        lines, rng = self.lines(seed), generator(seed, "probing", "phases")
        edge = round(PASSAGE * sampling_rate)
        rising = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
        voltage = np.array(excitation, dtype=float)
        probing = np.zeros(voltage.size, dtype=np.int64)
        realisation = np.zeros_like(probing)
        end = 0
        for number, time in enumerate(self.times, start=1):
            played, numbers = self._stretch(lines, sampling_rate, rng)
            begin = round(time * sampling_rate)
            if begin < end:
                raise _refused("times", f"the stretch at {time:g} s begins inside another")
            end = begin + played.size
            if end > voltage.size:
                raise _refused("times", f"the stretch at {time:g} s ends after the excitation")
            share = np.ones(played.size)
            share[:edge], share[-edge:] = rising, rising[::-1]
            voltage[begin:end] += share * (played - voltage[begin:end])
            realisation[begin:end] = numbers
            probing[begin:end] = np.where(numbers > 0, number, 0)
        return Probed(voltage, probing, realisation)

    def _stretch(
        self, lines: Numbers, sampling_rate: float, rng: np.random.Generator
    ) -> tuple[Signal, Numbers]:
        """Return the voltage of a stretch and the number of its realisation at each sample."""
        settle, edge = (round(time * sampling_rate) for time in (self.settle, PASSAGE))
        pieces, numbers = [], []
        for number in range(1, self.realisations + 1):
            one = self.bias + self._multisine(lines, round(sampling_rate / self.lowest), rng)
            before = np.resize(one[::-1], settle)[::-1]  # ends where a period ends
            pieces += [before, np.tile(one, self.periods)]
            numbers += [np.zeros(settle, dtype=np.int64), np.full(pieces[-1].size, number)]
        pieces.append(np.resize(one, edge))
        numbers.append(np.zeros(edge, dtype=np.int64))
        return np.concatenate(pieces), np.concatenate(numbers)

    def _multisine(self, lines: Numbers, samples: int, rng: np.random.Generator) -> Signal:
        """Return one period with random phases, its root mean square that of the settings."""
        amplitude = np.where(lines * self.lowest <= self.band * (1 + 1e-9), 1.0, _BEYOND)
        amplitude *= self.rms / np.sqrt(0.5 * np.sum(amplitude**2))
        spectrum = np.zeros(samples // 2 + 1, dtype=complex)
        phases = rng.uniform(0.0, 2.0 * np.pi, lines.size)
        spectrum[lines] = 0.5 * samples * amplitude * np.exp(1j * phases)
        return np.fft.irfft(spectrum, samples)


def _refused(field: str, problem: str) -> InputError:
    return InputError(
        problem,
        field=f"excitation.probing.{field}",
        remedy="Change it, or the duration and sampling rate of the excitation.",
    )
