"""Intervals of confidence from a covariance, and that of a free run."""

from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.confidence import LEVEL
from dea.errors import InputError
from dea.narx.model import NarxModel
from dea.narx.segments import sensitivities
from dea.store import Record


class Interval(NamedTuple):
    """Values and the ends of their pointwise intervals, all of one shape.

    The ends are NaN where no interval of that level can be given.
    """

    value: Array
    low: Array
    high: Array


def quantile(level: float) -> float:
    """Return how many standard deviations either side hold the share ``level`` of a normal law.

    Raises
    ------
    InputError
        If the level is not between 0 and 1.
    """
    if not 0.0 < level < 1.0:
        raise InputError(f"it is {level:g}", field="level", remedy="Give one between 0 and 1")
    return NormalDist().inv_cdf(0.5 + 0.5 * level)


def covariance_of(model: NarxModel) -> Array:
    """Return the covariance of the parameters (terms, terms); NaN where it is withheld.

    It is that of the parameters of the normalised signals.

    Raises
    ------
    InputError
        If the model has none.
    """
    if model.covariance is None:
        raise InputError(
            "the model has no covariance",
            field="model",
            remedy="Estimate it: dea.narx.refine(model, u, y)",
        )
    return np.full_like(model.covariance, np.nan) if model.withheld else model.covariance


def parameter_interval(model: NarxModel, *, level: float = LEVEL) -> Interval:
    """Return the parameters with their intervals, each of shape (terms,), normalised units.

    Each interval is for its own parameter: ``level`` of such intervals hold the true value where
    the model has the system's terms.

    Raises
    ------
    InputError
        If the model has no covariance.
    """
    reach = quantile(level) * np.sqrt(np.diag(covariance_of(model)))
    return Interval(model.parameters, model.parameters - reach, model.parameters + reach)


def simulation_interval(
    model: NarxModel,
    u: ArrayLike | Record,
    y_initial: ArrayLike | None = None,
    *,
    level: float = LEVEL,
) -> Interval:
    """Return the free run with the interval that the uncertainty of the parameters gives it.

    It holds the output free of noise, of the same initial outputs, not the measured one.

    Parameters are those of :meth:`dea.narx.NarxModel.simulate`; the results have shape (samples,),
    in output units.

    Raises
    ------
    InputError
        If the model has no covariance.
    """
    covariance = covariance_of(model)
    scaling = model.scaling
    run = model.simulate(u, y_initial)
    inputs, initial, before = model.run_from(u, y_initial)
    slope = sensitivities(model.terms, model.parameters, inputs, initial)[1][before:]
    variance = np.einsum("ij,jk,ik->i", slope, covariance, slope)
    reach = quantile(level) * scaling.y_scale * np.sqrt(np.maximum(variance, 0.0))
    return Interval(run, run - reach, run + reach)
