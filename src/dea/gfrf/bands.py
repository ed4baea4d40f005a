"""Frequency responses with pointwise intervals from the covariance of the parameters."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.gfrf.operating_point import rest_slope
from dea.gfrf.response import Inputs, response_and_slope, rests, tones_of
from dea.narx import LEVEL, Interval, NarxModel, covariance_of, quantile

_LARGEST = 1.0  # error of a gain, relative, or of a phase in rad, up to which a response is known


class ResponseBand(NamedTuple):
    """A frequency response and the ends of its pointwise intervals, all of one shape.

    ``response`` is complex, in output units per input unit to the power n, and ``gain_low`` and
    ``gain_high`` in the same units; ``phase_low`` and ``phase_high`` are in degrees and enclose the
    angle of ``response`` without wrapping. The ends are NaN where no interval can be given.
    """

    response: NDArray[np.complex128]
    gain_low: Array
    gain_high: Array
    phase_low: Array
    phase_high: Array

    @classmethod
    def exact(cls, response: NDArray[np.complex128]) -> "ResponseBand":
        """Return a response whose intervals have no width."""
        gain, phase = np.abs(response), np.degrees(np.angle(response))
        return cls(response, gain, gain, phase, phase)

    @property
    def gain(self) -> Array:
        """Magnitude of the response."""
        return np.abs(self.response)

    @property
    def phase(self) -> Array:
        """Angle of the response in degrees, -180 to 180."""
        return np.degrees(np.angle(self.response))

    def widened(self, gain: Array, phase: Array, level: float = LEVEL) -> "ResponseBand":
        """Return the band with further errors of these standard deviations.

        Of relative gain and of phase (rad), independent of those that it holds. Where one of them
        is larger than 1 the response is not known, and has no interval.
        """
        reach = quantile(level)
        unknown = (gain > _LARGEST) | (phase > _LARGEST)
        gain, phase = (np.where(unknown, np.nan, each) for each in (gain, phase))
        # A response that is missing or zero has no interval.
        with np.errstate(divide="ignore", invalid="ignore"):
            of_gain = np.exp(np.hypot(np.log(self.gain_high / self.gain), reach * gain))
        of_phase = np.hypot(self.phase_high - self.phase, np.degrees(reach * phase))
        return self._replace(
            gain_low=self.gain / of_gain,
            gain_high=self.gain * of_gain,
            phase_low=self.phase - of_phase,
            phase_high=self.phase + of_phase,
        )


def frequency_response_band(
    model: NarxModel,
    order: int = 1,
    frequencies: ArrayLike | Sequence[ArrayLike] = (),
    sampling_rate: float | None = None,
    *,
    level: float = LEVEL,
    inputs: Inputs = None,
    parameters: ArrayLike | None = None,
    covariance: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
    allow_missing: bool = False,
) -> ResponseBand:
    """Return the GFRF of a model with the intervals that its covariance gives gain and phase.

    The covariance is carried through the exact derivative of the response by the parameters, that
    of the rest included. The gain's interval is symmetric in the logarithm of the gain, so that its
    ends are positive.

    Parameters
    ----------
    level
        Share of such intervals that hold the true value, at each frequency on its own.
    parameters, covariance
        Other parameters (..., terms) with their covariances (..., terms, terms), as a tracker gives
        them; by default the model's own.

    Other parameters are those of :func:`dea.frequency_response`.

    Raises
    ------
    InputError
        As :func:`dea.frequency_response`; if the model has no covariance, or parameters come
        without theirs.
    """
    spread = _covariance(model, parameters, covariance)
    tones = tones_of(model, order, frequencies, sampling_rate, inputs)
    points = rests(model, parameters, operating_point, allow_missing)
    response, slope = response_and_slope(model, tones, points)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = slope / response  # derivative of log gain + j phase
    reach = quantile(level)
    gain_reach = np.exp(reach * _deviation(relative.real, spread))
    phase_reach = np.degrees(reach * _deviation(relative.imag, spread))
    gain, phase = np.abs(response), np.degrees(np.angle(response))
    return ResponseBand(
        response, gain / gain_reach, gain * gain_reach, phase - phase_reach, phase + phase_reach
    )


def zero_input_interval(
    model: NarxModel,
    *,
    level: float = LEVEL,
    parameters: ArrayLike | None = None,
    covariance: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
    allow_missing: bool = False,
) -> Interval:
    """Return the rest y0 of :func:`dea.gfrf.zero_input_response` with its interval.

    Parameters are those of :func:`frequency_response_band`.

    Returns
    -------
    Interval
        Value, low and high, each of shape (...) of the sets of parameters, in output units.

    Raises
    ------
    InputError
        As :func:`dea.gfrf.zero_input_response`; if the model has no covariance, or parameters come
        without theirs.
    """
    spread = _covariance(model, parameters, covariance)
    theta, y0, u0, sets = rests(model, parameters, operating_point, allow_missing)
    slope = rest_slope(model.terms, theta, y0, u0).reshape(-1, *sets)
    reach = quantile(level) * model.scaling.y_scale * _deviation(slope, spread)
    value = model.scaling.restore_output(y0).reshape(sets)
    return Interval(value, value - reach, value + reach)


def _covariance(
    model: NarxModel, parameters: ArrayLike | None, covariance: ArrayLike | None
) -> Array:
    if covariance is None:
        if parameters is not None:
            raise InputError(
                "parameters are given without it",
                field="covariance",
                remedy="Give the covariance of these parameters",
            )
        return covariance_of(model)
    found = np.asarray(covariance, dtype=float)
    sets = np.shape(model.parameters if parameters is None else parameters)
    if found.shape != (*sets, sets[-1]):
        raise InputError(
            f"its shape is {found.shape}",
            field="covariance",
            remedy=f"Give one of {(*sets, sets[-1])} for parameters of shape {sets}",
        )
    return found


def _deviation(slope: Array, covariance: Array) -> Array:
    """Return the standard deviation of what has this ``slope`` (terms, *sets, *frequencies).

    Each set has its own covariance (*sets, terms, terms).
    """
    terms, sets = slope.shape[0], covariance.shape[:-2]
    count = int(np.prod(sets, dtype=int))
    rows = slope.reshape(terms, count, -1)
    variance = np.einsum("jsf,sjk,ksf->sf", rows, covariance.reshape(count, terms, terms), rows)
    found: Array = np.sqrt(np.maximum(variance, 0.0)).reshape(slope.shape[1:])
    return found
