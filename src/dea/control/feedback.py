"""A proportional-integral controller with feedforward, tuned for every response in a band."""

from dataclasses import dataclass, field, replace
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array
from dea.control.limits import are_limits
from dea.errors import InputError
from dea.gfrf import ResponseBand
from dea.narx import check_rate

_GAINS = np.geomspace(1e-4, 1e4, 801)  # of the loop, times the gain at the lowest frequency
_TO = 0.9  # part of half the sampling rate up to which a loop is looked at, at least


@dataclass(frozen=True)
class Gains:
    """C(z) = K (1 + (T/Ti) z/(z - 1)) / (1 + (Tf/T) (1 - 1/z)), a controller of a filtered error.

    ``proportional`` is K, ``integral_time`` Ti and ``filter_time`` Tf in s.

    Raises
    ------
    InputError
        If one is out of range.
    """

    proportional: float
    integral_time: float
    sampling_rate: float
    filter_time: float = 0.0

    def __post_init__(self) -> None:
        check_rate(self.sampling_rate)
        for name, possible, remedy in (
            ("proportional", isfinite(self.proportional), "Give a finite number."),
            ("integral_time", 0.0 < self.integral_time < inf, "Give it in s, above 0."),
            ("filter_time", 0.0 <= self.filter_time < inf, "Give it in s; 0 is no filter."),
        ):
            if not possible:
                raise InputError(f"it is {getattr(self, name):g}", field=name, remedy=remedy)
        if not isfinite(self.integral_gain):
            raise InputError(
                f"it is {self.integral_time:g} s for a gain of {self.proportional:g}",
                field="integral_time",
                remedy="Give a longer one.",
            )

    @property
    def integral_gain(self) -> float:
        """What the integral grows by in a sample, for an error of one."""
        return self.proportional * (1.0 / self.sampling_rate) / self.integral_time

    def response(self, frequencies: Array) -> NDArray[np.complex128]:
        """Return C at these frequencies in Hz."""
        z = np.exp(2j * np.pi * frequencies / self.sampling_rate)
        integral = z / (z - 1.0) / (self.sampling_rate * self.integral_time)
        low_pass = 1.0 + self.filter_time * self.sampling_rate * (1.0 - 1.0 / z)
        response: NDArray[np.complex128] = self.proportional * (1.0 + integral) / low_pass
        return response


def tune_feedback(
    band: ResponseBand,
    frequencies: Array,
    sampling_rate: float,
    *,
    integral_time: float,
    filter_time: float = 0.0,
    largest_sensitivity: float = 1.6,
) -> Gains:
    """Return the largest gain that keeps its margins for every response in a band of H1.

    The largest sensitivity Ms = max |1/(1 + C H)| is held by every H whose gain and phase lie in
    their intervals, so that the gain margin is Ms/(Ms - 1) and the phase margin 2 asin(1/(2 Ms)) at
    least (K. J. Astroem and T. Haegglund, Advanced PID Control, ISA 2006, section 4.6). The gain is
    raised from nearly zero, where integral control of a stable system is stable, and no loop on
    the way touches -1: the loop it ends at is stable too.

    Parameters
    ----------
    band
        Of H1 at ``frequencies``, shape (k,): :func:`dea.frequency_response_band`.
    frequencies
        In Hz, rising, shape (k,), from well below 1/integral_time to half the sampling rate.
    integral_time
        Ti in s; about the time in which the system settles.
    filter_time
        Tf in s, of the low-pass filter of the error; it is for a band that is wide where the input
        has no power.
    largest_sensitivity
        Ms, above 1; from 1.2 (careful) to 2 (brisk).

    Raises
    ------
    InputError
        If there is no band, or frequencies or a setting are out of range, or no gain keeps the
        margins, or all do.
    """
    of_one = Gains(1.0, integral_time, sampling_rate, filter_time)
    if not 1.0 < largest_sensitivity < inf:
        raise InputError(
            f"it is {largest_sensitivity:g}", field="largest_sensitivity", remedy="Give one above 1"
        )
    _check_frequencies(frequencies, band, of_one)
    if not all(np.isfinite(part).all() for part in band):
        raise InputError(
            "the response has no band at some frequency",
            field="band",
            remedy="Take an estimate whose covariance holds: docs/method/bands.md.",
        )
    shape = of_one.response(frequencies)
    sign = float(np.sign(band.response[0].real))
    if not sign:
        raise InputError(
            "the response at the lowest frequency has no sign",
            field="band",
            remedy="Take an operating point at which the output changes with the input.",
        )
    unit = sign / float(band.gain[0])
    kept = 0.0
    for gain in _GAINS:
        if _nearest(gain * unit * shape, band).min() < 1.0 / largest_sensitivity:
            break
        kept = gain
    else:
        raise InputError(
            f"no gain up to {_GAINS[-1]:g} over that of the response is too large",
            field="band",
            remedy="Give the response with all its delay, and at all its frequencies.",
        )
    if not kept:
        raise InputError(
            "the band is too wide for any feedback with these margins",
            field="band",
            remedy="Identify from a longer record, or accept a larger sensitivity.",
        )
    return replace(of_one, proportional=kept * unit)


def _check_frequencies(frequencies: Array, band: ResponseBand, gains: Gains) -> None:
    """Refuse frequencies that leave out where a loop of these gains may come near -1."""
    half, size = 0.5 * gains.sampling_rate, band.response.size
    steps = np.diff(frequencies, prepend=0.0) if np.shape(frequencies) == (size,) else np.zeros(1)
    if not np.all(steps > 0.0):
        raise InputError(
            "they are not rising from above 0 Hz, one for each value of the band",
            field="frequencies",
            remedy=f"Give the {size} frequencies of the band, in Hz.",
        )
    low, high = float(frequencies[0]), float(frequencies[-1])
    if not (low * gains.integral_time < 1.0 and _TO * half <= high <= half):
        raise InputError(
            f"they go from {low:g} to {high:g} Hz",
            field="frequencies",
            remedy=f"Begin well below {1.0 / gains.integral_time:g} Hz, 1/integral_time, and end"
            f" at {half:g} Hz, half the sampling rate, or a little below.",
        )


def _nearest(controller: NDArray[np.complex128], band: ResponseBand) -> Array:
    """Return the least |1 + C H| over all H of the band, at each frequency.

    |1 + r e^{j psi}|^2 = 1 + r^2 + 2 r cos psi: whatever r is, the nearest psi is that nearest to
    180 degrees; then r is that nearest to -cos psi.
    """
    angle = np.degrees(np.angle(controller))
    low, high = angle + band.phase_low, angle + band.phase_high
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    away = np.abs(middle % 360.0 - 180.0)  # of the middle from 180 degrees
    psi = np.radians(180.0 - np.maximum(away - half, 0.0))
    size = np.abs(controller)
    r = np.clip(-np.cos(psi), size * band.gain_low, size * band.gain_high)
    distance: Array = np.abs(1.0 + r * np.exp(1j * psi))
    return distance


class FilteredError:
    """Proportional and integral part of the filtered error; without a reading both are held."""

    def __init__(self, gains: Gains) -> None:
        period = 1.0 / gains.sampling_rate
        self._proportional = gains.proportional
        self._of_integral = gains.integral_gain
        self._new = 1.0 / (1.0 + gains.filter_time / period)
        self._filtered = self.integral = 0.0

    def take(self, error: float) -> tuple[float, float]:
        """Return the sum of both parts, and by how much the integral has grown in it.

        The caller adds that to ``integral`` unless the actuator is at a limit.
        """
        growth = 0.0
        if isfinite(error - self._filtered):
            self._filtered += self._new * (error - self._filtered)
            growth = self._of_integral * self._filtered
        return self.integral + growth + self._proportional * self._filtered, growth


@dataclass
class Follower:
    """The controller at work: one call for each sample, within limits of input and rate.

    The integral stops where the input is at a limit and the error would drive it further
    (conditional integration), so that it does not wind up.

    Parameters
    ----------
    gains
        Of :func:`tune_feedback`.
    lowest, highest
        Limits of the input, in its units.
    rate
        Largest change of the input in one second.
    start
        The input before the first sample.
    """

    gains: Gains
    lowest: float
    highest: float
    rate: float
    start: float
    _feedback: FilteredError = field(init=False)
    _last: float = field(init=False)
    _ahead: float = field(init=False)

    def __post_init__(self) -> None:
        if not (
            are_limits(self.lowest, self.highest)
            and self.lowest <= self.start <= self.highest
            and self.rate > 0.0
        ):
            raise InputError(
                f"inputs from {self.lowest:g} to {self.highest:g} at {self.rate:g} per second,"
                f" from {self.start:g} on",
                field="lowest, highest, rate, start",
                remedy="Let the start lie between finite limits that rise, at a positive rate.",
            )
        self._last = self._ahead = self.start
        self._feedback = FilteredError(self.gains)

    def step(self, reference: float, measured: float, feedforward: float) -> float:
        """Return the input of this sample.

        Parameters
        ----------
        reference, measured
            Output wanted now, and measured now; NaN where the sensor gave none: the feedback then
            stays as it is.
        feedforward
            Input that a model has for the reference; where it is not finite the last one is kept.
        """
        added, growth = self._feedback.take(reference - measured)
        reach = self.rate / self.gains.sampling_rate
        low, high = max(self.lowest, self._last - reach), min(self.highest, self._last + reach)
        if isfinite(feedforward):
            self._ahead = feedforward
        wanted = self._ahead + added
        if low <= wanted <= high or (wanted > high) == (growth < 0.0):
            self._feedback.integral += growth
        self._last = min(max(wanted, low), high)
        return self._last
