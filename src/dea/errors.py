"""The exceptions shown to a user: their input is wrong, or a device failed."""

from pathlib import Path


class InputError(ValueError):
    """Something that the user supplied is wrong; the message is one line.

    Texts of several lines, as of another library's errors, are put on one.

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
        self.problem, self.file, self.field = _one_line(problem), file, field
        self.remedy = None if remedy is None else _one_line(remedy).removesuffix(".")
        place = ": ".join(_one_line(str(part)) for part in (file, field) if part is not None)
        message = f"{place}: {self.problem}" if place else self.problem
        super().__init__(f"{message}. {self.remedy}" if remedy else message)

    def at(
        self,
        *,
        file: str | Path | None = None,
        field: str | None = None,
        remedy: str | None = None,
    ) -> "InputError":
        """Return the same problem with another place or remedy; what is not given stays."""
        return InputError(
            self.problem,
            file=self.file if file is None else file,
            field=self.field if field is None else field,
            remedy=self.remedy if remedy is None else remedy,
        )


def noted(error: BaseException, message: str = "") -> str:
    """Return the message of an error, or one on it, with what the error notes, on one line."""
    text, notes = message or str(error), " ".join(getattr(error, "__notes__", []))
    return f"{text.removesuffix('.')}. {notes}" if notes else text


def _one_line(text: str) -> str:
    return " ".join(filter(None, map(str.strip, text.splitlines())))


class DeviceError(Exception):
    """A device or the connection to it failed; of a record, the message says what is missing."""
