"""The signals of a dataset that holds a record, whatever it calls them, and their flags."""

from collections.abc import Iterator
from itertools import count, islice, takewhile
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.store.record import Record

_INPUTS = ("voltage", "input")
_OUTPUTS = ("displacement", "output")


def signals(record: xr.Dataset) -> Record:
    """Return input and output of a record as arrays, whatever it calls them.

    The output of a flagged sample is NaN, its input what was applied. A lost sample of a record
    that was finished was never written, so that the device held the input before. A sample whose
    input or output is not a finite number is left out like a flagged one.

    Raises
    ------
    InputError
        Where every sample is flagged, the message names the flags; where units are not given.
    """
    require_good(record, record.encoding.get("source"))
    driving, y = driving_of(record), measured_of(record)
    applied = [each.values.astype(float) for each in driving]
    held = [_held(each) for each in applied]
    names = tuple(str(each.attrs.get("long_name", each.name)) for each in driving)
    units = tuple(str(units_of(each)) for each in driving)
    several = len(driving) > 1
    time = record["time"].values.astype(float)
    measured = y.values.astype(float)
    good = ~flagged_in(record) & np.isfinite([*applied, measured]).all(axis=0)
    return Record(
        time=time,
        u=np.array(held).T if several else held[0],
        y=np.where(good, measured, np.nan),
        sampling_rate=float((time.size - 1) / (time[-1] - time[0])),
        u_units=units if several else units[0],
        y_units=units_of(y),
        u_name=names if several else names[0],
        y_name=y.attrs.get("long_name", str(y.name)),
    )


def input_variables(number: int) -> list[str]:
    """Return what a record made elsewhere calls so many inputs."""
    return ["input"] if number == 1 else list(islice(_numbered_inputs(), number))


def driving_of(record: xr.Dataset, file: Path | None = None) -> list[xr.DataArray]:
    """Return the variable of the input, or of each of several.

    Raises
    ------
    InputError
        If there is none.
    """
    names = takewhile(lambda name: name in record.variables, _numbered_inputs())
    return [record[name] for name in names] or [_first(record, _INPUTS, file)]


def measured_of(record: xr.Dataset, file: Path | None = None) -> xr.DataArray:
    """Return the variable of the output.

    Raises
    ------
    InputError
        If there is none.
    """
    return _first(record, _OUTPUTS, file)


def _numbered_inputs() -> Iterator[str]:
    return (f"input_{k}" for k in count(1))


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


def units_of(variable: xr.DataArray, file: Path | None = None) -> Any:
    """Return the units of a variable.

    Raises
    ------
    InputError
        If they are not given.
    """
    if "units" not in variable.attrs:
        raise InputError(
            "its units are not given",
            file=file,
            field=str(variable.name),
            remedy='Set attrs["units"] of the variable',
        )
    return variable.attrs["units"]


def flagged_in(record: xr.Dataset) -> np.ndarray:
    """Say of each sample whether it carries a flag, (samples,)."""
    if "quality" not in record.variables:
        return np.zeros(record["time"].size, bool)
    return np.asarray(record["quality"].values != 0)


def flag_counts(record: xr.Dataset) -> dict[str, int]:
    """Return how many samples of a record carry which flag, of those that any does."""
    if "quality" not in record.variables:
        return {}
    quality = record["quality"]
    masks = np.atleast_1d(quality.attrs.get("flag_masks", []))
    meanings = str(quality.attrs.get("flag_meanings", "")).split()
    if len(masks) == len(meanings) > 0:
        each = {name: quality.values & mask for name, mask in zip(meanings, masks, strict=True)}
    else:  # a record made elsewhere, which does not say what its flags mean
        each = {"flagged": quality.values}
    counts = {name: int(np.count_nonzero(carried)) for name, carried in each.items()}
    return {name: count for name, count in counts.items() if count}


def require_good(record: xr.Dataset, file: Path | str | None) -> None:
    """Refuse a record of which every sample is flagged, with the counts of its flags.

    Raises
    ------
    InputError
        If so.
    """
    flagged = flagged_in(record)
    if flagged.all():
        counts = ", ".join(f"{name} {count}" for name, count in flag_counts(record).items())
        raise InputError(
            f"{flagged.size} of {flagged.size} samples are flagged ({counts})",
            file=file,
            field="quality",
            remedy="Mend what the flags name (docs/acquisition.md), and record it again",
        )


def _held(u: np.ndarray) -> np.ndarray:
    """Return ``u`` with the last known value, or at the start the first, where it is NaN."""
    known = np.flatnonzero(np.isfinite(u))
    if known.size == u.size:
        return u
    last = np.searchsorted(known, np.arange(u.size), side="right") - 1
    return np.asarray(u[known[np.maximum(last, 0)]])
