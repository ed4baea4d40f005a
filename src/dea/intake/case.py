"""From a file and what its user says of it to a case that can be run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dea import store
from dea.arrays import Array
from dea.configuration.record import RecordFile
from dea.errors import InputError
from dea.intake.bandwidth import samples_held, samples_to_average
from dea.intake.questions import command
from dea.intake.roles import Answers, Roles, find_roles
from dea.intake.settings import infer_settings
from dea.missing import filled
from dea.units import SECONDS

_JITTER = 1e-3  # share of the interval up to which times count as uniform
# How many times as far from the median as all others an output is that is no measurement, and one
# of how many samples may be so far.
_FAR, _FEW = 1e8, 100
# Ranges of all other outputs by which one is away that marks what is missing, as -999 does, and its
# least number; no more than a part of the samples is marked so, and others hold as many values.
_AWAY, _TWICE, _MARKED, _VALUES = 10.0, 2, 0.1, 10
_WHOLE = 0.1  # samples by which a hold may seem longer than a whole number
_SEVERAL_RATES = 0.1  # share of steps below half of the usual one that are no jitter


@dataclass(frozen=True)
class Inferred:
    """The content of a case file, and in words what it rests on."""

    content: Mapping[str, Any]
    inferred: tuple[str, ...]


def infer_case(
    file: Path,
    answers: Answers,
    *,
    simulation: str | None = None,
    goal: str = "case",
    given: Mapping[str, str] | None = None,
    kept: RecordFile | None = None,
) -> Inferred:
    """Return the case of a file, whose record has been read and checked.

    Parameters
    ----------
    goal, given
        Target and variables of the command that was typed, for what is asked back.
    kept
        What an earlier case says of the same file: it counts more than what its names tell, and
        less than an answer.

    Raises
    ------
    dea.intake.UnansweredError
        Where the file does not say what its columns are.
    InputError
        If it cannot be read, does not say which of its sheets holds the record, or its record is
        not usable.
    """
    if not file.is_file():
        problem = "it is no file" if file.exists() else "it does not exist"
        raise InputError(problem, file=file, remedy="Correct the path")
    table = _read(file, answers.sheet, goal, given or {})
    roles = find_roles(table, answers, file, goal, given or {}, kept)
    record = _described(file, answers.sheet, roles)
    try:
        time = _times(table, roles)
        known = _known(table, roles, time)
        _refuse_far_outputs(table, roles.output[0])
        _refuse_marks(table, roles.output[0])
        resample, notes = _resampling(table, roles, time, known, may_average=simulation is None)
        record |= {"resample": resample} if resample else {}
        signals = store.signals(store.import_record(record))
        settings = infer_settings(signals)
    except InputError as error:
        raise error.at(file=error.file or file) from error
    begin = _first_unseen(time[known], settings.held_out, resample)
    tested = record | {"rows": [int(np.flatnonzero(known)[begin]), time.size]}
    sections = dict(settings.sections)
    split = sections.pop("split")
    content = {
        "title": file.stem if answers.sheet is None else f"{file.stem}: {answers.sheet}",
        "record": record,
        "test_records": {"held_out": tested},
        **sections,
        **({"simulation": simulation, "split": split} if simulation else {}),
    }
    return Inferred(content, (*roles.inferred, *notes, *settings.inferred))


def _read(file: Path, sheet: str | None, goal: str, given: Mapping[str, str]) -> store.ForeignTable:
    """Read a file; where several sheets may be meant, give the command that names the first."""
    try:
        return store.read_foreign(file, sheet)
    except store.SeveralSheetsError as error:
        named = command(goal, {**given, "SHEET": error.sheets[0]})
        raise error.at(file=file, remedy=f"Name the one of the record: `{named}`") from error


def _described(file: Path, sheet: str | None, roles: Roles) -> dict[str, Any]:
    record: dict[str, Any] = {"file": str(file)} | ({"sheet": sheet} if sheet is not None else {})
    if roles.time is not None:
        record["time"] = _column(roles.time)
    if len(roles.inputs) == 1:
        record["input"] = _column(roles.inputs[0])
    else:
        record["inputs"] = [_column(each) for each in roles.inputs]
    record["output"] = _column(roles.output)
    if roles.interval is not None:
        record["sampling_interval"] = float(f"{roles.interval:.12g}")
    return record


def _column(named: tuple[str, str]) -> dict[str, str]:
    return {"column": named[0], "units": named[1]}


def _times(table: store.ForeignTable, roles: Roles) -> Array:
    """Return the time of each row in s."""
    if roles.time is not None:
        return table.columns[roles.time[0]] * SECONDS[roles.time[1]]
    assert roles.interval is not None
    return roles.interval * np.arange(table.columns[roles.output[0]].size, dtype=float)


def _known(table: store.ForeignTable, roles: Roles, time: Array) -> NDArray[np.bool_]:
    """Tell which rows have time, inputs and output.

    Raises
    ------
    InputError
        Where columns differ in length or hold numbers too large, or hardly any row has all.
    """
    _check_lengths(table, roles)
    known = np.isfinite(time)
    for name, _ in (roles.output, *roles.inputs):
        store.require_squares(table.columns[name], name)
        known &= np.isfinite(table.columns[name])
    if np.count_nonzero(known) < 3:
        raise InputError(
            f"{np.count_nonzero(known)} rows have both input and output",
            remedy="Record at least three, or name other columns: INPUT=volts OUTPUT=position",
        )
    return known


def _first_unseen(time: Array, held_out: int, resample: float | None) -> int:
    """Return the first sample of a file from which nothing before the part held out comes.

    Parameters
    ----------
    time
        Those of the samples of the file that have all their values, in s.
    held_out
        The first sample of the part held out, of the record on uniform times.
    """
    if resample is None:
        return held_out
    step = resample / store.samples_per_interval(time, resample)
    # The last value before that part is interpolated between the samples around its time.
    last = time[0] + held_out * resample - step
    return int(np.searchsorted(time, last - _JITTER * step)) + 1


def _resampling(
    table: store.ForeignTable,
    roles: Roles,
    time: Array,
    known: NDArray[np.bool_],
    *,
    may_average: bool,
) -> tuple[float | None, list[str]]:
    """Return the interval to which the record is resampled, None where it may stay as it is.

    A record that is compared with a simulation keeps its rate: what a threshold or a limit passes
    of the mean of an input is not the mean of what it passes. A diagnosis decimates it itself where
    that changes nothing.
    """
    y = table.columns[roles.output[0]]
    _check_times(time[known], time[np.isfinite(time)])
    interval = store.usual_interval(time[known])
    steps = np.diff(time[known])
    if np.mean(steps < 0.5 * interval) > _SEVERAL_RATES:
        raise InputError(
            f"its samples are {steps.min():.4g} to {steps.max():.4g} s apart",
            field="time",
            remedy="Give the part of one sampling rate a file of its own",
        )
    several = samples_to_average(filled(y)[0], 1.0 / interval)
    notes = []
    held = samples_held(y[known])
    if held > 1.0:
        rate = 1.0 / (held * interval)
        notes.append(
            f"the output holds each value for {held:.3g} samples: its sensor is read at"
            f" {rate:.4g} Hz"
        )
        several = max(several, math.ceil(held - _WHOLE))
    if several > 1 and not may_average:
        notes.append(
            f"every sample is kept for the simulation; without one, {several} would be averaged"
            " into one, and models would come from a longer part"
        )
        several = 1
    gaps = store.are_gaps(steps, interval)
    missing = steps[gaps]
    if missing.size:
        several_missing = f"{missing.size} missing stretches, the longest"
        stretches = several_missing if missing.size > 1 else "a missing stretch"
        notes.append(f"{stretches} of {missing.max():.4g} s: flagged")
    uneven = float(np.max(np.abs(steps - interval), initial=0.0, where=~gaps))
    if uneven > _JITTER * interval:
        notes.append(f"times jitter by up to {uneven:.2g} s: interpolated to {interval:g} s")
    if several > 1:
        highest = 1 / (20 * several * interval)
        why = f"the output holds no power beyond {highest:.3g} Hz: " if several > held + 1.0 else ""
        notes.append(f"{why}{several} samples are averaged into one")
    needed = missing.size or uneven > _JITTER * interval or several > 1 or not known.all()
    return (float(f"{several * interval:.9g}") if needed else None), notes


def _refuse_far_outputs(table: store.ForeignTable, name: str) -> None:
    """Refuse few outputs so far from all others that no model could run beside them.

    Raises
    ------
    InputError
        Naming the first.
    """
    y = table.columns[name]
    far = np.abs(y - np.nanmedian(y))
    largest = np.sort(far[np.isfinite(far)])[::-1][: 2 + y.size // _FEW]
    beyond = np.flatnonzero((largest[:-1] > _FAR * largest[1:]) & (largest[1:] > 0))
    if beyond.size:
        row = int(np.flatnonzero(far >= largest[beyond[0]])[0])
        raise _entry_error(
            table,
            name,
            row,
            f"{y[row]:.4g} is {_FAR:.0e} times as far from most as any other",
            "Correct that entry, or empty it: it then counts as missing",
        )


def _refuse_marks(table: store.ForeignTable, name: str) -> None:
    """Refuse a number that stands for missing outputs: one value again and again, far from others.

    Raises
    ------
    InputError
        Naming the first.
    """
    y = table.columns[name]
    there = y[np.isfinite(y)]
    for mark in (there.min(), there.max()) if there.size else ():
        others = there[there != mark]
        count = there.size - others.size
        if not _TWICE <= count <= _MARKED * there.size or np.unique(others).size < _VALUES:
            continue
        if np.abs(others - mark).min() > _AWAY * np.ptp(others):
            raise _entry_error(
                table,
                name,
                int(np.flatnonzero(y == mark)[0]),
                f"{count} entries are {mark:g}, far from all others, as a mark of what is missing"
                " is",
                "Empty these entries: they then count as missing",
            )


def _entry_error(
    table: store.ForeignTable, name: str, row: int, problem: str, remedy: str
) -> InputError:
    """Return the error of an entry of a column, which says where it is in the file."""
    return InputError(f"{table.place(row)}: {problem}", field=f"column {name!r}", remedy=remedy)


def _check_lengths(table: store.ForeignTable, roles: Roles) -> None:
    """Refuse columns of different length.

    Raises
    ------
    InputError
        Naming each with its length.
    """
    used = [each for each in (roles.output, roles.time, *roles.inputs) if each is not None]
    sizes = {name: table.columns[name].size for name, _ in used}
    if len(set(sizes.values())) > 1:
        raise InputError(
            "its columns differ in length: "
            + ", ".join(f"{name!r} has {size}" for name, size in sizes.items()),
            remedy="Give signals of one sampling rate, of the same samples",
        )


def _check_times(time: Array, all_times: Array) -> None:
    """Refuse times that do not ascend, or are so coarse that samples seem to be missing.

    Parameters
    ----------
    time, all_times
        Of the samples that have all their values, and of every sample.

    Raises
    ------
    InputError
        Naming the first sample at fault, and the rate where it is known.
    """
    steps = np.diff(time)
    told, counts = np.unique(time, return_counts=True)
    coarse = told.size > 1 and bool(np.median(counts) > 1)
    uneven = np.ptp(steps) > 0.5 * np.median(steps)
    rounded = store.rounding(all_times) if np.all(steps >= 0) and uneven else None
    if coarse and np.all(steps >= 0):
        # In the first and the last of the times there are fewer samples than in others.
        whole = counts[1:-1] if told.size > 2 else counts.max()
        rate = rounded.rate if rounded else float(np.median(whole) / np.median(np.diff(told)))
        problem = (
            f"{counts[0]} samples are at {told[0]:.12g} s: the clock is coarser than the samples"
        )
    elif rounded:
        rate = rounded.rate
        problem = f"times of {rate:.6g} samples a second are rounded to {rounded.to:.3g} s"
    else:
        return store.check_order(time, "the samples per second, RATE=…,")
    remedy = f"Give the samples per second instead: RATE={rate:.6g}"
    raise InputError(problem, field="time", remedy=remedy)
