"""Records made elsewhere: CSV, NetCDF or MATLAB files whose columns a case file names."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.store.records import check_record

if TYPE_CHECKING:
    from dea.configuration.record import Column


def import_record(
    settings: Mapping[str, Any], case_file: Path | None = None, root: Path = Path()
) -> xr.Dataset:
    """Read the record a case file describes as time (s), input and output.

    Parameters
    ----------
    settings
        The case's ``record``: ``file`` (relative to ``root``), ``input`` and ``output`` (each
        ``column``, ``units``, ``name``), and either a ``time`` column in seconds or a
        ``sampling_interval`` in seconds; optionally ``rows`` = [first, last + 1].
    case_file
        Named in error messages, where the settings come from one.

    Raises
    ------
    InputError
        If a setting is wrong, the file cannot be read, a column is missing or holds text, units
        disagree with the file, or the record is not whole.
    """
    # pydantic takes long to import, and most who import this room import no record.
    from dea.configuration.problems import validated
    from dea.configuration.record import Record

    described = validated(Record, settings, case_file, "record" if case_file else "")
    file = root / described.file
    place = "record." if case_file else ""
    if not file.exists():
        raise InputError(
            f"the record {file} does not exist",
            file=case_file,
            field=f"{place}file",
            remedy="Correct the path, or fetch the public records with `make records`",
        )
    columns, units = _read_columns(file, case_file)
    rows = slice(*(described.rows or (None,)))

    def column(role: str, declared: "Column") -> np.ndarray:
        name = declared.column
        if name not in columns:
            raise InputError(
                f"{file} has no column {name!r}",
                file=case_file,
                field=f"{place}{role}.column",
                remedy=f"Its columns of numbers are {', '.join(columns) or 'none'}",
            )
        stored = units.get(name, declared.units)
        if declared.units != stored:
            raise InputError(
                f"{file} has {name!r} in {stored!r}, not in {declared.units!r}",
                file=case_file,
                field=f"{place}{role}.units",
                remedy="Correct the units, or convert the record",
            )
        return columns[name][rows]

    u, y = column("input", described.input), column("output", described.output)
    if described.time is not None:
        time = column("time", described.time)
        time = time - time[:1]
    else:
        assert described.sampling_interval is not None
        time = np.arange(u.size) * float(described.sampling_interval)
    record = xr.Dataset(
        {
            "input": ("time", u, _attributes(described.input)),
            "output": ("time", y, _attributes(described.output)),
        },
        coords={"time": ("time", time, {"units": "s", "long_name": "time since the start"})},
        attrs={"contract": "imported_record", "source_file": described.file},
    )
    check_record(record, file)
    return record


def _attributes(column: "Column") -> dict[str, str]:
    return {"units": column.units, "long_name": column.name or column.column}


def _read_columns(file: Path, case_file: Path | None) -> "_Columns":
    suffix = file.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(
            f"cannot read {suffix or 'a file without an ending'}",
            file=case_file,
            field="record.file" if case_file else str(file),
            remedy=f"Use one of {', '.join(FORMATS)}",
        )
    try:
        return FORMATS[suffix](file)
    # Each reader has its own errors, MatReadError a class straight below Exception.
    except Exception as error:
        other = f", or name another file in {case_file}: record.file" if case_file else ""
        raise InputError(
            f"cannot be read as {suffix} ({error})", file=file, remedy=f"Repair it{other}"
        ) from error


_Columns = tuple[dict[str, np.ndarray], dict[str, str]]


def _read_csv(file: Path) -> _Columns:
    import pandas as pd

    table = pd.read_csv(file, skipinitialspace=True)
    numeric = table.select_dtypes("number")
    return {str(name): numeric[name].to_numpy(float) for name in numeric.columns}, {}


def _read_netcdf(file: Path) -> _Columns:
    with xr.open_dataset(file, decode_times=False) as dataset:
        variables = {str(k): v for k, v in dataset.load().variables.items() if v.ndim == 1}
    return (
        {name: variable.values.astype(float) for name, variable in variables.items()},
        {name: v.attrs["units"] for name, v in variables.items() if "units" in v.attrs},
    )


def _read_matlab(file: Path) -> _Columns:
    from scipy.io import loadmat

    arrays = {name: value for name, value in loadmat(file).items() if not name.startswith("__")}
    return {name: np.ravel(value).astype(float) for name, value in arrays.items()}, {}


FORMATS = {".csv": _read_csv, ".nc": _read_netcdf, ".mat": _read_matlab}
