"""Table 1: the terms of every actuator's model with their parameters, and its scores."""

from collections.abc import Mapping
from math import floor, isfinite, log10
from typing import Any

import pandas as pd
import xarray as xr

from dea.number_format import DASH, number
from dea.store import Sources
from dea.tables.table import Table, header, score
from dea.terms import Term

_TERM_COUNT = "number of terms"


def tabulate(sources: Sources) -> Table:
    """Make it from ``model.nc`` and ``validation.nc`` of every actuator."""
    return table1(sources.datasets("model"), sources.datasets("validation"))


def table1(models: Mapping[str, xr.Dataset], validations: Mapping[str, xr.Dataset]) -> Table:
    """Terms x actuators with standard errors, then scores on the first validation window.

    Parameters
    ----------
    models, validations
        Contracts ``model`` and ``validation``, by the actuators' names.
    """
    every = {str(term) for model in models.values() for term in model["term"].values}
    terms = sorted(every, key=lambda text: Term.parse(text).reading_order)
    exact: dict[str, list[Any]] = {"term": [*terms, _TERM_COUNT]}
    shown: dict[str, list[str]] = {"term": [*terms, _TERM_COUNT]}
    for name, model in models.items():
        found = [str(term) for term in model["term"].values]
        parameter = dict(zip(found, model["parameter"].values.tolist(), strict=True))
        exact[name] = [*map(parameter.get, terms), len(found)]
        for quality in ("standard_error", "inclusion_frequency"):
            if quality in model:
                values = dict(zip(found, model[quality].values.tolist(), strict=True))
                exact[f"{name} {quality.replace('_', ' ')}"] = [*map(values.get, terms), None]
        error = exact.get(f"{name} standard error", [None] * len(terms))
        shown[name] = [
            *(_estimate(parameter.get(term), error[i]) for i, term in enumerate(terms)),
            str(len(found)),
        ]
    exact_scores, shown_scores = _scores(validations)
    return Table(
        pd.concat([pd.DataFrame(exact, dtype=object), exact_scores], ignore_index=True),
        pd.concat([pd.DataFrame(shown), shown_scores], ignore_index=True),
    )


def _scores(validations: Mapping[str, xr.Dataset]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """nmse, fit and fpe of the NARX model on the first window, by both approaches."""
    exact, shown = [], []
    for name in ("nmse", "fit", "fpe"):
        for approach in ("forecast", "fitted, one-step"):
            values = {
                actuator: each[name].isel(window=0).sel(model="narx", approach=approach)
                for actuator, each in validations.items()
            }
            label = {"term": f"{header(next(iter(values.values())))}, {approach}"}
            exact.append(label | {actuator: float(value) for actuator, value in values.items()})
            shown.append(
                label | {actuator: score(name, float(value)) for actuator, value in values.items()}
            )
    return pd.DataFrame(exact, dtype=object), pd.DataFrame(shown)


def _estimate(value: float | None, error: float | None) -> str:
    """A parameter with its standard error, both to the error's second significant digit."""
    if value is None:
        return DASH
    if not error or not isfinite(error):
        return number(value, 4)
    decimals = max(0, 1 - floor(log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"
