"""The formats that are read, by the ending of the file."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from dea.arrays import Array
from dea.errors import InputError
from dea.store.foreign_files.headings import (
    LOOKED_AT,
    counts_columns,
    headings_and_units,
    is_data,
    is_number,
)
from dea.store.foreign_files.table import ForeignTable, from_columns
from dea.store.foreign_files.text import read_text
from dea.units import plain_units

_WORKBOOK = ".xlsx"
_COMMA_NUMBER = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")
_MAY_BE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_FEWEST = 3  # rows of a table that may be a record


class SeveralSheetsError(InputError):
    """A workbook several of whose ``sheets`` may hold the record, and none of which is named."""

    def __init__(self, sheets: Sequence[str], *, file: Path) -> None:
        super().__init__(
            f"several of its sheets hold tables of numbers: {', '.join(map(repr, sheets))}",
            file=file,
            remedy="Name the one of the record: `sheet`",
        )
        self.sheets = tuple(sheets)


def read_foreign(file: Path, sheet: str | None = None) -> ForeignTable:
    """Read a file by its ending (:data:`FORMATS`), of a workbook the ``sheet`` of that name.

    Raises
    ------
    SeveralSheetsError
        If none is named, and several may hold a record.
    InputError
        If the ending is none of them, or the file cannot be read as what it says.
    """
    suffix = file.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(
            f"cannot read {suffix or 'a file without an ending'}",
            file=file,
            remedy=f"Use one of {', '.join(FORMATS)}",
        )
    if sheet is not None and suffix != _WORKBOOK:
        raise InputError(
            f"it has no sheets, and {sheet!r} is named", file=file, remedy="Leave the sheet out"
        )
    try:
        return FORMATS[suffix](file) if sheet is None else _read_sheet(file, sheet)
    except SeveralSheetsError:
        raise
    except InputError as error:
        raise error.at(file=file) from error
    except ImportError as error:
        package = error.name or "pyarrow"  # pandas names none of its own
        raise InputError(
            f"{package} is needed to read {suffix}",
            file=file,
            remedy=f"Install it with `pip install {package}`, or save the record as .csv",
        ) from error
    except NotImplementedError as error:
        raise InputError(
            f"it is a newer kind of {suffix} ({error})",
            file=file,
            remedy="Save it from MATLAB with save(..., '-v7'), or as .csv",
        ) from error
    # Each reader has its own errors, MatReadError a class straight below Exception.
    except Exception as error:
        raise InputError(
            f"cannot be read as {suffix} ({error})", file=file, remedy="Repair it"
        ) from error


def _read_sheet(file: Path, named: str | None = None) -> ForeignTable:
    """Read the sheet that is named, the only one, or the only one that may hold a record.

    Raises
    ------
    SeveralSheetsError
        Naming the sheets, if several may.
    InputError
        If there is none of that name.
    """
    with pd.ExcelFile(file) as book:
        if named is not None:
            if named not in book.sheet_names:
                raise InputError(
                    f"it has no sheet {named!r}",
                    remedy=f"Its sheets are {', '.join(map(repr, book.sheet_names))}",
                )
            return _of_cells(pd.read_excel(book, sheet_name=named, header=None))
        sheets = pd.read_excel(book, sheet_name=None, header=None)
    tables = [name for name, cells in sheets.items() if _holds_a_table(cells)]
    if len(tables) > 1:
        raise SeveralSheetsError(tables, file=file)
    return _of_cells(sheets[tables[0] if tables else next(iter(sheets))])


def _is_comma_number(cell: object) -> bool:
    return isinstance(cell, str) and _COMMA_NUMBER.fullmatch(cell.strip()) is not None


def _has_decimals(cell: object) -> bool:
    """Tell whether the comma of a number that is text is certain to be that of its decimals."""
    return _is_comma_number(cell) and not _MAY_BE_THOUSANDS.fullmatch(str(cell).strip())


def _holds_a_table(cells: pd.DataFrame) -> bool:
    """Tell whether enough rows for a record hold two numbers: lone ones are settings."""
    rows = _texts(cells)
    return sum(sum(map(is_number, row)) > 1 for row in rows) >= _FEWEST


def _texts(cells: pd.DataFrame) -> list[list[str]]:
    """Return the cells among which the numbers must begin as text."""
    return [
        ["" if pd.isna(cell) else _text(cell) for cell in row]
        for row in cells.head(LOOKED_AT).itertuples(index=False)
    ]


def _text(cell: object) -> str:
    """Return a cell as text; beside an empty cell pandas reads whole numbers as floats.

    A number that is text with a decimal comma has a point.
    """
    if _is_comma_number(cell):
        return str(cell).strip().replace(",", ".")
    return f"{cell:.17g}" if isinstance(cell, float) else str(cell).strip()


def _of_cells(cells: pd.DataFrame) -> ForeignTable:
    rows = _texts(cells)
    begin = next((i for i, row in enumerate(rows) if is_data(row)), None)
    if begin is None:
        raise InputError("no row of it holds numbers", remedy="Write it as a table of numbers")
    if begin == 0 and len(rows) > 1 and counts_columns(*rows[:2]):
        begin = 1
    headings, units = headings_and_units(rows[:begin], cells.shape[1])
    frame = cells.iloc[begin:].reset_index(drop=True).infer_objects()
    columns = [frame[name] for name in frame.columns]
    decimal = "," if any(_has_decimals(cell) for each in columns for cell in each) else "."
    return from_columns(
        headings, columns, units, decimal=decimal, place=lambda row: f"row {begin + row + 1}"
    )


def _read_parquet(file: Path) -> ForeignTable:
    frame = pd.read_parquet(file)
    if frame.index.name is not None:
        frame = frame.reset_index()
    return from_columns(map(str, frame.columns), [frame[name] for name in frame.columns])


def _read_netcdf(file: Path) -> ForeignTable:
    with xr.open_dataset(file, decode_times=False) as dataset:
        variables = {str(name): each for name, each in dataset.load().variables.items()}
    vectors = {
        name: each for name, each in variables.items() if each.ndim == 1 and _holds_numbers(each)
    }
    scalars = {
        name: each for name, each in variables.items() if each.ndim == 0 and _is_real(each.values)
    }
    known = {n: str(v.attrs["units"]) for n, v in (vectors | scalars).items() if "units" in v.attrs}
    return ForeignTable(
        {name: _real(each.values) for name, each in vectors.items()},
        {name: plain_units(units) for name, units in known.items()},
        {name: float(each) for name, each in scalars.items()},
        complex_numbers=tuple(n for n, each in vectors.items() if not _is_real(each.values)),
        no_numbers={
            n: _kind(each.values, "text")
            for n, each in variables.items()
            if each.ndim and n not in vectors
        },
    )


def _read_matlab(file: Path) -> ForeignTable:
    from scipy.io import loadmat

    columns: dict[str, Array] = {}
    constants: dict[str, float] = {}
    complex_numbers: list[str] = []
    no_numbers: dict[str, str] = {}
    content = loadmat(file, simplify_cells=True)
    for name, value in _flat({k: v for k, v in content.items() if not k.startswith("__")}):
        found = {}
        if not _holds_numbers(value) or value.size == 0 or value.ndim > 2:
            no_numbers |= {name: _kind(value, "a cell array")} if value.size != 1 else {}
        elif value.size == 1:
            constants |= {name: float(value.ravel()[0])} if _is_real(value) else {}
        elif value.ndim == 1 or 1 in value.shape:
            found = {name: _real(value.ravel())}
        else:
            long = value if value.shape[0] > value.shape[1] else value.T
            found = {f"{name}_{i + 1}": _real(column) for i, column in enumerate(long.T)}
        columns |= found
        complex_numbers += [] if _is_real(value) else found
    if not columns:
        held = ", ".join(f"{told} {name!r}" for name, told in no_numbers.items())
        raise InputError(
            f"it holds no vectors of numbers{held and ', only '}{held}",
            remedy="Save each signal as a variable of its own: save('mine.mat', 'u', 'y')",
        )
    return ForeignTable(
        columns, {}, constants, complex_numbers=tuple(complex_numbers), no_numbers=no_numbers
    )


def _kind(values: np.ndarray, objects: str) -> str:
    """Return in words what an array that is no vector of numbers holds; what ``objects`` are."""
    if not values.size:
        return "nothing"
    if _holds_numbers(values):
        return f"numbers in {values.ndim} dimensions"
    return "text" if values.dtype.kind in "SU" else objects


def _holds_numbers(values: np.ndarray | xr.Variable) -> bool:
    """Tell whether an array holds numbers; true and false are 1 and 0."""
    return np.issubdtype(values.dtype, np.number) or values.dtype == np.bool_


def _is_real(values: np.ndarray) -> bool:
    return _holds_numbers(values) and not np.iscomplexobj(values)


def _real(values: np.ndarray) -> Array:
    """Return numbers, NaN in place of complex ones: a real part alone would look like a signal."""
    return values.astype(float) if _is_real(values) else np.full(values.size, np.nan)


def _flat(content: Mapping[str, Any], prefix: str = "") -> list[tuple[str, np.ndarray]]:
    """Return the arrays of a MATLAB file, those within structures as ``structure.field``."""
    found = []
    for name, value in content.items():
        if isinstance(value, Mapping):
            found += _flat(value, f"{prefix}{name}.")
        else:
            found.append((prefix + name, np.asarray(value)))
    return found


FORMATS: dict[str, Callable[[Path], ForeignTable]] = {
    ".csv": read_text,
    ".txt": read_text,
    ".tsv": read_text,
    ".dat": read_text,
    ".asc": read_text,
    ".lvm": read_text,
    ".nc": _read_netcdf,
    ".mat": _read_matlab,
    _WORKBOOK: _read_sheet,
    ".parquet": _read_parquet,
}
