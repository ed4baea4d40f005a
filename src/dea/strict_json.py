"""JSON that any reader takes: what it has no numbers for is told as a string.

These are ``"Infinity"``, ``"-Infinity"`` and ``"NaN"``, as in the JSON of Protocol Buffers.
"""

import json
from collections.abc import Mapping
from math import isfinite, isnan
from typing import Any

_NUMBERS = {"Infinity": float("inf"), "-Infinity": float("-inf"), "NaN": float("nan")}


def as_json(content: Any, indent: int) -> str:
    """Return content as JSON."""
    return json.dumps(_told(content), indent=indent, allow_nan=False)


def from_json(text: str) -> Any:
    """Return the content of what :func:`as_json` made.

    Raises
    ------
    ValueError
        If it is no JSON.
    """
    return _numbers(json.loads(text))


def _told(content: Any) -> Any:
    match content:
        case float() if not isfinite(content):
            return "NaN" if isnan(content) else "Infinity" if content > 0 else "-Infinity"
        case Mapping():
            return {key: _told(value) for key, value in content.items()}
        case list() | tuple():
            return [_told(value) for value in content]
    return content


def _numbers(content: Any) -> Any:
    match content:
        case str():
            return _NUMBERS.get(content, content)
        case dict():
            return {key: _numbers(value) for key, value in content.items()}
        case list():
            return [_numbers(value) for value in content]
    return content
