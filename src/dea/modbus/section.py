"""Reading a mapping key by key, with errors that name the key and the remedy."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from dea.errors import InputError


class Section:
    """A mapping at ``path`` (keys joined by dots) of the file ``source``."""

    def __init__(self, values: Any, source: Path | None, path: str) -> None:
        self.source, self.path = source, path
        if not isinstance(values, Mapping):
            raise InputError(
                f"expected a mapping, found {type(values).__name__}",
                file=source,
                field=path or None,
                remedy="Write it as `key: value` lines.",
            )
        self.values = values

    def error(self, key: str, problem: str, remedy: str) -> InputError:
        """What is wrong with ``key``, ready to be raised."""
        where = ".".join(part for part in (self.path, key) if part)
        return InputError(problem, file=self.source, field=where, remedy=remedy)

    def allow(self, *keys: str) -> None:
        """Refuse any key but these."""
        for key in self.values:
            if key not in keys:
                raise self.error(str(key), "unknown key", f"Known here: {', '.join(keys)}.")

    def get(self, key: str, default: Any) -> Any:
        """Value of ``key``; a missing one without default is refused, as are all below."""
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, "missing", "Give it.")
        return value

    def section(self, key: str) -> "Section":
        """Mapping under ``key``."""
        where = ".".join(part for part in (self.path, key) if part)
        return Section(self.get(key, None), self.source, where)

    def text(self, key: str, default: str | None = None) -> str:
        """Text under ``key``."""
        value = self.get(key, default)
        if not isinstance(value, str):
            raise self.error(key, f"{value!r} is not text", "Put it in quotes.")
        return value

    def boolean(self, key: str, default: bool) -> bool:
        """Truth value under ``key``."""
        value = self.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"{value!r} is neither true nor false", "Use true or false.")
        return value

    def integer(self, key: str, low: int, high: int, default: int | None = None) -> int:
        """Whole number under ``key``, from ``low`` to ``high``."""
        value = self.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.error(key, f"{value!r}", f"Use a whole number from {low} to {high}.")
        return value

    def number(self, key: str, default: float | None = None, positive: bool = False) -> float:
        """Finite number under ``key``."""
        value = self.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, f"{value!r} is not a number", "Use a number.")
        if value != value or abs(value) == float("inf") or (positive and value <= 0):
            raise self.error(key, f"{value!r}", "Use a finite, positive number.")
        return float(value)

    def choice(self, key: str, allowed: Any, default: str) -> str:
        """One of the texts of the Literal type ``allowed``."""
        value = self.get(key, default)
        if value not in get_args(allowed):
            raise self.error(
                key, f"unknown {key} {value!r}", f"Use {', '.join(get_args(allowed))}."
            )
        return value

    def interval(self, key: str) -> tuple[float, float] | None:
        """Two ascending numbers under ``key``, or None where there are none."""
        value = self.values.get(key)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise self.error(key, f"{value!r}", "Give [low, high].")
        if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in value):
            raise self.error(key, f"{value!r}", "Give two numbers, [low, high].")
        low, high = float(value[0]), float(value[1])
        if not low < high:
            raise self.error(key, f"{low:g} and {high:g} cross", "Give the lower one first.")
        return low, high
