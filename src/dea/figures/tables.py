"""The study's tables: exact numbers for programs, rounded ones for readers."""

import re
from collections.abc import Mapping
from math import floor, isfinite, log10
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
import xarray as xr

from dea.figures.symbols import DASH, number
from dea.store import atomic
from dea.terms import Term, is_term

_TERM_COUNT = "number of terms"
_SCORES = ("nmse", "fit", "fpe", "rmse")
_SCIENTIFIC = re.compile(r"(-?[\d.]+)e([+-]\d+)")


class Table(NamedTuple):
    """A table twice: ``exact`` numbers for CSV, ``shown`` as rounded text for readers."""

    exact: pd.DataFrame
    shown: pd.DataFrame


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


def validation(validations: Mapping[str, xr.Dataset]) -> Table:
    """Scores of every actuator, window, model and approach (contract ``validation``)."""
    rows = []
    for name, dataset in validations.items():
        for window in range(dataset["window"].size):
            time = dataset["time"].isel(window=window).values
            for model in dataset["model"].values:
                for approach in dataset["approach"].values:
                    chosen = dataset.isel(window=window).sel(model=model, approach=approach)
                    rows.append(
                        {
                            "actuator": name,
                            "window (s)": f"{time[0]:.0f}-{time[-1]:.0f}",
                            "model": str(model),
                            "approach": str(approach),
                        }
                        | {_header(chosen[score]): float(chosen[score]) for score in _SCORES}
                    )
    return _rounded(pd.DataFrame(rows))


def tracking(tracks: Mapping[str, xr.Dataset]) -> Table:
    """Free-run scores over the whole record (contract ``track``), fixed and tracked parameters."""
    rows = []
    for name, track in tracks.items():
        scores = [each for each in track.data_vars.values() if each.dims == ("simulation",)]
        rows += [
            {"actuator": name, "parameters": str(simulation)}
            | {_header(score): float(score.sel(simulation=simulation)) for score in scores}
            for simulation in track["simulation"].values
        ]
    return _rounded(pd.DataFrame(rows))


def recovery(scores: xr.Dataset) -> Table:
    """How each published plant came back (``recovery.nc``): by excitation and by search."""
    errors = [name for name in scores.data_vars if not str(name).startswith("terms")]
    counts = ["terms found", "foreign terms"]
    exact, shown = [], []
    for plant in scores["plant"].values:
        for excitation in scores["excitation"].values:
            for search in scores["search"].values:
                case = scores.sel(plant=plant, excitation=excitation, search=search)
                own = int(case["plant_terms"])
                found, foreign = (int(case[n].round()) for n in ("terms_common", "terms_foreign"))
                row = {"plant": str(plant), "excitation": str(excitation), "search": str(search)}
                values = {str(name): float(case[name]) for name in errors}
                exact.append(row | values | dict(zip(counts, (found, foreign), strict=True)))
                shown.append(
                    row
                    | {name: _score(name, value) for name, value in values.items()}
                    | dict(zip(counts, (f"{found} of {own}", str(foreign)), strict=True))
                )
    return Table(pd.DataFrame(exact), pd.DataFrame(shown))


def save(table: Table, *, csv: Path, md: Path, tex: Path) -> None:
    """Write ``table`` as CSV (exact), Markdown and LaTeX (rounded, for booktabs)."""
    texts = {
        csv: table.exact.to_csv(index=False),
        md: table.shown.to_markdown(index=False, disable_numparse=True) + "\n",
        tex: _latex(table.shown),
    }
    for path, text in texts.items():
        with atomic(path) as partial:
            partial.write_text(text, encoding="utf-8")


def _scores(validations: Mapping[str, xr.Dataset]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """nmse, fit and fpe of the NARX model on the first window, by both approaches."""
    exact, shown = [], []
    for score in ("nmse", "fit", "fpe"):
        for approach in ("honest", "re-estimated"):
            values = {
                name: each[score].isel(window=0).sel(model="narx", approach=approach)
                for name, each in validations.items()
            }
            label = {"term": f"{_header(next(iter(values.values())))}, {approach}"}
            exact.append(label | {name: float(value) for name, value in values.items()})
            shown.append(
                label | {name: _score(score, float(value)) for name, value in values.items()}
            )
    return pd.DataFrame(exact, dtype=object), pd.DataFrame(shown)


def _header(variable: xr.DataArray) -> str:
    units = variable.attrs["units"]
    return str(variable.name) if units == "1" else f"{variable.name} ({units})"


def _rounded(exact: pd.DataFrame) -> Table:
    shown = {
        name: [value if isinstance(value, str) else _score(str(name), value) for value in column]
        for name, column in exact.items()
    }
    return Table(exact, pd.DataFrame(shown))


def _score(name: str, value: float) -> str:
    """A score as text: a fit is near one, so that it takes fixed decimals."""
    return f"{value:.4f}" if name == "fit" and isfinite(value) else number(value)


def _estimate(value: float | None, error: float | None) -> str:
    """A parameter with its standard error, both to the error's second significant digit."""
    if value is None:
        return DASH
    if not error or not isfinite(error):
        return number(value, 4)
    decimals = max(0, 1 - floor(log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"


def _latex(shown: pd.DataFrame) -> str:
    plain = shown.rename(columns=_latex_text).map(_latex_text)
    return plain.to_latex(index=False, escape=False, column_format="l" + "r" * (plain.shape[1] - 1))


def _latex_text(text: str) -> str:
    if is_term(text):
        return Term.parse(text).mathematics()
    if scientific := _SCIENTIFIC.fullmatch(text):
        return rf"${scientific[1]} \times 10^{{{int(scientific[2])}}}$"
    if "±" in text or text.startswith("-"):
        return "$" + text.replace("±", r"\pm") + "$"
    for plain, command in ((DASH, "--"), ("_", r"\_"), ("^2", r"\textsuperscript{2}")):
        text = text.replace(plain, command)
    return text
