"""Records of a system's input and output: what makes one usable, and its arrays."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from dea.errors import InputError

_INPUTS = ("voltage", "input")
_OUTPUTS = ("displacement", "output")


class Signals(NamedTuple):
    """The arrays of a record, shape (samples,), and what they are."""

    time: np.ndarray
    u: np.ndarray
    y: np.ndarray
    sampling_rate: float
    u_units: str
    y_units: str
    u_name: str
    y_name: str


def signals(record: xr.Dataset) -> Signals:
    """Return input and output of a record as arrays, whatever it calls them."""
    u, y = (_first(record, names) for names in (_INPUTS, _OUTPUTS))
    time = record["time"].values.astype(float)
    return Signals(
        time=time,
        u=u.values.astype(float),
        y=y.values.astype(float),
        sampling_rate=float((time.size - 1) / (time[-1] - time[0])),
        u_units=u.attrs["units"],
        y_units=y.attrs["units"],
        u_name=u.attrs.get("long_name", str(u.name)),
        y_name=y.attrs.get("long_name", str(y.name)),
    )


def check_record(record: xr.Dataset, file: Path) -> None:
    """Check that a record is whole: uniform time, no gap, no NaN, an input that moves.

    Raises
    ------
    InputError
        Naming the file, the variable, the first sample at fault and the remedy.
    """
    if "time" not in record.variables:
        raise InputError("there is no time", file=file, field="time", remedy="Add it in seconds")
    _require_units(record["time"], ("s",), file)
    time = record["time"].values.astype(float)
    if time.size < 2:
        raise InputError(f"it holds {time.size} samples", file=file, remedy="Record at least two")
    for names in (_INPUTS, _OUTPUTS):
        variable = _first(record, names, file)
        if "units" not in variable.attrs:
            raise InputError("its units are not given", file=file, field=str(variable.name))
        _require_finite(variable.values, str(variable.name), file)
    _require_finite(time, "time", file)
    _require_uniform(time, file)
    if "device_index" in record.variables:
        _require_consecutive(record["device_index"].values, file)
    if "quality" in record.variables:
        _require_good(record["quality"], file)
    u = _first(record, _INPUTS)
    if np.ptp(u.values) == 0:
        raise InputError(
            f"the input is constant at {u.values[0]:g} {u.attrs['units']}",
            file=file,
            field=str(u.name),
            remedy="A model can only be identified from an input that moves",
        )


def _first(record: xr.Dataset, names: tuple[str, ...], file: Path | None = None) -> xr.DataArray:
    for name in names:
        if name in record.variables:
            return record[name]
    raise InputError(
        "the variable is missing",
        file=file,
        field=" or ".join(names),
        remedy=f"It holds {', '.join(sorted(map(str, record.variables)))}",
    )


def _require_units(variable: xr.DataArray, allowed: tuple[str, ...], file: Path) -> None:
    units = variable.attrs.get("units")
    if units not in allowed:
        raise InputError(
            f"its units are {units!r}",
            file=file,
            field=str(variable.name),
            remedy=f"They must be {' or '.join(map(repr, allowed))}",
        )


def _require_finite(values: np.ndarray, name: str, file: Path) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(
            f"{bad.size} of {values.size} samples are not numbers, the first at sample {bad[0]}",
            file=file,
            field=name,
            remedy="Cut the record before the first, or record it again",
        )


def _require_uniform(time: np.ndarray, file: Path) -> None:
    steps = np.diff(time)
    interval = np.median(steps)
    bad = np.flatnonzero(np.abs(steps - interval) > 1e-3 * abs(interval))
    if interval <= 0 or bad.size:
        at = int(bad[0]) if bad.size else 0
        gap = steps[at]
        kind = "a gap" if gap > 1.5 * interval > 0 else "a step"
        raise InputError(
            f"there is {kind} of {gap:g} s after sample {at}; samples are {interval:g} s apart",
            file=file,
            field="time",
            remedy="Use an unbroken stretch, or resample to uniform time",
        )


def _require_consecutive(index: np.ndarray, file: Path) -> None:
    bad = np.flatnonzero(np.diff(index.astype(np.int64)) != 1)
    if bad.size:
        at = int(bad[0])
        raise InputError(
            f"the device's sample {index[at]} is followed by {index[at + 1]}",
            file=file,
            field="device_index",
            remedy="Samples are missing or doubled there: use an unbroken stretch",
        )


def _require_good(quality: xr.DataArray, file: Path) -> None:
    bad = np.flatnonzero(quality.values)
    if bad.size:
        raise InputError(
            f"{bad.size} samples are flagged, the first at sample {bad[0]} "
            f"(flag {int(quality.values[bad[0]])}: {quality.attrs.get('flag_meanings', '')})",
            file=file,
            field="quality",
            remedy="Use an unflagged stretch, or record it again",
        )
