"""Reading a YAML file, with errors of one line."""

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from dea.errors import InputError

_REMEDY = "Correct that line or the one before it; indent with spaces, not tabs."
_TRUTH, _TEXT = "tag:yaml.org,2002:bool", "tag:yaml.org,2002:str"
_KINDS = {"int": "whole number", "float": "number", "bool": "truth value", "timestamp": "date"}


class _Loader(yaml.CSafeLoader):
    """Refuses a key that is given twice, of which YAML would keep the last.

    Keys are text: ``on`` and ``off``, which YAML 1.1 takes for truth values, are keys of
    ``safety``. Where a value looks like a number or a date and is none, an error says where it is.
    The notes of its errors are remedies.
    """

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, OverflowError, LookupError, AttributeError):
            value = str(node.value)
            shown = value if len(value) <= 60 else f"{value[:57]}..."
            name = node.tag.rpartition(":")[2]
            raise yaml.MarkedYAMLError(
                problem=f"{shown!r} is no {_KINDS.get(name, name)}",
                problem_mark=node.start_mark,
                note="Correct it, or put it in quotes where it is meant as text.",
            ) from None

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.tag == _TRUTH:
                    key.tag = _TEXT
                if (key.tag, key.value) in seen:
                    raise yaml.MarkedYAMLError(
                        problem=f"the key {key.value!r} is given twice",
                        problem_mark=key.start_mark,
                        note="Delete one of the two.",
                    )
                seen.add((key.tag, key.value))
        return super().construct_mapping(node, deep)


def read_yaml(path: str | Path, *, what: str, example: str) -> Any:
    """Return the content of a YAML file; see :func:`read_text_and_yaml`."""
    return read_text_and_yaml(path, what=what, example=example)[1]


def read_text_and_yaml(path: str | Path, *, what: str, example: str) -> tuple[str, Any]:
    """Return the text of a YAML file, its line ends as they are, and what it says.

    Parameters
    ----------
    what, example
        What the file is, and one that is right, for messages.

    Raises
    ------
    InputError
        If it cannot be read, is not valid YAML, gives a key twice, or holds a value that looks like
        a number or a date and is none.
    """
    try:
        text = Path(path).read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{what} cannot be read: {error}",
            file=path,
            remedy=f"Name {example} or a file written like it.",
        ) from error
    return text, parse_yaml(text, path)


def parse_yaml(text: str, path: str | Path) -> Any:
    """Return what YAML says that was read from a file.

    Raises
    ------
    InputError
        As :func:`read_text_and_yaml`.
    """
    try:
        return yaml.load(text, _Loader)  # a safe loader
    except yaml.YAMLError as error:
        raise InputError(
            f"not valid YAML{_described(error)}",
            file=path,
            remedy=getattr(error, "note", None) or _REMEDY,
        ) from None


def _described(error: yaml.YAMLError) -> str:
    mark = getattr(error, "problem_mark", None)
    if mark is None:
        return f": {' '.join(str(error).split())}"
    context = " ".join(
        part for part in (getattr(error, "context", None), getattr(error, "problem", None)) if part
    )
    return f" at line {mark.line + 1}, column {mark.column + 1}: {context}"
