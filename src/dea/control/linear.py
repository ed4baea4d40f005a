"""Linear models of a NARX model around an operating point, for python-control."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.errors import InputError
from dea.gfrf import Instants, linear_part, zero_input_interval, zero_input_response
from dea.narx import LEVEL, Interval, NarxModel, quantile, rate_of

if TYPE_CHECKING:
    from control import StateSpace, TransferFunction


@dataclass(frozen=True)
class Linearised:
    """A linear model of deviations from an operating point, in physical units.

    Parameters
    ----------
    input
        The constant input of the operating point.
    output
        Where the model rests there, with its interval.
    numerator, denominator
        Coefficients of the transfer function by falling power of z, each of shape (order + 1,),
        with their intervals; the first of the denominator is one.
    sampling_rate
        In Hz.
    """

    input: float
    output: Interval
    numerator: Interval
    denominator: Interval
    sampling_rate: float

    def transfer_function(self) -> "TransferFunction":
        """Return python-control's transfer function of the deviations."""
        import control

        return control.tf(self.numerator.value, self.denominator.value, 1.0 / self.sampling_rate)

    def state_space(self) -> "StateSpace":
        """Return python-control's state space of the deviations, in observable canonical form."""
        import control

        a, b = -self.denominator.value[1:], self.numerator.value
        A = np.diag(np.ones(a.size - 1), 1)
        A[:, 0] = a
        C = np.eye(1, a.size)
        return control.ss(A, (b[1:] + a * b[0])[:, None], C, b[0], 1.0 / self.sampling_rate)


def linearise(
    model: NarxModel,
    operating_point: float | None = None,
    *,
    sampling_rate: float | None = None,
    parameters: ArrayLike | None = None,
    covariance: ArrayLike | None = None,
    level: float = LEVEL,
) -> Linearised:
    """Return the linear model of a NARX model around its rest at a constant input.

    Parameters
    ----------
    operating_point
        Constant input in physical units; by default the input's offset.
    sampling_rate
        In Hz. By default that of the model's own record.
    parameters, covariance
        Other parameters (terms,) with their covariance (terms, terms), as a tracker gives them; by
        default the model's own.
    level
        Of the intervals, which are missing (NaN) where there is no covariance or it is withheld.

    Raises
    ------
    InputError
        If the model does not come to rest at the operating point, or the rate is not positive,
        not known or not the model's own.
    """
    rate = rate_of(model.labels, sampling_rate)
    middle = model.of_one_input("A linear model").u_offset
    theta = np.asarray(model.parameters if parameters is None else parameters, dtype=float)
    own = model.covariance if parameters is None and not model.withheld else None
    given = own if covariance is None else np.asarray(covariance, dtype=float)
    spread = np.full((theta.size, theta.size), np.nan) if given is None else given
    output = zero_input_interval(
        model, level=level, parameters=theta, covariance=spread, operating_point=operating_point
    )
    part = linear_part(model, parameters=theta, operating_point=operating_point)
    reach = quantile(level)

    def interval(value: Array, slope: Array) -> Interval:
        variance = np.einsum("ji,jk,ki->i", slope, spread, slope)
        deviation = reach * np.sqrt(np.maximum(variance, 0.0))
        return Interval(value, value - deviation, value + deviation)

    feedback = interval(-part.outputs, -part.outputs_slope)
    leading = np.ones(1)  # exact
    return Linearised(
        middle if operating_point is None else float(operating_point),
        output,
        interval(part.inputs, part.inputs_slope),
        Interval(*(np.concatenate([leading, each]) for each in feedback)),
        rate,
    )


def linearise_over_time(
    model: NarxModel,
    track: xr.Dataset,
    operating_point: float | None = None,
    *,
    sampling_rate: float | None = None,
    level: float = LEVEL,
) -> dict[float, Linearised]:
    """Return the linear model at each instant of a track, by its time in s.

    Parameters
    ----------
    model
        With the terms of the track: :func:`dea.tracking.with_constant` of the model tracked.
    track
        Of :func:`dea.track_parameters`. The intervals are missing where it withholds them.

    Other parameters are those of :func:`linearise`. Instants at which the model does not come to
    rest have no linear model, and are left out.

    Raises
    ------
    InputError
        If the track is of other terms, or the model comes to rest at no instant.
    """
    instants = Instants.of(track, model)
    rests = zero_input_response(
        model,
        parameters=instants.theta,
        operating_point=operating_point,
        allow_missing=True,
    )
    found = {
        float(time): linearise(
            model,
            operating_point,
            sampling_rate=sampling_rate,
            parameters=theta,
            covariance=covariance,
            level=level,
        )
        for time, theta, covariance, rest in zip(
            instants.time, instants.theta, instants.covariance, rests, strict=True
        )
        if np.isfinite(rest)
    }
    if not found:
        raise InputError(
            "the model comes to rest at no instant",
            field="operating_point",
            remedy="Take another constant input.",
        )
    return found
