"""Excitation design: voltage sequences for identification and for telling rival effects apart.

Every design is a pure function of its settings and seed and stays within [low, high] volts.
"""

import inspect
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.errors import InputError
from dea.seeds import generator

__all__ = [
    "KINDS",
    "Frame",
    "binary",
    "bursts",
    "design",
    "gaussian",
    "multisine",
    "staircase",
    "triangle",
]

Signal = NDArray[np.float64]
CLIP = 3.0  # standard deviations between the middle of the range and its ends


class Frame(NamedTuple):
    """What every kind is designed into: chance, length, rate in Hz, range in V."""

    rng: np.random.Generator
    samples: int
    sampling_rate: float
    low: float
    high: float

    @property
    def duration(self) -> float:
        """Length in s."""
        return self.samples / self.sampling_rate

    def length(self, seconds: float) -> int:
        """Return the samples nearest to so many seconds."""
        return round(seconds * self.sampling_rate)

    def spread(self, unit: Signal) -> Signal:
        """Map [-1, 1] onto the range."""
        return 0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * unit


def gaussian(frame: Frame, *, band: float = 1.0) -> Signal:
    """Gaussian noise with a flat spectrum from 0 to ``band`` Hz and none above.

    The mean is the middle of the range and the range ends lie three standard deviations from it;
    the 0.27 % of the samples that fall outside are clipped, which leaves less than 1e-3 of the
    power above ``band``.
    """
    frequencies = np.fft.rfftfreq(frame.samples, 1.0 / frame.sampling_rate)
    inside = (frequencies > 0.0) & (frequencies <= band)
    _require(inside.any(), "band", f"holds no line of a {frame.duration:g} s sequence")
    spectrum = np.zeros(frequencies.size, dtype=complex)
    spectrum[inside] = frame.rng.standard_normal((inside.sum(), 2)) @ (1.0, 1.0j)
    noise = np.fft.irfft(spectrum, frame.samples)
    return np.clip(frame.spread(noise / (CLIP * noise.std())), frame.low, frame.high)


def bursts(frame: Frame, *, band: float = 1.0, active: float = 20.0, rest: float = 10.0) -> Signal:
    """Gaussian noise in bursts of ``active`` seconds with rests at ``low`` between them.

    Half-cosine edges of one second join the two. What goes on in the rests is memory.
    """
    _require(active > 0.0, "active", "is not positive")
    on, off = max(frame.length(active), 1), frame.length(rest)
    gate = np.resize(np.repeat([1.0, 0.0], [on, off]), frame.samples)
    noise = gaussian(frame, band=band)
    return frame.low + (noise - frame.low) * _smooth(gate, frame.sampling_rate)


def multisine(frame: Frame, *, band: float = 1.0, period: float = 30.0) -> Signal:
    """Equal sines at every multiple of 1/``period`` Hz up to ``band``, with random phases.

    The period repeats to fill the duration, so that what differs between periods is noise or
    drift; the largest excursion from the mean touches the range.
    """
    length = frame.length(period)
    _require(0 < length <= frame.samples, "period", f"is not between 0 and {frame.duration:g} s")
    lines = np.arange(1, int(band * length / frame.sampling_rate + 1e-9) + 1)
    _require(lines.size, "band", f"is below the first line, {1.0 / period:g} Hz")
    spectrum = np.zeros(length // 2 + 1, dtype=complex)
    spectrum[lines] = np.exp(2j * np.pi * frame.rng.random(lines.size))
    one = np.fft.irfft(spectrum, length)
    return frame.spread(np.resize(one / np.abs(one).max(), frame.samples))


def staircase(
    frame: Frame, *, levels: int = 6, hold: float = 10.0, rest: float = 10.0, rise: float = 0.5
) -> Signal:
    """Equally spaced levels in random order, each held, with a rest at ``low`` between them.

    Steps are half-cosines of ``rise`` seconds. The rests separate creep, which recovers in them,
    from drift, which does not; every level comes once before any comes again.
    """
    _require(levels >= 1, "levels", "is below 1")
    held, rested = (max(frame.length(seconds), 0) for seconds in (hold, rest))
    _require(held > 0, "hold", "is shorter than a sample")
    rounds = -(-frame.samples // (levels * (held + rested)))
    ladder = np.linspace(frame.low, frame.high, levels + 1)[1:]
    heights = np.concatenate([frame.rng.permutation(ladder) for _ in range(rounds)])
    steps = np.concatenate([[frame.low] * rested + [height] * held for height in heights])
    return _smooth(steps, rise * frame.sampling_rate)[: frame.samples]


def binary(frame: Frame, *, band: float = 1.0) -> Signal:
    """A filtered random binary sequence: chances to switch every half period of ``band``.

    A Hann window of one period of ``band`` smooths the edges without overshoot, so that the power
    falls to nothing by twice that frequency.
    """
    clock = round(frame.sampling_rate / (2.0 * band))
    _require(clock > 0, "band", "is above half the sampling rate")
    bits = np.repeat(frame.rng.integers(0, 2, -(-frame.samples // clock)), clock)
    steps = np.where(bits, frame.high, frame.low)
    return _smooth(steps, frame.sampling_rate / band)[: frame.samples]


def triangle(frame: Frame, *, slowest: float = 20.0, fastest: float = 4.0) -> Signal:
    """Triangles between ``low`` and random peaks, each rise and fall at one of three rates.

    Full-range periods are ``slowest``, ``fastest`` and their geometric mean, in s. The same path
    at several rates separates hysteresis, which keeps its loop, from lags, which widen theirs;
    the falling and rising peaks leave inner loops.
    """
    _require(0.0 < fastest <= slowest, "fastest", "is not between 0 and the slowest period")
    periods = np.array([slowest, np.sqrt(slowest * fastest), fastest])
    span, pieces, total = frame.high - frame.low, [], 0
    while total < frame.samples:
        for share in frame.rng.permutation([1.0, 0.8, 0.6, 0.4]):
            half = max(round(0.5 * share * frame.rng.choice(periods) * frame.sampling_rate), 1)
            rising = np.arange(half) / half
            pieces.append(frame.low + share * span * np.concatenate([rising, 1.0 - rising]))
            total += 2 * half
    return np.concatenate(pieces)[: frame.samples]


KINDS: dict[str, Callable[..., Signal]] = {
    "gaussian": gaussian,
    "bursts": bursts,
    "multisine": multisine,
    "staircase": staircase,
    "binary": binary,
    "triangle": triangle,
}


def design(
    kind: str,
    *,
    duration: float,
    sampling_rate: float,
    low: float,
    high: float,
    seed: int,
    **settings: Any,
) -> Signal:
    """Return an excitation of ``duration`` s at ``sampling_rate`` Hz between two voltages.

    Parameters
    ----------
    kind
        A name in :data:`KINDS`.
    low, high
        Range in V; no sample lies outside.
    seed
        The same settings and seed give the same sequence.
    settings
        The keyword settings of the kind's own function.

    Returns
    -------
    ndarray
        Voltage in V, shape (round(duration * sampling_rate),).

    Raises
    ------
    InputError
        An unknown kind or setting, or one that leaves no sequence to design.
    """
    if kind not in KINDS:
        raise InputError(
            f"there is no excitation {kind!r}", field="kind", remedy=f"Use {', '.join(KINDS)}."
        )
    own = [
        name
        for name, parameter in inspect.signature(KINDS[kind]).parameters.items()
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY
    ]
    for name in settings:
        if name not in own:
            raise InputError(
                f"a {kind} excitation has no setting {name!r}",
                field=name,
                remedy=f"Its settings are {', '.join(own)}.",
            )
    numbers = {"duration": duration, "sampling_rate": sampling_rate, **settings}
    for name, value in numbers.items():
        _require(np.isfinite(value) and value >= 0.0, name, "is not a positive number")
    _require(np.isfinite([low, high]).all() and low < high, "low", f"{low} is not below {high}")
    samples = round(duration * sampling_rate)
    _require(samples >= 2, "duration", "holds fewer than two samples")
    band = settings.get("band", 0.0)
    _require(band < 0.5 * sampling_rate, "band", f"{band} Hz is not below half the sampling rate")
    frame = Frame(generator(seed, "signals", kind), samples, sampling_rate, low, high)
    signal = KINDS[kind](frame, **settings)
    # Rounding may carry a sample past the end it was meant to reach.
    return np.clip(signal, low, high)


def _smooth(steps: Signal, width: float) -> Signal:
    """Average over a Hann window of ``width`` samples, the first value standing for the past."""
    window = np.hanning(max(round(width), 1) + 2)[1:-1]
    padded = np.concatenate([np.full(window.size - 1, steps[0]), steps])
    return np.convolve(padded, window / window.sum(), mode="valid")


def _require(good: Any, field: str, problem: str) -> None:
    if not good:
        raise InputError(
            f"the excitation's {field} {problem}",
            field=field,
            remedy="Change it, or the duration and sampling rate it depends on.",
        )
