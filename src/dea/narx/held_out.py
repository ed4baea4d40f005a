"""The error of a structure on parts of its own record that its parameters were not fitted to."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from dea.errors import InputError
from dea.narx.checks import as_record
from dea.narx.estimation import normalised
from dea.narx.free_run_fit import fit_free_runs
from dea.narx.labels import pair
from dea.narx.metrics import rmse
from dea.narx.model import NarxModel
from dea.store import Record


def held_out_error(
    model: NarxModel,
    u: ArrayLike | Record,
    y: ArrayLike | None = None,
    *,
    parts: int = 6,
    start: int | None = None,
) -> float:
    """Free-run error of a model's structure by cross-validation on one record.

    The record is cut into contiguous parts. For each, the parameters that minimise the simulated
    error (6) on all others are sought from the model's own, and simulate the part left out from
    its first measured outputs on. Choosing lags, degree and thresholds by this error uses no test
    record.

    Parameters
    ----------
    model
        As :func:`dea.select_terms` found it on this record.
    u, y
        Input and output in physical units, as for :func:`dea.select_terms`, or a
        :class:`dea.Record` alone, of which no sample may be missing.
    parts
        At least two.
    start
        The sample of each part at which its run starts, by default the model's largest lag. Errors
        of models whose lags differ are comparable where all start at the same.

    Returns
    -------
    float
        Root mean square over the parts of their rmse, in units of the output; infinite where a
        run diverges.

    Raises
    ------
    InputError
        If a part is too short for the model's lags, or a run is to start before them.
    """
    given = model.max_lag if start is None else start
    if given < model.max_lag:
        raise InputError(
            f"it is {given}, and the model's largest lag {model.max_lag}",
            field="start",
            remedy="Start runs after as many outputs as the largest lag.",
        )
    whole = pair(model.labels, u, y, model.max_lag)
    inputs, outputs = as_record(*whole, model.max_lag, len(model.terms))
    check_parts(parts, outputs.size, given)
    edges = np.linspace(0, outputs.size, parts + 1).astype(int)
    errors = np.empty(parts)
    for i, (first, last) in enumerate(pairwise(edges)):
        others = [
            (inputs[piece], outputs[piece])
            for piece in (slice(0, first), slice(last, outputs.size))
            if outputs[piece].size > model.max_lag
        ]
        fitted = fit_free_runs(model.terms, model.parameters, normalised(others, model.scaling))
        if not np.isfinite(fitted.msse):
            return np.inf
        part = slice(first + given - model.max_lag, last)
        run = model.with_parameters(fitted.parameters).simulate(inputs[part], outputs[part])
        errors[i] = rmse(outputs[part][model.max_lag :], run[model.max_lag :])
    return float(np.sqrt(np.mean(errors**2)))


def check_parts(parts: int, samples: int, start: int) -> None:
    """Check that every part of a record is longer than what its run starts after.

    Raises
    ------
    InputError
        If one is not, or there are fewer than two.
    """
    if parts < 2 or samples // parts < start + 2:
        raise InputError(
            f"{parts} parts of {samples} samples, for a largest lag of {start}",
            field="parts",
            remedy="Cut the record into at least two parts, each longer than the lags.",
        )
