"""Which column of a file is the time, which the input, which the output, and in what units."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dea.configuration.record import Column, RecordFile
from dea.errors import InputError
from dea.intake.names import ColumnUnits, named
from dea.intake.questions import KEPT, UnansweredError, command, described
from dea.intake.timing import find_times
from dea.store import ForeignTable
from dea.units import SECONDS, plain_units

# Whole words of a name, numbered or not. Names that could be either (voltage, position) are asked
# about.
_INPUT = {"u", "in", "input", "inputs", "command", "cmd", "excitation", "drive", "uest"}
# Words that make a column the input only where all words of its name do: drive_temp is measured.
_BESIDE = {"drive"}
_OUTPUT = {"y", "out", "output", "outputs", "response", "measured", "displacement", "yest"}


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
    inferred: list[str] = []
    of_user, of_case = (next(iter(each["time"]), None) for each in (said, earlier))
    time, interval, clock = find_times(table, of_user, of_case, answers.rate, kept, file, inferred)
    free = [name for name in table.columns if name != clock]
    told = {role: said[role] or earlier[role] for role in ("input", "output")}
    taken = {name for each in told.values() for name, _ in each}
    open_names = [name for name in free if name not in taken]
    found = {
        "input": told["input"] or _guess(open_names, _INPUT, table),
        "output": told["output"] or _guess(open_names, _OUTPUT, table),
    }
    left_over = _fill_the_other(found, free, table)
    _check_apart(found, time, file)
    asked, lines = _question(found, time, interval, free, table)
    if asked:
        raise UnansweredError(asked, command(goal, {**given, **lines}), file, described(table))
    names = [name for each in found.values() for name, _ in each]
    table.refuse_words([*names, *([time[0]] if time else [])], file)
    unsaid = [role for role in ("input", "output") if not said[role]]
    by = dict.fromkeys(unsaid, ", by the names") | dict.fromkeys(left_over, ", the only other one")
    by |= {role: KEPT for role in unsaid if earlier[role]}
    inferred += [
        f"{role}: {_listed([name for name, _ in found[role]])}{by[role]}" for role in unsaid
    ]
    if rest := _without_role(found, free):
        inferred.append(f"not used: {_listed(rest)}")
    columns = {
        role: tuple((name, units or "") for name, units in each) for role, each in found.items()
    }
    timed = (time[0], time[1] or "") if time is not None else None
    return Roles(columns["input"], columns["output"][0], timed, interval, tuple(inferred))


def _check_apart(
    found: Mapping[str, list[ColumnUnits]], time: ColumnUnits | None, file: Path
) -> None:
    """Refuse a column that has two roles, or is named twice as an input.

    Raises
    ------
    InputError
        Naming it.
    """
    driving, measured = ([name for name, _ in found[role]] for role in ("input", "output"))
    if both := set(driving).intersection(measured):
        raise InputError(
            f"{both.pop()!r} is input and output", file=file, remedy="Name two columns"
        )
    if time is not None and time[0] in (*driving, *measured):
        raise InputError(
            f"{time[0]!r} is {'input' if time[0] in driving else 'output'} and the time",
            file=file,
            remedy="Name two columns, or the samples per second: RATE=…",
        )
    if len(set(driving)) < len(driving):
        raise InputError("it names a column twice", field="INPUT", remedy="Name each input once")


def _earlier(
    kept: RecordFile | None, said: Mapping[str, list[ColumnUnits]], table: ForeignTable
) -> dict[str, list[ColumnUnits]]:
    """Return what an earlier case says of the roles of which the user says nothing.

    Nothing where the file has a column of it no more, or the user gives that another role. Units
    that the file says are those of the file, which may have been corrected.
    """
    taken = {name for each in said.values() for name, _ in each}

    def columns(role: str, declared: Sequence[Column | None]) -> list[ColumnUnits]:
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


def _listed(names: Sequence[str]) -> str:
    listed = ", ".join(map(repr, names))
    return f"column{'s' if len(names) > 1 else ''} {listed}"


def _answers(text: str | None, table: ForeignTable, role: str, file: Path) -> list[ColumnUnits]:
    """Return the columns that an answer names; several only of the input."""
    if text is None:
        return []
    name, _, units = text.rpartition(":")
    whole = text in table.columns or (name in table.columns and "," not in units)
    parts = [text] if whole or role != "input" else [part.strip() for part in text.split(",")]
    return [_answer(part, table, role, file) for part in parts]


def _answer(text: str, table: ForeignTable, role: str, file: Path) -> ColumnUnits:
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


def _question(
    found: Mapping[str, list[ColumnUnits]],
    time: ColumnUnits | None,
    interval: float | None,
    free: list[str],
    table: ForeignTable,
) -> tuple[list[str], dict[str, str]]:
    """Return what is not known of the columns, and the variables of a command that tells it.

    Nothing is asked where all is known. ``free`` are the columns that may be input or output.
    """
    lines: dict[str, str] = {}
    asked = _unknown_roles(found, free, table)
    rest = _without_role(found, free)
    # Two columns are likely input and output, in this order; of more, none is likelier.
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
    return asked, lines


def _unknown_roles(
    found: Mapping[str, list[ColumnUnits]], free: list[str], table: ForeignTable
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
    asked = ", which ".join(questions[role] for role in unknown)
    if _all_have_units(_without_role(found, free), table):
        return [f"which column {asked}"]
    return [f"which column {asked}, and {'their' if len(unknown) > 1 else 'its'} units"]


def _without_role(found: Mapping[str, list[ColumnUnits]], free: list[str]) -> list[str]:
    names = {name for each in found.values() for name, _ in each}
    return [name for name in free if name not in names]


def _all_have_units(names: list[str], table: ForeignTable) -> bool:
    return bool(names) and all(table.units.get(name) for name in names)


def _fill_the_other(
    found: dict[str, list[ColumnUnits]], free: list[str], table: ForeignTable
) -> list[str]:
    """Give the only column that is left to the only role that none has; return that role.

    Where a column holds no numbers it may have been meant.
    """
    known = [role for role, columns in found.items() if columns]
    if len(known) != 1 or table.no_numbers:
        return []
    rest = _without_role(found, free)
    if len(rest) != 1:
        return []
    missing = "output" if known[0] == "input" else "input"
    found[missing] = [(rest[0], table.units.get(rest[0]))]
    return [missing]


def _guess(free: list[str], words: set[str], table: ForeignTable) -> list[ColumnUnits]:
    """Return the only column whose name holds one of these words, empty where there are more.

    Words may be numbered, as those of several inputs are. One that holds no numbers counts, and is
    none.
    """
    numbered = re.compile(r"\d+(?![^\W_])")  # at the end of a word

    def hold(words: set[str]) -> Callable[[str], bool]:
        matching = named(words)
        return lambda name: matching(name) or matching(numbered.sub("", name))

    found = list(filter(hold(words), [*free, *table.no_numbers]))
    if len(found) != 1 or found[0] not in free:
        return []
    only = words.issuperset(re.findall(r"[a-z]+", found[0].lower()))
    sure = only or hold(words - _BESIDE)(found[0])
    return [(found[0], table.units.get(found[0]))] if sure else []
