"""Which column of a file is the time, which the input, which the output, and in what units."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dea import store
from dea.configuration.record import Column, RecordFile
from dea.errors import InputError
from dea.intake.questions import UnansweredError, answer, command, described
from dea.store import ForeignTable
from dea.units import HERTZ, SECONDS, plain_units

# Whole words of a name, numbered or not. Names that could be either (voltage, position) are asked
# about.
_INPUT = {"u", "in", "input", "inputs", "command", "cmd", "excitation", "drive", "uest"}
_OUTPUT = {"y", "out", "output", "outputs", "response", "measured", "displacement", "yest"}
# Whole names, a number behind them at most: as words of a longer one they are prepositions.
_ALONE = {"in", "out"}
_INTERVAL = {"ts", "dt", "tsample", "sampling_interval", "sample_time"}
_Column = tuple[str, str | None]  # its name and its units, where they are known
_RATE = {"fs", "rate", "sampling_rate", "samplerate", "sample_rate"}
_KEPT = ", kept from the case"
# Steps of times without units, in s where they are taken to be in s. Whole numbers that are further
# apart than one may as well be milliseconds.
_FINEST, _COARSEST = 1e-6, 10.0
_LATEST = 1e11  # s since 1970: clocks that count milliseconds or less are beyond it


@dataclass(frozen=True)
class Answers:
    """What the user said of a file; what is None is looked for in it.

    Parameters
    ----------
    input, output
        ``COLUMN`` or ``COLUMN:UNITS``; several inputs, separated by commas.
    time
        The same of the time column.
    rate
        Samples per second.
    sheet
        Of a workbook, that which holds the record.
    """

    input: str | None = None
    output: str | None = None
    time: str | None = None
    rate: float | None = None
    sheet: str | None = None


@dataclass(frozen=True)
class Roles:
    """The columns of a record with their units; ``time`` or ``interval`` (s) is None.

    ``inferred`` says in words what the user did not.
    """

    inputs: tuple[tuple[str, str], ...]
    output: tuple[str, str]
    time: tuple[str, str] | None
    interval: float | None
    inferred: tuple[str, ...] = ()


def find_roles(
    table: ForeignTable,
    answers: Answers,
    file: Path,
    goal: str,
    given: Mapping[str, str],
    kept: RecordFile | None = None,
) -> Roles:
    """Return what each column is, by the answers, an earlier case, names and units of the file.

    Parameters
    ----------
    goal, given
        Target and variables of the command that was typed, for the question.
    kept
        What an earlier case says of the same file.

    Raises
    ------
    UnansweredError
        Where the file does not say which columns are input and output, what their units are, or how
        far apart the samples are.
    InputError
        Where an answer names no column, or one twice, or a column has text among its numbers.
    """
    said = {
        role: _answers(getattr(answers, role), table, role, file)
        for role in ("input", "output", "time")
    }
    earlier = _earlier(kept, said, table)
    rate = answers.rate
    of_the_case = rate is None and not said["time"] and kept is not None
    if kept is not None and of_the_case and kept.sampling_interval is not None:
        rate = 1.0 / kept.sampling_interval
    inferred: list[str] = []
    named = next(iter(said["time"] or earlier["time"]), None)
    if not said["time"]:
        _refuse_falling_time(
            table, named[0] if named else store.called_time(table), rate, file, inferred
        )
    time, interval = _timing(table, named, rate, inferred, file)
    clock = named[0] if named else store.time_column(table)
    if rate is not None and (clock is not None or of_the_case):
        unused = f"; column {clock!r} is not used" if clock is not None else ""
        of_case = f"{_KEPT}{_otherwise(table, rate)}" if of_the_case else ""
        inferred.append(f"time: {rate:g} samples per second{of_case}{unused}")
    elif time is not None and earlier["time"]:
        inferred.append(f"time: column {time[0]!r}, in {time[1]}{_KEPT}")
    free = [name for name in table.columns if name != clock]
    told = {role: said[role] or earlier[role] for role in ("input", "output")}
    taken = {name for each in told.values() for name, _ in each}
    open_names = [name for name in free if name not in taken]
    found = {
        "input": told["input"] or _guess(open_names, _INPUT, table),
        "output": told["output"] or _guess(open_names, _OUTPUT, table),
    }
    left_over = _fill_the_other(found, free, table)
    names = [name for each in found.values() for name, _ in each]
    driving, measured = ([name for name, _ in found[role]] for role in ("input", "output"))
    if both := set(driving).intersection(measured):
        raise InputError(
            f"{both.pop()!r} is input and output", file=file, remedy="Name two columns"
        )
    if len(set(driving)) < len(driving):
        raise InputError("it names a column twice", field="INPUT", remedy="Name each input once")
    lines = dict(given)
    asked = _unknown_roles(found, free, table)
    # Two columns are likely input and output, in this order; of more, none is likelier.
    rest = [name for name in free if name not in names]
    guesses = rest if len(free) == 2 and not table.no_numbers else []
    for role, known in found.items():
        if not known:
            name = guesses.pop(0) if guesses else "COLUMN"
            units = table.units.get(name) or ("" if _all_have_units(rest, table) else "UNITS")
            lines[role.upper()] = f"{name}:{units}" if units else name
            continue
        asked += [f"the units of {name!r}" for name, units in known if not units]
        lines[role.upper()] = ",".join(f"{name}:{units or 'UNITS'}" for name, units in known)
    if time is None and interval is None:
        asked.append(
            "how many samples there are in a second (or which column is the time:"
            " TIME=COLUMN:UNITS)"
        )
        lines["RATE"] = "SAMPLES_PER_SECOND"
    if time is not None and time[1] is None:
        asked.append(f"the units of the time {time[0]!r} ({', '.join(SECONDS)})")
        lines["TIME"] = f"{time[0]}:UNITS"
    if asked:
        raise UnansweredError(asked, command(goal, lines), file, described(table))
    table.refuse_words([*names, *([time[0]] if time else [])], file)
    unsaid = [role for role in ("input", "output") if not said[role]]
    by = dict.fromkeys(unsaid, ", by the names") | dict.fromkeys(left_over, ", the only other one")
    by |= {role: _KEPT for role in unsaid if earlier[role]}
    inferred += [
        f"{role}: {_listed([name for name, _ in found[role]])}{by[role]}" for role in unsaid
    ]
    if rest:
        inferred.append(f"not used: {_listed(rest)}")
    columns = {
        role: tuple((name, units or "") for name, units in each) for role, each in found.items()
    }
    timed = (time[0], time[1] or "") if time is not None else None
    return Roles(columns["input"], columns["output"][0], timed, interval, tuple(inferred))


def _earlier(
    kept: RecordFile | None, said: Mapping[str, list[_Column]], table: ForeignTable
) -> dict[str, list[_Column]]:
    """Return what an earlier case says of the roles of which the user says nothing.

    Nothing where the file has a column of it no more, or the user gives that another role. Units
    that the file says are those of the file, which may have been corrected.
    """
    taken = {name for each in said.values() for name, _ in each}

    def columns(role: str, declared: Sequence[Column | None]) -> list[_Column]:
        given = [each for each in declared if each is not None]
        there = all(each.column in table.columns for each in given)
        if said[role] or not there or taken.intersection(each.column for each in given):
            return []
        return [(each.column, table.units.get(each.column, each.units)) for each in given]

    if kept is None:
        return {role: [] for role in said}
    time = columns("time", [kept.time])
    return {
        "input": columns("input", kept.driving),
        "output": columns("output", [kept.output]),
        "time": [each for each in time if each[1] in SECONDS],
    }


def _otherwise(table: ForeignTable, rate: float) -> str:
    """Say where the file itself holds another interval than the case: it may be recorded anew."""
    stated = _stated_interval(table)
    if stated is None or np.isclose(stated[1] * rate, 1.0, rtol=1e-6):
        return ""
    return f", though {stated[0]!r} says {1.0 / stated[1]:g}"


def _listed(names: Sequence[str]) -> str:
    listed = ", ".join(map(repr, names))
    return f"column{'s' if len(names) > 1 else ''} {listed}"


def _answers(text: str | None, table: ForeignTable, role: str, file: Path) -> list[_Column]:
    """Return the columns that an answer names; several only of the input."""
    if text is None:
        return []
    name, _, units = text.rpartition(":")
    whole = text in table.columns or (name in table.columns and "," not in units)
    parts = [text] if whole or role != "input" else [part.strip() for part in text.split(",")]
    return [_answer(part, table, role, file) for part in parts]


def _answer(text: str, table: ForeignTable, role: str, file: Path) -> _Column:
    name, mark, units = text.rpartition(":")
    if text in table.columns or not mark:
        name, units = text, ""
    if name not in table.columns:
        told = table.no_numbers.get(name)
        raise InputError(
            f"column {name!r} holds {told}" if told else f"it has no column {name!r}",
            file=file,
            field=role.upper(),
            remedy=f"Its columns of numbers are {', '.join(table.columns) or 'none'}",
        )
    return name, plain_units(units) if units else table.units.get(name)


def _timing(
    table: ForeignTable,
    said: _Column | None,
    rate: float | None,
    inferred: list[str],
    file: Path,
) -> tuple[_Column | None, float | None]:
    """Return the time column with its units, None where only the user knows them, or the interval.

    The interval is in s; there may be neither.

    Raises
    ------
    InputError
        If the column that the user names is in other units.
    """
    if rate is not None:
        return None, 1.0 / rate
    name, units = said or (store.time_column(table), None)
    if name is not None:
        units = units or table.units.get(name) or store.units_in_name(name)
        if units is None and not _may_be_seconds(table.columns[name]):
            return (name, None), None
        if units is None:
            other = answer("TIME", f"{name}:ms")
            inferred.append(f"time: column {name!r}, taken to be in s; if it is in ms, {other}")
        elif said is None:
            inferred.append(f"time: column {name!r}, in {units}")
        if (units or "s") in SECONDS:
            return (name, units or "s"), None
        if said is not None:
            raise InputError(
                f"{units!r} is no unit of time",
                file=file,
                field="TIME",
                remedy=f"Units of time are {', '.join(SECONDS)}; or give the samples per second,"
                " RATE=…",
            )
    if (stated := _stated_interval(table)) is not None:
        constant, interval = stated
        inferred.append(f"{interval:g} s between samples, from {constant!r}")
        return None, interval
    return None, None


def _may_be_seconds(values: np.ndarray) -> bool:
    """Tell whether times without units are likely to be in s, if they ascend at all."""
    there = values[np.isfinite(values)]
    steps = np.diff(there)
    if not np.any(steps > 0):
        return True
    most = 1.0 if np.all(there == np.round(there)) else _COARSEST
    likely = _FINEST <= np.median(steps[steps > 0]) <= most
    return bool(likely and np.all(np.abs(there) < _LATEST))


def _stated_interval(table: ForeignTable) -> tuple[str, float] | None:
    """Return the lone number that is the interval or the rate, and the interval in s."""
    for known, plain, scale in ((_INTERVAL, "s", SECONDS), (_RATE, "Hz", HERTZ)):
        constant = next(filter(_named(known), table.constants), None)
        factor = scale.get(table.units.get(constant, plain)) if constant is not None else None
        if constant is not None and factor and table.constants[constant] > 0:
            value = factor * table.constants[constant]
            return constant, value if scale is SECONDS else 1.0 / value
    return None


def _refuse_falling_time(
    table: ForeignTable, name: str | None, rate: float | None, file: Path, inferred: list[str]
) -> None:
    """Refuse a column that is taken for the time and falls back, unless a rate is given.

    Records that were joined fall back, and one that was sorted the other way round.

    Raises
    ------
    InputError
        Naming the first sample at fault.
    """
    if name is None:
        return
    time = table.columns[name]
    there = np.flatnonzero(np.isfinite(time))
    back = np.flatnonzero(np.diff(time[there]) < 0)
    if not back.size:
        return
    before, at = there[back[0]], there[back[0] + 1]
    told = f"sample {at} is at {time[at]:g}, sample {before} at {time[before]:g}"
    if rate is not None:
        inferred.append(f"time: column {name!r} falls back ({told})")
        return
    raise InputError(
        f"it falls back: {told}",
        file=file,
        field=f"column {name!r}",
        remedy="Give each run a file of its own, or the samples per second if they follow each"
        " other without a break: RATE=…",
    )


def _unknown_roles(
    found: Mapping[str, list[_Column]], free: list[str], table: ForeignTable
) -> list[str]:
    """Return the question for the roles that no column is known to have."""
    questions = {
        "input": "is the input (several: INPUT=A:UNITS,B:UNITS)",
        "output": "the output",
    }
    unknown = [role for role, columns in found.items() if not columns]
    if not unknown:
        return []
    if unknown == ["output"]:
        questions["output"] = "is the output"
    known = [name for columns in found.values() for name, _ in columns]
    asked = ", which ".join(questions[role] for role in unknown)
    if _all_have_units([name for name in free if name not in known], table):
        return [f"which column {asked}"]
    return [f"which column {asked}, and {'their' if len(unknown) > 1 else 'its'} units"]


def _all_have_units(names: list[str], table: ForeignTable) -> bool:
    return bool(names) and all(table.units.get(name) for name in names)


def _fill_the_other(
    found: dict[str, list[_Column]], free: list[str], table: ForeignTable
) -> list[str]:
    """Give the only column that is left to the only role that none has; return that role.

    Where a column holds no numbers it may have been meant.
    """
    known = [role for role, columns in found.items() if columns]
    if len(known) != 1 or table.no_numbers:
        return []
    names = [name for name, _ in found[known[0]]]
    rest = [name for name in free if name not in names]
    if len(rest) != 1:
        return []
    missing = "output" if known[0] == "input" else "input"
    found[missing] = [(rest[0], table.units.get(rest[0]))]
    return [missing]


def _guess(free: list[str], words: set[str], table: ForeignTable) -> list[_Column]:
    """Return the only column whose name holds one of these words, empty where there are more.

    Words may be numbered, as those of several inputs are. One that holds no numbers counts, and is
    none.
    """
    named = _named(words)
    numbered = re.compile(r"\d+(?![^\W_])")  # at the end of a word

    def matches(name: str) -> bool:
        return named(name) or named(numbered.sub("", name))

    found = list(filter(matches, [*free, *table.no_numbers]))
    sure = len(found) == 1 and found[0] in free
    return [(found[0], table.units.get(found[0]))] if sure else []


def _named(words: set[str]) -> Callable[[str], bool]:
    def matches(name: str) -> bool:
        whole = name.lower()
        parts = re.split(r"[^a-z0-9]+", whole)
        alone = re.sub(r"[^a-z]*\d*$", "", whole) in words & _ALONE
        return whole in words or alone or bool((words - _ALONE).intersection(parts))

    return matches
