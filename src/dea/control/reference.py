"""References that an actuator can follow: steps, a sine and band-limited noise, in turn."""

from typing import NamedTuple

import numpy as np

from dea.arrays import Array
from dea.errors import InputError
from dea.narx import check_rate

STRETCH = 60.0  # s of a record, in each of which the actuator was where the reference goes


class Reach(NamedTuple):
    """The outputs between which a reference moves; their difference is its stroke."""

    low: float
    high: float

    @property
    def stroke(self) -> float:
        """The reference from end to end."""
        return self.high - self.low


def reach_of(y: Array, sampling_rate: float, shares: tuple[float, float]) -> Reach:
    """Return where a reference may go: where the actuator was in every minute of a record.

    Parameters
    ----------
    y
        Output of the record, shape (samples,); it may hold NaN.
    shares
        The part of the range common to all minutes that is used, from 0 to 1.

    Raises
    ------
    InputError
        If the record has no reading, its minutes no range in common, or the rate is not positive.
    """
    check_rate(sampling_rate)
    length = max(1, min(round(STRETCH * sampling_rate), y.size))
    rows = y[: y.size // length * length].reshape(-1, length)
    rows = rows[np.isfinite(rows).any(axis=1)]
    if not rows.size:
        raise InputError(
            "it has no reading", field="y", remedy="Take a record whose output is known."
        )
    low, high = np.nanmin(rows, axis=1).max(), np.nanmax(rows, axis=1).min()
    if not low < high:
        raise InputError(
            f"its minutes have no range in common: one begins at {low:g}, another ends at {high:g}",
            field="y",
            remedy="Take a record whose outputs stay in one range.",
        )
    first, last = (float(low + share * (high - low)) for share in shares)
    return Reach(first, last)


class ReferenceShape(NamedTuple):
    """What a reference is made of.

    ``turn`` is the length of each kind in s, ``hold`` the time from step to step and ``rise`` that
    of each, in s; ``frequency`` is that of the sine, and half the band of the noise, in Hz.
    """

    turn: float
    hold: float
    rise: float
    frequency: float


def design_reference(
    reach: Reach, samples: int, sampling_rate: float, seed: int, shape: ReferenceShape
) -> Array:
    """Return a reference, shape (samples,): turns of steps, a sine and noise, one after the other.

    Steps go to random levels, the ends of the reach among them, along the polynomial of fifth
    degree with least jerk (T. Flash and N. Hogan, J. Neuroscience 5 (1985) 1688-1703): no actuator
    follows a corner. Each turn begins and ends in the middle of the reach.

    Parameters
    ----------
    shape
        Lengths and frequencies.

    Raises
    ------
    InputError
        If a turn is no sample, or holds no step or no period of the noise.
    """
    rng = np.random.default_rng(seed)
    turn, hold, _, frequency = shape
    if not turn * sampling_rate >= 1.0:
        raise InputError(
            f"{turn:g} s are no sample at {sampling_rate:g} Hz", field="turn", remedy="Lengthen it."
        )
    if not hold <= turn:
        raise InputError(
            f"steps take {hold:g} s, and turns {turn:g} s", field="hold", remedy="Shorten it."
        )
    length = round(turn * sampling_rate)
    time = np.arange(length) / sampling_rate
    fade = least_jerk(time) * least_jerk(turn - time)
    kinds = (
        lambda: _steps(time, shape, rng),
        lambda: np.sin(2.0 * np.pi * frequency * time) * fade,
        lambda: _noise(length, sampling_rate, 2.0 * frequency, rng) * fade,
    )
    turns = [kinds[k % 3]() for k in range(-(-samples // length))]
    middle, half = 0.5 * (reach.low + reach.high), 0.5 * reach.stroke
    reference: Array = middle + half * np.concatenate(turns)[:samples]
    return reference


def least_jerk(time: Array) -> Array:
    """Return the way from 0 to 1 with least jerk, which takes as long as from 0 to 1."""
    x = np.clip(time, 0.0, 1.0)
    way: Array = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    return way


def _steps(time: Array, shape: ReferenceShape, rng: np.random.Generator) -> Array:
    count = int(shape.turn / shape.hold)
    levels = rng.uniform(-1.0, 1.0, count)
    levels[:3] = [levels[0], 1.0, -1.0][:count]
    levels[-1:] = 0.0
    before = np.concatenate([[0.0], levels[:-1]])
    steps = (levels - before)[:, None] * least_jerk(
        (time - shape.hold * np.arange(count)[:, None]) / shape.rise
    )
    total: Array = steps.sum(axis=0)
    return total


def _noise(length: int, sampling_rate: float, band: float, rng: np.random.Generator) -> Array:
    frequencies = np.fft.rfftfreq(length, 1.0 / sampling_rate)
    phases = rng.uniform(0.0, 2.0 * np.pi, frequencies.size)
    inside = (frequencies > 0.0) & (frequencies <= band)
    if not inside.any():
        raise InputError(
            f"noise up to {band:g} Hz has no period in {length / sampling_rate:g} s",
            field="frequency",
            remedy="Raise it, or lengthen the turns.",
        )
    noise = np.fft.irfft(np.where(inside, np.exp(1j * phases), 0.0), length)
    scaled: Array = noise / np.abs(noise).max()
    return scaled
