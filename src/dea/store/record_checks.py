"""What makes a record usable."""

from pathlib import Path

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.store.record import require_squares
from dea.store.records import driving_of, flagged_in, measured_of, require_good, units_of


def check_record(record: xr.Dataset, file: Path) -> None:
    """Check that a record is whole: uniform time, no gap, no NaN but where flagged, a moving input.

    Flagged samples are no reason to refuse it: :func:`dea.store.signals` leaves them out.

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
    flagged = flagged_in(record)
    require_good(record, file)
    driving = driving_of(record, file)
    for variable in (*driving, measured_of(record, file)):
        units_of(variable, file)
        values = np.where(flagged, 0.0, variable.values)
        _require_finite(values, str(variable.name), file)
        require_squares(values, str(variable.name), file)
    _require_finite(time, "time", file)
    _require_uniform(time, file)
    if "device_index" in record.variables:
        _require_consecutive(record["device_index"].values, file)
    still = [each for each in driving if np.ptp(each.values[~flagged]) == 0]
    if len(still) == len(driving):
        u = still[0]
        raise InputError(
            f"the input is constant at {u.values[~flagged][0]:g} {u.attrs['units']}",
            file=file,
            field=str(u.name),
            remedy="A model can only be identified from an input that moves",
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
    back = np.flatnonzero(steps <= 0)
    if back.size:
        raise InputError(
            f"there is a step of {steps[back[0]]:g} s after sample {back[0]}: it does not ascend",
            file=file,
            field="time",
            remedy="Use a stretch in which it does",
        )
    interval = np.median(steps)
    bad = np.flatnonzero(np.abs(steps - interval) > 1e-3 * interval)
    if bad.size:
        at = int(bad[0])
        gap = steps[at]
        kind = "a gap" if gap > 1.5 * interval else "a step"
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
