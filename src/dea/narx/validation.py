"""Validation on windows of a long record: fitted to the window as published, and forecast."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.inputs import input_count
from dea.missing import filled, stretches
from dea.narx.checks import as_record
from dea.narx.estimation import estimate, normalised
from dea.narx.metrics import fit, fpe, nmse, rmse
from dea.narx.model import NarxModel
from dea.narx.refinement import minimise
from dea.narx.residual_verdict import joint_tests, verdict
from dea.narx.residuals import band, correlation_tests, each_test
from dea.narx.scaling import Scaling
from dea.narx.validation_dataset import Measured, Validated, validation_dataset
from dea.store import Text
from dea.terms import Term, input_symbol


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
    windows
        Where models are estimated and validated.
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
    names = list(inputs) or [input_symbol(k, count) for k in range(count)]
    spans = _spans(windows, sampling_rate, outputs.size)
    cut = [window for _, window in spans]
    listed = list(each_test(count))
    found = _tried(list(models.values()), driving, outputs, seen, spans, windows.max_lag)
    forecast = list(APPROACHES).index(FORECAST)
    verdicts = [
        verdict(
            found.p_value[row, forecast],
            found.explained[row, forecast],
            float(np.sqrt(np.mean(found.scores["rmse"][row, forecast] ** 2))),
            float(np.std([outputs[window] for window in cut])),
            units[1],
            names if count > 1 else ("the input",),
        )
        for row in range(len(models))
    ]
    measured = Measured(
        np.array([np.arange(w.start, w.stop) / sampling_rate for w in cut]),
        np.array([driving[w] for w in cut]),
        np.array([recorded[w] for w in cut]),
        units,
        names,
    )
    coordinates = {
        "model": np.array(list(models)),
        "approach": np.array(list(APPROACHES)),
        "test": np.array(listed),
        "lag": np.arange(1, windows.max_lag + 1),
    }
    return validation_dataset(measured, found._replace(verdicts=verdicts), coordinates)


def _tried(
    models: Sequence[NarxModel],
    driving: Array,
    outputs: Array,
    seen: NDArray[np.bool_],
    spans: Sequence[tuple[slice, slice]],
    max_lag: int,
) -> Validated:
    """Estimate and simulate each model by each approach on each window; no verdicts yet."""
    tests = len(list(each_test(input_count(driving))))
    samples = spans[0][1].stop - spans[0][1].start
    shape = (len(models), len(APPROACHES), len(spans))
    simulated = np.empty((*shape, samples))
    scores = {name: np.empty(shape) for name in ("nmse", "fit", "fpe", "rmse")}
    p_value, explained = np.empty((*shape, tests)), np.empty((*shape, tests))
    correlation, tested = np.empty((2, *shape, tests, max_lag))
    for at in np.ndindex(shape):
        model = models[at[0]]
        earlier, window = spans[at[2]]
        own, estimator = list(APPROACHES.values())[at[1]]
        good = stretches(seen, window if own else earlier, model.max_lag, len(model.terms))
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
        correlation[at] = correlation_tests(residual, known_input, max_lag)
        p_value[at], explained[at], tested[at] = joint_tests(residual, known_input, max_lag)
    width = band(samples - max(model.max_lag for model in models))
    return Validated(simulated, scores, correlation, tested, p_value, explained, width, [])


def _spans(windows: Windows, rate: float, samples: int) -> list[tuple[slice, slice]]:
    """Return the stretch before each window and the window, as slices of samples."""
    spans = []
    for begin, end in windows.spans:
        # Lengths are rounded, not ends: windows of one length in s have as many samples.
        first = round(begin * rate)
        last = first + round((end - begin) * rate)
        earliest = first - round(windows.before * rate)
        if last - first <= 2 * windows.max_lag:
            raise InputError(
                f"the window {begin:g} to {end:g} s holds {last - first} samples, not more than"
                f" twice {windows.max_lag}",
                field="max_lag",
                remedy="Take less than half of a window, or longer windows.",
            )
        if earliest < 0 or last > samples or earliest >= first:
            raise InputError(
                f"the window {begin:g} to {end:g} s with {windows.before:g} s before it does not"
                f" fit a record of {samples / rate:g} s",
                field="windows",
                remedy="Choose windows inside the record.",
            )
        spans.append((slice(earliest, first), slice(first, last)))
    if len({window.stop - window.start for _, window in spans}) != 1:
        raise InputError(
            "the windows differ in length, or there is none",
            field="windows",
            remedy="Give windows of one length.",
        )
    return spans
