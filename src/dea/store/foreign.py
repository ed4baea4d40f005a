"""Records made elsewhere: files of other programs, whose columns a case file names."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.store.clock_agreement import require_interval
from dea.store.described import Described, variable
from dea.store.foreign_files import ForeignTable, read_foreign
from dea.store.record import require_squares
from dea.store.record_checks import check_record
from dea.store.records import input_variables
from dea.store.resampling import IntervalError, Uniform, check_order, resample, rounding
from dea.units import SECONDS, plain_units

if TYPE_CHECKING:
    from dea.configuration.record import Column

FLAG = {"units": "1", "long_name": "quality of the sample", "flag_meanings": "good missing"}


def import_record(
    settings: Mapping[str, Any],
    case_file: Path | None = None,
    root: Path = Path(),
    place: str = "record",
    *,
    compare_times: bool = False,
) -> xr.Dataset:
    """Read the record a case file describes as time (s), input and output.

    Parameters
    ----------
    settings
        The case's ``record``: ``file`` (relative to ``root``), ``input`` and ``output`` (each
        ``column``, ``units``, ``name``), or in place of ``input`` a list of ``inputs``, and either
        a ``time`` column or a ``sampling_interval`` in seconds; optionally the ``sheet`` of a
        workbook, ``rows`` = [first, last + 1], and ``resample``, the time in seconds to which
        samples that jitter are interpolated and closer ones averaged.
    case_file, place
        Named in error messages, where the settings come from one, and their key in it.
    compare_times
        Refuse a ``sampling_interval`` that a column of times contradicts.

    Raises
    ------
    InputError
        If a setting is wrong, the file cannot be read, a column is missing or holds text, units
        disagree with the file, or the record is not whole.
    """
    # pydantic takes long to import, and most who import this room import no record.
    from dea.configuration.problems import validated
    from dea.configuration.record import RecordFile

    described = validated(RecordFile, settings, case_file, place if case_file else "")
    file = root / described.file
    source = _Source(file, case_file, place)
    if not file.is_file():
        raise InputError(
            f"the record {file} {'is no file' if file.exists() else 'does not exist'}",
            file=case_file,
            field=source.key("file"),
            remedy="Correct the path, or fetch the public records with `make records`",
        )
    table = _read(source, described.sheet)
    driving = described.driving
    roles = ["input"] if len(driving) == 1 else [f"inputs[{k}]" for k in range(len(driving))]
    column = partial(_column, source, table, described.rows)
    u = np.stack([column(*each) for each in zip(roles, driving, strict=True)], axis=1)
    y = column("output", described.output)
    if described.time is not None:
        time = column("time", described.time) * SECONDS[described.time.units]
        time = time - next(iter(time[np.isfinite(time)]), 0.0)
    else:
        assert described.sampling_interval is not None
        interval = float(described.sampling_interval)
        if compare_times:
            named = [each.column for each in (*driving, described.output)]
            require_interval(table, named, described.rows, interval, file)
        time = interval * np.arange(y.size, dtype=float)
    flags = {}
    if described.resample is not None:
        time, u, y, missing = _resampled(source, time, u, y, float(described.resample))
        flags["quality"] = ("time", missing.astype("uint8"), FLAG)
    else:
        _require_whole(time, u, y, file)
        if described.time is not None:
            _require_clock(time, source)
    record = xr.Dataset(
        {
            **{
                name: _of_column(u[:, k], driving[k])
                for k, name in enumerate(input_variables(len(driving)))
            },
            "output": _of_column(y, described.output),
            **flags,
        },
        coords={"time": variable("time", time, "s", "time since the start")},
        attrs={"contract": "imported_record", "source_file": described.file},
    )
    check_record(record, file)
    return record


class _Source(NamedTuple):
    """The file of a record, and where its settings come from, for messages."""

    file: Path
    case_file: Path | None
    place: str

    @property
    def named(self) -> Path:
        """The file in which a setting is to be corrected, or the record's own."""
        return self.case_file or self.file

    @property
    def it(self) -> str:
        """What the record is called beside that."""
        return str(self.file) if self.case_file else "it"

    def key(self, name: str) -> str:
        """Return the whole key of a setting."""
        return f"{self.place}.{name}" if self.case_file else name


def _column(
    source: _Source, table: ForeignTable, rows: Sequence[int] | None, role: str, declared: "Column"
) -> np.ndarray:
    """Return the values of a column that the settings declare.

    Raises
    ------
    InputError
        If there is no such column, it is in other units, has no such rows or holds text.
    """
    name = declared.column
    if name not in table.columns:
        known = f"columns of numbers are {', '.join(table.columns) or 'none'}"
        told = table.no_numbers.get(name, "a single number" if name in table.constants else None)
        raise InputError(
            f"{source.it} has {told} in column {name!r}"
            if told
            else f"{source.it} has no column {name!r}",
            file=source.named,
            field=source.key(f"{role}.column"),
            remedy=f"Write numbers alone there, or name another: its {known}"
            if told
            else f"Its {known}",
        )
    stored = table.units.get(name, declared.units)
    if plain_units(declared.units) != plain_units(stored):
        raise InputError(
            f"{source.it} has {name!r} in {stored!r}, not in {declared.units!r}",
            file=source.named,
            field=source.key(f"{role}.units"),
            remedy="Correct the units, or convert the record",
        )
    values = table.columns[name]
    if rows is not None:
        _require_rows(rows, values.size, source)
        values = values[slice(*rows)]
    if not np.isfinite(values).all():
        table.refuse_words([name], source.file)
    require_squares(values, name, source.file)
    return values


def _resampled(
    source: _Source, time: np.ndarray, u: np.ndarray, y: np.ndarray, interval: float
) -> Uniform:
    """Return the record at uniform times; an error names the file or setting at fault."""
    try:
        found = resample(time, u, y, interval)
    except IntervalError as error:
        raise InputError(
            f"{source.it}: {error.problem}" if source.case_file else error.problem,
            file=source.named,
            field=source.key("resample"),
            remedy=error.remedy,
        ) from error
    except InputError as error:
        _refuse_rounding(time, source)
        raise error.at(file=source.file) from error
    there = np.isfinite(time) & np.isfinite(u).all(axis=1) & np.isfinite(y)
    if np.count_nonzero(found.missing) > np.count_nonzero(~there):
        _refuse_rounding(time, source)
    return found


def _of_column(values: np.ndarray, column: "Column") -> Described:
    return variable("time", values, column.units, column.name or column.column)


def _read(source: _Source, sheet: str | None) -> ForeignTable:
    try:
        return read_foreign(source.file, sheet)
    except InputError as error:
        if source.case_file is None:
            raise
        raise InputError(
            f"{source.file}: {error.problem}" if error.file else error.problem,
            file=source.case_file,
            field=source.key("file"),
            remedy=f"{error.remedy}, or name another file",
        ) from error


def _require_whole(time: np.ndarray, u: np.ndarray, y: np.ndarray, file: Path) -> None:
    """Refuse a record with a missing value, and say how such a record is taken.

    Raises
    ------
    InputError
        Naming the first sample at fault, and the setting by which it is flagged.
    """
    there = np.isfinite(time) & np.isfinite(u).all(axis=1) & np.isfinite(y)
    if there.all():
        return
    bad = np.flatnonzero(~there)
    steps = np.diff(time[np.isfinite(time)])
    interval = f"{np.median(steps):.6g}" if steps.size else "INTERVAL"
    raise InputError(
        f"{bad.size} of {there.size} samples have a missing value, the first sample {bad[0]}",
        file=file,
        field="resample",
        remedy=f"Give `resample` {interval} (s): missing samples are then flagged and left out",
    )


def _require_clock(time: np.ndarray, source: _Source) -> None:
    """Refuse times that do not ascend, or are rounded so that samples seem to be missing.

    Raises
    ------
    InputError
        Naming the setting that is given in place of them.
    """
    _refuse_rounding(time, source)
    try:
        check_order(time)
    except InputError as error:
        raise error.at(file=source.file) from error


def _refuse_rounding(time: np.ndarray, source: _Source) -> None:
    """Refuse times that are rounded so that samples share one or seem to be missing.

    Raises
    ------
    InputError
        Naming the interval that is given in place of them.
    """
    if (found := rounding(time[np.isfinite(time)])) is not None:
        raise InputError(
            f"times of {found.rate:.6g} samples a second are rounded to {found.to:.3g} s",
            file=source.file,
            field="time",
            remedy=f"Give `sampling_interval` {1.0 / found.rate:.10g} (s) in place of the time"
            " column",
        )


def _require_rows(rows: Sequence[int], count: int, source: _Source) -> None:
    """Refuse rows that a table of ``count`` rows has not, or that are fewer than two.

    Raises
    ------
    InputError
        Naming the field, and which rows there are.
    """
    first, last = (row + count if row < 0 else row for row in rows)
    if not (first >= 0 and first + 2 <= last <= count):
        raise InputError(
            f"rows {rows[0]} to {rows[1]} of {source.it}, which has {count}",
            file=source.named,
            field=source.key("rows"),
            remedy=f"Give the first row and one past the last, at least two, from 0 to {count}",
        )
