"""Validation on windows of a long record: fitted to the window as published, and forecast."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.errors import InputError
from dea.inputs import input_count
from dea.missing import filled, stretches
from dea.narx.checks import Array, as_record
from dea.narx.estimation import estimate, normalised
from dea.narx.metrics import fit, fpe, nmse, rmse
from dea.narx.model import NarxModel
from dea.narx.refinement import minimise
from dea.narx.residual_verdict import joint_tests, verdict
from dea.narx.residuals import band, correlation_tests, each_test
from dea.narx.scaling import Scaling
from dea.store import Text, each_text
from dea.terms import Term, input_symbol
from dea.units import power


def _estimate_free_run(
    terms: Iterable[Term], u: list[Array], y: list[Array], *, scaling: Scaling
) -> NarxModel:
    """Return the parameters of least error of the free run from the first measured outputs.

    The least-squares ones where that run diverges. Runs are scored from measured outputs too; where
    the outputs at the start were estimated as well, a fit to a window could score worse on it.
    """
    model = estimate(terms, u, y, scaling=scaling)
    segments = normalised(list(zip(u, y, strict=True)), scaling)
    found = minimise(model.terms, model.parameters, segments)
    return model.with_parameters(found.parameters) if np.isfinite(found.msse) else model


# By name: whether the parameters are estimated from the window itself, and by which criterion.
FORECAST, PUBLISHED = "forecast", "fitted, one-step"
APPROACHES = {
    FORECAST: (False, _estimate_free_run),
    "fitted": (True, _estimate_free_run),
    "forecast, one-step": (False, estimate),
    PUBLISHED: (True, estimate),
}
_RUN = ("model", "approach", "window")


@dataclass(frozen=True)
class Windows:
    """Where models are validated.

    Parameters
    ----------
    spans
        Beginnings and ends in s, all equally long.
    before
        Seconds before each window that forecasts are estimated from.
    max_lag
        Largest lag of the residual tests, in samples.
    """

    spans: Sequence[tuple[float, float]]
    before: float
    max_lag: int = 50


def validate(
    models: Mapping[str, NarxModel],
    u: ArrayLike,
    y: ArrayLike,
    sampling_rate: float,
    windows: Windows,
    units: tuple[Text, str] = ("1", "1"),
    inputs: Sequence[str] = (),
) -> xr.Dataset:
    """Simulate model structures on windows, their parameters estimated in four ways.

    ``forecast``: on the stretch before the window, by the least simulated error (6). ``fitted``: by
    the same criterion on the window itself, which bounds what the structure can do there.
    ``forecast, one-step`` and ``fitted, one-step``: on the same stretches by least squares (4) on
    the one-step error; the last is the published approach. Runs start from the window's first
    measured outputs; scores, correlations and tests are those of the free run.

    Parameters
    ----------
    models
        Structures and scalings by name, for instance ``linear`` and ``narx``.
    u, y
        The whole record in physical units, as for :func:`dea.select_terms`; it starts at time 0.
        Missing outputs (NaN) enter no estimate and no score; in the correlations their residual is
        zero.
    sampling_rate
        In Hz.
    units
        Of input and output; of several inputs one for each.
    inputs
        What the verdict calls several inputs, by default u1 and so on.

    Returns
    -------
    Dataset
        As ``validation.nc`` holds it. Where a model diverges its run, errors and correlations
        are infinite. ``verdict(model)`` says in words what the residuals of its forecasts hold.

    Raises
    ------
    InputError
        If a window, or the stretch before it, is not inside the record.
    """
    driving, recorded = as_record(u, y, missing=True)
    outputs, seen = filled(recorded)
    count = input_count(driving)
    listed = list(each_test(count))
    names = list(inputs) or [input_symbol(k, count) for k in range(count)]
    spans = _spans(windows, sampling_rate, outputs.size)
    samples = spans[0][1].stop - spans[0][1].start
    shape = (len(models), len(APPROACHES), len(spans))
    simulated = np.empty((*shape, samples))
    scores = {name: np.empty(shape) for name in ("nmse", "fit", "fpe", "rmse")}
    tests = {name: np.empty((*shape, len(listed))) for name in ("p_value", "explained")}
    correlation = np.empty((*shape, len(listed), windows.max_lag))
    for at in np.ndindex(shape):
        model = list(models.values())[at[0]]
        earlier, window = spans[at[2]]
        own, estimator = list(APPROACHES.values())[at[1]]
        known = window if own else earlier
        good = stretches(seen, known, model.max_lag, len(model.terms))
        segments = [driving[part] for part in good], [outputs[part] for part in good]
        fitted = estimator(model.terms, *segments, scaling=model.scaling)
        measured = outputs[window]
        run = fitted.simulate(driving[window], measured)
        simulated[at] = run
        start = model.max_lag  # the samples before it are given, not simulated
        there = seen[window][start:]
        pair = measured[start:][there], run[start:][there]
        for name, score in (("nmse", nmse), ("fit", fit), ("rmse", rmse)):
            scores[name][at] = score(*pair)
        scores["fpe"][at] = fpe(*pair, len(model.terms))
        residual, known_input = np.zeros(there.size), driving[window][start:]
        residual[there] = pair[0] - pair[1]
        correlation[at] = correlation_tests(residual, known_input, windows.max_lag)
        found = joint_tests(residual, known_input, windows.max_lag)
        tests["p_value"][at], tests["explained"][at] = found
    u_units, y_units = units
    size = samples - max(model.max_lag for model in models.values())
    cut = [window for _, window in spans]
    forecast = list(APPROACHES).index(FORECAST)
    verdicts = [
        verdict(
            tests["p_value"][row, forecast],
            tests["explained"][row, forecast],
            float(np.sqrt(np.mean(scores["rmse"][row, forecast] ** 2))),
            float(np.std([outputs[window] for window in cut])),
            y_units,
            names if count > 1 else ("the input",),
        )
        for row in range(len(models))
    ]
    over = ("window", "sample")
    score_units = {"rmse": y_units, "fpe": power(y_units, 2)}
    variables: dict[str, tuple[tuple[str, ...], NDArray[Any], str, str]] = {
        "time": (
            over,
            np.array([np.arange(w.start, w.stop) / sampling_rate for w in cut]),
            "s",
            "time",
        ),
        "input": (
            (*over, "signal")[: 1 + driving.ndim],
            np.array([driving[w] for w in cut]),
            ", ".join(dict.fromkeys(each_text(u_units))),
            "input",
        ),
        "measured": (over, np.array([recorded[w] for w in cut]), y_units, "measured output"),
        "simulated": (
            ("model", "approach", *over),
            simulated,
            y_units,
            "free-run simulation",
        ),
        **{
            name: (_RUN, values, score_units.get(name, "1"), name)
            for name, values in scores.items()
        },
        "correlation": (
            (*_RUN, "test", "lag"),
            correlation,
            "1",
            "correlation coefficient of the free run's residual",
        ),
        "band": (
            ("test",),
            np.full(len(listed), band(size)),
            "1",
            "half-width of the 95 % band",
        ),
        "p_value": (
            (*_RUN, "test"),
            tests["p_value"],
            "1",
            "probability of as much in a residual without that relation, all lags together",
        ),
        "explained": (
            (*_RUN, "test"),
            tests["explained"],
            "1",
            "share of the whitened residual's power that all lags explain",
        ),
        "verdict": (("model",), np.array(verdicts), "1", "what the residuals of forecasts hold"),
    }
    coordinates = {
        **({"signal": np.array(names)} if count > 1 else {}),
        "model": np.array(list(models)),
        "approach": np.array(list(APPROACHES)),
        "window": np.arange(len(spans)),
        "test": np.array(listed),
        "lag": np.arange(1, windows.max_lag + 1),
    }
    return xr.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": label})
            for name, (dims, values, unit, label) in variables.items()
        },
        coords={
            name: (name, values, {"units": "1", "long_name": name})
            for name, values in coordinates.items()
        },
    )


def _spans(windows: Windows, rate: float, samples: int) -> list[tuple[slice, slice]]:
    """Return the stretch before each window and the window, as slices of samples."""
    spans = []
    for begin, end in windows.spans:
        # Lengths are rounded, not ends: windows of one length in s have as many samples.
        first = round(begin * rate)
        last = first + round((end - begin) * rate)
        earliest = first - round(windows.before * rate)
        short = last - first <= 2 * windows.max_lag
        if earliest < 0 or last > samples or short or earliest >= first:
            raise InputError(
                f"the window {begin:g} to {end:g} s with {windows.before:g} s before it does not"
                f" fit a record of {samples / rate:g} s, or is not longer than twice"
                f" {windows.max_lag} samples",
                field="windows",
                remedy="Choose windows inside the record, or fewer lags.",
            )
        spans.append((slice(earliest, first), slice(first, last)))
    if len({window.stop - window.start for _, window in spans}) != 1:
        raise InputError(
            "the windows differ in length, or there is none",
            field="windows",
            remedy="Give windows of one length.",
        )
    return spans
