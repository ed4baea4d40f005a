"""Validation on windows of a long record: re-estimated as published, and honestly."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from dea.errors import InputError
from dea.narx.checks import as_record
from dea.narx.estimation import estimate
from dea.narx.metrics import fit, fpe, nmse, rmse, squared
from dea.narx.model import NarxModel
from dea.narx.refinement import estimate_refined
from dea.narx.residuals import TESTS, band, correlation_tests

APPROACHES = ("re-estimated", "honest")


def validate(
    models: Mapping[str, NarxModel],
    u: ArrayLike,
    y: ArrayLike,
    sampling_rate: float,
    *,
    windows: Sequence[tuple[float, float]],
    before: float,
    max_lag: int = 50,
    u_units: str = "1",
    y_units: str = "1",
) -> xr.Dataset:
    """Simulate model structures on windows, their parameters estimated in two ways.

    ``re-estimated``: by least squares on the window itself, as published, which scores on the data
    it was fitted to. ``honest``: on the stretch before the window, by least squares and then
    refined, and simulated on the window it has not seen. Runs start from the window's first
    measured outputs; scores and correlations are those of the free run.

    Parameters
    ----------
    models
        Structures and scalings by name, for instance ``linear`` and ``narx``.
    u, y
        The whole record in physical units, shape (samples,); it starts at time 0.
    sampling_rate
        In Hz.
    windows
        Beginnings and ends in s, all equally long.
    before
        Seconds before each window that the honest parameters are estimated from.
    max_lag
        Largest lag of the residual correlation tests, in samples.

    Returns
    -------
    Dataset
        As ``validation.nc`` holds it. Where a model diverges its run, errors and correlations
        are infinite.

    Raises
    ------
    InputError
        If a window, or the stretch before it, is not inside the record.
    """
    inputs, outputs = as_record(u, y)
    spans = _spans(windows, before, sampling_rate, inputs.size, max_lag)
    samples = spans[0][1].stop - spans[0][1].start
    shape = (len(models), len(APPROACHES), len(spans))
    simulated = np.empty((*shape, samples))
    scores = {name: np.empty(shape) for name in ("nmse", "fit", "fpe", "rmse")}
    correlation = np.empty((*shape, len(TESTS), max_lag))
    for at in np.ndindex(shape):
        model = list(models.values())[at[0]]
        earlier, window = spans[at[2]]
        if APPROACHES[at[1]] == "honest":
            past = inputs[earlier], outputs[earlier]
            fitted = estimate_refined(model.terms, *past, scaling=model.scaling)
        else:
            fitted = estimate(model.terms, inputs[window], outputs[window], scaling=model.scaling)
        measured = outputs[window]
        run = fitted.simulate(inputs[window], measured)
        simulated[at] = run
        start = model.max_lag  # the samples before it are given, not simulated
        pair = measured[start:], run[start:]
        scores["nmse"][at], scores["fit"][at], scores["rmse"][at] = (
            nmse(*pair),
            fit(*pair),
            rmse(*pair),
        )
        scores["fpe"][at] = fpe(*pair, len(model.terms))
        correlation[at] = correlation_tests(pair[0] - pair[1], inputs[window][start:], max_lag)
    size = samples - max(model.max_lag for model in models.values())
    return _labelled(
        {
            "time": (
                ("window", "sample"),
                np.array([np.arange(w.start, w.stop) / sampling_rate for _, w in spans]),
                "s",
                "time",
            ),
            "input": (
                ("window", "sample"),
                np.array([inputs[w] for _, w in spans]),
                u_units,
                "input",
            ),
            "measured": (
                ("window", "sample"),
                np.array([outputs[w] for _, w in spans]),
                y_units,
                "measured output",
            ),
            "simulated": (
                ("model", "approach", "window", "sample"),
                simulated,
                y_units,
                "free-run simulation",
            ),
            **{
                name: (
                    ("model", "approach", "window"),
                    values,
                    {"rmse": y_units, "fpe": squared(y_units)}.get(name, "1"),
                    name,
                )
                for name, values in scores.items()
            },
            "correlation": (
                ("model", "approach", "window", "test", "lag"),
                correlation,
                "1",
                "correlation coefficient of the free run's residual",
            ),
            "band": (
                ("test",),
                np.full(len(TESTS), band(size)),
                "1",
                "half-width of the 95 % band",
            ),
        },
        {
            "model": np.array(list(models)),
            "approach": np.array(APPROACHES),
            "window": np.arange(len(spans)),
            "test": np.array(list(TESTS)),
            "lag": np.arange(1, max_lag + 1),
        },
    )


def _spans(
    windows: Sequence[tuple[float, float]],
    before: float,
    rate: float,
    samples: int,
    max_lag: int,
) -> list[tuple[slice, slice]]:
    """Return the stretch before each window and the window, as slices of samples."""
    spans = []
    for begin, end in windows:
        # Lengths are rounded, not ends: windows of one length in s have as many samples.
        first = round(begin * rate)
        earliest, last = first - round(before * rate), first + round((end - begin) * rate)
        if earliest < 0 or last > samples or last - first <= 2 * max_lag or earliest >= first:
            raise InputError(
                f"the window {begin:g} to {end:g} s with {before:g} s before it does not fit a "
                f"record of {samples / rate:g} s, or is not longer than twice {max_lag} samples",
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


def _labelled(
    variables: Mapping[str, tuple[tuple[str, ...], NDArray[Any], str, str]],
    coordinates: Mapping[str, NDArray[Any]],
) -> xr.Dataset:
    return xr.Dataset(
        {
            name: (dims, values, {"units": units, "long_name": label})
            for name, (dims, values, units, label) in variables.items()
        },
        coords={
            name: (name, values, {"units": "1", "long_name": name})
            for name, values in coordinates.items()
        },
    )
