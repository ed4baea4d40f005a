"""Reading a YAML file, with errors of one line."""

from pathlib import Path
from typing import Any

import yaml

from dea.errors import InputError


def read_yaml(path: str | Path, *, what: str, example: str) -> Any:
    """Return the content of a YAML file.

    Parameters
    ----------
    what, example
        What the file is, and one that is right, for messages.

    Raises
    ------
    InputError
        If it cannot be read or is not valid YAML.
    """
    try:
        return yaml.safe_load(Path(path).read_text())
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{what} cannot be read: {error}",
            file=path,
            remedy=f"Name {example} or a file written like it.",
        ) from error
    except yaml.YAMLError as error:
        problem = " ".join(str(error).split())
        raise InputError(
            f"not valid YAML: {problem}", file=path, remedy="Mend the syntax."
        ) from None
