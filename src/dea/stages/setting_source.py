"""Where a setting stands that does not fit a record: in the case of the record, or in the study."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dea.configuration.files import read_yaml
from dea.errors import InputError

_CASES = Path("config/cases")


def at_setting(error: InputError, record: Path, *keys: str) -> InputError:
    """Return the error at these dotted keys, of the case where it holds one, else of the record.

    A job gets the settings of case and study as one.

    Parameters
    ----------
    record
        ``results/NAME/record.nc``, of an actuator or a case.
    """
    field = ", ".join(keys)
    case = _CASES / f"{record.parent.name}.yaml"
    if case.is_file():
        content = read_yaml(case, what="the case", example="a file of config/cases")
        if any(_holds(content, key) for key in keys):
            problem = f"{record}: {error.problem}"
            return InputError(problem, file=case, field=field, remedy=error.remedy)
    return error.at(file=record, field=field)


@contextmanager
def settings_told(record: Path, keys: Mapping[str, str]) -> Iterator[None]:
    """Raise an error of one of these fields as that of the setting with its dotted key."""
    try:
        yield
    except InputError as error:
        key = keys.get(error.field or "")
        if key is None:
            raise
        raise at_setting(error, record, key) from error


def _holds(content: Any, key: str) -> bool:
    for part in key.split("."):
        if not isinstance(content, Mapping) or part not in content:
            return False
        content = content[part]
    return True
