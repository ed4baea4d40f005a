"""Excitation design: voltage sequences for identification and to separate rival effects.

Every design is a pure function of its settings and seed and stays within [low, high] volts.
"""

import inspect
from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dea.errors import InputError
from dea.seeds import generator

__all__ = [
    "KINDS",
    "Span",
    "binary",
    "bursts",
    "design",
    "gaussian",
    "multisine",
    "staircase",
    "triangle",
]

Signal = NDArray[np.float64]
MOST = 100_000_000  # samples; a design of that many takes some GB
CLIP = 3.0  # standard deviations between the middle of the range and its ends


class Span(NamedTuple):
    """Length, sampling rate (Hz) and range (V) of a sequence, and its random generator."""

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
        """Return the number of samples nearest to ``seconds``, at most one more than there are."""
        return round(min(seconds * self.sampling_rate, self.samples + 1.0))

    def spread(self, unit: Signal) -> Signal:
        """Map [-1, 1] onto the range."""
        return 0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * unit


def gaussian(span: Span, *, band: float = 1.0) -> Signal:
    """Gaussian noise with a flat spectrum from 0 to ``band`` Hz and none above.

    The mean is the middle of the range and the range ends lie three standard deviations from it;
    the 0.27 % of the samples that fall outside are clipped, which leaves less than 1e-3 of the
    power above ``band``.
    """
    frequencies = np.fft.rfftfreq(span.samples, 1.0 / span.sampling_rate)
    inside = (frequencies > 0.0) & (frequencies <= band)
    _require(inside.any(), "band", f"holds no line of a {span.duration:g} s sequence")
    spectrum = np.zeros(frequencies.size, dtype=complex)
    spectrum[inside] = span.rng.standard_normal((inside.sum(), 2)) @ (1.0, 1.0j)
    noise = np.fft.irfft(spectrum, span.samples)
    return np.clip(span.spread(noise / (CLIP * noise.std())), span.low, span.high)


def bursts(span: Span, *, band: float = 1.0, active: float = 20.0, rest: float = 10.0) -> Signal:
    """Gaussian noise in bursts of ``active`` seconds with rests at ``low`` between them.

    A Hann window of one second smooths the edges. The response in the rests shows memory.
    """
    _require(active > 0.0, "active", "is not positive")
    on, off = max(span.length(active), 1), span.length(rest)
    gate = np.resize(np.repeat([1.0, 0.0], [on, off]), span.samples)
    noise = gaussian(span, band=band)
    return span.low + (noise - span.low) * _smooth(gate, span.sampling_rate)


def multisine(span: Span, *, band: float = 1.0, period: float = 30.0) -> Signal:
    """Equal sines at every multiple of 1/``period`` Hz up to ``band``, with random phases.

    The period repeats to fill the duration, so that the response differs between periods by noise
    or drift alone; the largest excursion from the mean reaches the end of the range.
    """
    length = span.length(period)
    _require(0 < length <= span.samples, "period", f"is not between 0 and {span.duration:g} s")
    lines = np.arange(1, int(band * length / span.sampling_rate + 1e-9) + 1)
    _require(lines.size, "band", f"is below the first line, {1.0 / period:g} Hz")
    spectrum = np.zeros(length // 2 + 1, dtype=complex)
    spectrum[lines] = np.exp(2j * np.pi * span.rng.random(lines.size))
    one = np.fft.irfft(spectrum, length)
    return span.spread(np.resize(one / np.abs(one).max(), span.samples))


def staircase(
    span: Span, *, levels: int = 6, hold: float = 10.0, rest: float = 10.0, rise: float = 0.5
) -> Signal:
    """Equally spaced levels in random order, each held, with a rest at ``low`` between them.

    A Hann window of ``rise`` seconds smooths the steps. Creep recovers in the rests, drift does
    not. Every level occurs once before any occurs again.
    """
    _require(
        1 <= levels <= span.samples and levels % 1 == 0,
        "levels",
        f"is not a whole number between 1 and {span.samples}",
    )
    _require(rise <= span.duration, "rise", f"is longer than the {span.duration:g} s of all")
    held, rested = (max(span.length(seconds), 0) for seconds in (hold, rest))
    _require(held > 0, "hold", "is shorter than a sample")
    count = -(-span.samples // (held + rested))
    ladder = np.linspace(span.low, span.high, int(levels) + 1)[1:]
    rounds = [span.rng.permutation(ladder) for _ in range(-(-count // ladder.size))]
    heights = np.concatenate(rounds)[:count]
    pairs = np.column_stack([np.full(count, span.low), heights]).ravel()
    steps = np.repeat(pairs, np.resize([rested, held], pairs.size))[: span.samples]
    return _smooth(steps, rise * span.sampling_rate)


def binary(span: Span, *, band: float = 1.0) -> Signal:
    """A smoothed random binary sequence that may switch every half period of ``band``.

    A Hann window of one period of ``band`` smooths the edges without overshoot, so that less than
    1e-3 of the power lies above twice that frequency.
    """
    _require(band * span.duration >= 1.0, "band", f"has no period within {span.duration:g} s")
    clock = round(span.sampling_rate / (2.0 * band))
    bits = np.repeat(span.rng.integers(0, 2, -(-span.samples // clock)), clock)
    steps = np.where(bits, span.high, span.low)
    return _smooth(steps, span.sampling_rate / band)[: span.samples]


def triangle(span: Span, *, slowest: float = 20.0, fastest: float = 4.0) -> Signal:
    """Triangles between ``low`` and random peaks, each rise and fall at one of three rates.

    Full-range periods are ``slowest``, ``fastest`` and their geometric mean, in s. The loop of a
    hysteresis is the same at every rate, that of a lag widens with it; peaks of different height
    give inner loops.
    """
    _require(0.0 < fastest <= slowest, "fastest", "is not between 0 and the slowest period")
    periods = np.array([slowest, np.sqrt(slowest * fastest), fastest])
    width, pieces, total = span.high - span.low, [], 0
    while total < span.samples:
        for share in span.rng.permutation([1.0, 0.8, 0.6, 0.4]):
            half = max(round(0.5 * share * span.rng.choice(periods) * span.sampling_rate), 1)
            rising = np.arange(half) / half
            pieces.append(span.low + share * width * np.concatenate([rising, 1.0 - rising]))
            total += 2 * half
    return np.concatenate(pieces)[: span.samples]


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
    own = {
        name: parameter.default
        for name, parameter in inspect.signature(KINDS[kind]).parameters.items()
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY
    }
    for name in settings:
        if name not in own:
            raise InputError(
                f"a {kind} excitation has no setting {name!r}",
                field=name,
                remedy=f"Its settings are {', '.join(own)}.",
            )
    numbers = {"duration": duration, "sampling_rate": sampling_rate, **settings}
    for name, value in numbers.items():
        _require(_finite(value) and value >= 0.0, name, "is negative, or not a finite number")
    _require(_finite(low) and _finite(high) and low < high, "low", f"{low} is not below {high}")
    _require(duration * sampling_rate <= MOST, "duration", f"holds more than {MOST:g} samples")
    samples = round(duration * sampling_rate)
    _require(samples >= 2, "duration", "holds fewer than two samples")
    if "band" in own:
        band = settings.get("band", own["band"])
        _require(band > 0.0, "band", "is not a positive number")
        half = 0.5 * sampling_rate
        _require(band < half, "band", f"{band} Hz is not below half the sampling rate")
    span = Span(generator(seed, "signals", kind), samples, sampling_rate, low, high)
    signal = KINDS[kind](span, **settings)
    # Rounding may carry a sample beyond the end of the range.
    return np.clip(signal, low, high)


def _smooth(steps: Signal, width: float) -> Signal:
    """Average over a Hann window of ``width`` samples; the first value continues to the past."""
    window = np.hanning(max(round(width), 1) + 2)[1:-1]
    padded = np.concatenate([np.full(window.size - 1, steps[0]), steps])
    return np.convolve(padded, window / window.sum(), mode="valid")


def _finite(value: Any) -> bool:
    return isinstance(value, Real) and isfinite(value)


def _require(good: Any, field: str, problem: str) -> None:
    if not good:
        raise InputError(
            f"the excitation's {field} {problem}",
            field=field,
            remedy="Change it, or the duration and sampling rate it depends on.",
        )
