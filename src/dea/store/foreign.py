"""Records made elsewhere: CSV, NetCDF or MATLAB files whose columns a case file names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.store.records import check_record


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
        If the file cannot be read, a column is missing or holds text, units disagree with the
        file, or the record is not whole.
    """
    file = root / settings["file"]
    place = "record." if case_file else ""
    if not file.exists():
        raise InputError(
            f"the record {file} does not exist",
            file=case_file,
            field=f"{place}file",
            remedy="Correct the path, or fetch the public records with `make records`",
        )
    columns, units = _read_columns(file, case_file)
    rows = slice(*settings.get("rows", (None,)))

    def column(role: str) -> np.ndarray:
        name = settings[role]["column"]
        if name not in columns:
            raise InputError(
                f"{file} has no column {name!r}",
                file=case_file,
                field=f"{place}{role}.column",
                remedy=f"Its columns of numbers are {', '.join(columns) or 'none'}",
            )
        declared, stored = settings[role]["units"], units.get(name, settings[role]["units"])
        if declared != stored:
            raise InputError(
                f"{file} has {name!r} in {stored!r}, not in {declared!r}",
                file=case_file,
                field=f"{place}{role}.units",
                remedy="Correct the units, or convert the record",
            )
        return columns[name][rows]

    u, y = column("input"), column("output")
    if "time" in settings:
        if settings["time"]["units"] != "s":
            raise InputError(
                f"its units are {settings['time']['units']!r}",
                file=case_file,
                field=f"{place}time.units",
                remedy="Time is in 's': convert the column, or give a sampling_interval instead",
            )
        time = column("time")
        time = time - time[:1]
    else:
        time = np.arange(u.size) * float(settings["sampling_interval"])
    record = xr.Dataset(
        {
            role: ("time", values, _attributes(settings[role]))
            for role, values in (("input", u), ("output", y))
        },
        coords={"time": ("time", time, {"units": "s", "long_name": "time since the start"})},
        attrs={"contract": "imported_record", "source_file": settings["file"]},
    )
    check_record(record, file)
    return record


def _attributes(role: Mapping[str, str]) -> dict[str, str]:
    return {"units": role["units"], "long_name": role.get("name", role["column"])}


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
