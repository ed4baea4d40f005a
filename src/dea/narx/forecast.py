"""How far model structures forecast, with parameters that follow the past alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array, Segment
from dea.errors import InputError
from dea.missing import filled, stretches
from dea.narx.checks import as_record
from dea.narx.estimation import least_squares, normalised
from dea.narx.limits import MeasuredRange, stays_in_range
from dea.narx.model import NarxModel
from dea.narx.refinement import minimise
from dea.narx.segments import squared_error
from dea.store import Described, variable
from dea.terms import Term

LAST_VALUE = "last value"


@dataclass(frozen=True)
class ForecastPlan:
    """When forecasts are made, how far they reach and what they may know; all in s.

    Parameters
    ----------
    start, every
        The first forecast begins at ``start``, the next ones ``every`` s later.
    window
        Length of the past that parameters are estimated from.
    horizons
        Lengths of the forecasts over which errors are taken, ascending.
    """

    start: float = 120.0
    every: float = 60.0
    window: float = 100.0
    horizons: Sequence[float] = (1.0, 10.0, 60.0)


_PLAN = ForecastPlan()


def forecast_errors(
    models: Mapping[str, NarxModel],
    u: ArrayLike,
    y: ArrayLike,
    sampling_rate: float,
    plan: ForecastPlan = _PLAN,
    y_units: str = "1",
) -> xr.Dataset:
    """Forecast a record from many times on, and compare structures and the last value.

    At each time the parameters of every structure, with a constant where it has none, are those
    that minimise the simulated error over the window before, among those with which the model stays
    in range on all inputs until then; then the future input alone is given,
    and the model runs freely from the last measured outputs. ``last value`` keeps the last output.

    Parameters
    ----------
    models
        Structures and scalings by name.
    u, y
        The record in physical units, shape (samples,); missing outputs (NaN) enter no estimate and
        no error.
    sampling_rate
        In Hz.

    Returns
    -------
    Dataset
        ``error(forecaster, horizon, origin)``, root mean square over the horizon, and
        ``rmse(forecaster, horizon)``, over all origins, in output units; infinite where a run
        diverges. The errors of an origin are NaN for every forecaster, and enter no ``rmse``, where
        too many outputs are missing to estimate one of the structures before it, or where the
        horizon holds no output.

    Raises
    ------
    InputError
        If the record is too short for a window, a horizon holds no sample, or no origin has enough
        outputs before it.
    """
    inputs, recorded = as_record(u, y, missing=True)
    seen = np.isfinite(recorded)
    origins, window, reaches = _planned(plan, sampling_rate, recorded.size)
    structures = [_with_constant(model) for model in models.values()]
    windows = {
        column: parts
        for column, origin in enumerate(origins)
        if (parts := _known(structures, seen, slice(origin - window, origin))) is not None
    }
    if not windows:
        raise InputError(
            f"no window of {plan.window:g} s before a forecast holds as many good samples in a row"
            " as lags and terms need",
            field="y",
            remedy="Record it again, plan longer windows, or take a model of smaller lags.",
        )
    errors = np.full((len(models) + 1, len(reaches), origins.size), np.nan)
    # What is missing before an origin is not to be interpolated from what follows it.
    pasts = [filled(recorded[: origins[column]])[0] for column in windows]
    for row, structure in enumerate(structures):
        parts = [each[row] for each in windows.values()]
        forecasts = _forecasts(structure, inputs, pasts, parts, max(reaches))
        for column, forecast in zip(windows, forecasts, strict=True):
            errors[row, :, column] = _errors(forecast, recorded[origins[column] :], reaches)
    for column, past in zip(windows, pasts, strict=True):
        held = np.full(max(reaches), past[-1])
        errors[-1, :, column] = _errors(held, recorded[past.size :], reaches)
    coordinates = {
        "forecaster": variable("forecaster", [*models, LAST_VALUE], "1", "what forecasts"),
        "horizon": variable(
            "horizon", np.asarray(plan.horizons, dtype=float), "s", "length of the forecast"
        ),
        "origin": variable("origin", origins / sampling_rate, "s", "beginning of the forecast"),
    }
    return _dataset(errors, y_units, coordinates)


def _planned(
    plan: ForecastPlan, sampling_rate: float, samples: int
) -> tuple[NDArray[np.int64], int, list[int]]:
    """Return where forecasts of a record begin, and the lengths of window and horizons, in samples.

    Raises
    ------
    InputError
        If no forecast fits the record, or the horizons do not ascend.
    """
    window, *reaches = (round(t * sampling_rate) for t in (plan.window, *plan.horizons))
    origins = np.arange(
        round(plan.start * sampling_rate),
        samples - max(reaches) + 1,
        max(round(plan.every * sampling_rate), 1),
    )
    if not origins.size or origins[0] < window or any(b <= a for a, b in pairwise([0, *reaches])):
        raise InputError(
            f"no forecast over {plan.horizons} s fits a record of {samples / sampling_rate:g} s"
            f" from {plan.start:g} s on with {plan.window:g} s before",
            field="forecast",
            remedy="Give ascending horizons of a sample or more, and start after the window.",
        )
    return origins, window, reaches


def _dataset(errors: Array, units: str, coordinates: Mapping[str, Described]) -> xr.Dataset:
    """Return the errors (forecaster, horizon, origin), and their root mean square over origins."""
    with np.errstate(invalid="ignore"):  # a horizon that holds no output at any origin
        mean_squares = np.nansum(errors**2, axis=-1) / np.sum(~np.isnan(errors), axis=-1)
    what, over = "root mean square error of", tuple(coordinates)
    return xr.Dataset(
        {
            "error": variable(over, errors, units, f"{what} a forecast"),
            "rmse": variable(over[:-1], np.sqrt(mean_squares), units, f"{what} all forecasts"),
        },
        coords=coordinates,
    )


def _with_constant(model: NarxModel) -> NarxModel:
    """Return the structure to fit, with a constant and all parameters zero."""
    terms = model.terms if Term() in model.terms else (Term(), *model.terms)
    return NarxModel(terms, np.zeros(len(terms)), model.scaling)


def _known(
    structures: Sequence[NarxModel], seen: NDArray[np.bool_], window: slice
) -> list[list[slice]] | None:
    """Return what each structure is estimated from in a window; None where one has too little.

    All forecasters are compared on the same origins.
    """
    try:
        return [stretches(seen, window, each.max_lag, len(each.terms)) for each in structures]
    except InputError:
        return None


def _forecasts(
    fitted: NarxModel, u: Array, pasts: Sequence[Array], parts: Sequence[list[slice]], reach: int
) -> Iterator[Array]:
    """Yield the free run of ``reach`` samples from each origin, in physical units.

    ``pasts`` are the outputs (origin,) before each, ``parts`` what of them is estimated from.
    """
    lag = fitted.max_lag
    for y, good in zip(pasts, parts, strict=True):
        [past] = normalised([(u[: y.size], y)], fitted.scaling)
        window = [(past[0][part], past[1][part]) for part in good]
        fitted = fitted.with_parameters(_estimate(fitted.terms, fitted.parameters, past, window))
        yield fitted.simulate(u[y.size - lag : y.size + reach], y[y.size - lag :])[lag:]


def _estimate(
    terms: tuple[Term, ...], before: Array, past: Segment, window: list[Segment]
) -> Array:
    """Return the parameters of least simulated error over the ``window`` at the end of the past.

    The search starts from the parameters of the window before or from the least-squares ones,
    whichever simulate the window better. Parameters with which the model leaves the range of the
    outputs on any input played until then are not taken while others do not.
    """
    starts = [before, least_squares(terms, window).parameters]
    starts.sort(key=lambda start: squared_error(terms, start, window))
    searched = (minimise(terms, start, window).parameters for start in starts)
    found, measured = [], MeasuredRange.of([past])
    for candidate in chain(searched, starts):
        found.append(candidate)
        if stays_in_range(terms, candidate, *past, measured):
            return candidate
    return found[0]


def _errors(forecast: Array, measured: Array, reaches: Sequence[int]) -> list[float]:
    with np.errstate(over="ignore"):
        squares = (forecast - measured[: forecast.size]) ** 2
    parts = [squares[:reach][np.isfinite(measured[:reach])] for reach in reaches]
    return [float(np.sqrt(np.mean(part))) if part.size else np.nan for part in parts]
