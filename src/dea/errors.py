"""The exceptions a user meets: something they supplied is wrong, or a device failed."""

from pathlib import Path


class InputError(ValueError):
    """Something the user supplied is wrong: what, where, and what would be right.

    Parameters
    ----------
    problem
        What is wrong, with the offending value.
    file, field
        Where: the file and the key, column or variable in it.
    remedy
        What would be right.
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
    """A device, or the way to it, failed an acquisition; the message says what is left of it."""
