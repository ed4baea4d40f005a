"""What every table is: exact numbers for programs, the same rounded for readers."""

from math import isfinite
from numbers import Integral
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import xarray as xr

from dea.number_format import number
from dea.store import atomic
from dea.tables.latex_table import latex

# At the end of a table in Markdown. The captions are those of the report, and no copies of them.
CAPTIONS = (
    "<!-- What the columns are is in the caption: results/report.html (make report), "
    "workflow/report/tables. -->"
)


class Table(NamedTuple):
    """A table twice: ``exact`` numbers for CSV, ``shown`` as rounded text for readers."""

    exact: pd.DataFrame
    shown: pd.DataFrame


def save(table: Table, csv: Path, md: Path, tex: Path) -> None:
    """Write ``table`` as CSV (exact), Markdown and LaTeX (rounded, for booktabs)."""
    texts = {
        csv: table.exact.to_csv(index=False),
        md: table.shown.to_markdown(index=False, disable_numparse=True) + f"\n\n{CAPTIONS}\n",
        tex: latex(table.shown),
    }
    for path, text in texts.items():
        with atomic(path) as partial:
            partial.write_text(text, encoding="utf-8")


def header(variable: xr.DataArray) -> str:
    """Return the heading of a column: the variable's name and its units."""
    units = variable.attrs["units"]
    return str(variable.name) if units == "1" else f"{variable.name} ({units})"


def rounded(exact: pd.DataFrame) -> Table:
    """Return the table of these numbers, rounded for readers; text stays as it is."""
    shown = {
        name: [
            str(value) if isinstance(value, str | Integral) else score(str(name), value)
            for value in column
        ]
        for name, column in exact.items()
    }
    return Table(exact, pd.DataFrame(shown))


def score(name: str, value: float) -> str:
    """Return a score as text; a fit is near one and takes fixed decimals."""
    return f"{value:.4f}" if name == "fit" and isfinite(value) else number(value)
