"""The exceptions shown to a user: their input is wrong, or a device failed."""

from pathlib import Path


class InputError(ValueError):
    """Something that the user supplied is wrong; the message is one line.

    Parameters
    ----------
    problem
        What is wrong, with the value at fault.
    file, field
        Where it is: the file, and the key, column or variable in it.
    remedy
        What to do, or what would be right.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: str | Path | None = None,
        field: str | None = None,
        remedy: str | None = None,
    ) -> None:
        self.problem, self.file, self.field, self.remedy = problem, file, field, remedy
        place = ": ".join(str(part) for part in (file, field) if part is not None)
        message = f"{place}: {problem}" if place else problem
        super().__init__(f"{message}. {remedy}" if remedy else message)


class DeviceError(Exception):
    """A device or the connection to it failed; of a record, the message says what is missing."""
