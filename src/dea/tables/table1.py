"""Table 1: the terms of every actuator's own model and of their common structure, and scores."""

from collections.abc import Callable, Mapping
from math import ceil, isfinite, log10
from typing import Any

import pandas as pd
import xarray as xr

from dea.number_format import DASH, number
from dea.store import Sources
from dea.tables.table import Table, header, score
from dea.terms import Term

_Row = dict[str, Any]


def tabulate(sources: Sources) -> Table:
    """Make it from ``model.nc`` and ``validation.nc`` of every actuator and ``common_model.nc``."""
    return table1(
        sources.datasets("model"), sources.datasets("validation"), sources.dataset("common_model")
    )


def table1(
    models: Mapping[str, xr.Dataset], validations: Mapping[str, xr.Dataset], common: xr.Dataset
) -> Table:
    """Terms x actuators, first of the own structures and then of the common one, with scores.

    A cell holds the parameter, its standard error and, for own structures, the share of resampled
    records that lead to the same term. Scores of the own structures are on the first validation
    window; those that compare the structures, on data that neither was identified from.

    Parameters
    ----------
    models, validations
        Contracts ``model`` and ``validation``, by the actuators' names.
    common
        Contract ``common_model``.
    """
    exact = [*_own_terms(models, exactly=True), *_scores(validations, lambda _, value: value)]
    shown = [*_own_terms(models, exactly=False), *_scores(validations, score)]
    for rows, exactly in ((exact, True), (shown, False)):
        rows += _common_terms(common, exactly)
        rows += _costs(common, exactly)
    return Table(pd.DataFrame(exact, dtype=object), pd.DataFrame(shown))


def _own_terms(models: Mapping[str, xr.Dataset], exactly: bool) -> list[_Row]:
    every = {str(term) for model in models.values() for term in model["term"].values}
    rows: list[_Row] = []
    for text in sorted(every, key=lambda text: Term.parse(text).reading_order):
        row: _Row = {"structure": "own", "term": text}
        for name, model in models.items():
            has = text in model["term"].values
            values = model.sel(term=text) if has else None
            valid = not model.attrs.get("withheld")
            row |= _cells(name, values, exactly, ("standard_error", "inclusion_frequency"), valid)
        rows.append(row)
    count = {name: model["term"].size for name, model in models.items()}
    rows.append(_labelled("own", "number of terms", count, exactly))
    status = {name: str(model.attrs.get("stability", DASH)) for name, model in models.items()}
    rows.append(_labelled("own", "stability", status, exactly))
    reasons = {name: str(model.attrs.get("withheld", "")) for name, model in models.items()}
    return rows + _withheld("own", reasons, exactly)


def _common_terms(common: xr.Dataset, exactly: bool) -> list[_Row]:
    rows: list[_Row] = []
    withheld = common["withheld"]
    reasons = {str(name): str(withheld.sel(system=name).item()) for name in common["system"].values}
    for term in sorted(
        map(str, common["term"].values), key=lambda text: Term.parse(text).reading_order
    ):
        row: _Row = {"structure": "common", "term": term}
        for name in map(str, common["system"].values):
            values = common[["parameter", "standard_error"]].sel(term=term, system=name)
            row |= _cells(name, values, exactly, ("standard_error",), not reasons[name])
        rows.append(row)
    for variable, label in (("terms", "number of terms"), ("stability", "stability")):
        row_of = common[variable].sel(structure="common")
        found = {str(name): row_of.sel(system=name).item() for name in common["system"].values}
        rows.append(_labelled("common", label, found, exactly))
    return rows + _withheld("common", reasons, exactly)


def _cells(
    name: str, values: xr.Dataset | None, exactly: bool, qualities: tuple[str, ...], valid: bool
) -> _Row:
    """One term of one actuator: a cell for readers, or a column for each quantity.

    A standard error that is not ``valid`` is left out, and its cell says that it is withheld.
    """
    if values is None:
        return {name: None if exactly else DASH}
    found = {
        quality: float(values[quality])
        for quality in ("parameter", *qualities)
        if quality in values and (valid or quality != "standard_error")
    }
    if exactly:
        extra = {f"{name} {each.replace('_', ' ')}": found.get(each) for each in qualities}
        return {name: found["parameter"], **{k: v for k, v in extra.items() if v is not None}}
    return {name: _estimate(**found, withheld=not valid)}


def _withheld(structure: str, reasons: Mapping[str, str], exactly: bool) -> list[_Row]:
    """Why standard errors are withheld, where that is so of any actuator."""
    if not any(reasons.values()):
        return []
    said = {name: reason or DASH for name, reason in reasons.items()}
    return [_labelled(structure, "standard errors withheld", said, exactly)]


def _scores(validations: Mapping[str, xr.Dataset], form: Callable[[str, float], Any]) -> list[_Row]:
    """nmse, fit and fpe of the NARX model on the first window, by both approaches."""
    rows = []
    for name in ("nmse", "fit", "fpe"):
        for approach in ("forecast", "fitted, one-step"):
            values = {
                actuator: each[name].isel(window=0).sel(model="narx", approach=approach)
                for actuator, each in validations.items()
            }
            label = f"{header(next(iter(values.values())))}, {approach}"
            row: _Row = {"structure": "own", "term": label}
            rows.append(row | {key: form(name, float(value)) for key, value in values.items()})
    return rows


def _costs(common: xr.Dataset, exactly: bool) -> list[_Row]:
    """nmse of both structures on data that neither was identified from, and their ratio."""
    rows = []
    names = [str(name) for name in common["system"].values]
    error = {
        str(structure): common["nmse"].sel(structure=structure).values.tolist()
        for structure in common["structure"].values
    }
    ratio = common["nmse"].sel(structure="common") / common["nmse"].sel(structure="own")
    for structure, label, values in (
        ("own", "nmse, data not used", error["own"]),
        ("common", "nmse, data not used", error["common"]),
        ("common", "nmse, common over own", ratio.values.tolist()),
    ):
        cells = [value if exactly else number(value) for value in values]
        rows.append({"structure": structure, "term": label} | dict(zip(names, cells, strict=True)))
    return rows


def _labelled(structure: str, label: str, values: Mapping[str, Any], exactly: bool) -> _Row:
    row: _Row = {"structure": structure, "term": label}
    return row | {name: value if exactly else str(value) for name, value in values.items()}


def _estimate(
    parameter: float,
    standard_error: float | None = None,
    inclusion_frequency: float | None = None,
    withheld: bool = False,
) -> str:
    """A parameter with as many digits as its standard error leaves, that error, and the share.

    The error is given to two digits where it begins with a one or a two, else to one, and the
    parameter to the same place.
    """
    if withheld:
        text = f"{number(parameter, 4)} ± withheld"
    elif not standard_error or not isfinite(standard_error):
        text = number(parameter, 4)
    else:
        first = 10.0 ** (ceil(log10(standard_error)) - 1)  # the place of the error's first digit
        digits = 2 if standard_error / first < 3.0 else 1
        decimals = max(0, round(-log10(first)) + digits - 1)
        text = f"{parameter:.{decimals}f} ± {standard_error:.{decimals}f}"
    if inclusion_frequency is None:
        return text
    return f"{text} ({100 * inclusion_frequency:.0f} %)"
