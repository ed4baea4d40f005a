"""A record made elsewhere: its file, and what the columns of the file are."""

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from dea.configuration.section import Positive, Section, Whole, key, refuse
from dea.units import SECONDS


class Column(Section):
    """A column of numbers in a file."""

    column: str = key("name of the column, without units in brackets, or of the variable of a file")
    units: str = key("units of the numbers, as the file has them where it says so")
    name: str | None = key("what it is, for labels; the column's own name otherwise", default=None)


class RecordColumns(Section):
    """What drove the system and what was measured, and when."""

    input: Column | None = key("what drove the system, where it has one input", default=None)
    inputs: Annotated[list[Column], Field(min_length=2)] | None = key(
        "what drove the system, where it has several inputs; terms number them in this order",
        default=None,
    )
    output: Column = key("what was measured")
    time: Column | None = key(
        "time, in s, ms, us, ns, min, h or d; a date or a time of day is in s", default=None
    )
    sampling_interval: Positive | None = key(
        "time between samples, where there is no time column", unit="s", default=None
    )
    resample: Positive | None = key(
        "time between samples that jittering ones are interpolated to, and closer ones averaged to;"
        " what is missing is flagged. Without it the record must be uniform and whole",
        unit="s",
        default=None,
    )
    rows: Annotated[list[Whole], Field(min_length=2, max_length=2, strict=False)] | None = key(
        "first row, and one past the last; negative rows count from the end", default=None
    )
    sheet: str | None = key("which sheet of an .xlsx file, where several hold tables", default=None)

    @property
    def driving(self) -> list[Column]:
        """What drove the system, one column or several."""
        return self.inputs or [column for column in (self.input,) if column is not None]

    @model_validator(mode="after")
    def _columns_are_apart(self) -> Self:
        if (self.input is None) == (self.inputs is None):
            raise refuse(
                "input",
                "missing" if self.input is None else "both input and inputs given",
                "Give a mapping with the keys column, units, name; of several, inputs: a list of"
                " them.",
            )
        names = [column.column for column in self.driving]
        if len(set(names)) < len(names):
            raise refuse("inputs", "a column is named twice", "Name each input once.")
        called = [column.name or column.column for column in self.driving]
        if len(set(called)) < len(called):
            raise refuse("inputs", "two have the same name", "Give each its own `name`.")
        if self.output.column in names:
            raise refuse(
                "output",
                f"column {self.output.column!r} is input and output",
                "Name two columns.",
            )
        return self

    @model_validator(mode="after")
    def _one_time(self) -> Self:
        if self.time is not None and self.time.units not in SECONDS:
            raise refuse(
                "time.units",
                f"its units are {self.time.units!r}",
                f"Units of time are {', '.join(SECONDS)}; or give a sampling_interval instead.",
            )
        if (self.time is None) == (self.sampling_interval is None):
            count = "neither" if self.time is None else "both"
            raise refuse(
                "time",
                f"{count} of time and sampling_interval given",
                "Give the time column, or the sampling_interval in s.",
            )
        driving = [column.column for column in self.driving]
        if self.time is not None and self.time.column in (*driving, self.output.column):
            role = "input" if self.time.column in driving else "output"
            raise refuse(
                "time",
                f"column {self.time.column!r} is {role} and the time",
                "Name two columns, or give a sampling_interval in place of the time.",
            )
        return self


class RecordFile(RecordColumns):
    """The file of a record made elsewhere."""

    file: str = key(
        "text table (.csv, .txt, .dat), NetCDF, MATLAB, .xlsx or .parquet file, relative to the"
        " project"
    )


def is_part_of(test: Mapping[str, Any], record: Mapping[str, Any]) -> bool:
    """Return whether a test record holds samples of the record alone, all of which are diagnosed.

    Both are descriptions as a case writes them.
    """
    if {**test, "rows": None} != {**record, "rows": None}:
        return False
    rows, of_record = test.get("rows"), record.get("rows")
    return of_record is None or (
        rows is not None and bool(of_record[0] <= rows[0] and rows[1] <= of_record[1])
    )
