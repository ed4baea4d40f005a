"""What several methods need is computed once, and its time counts for each of them."""

import time
from collections.abc import Callable
from typing import Any


class Shared:
    """Values by name, with the time of a processor (s) that each took."""

    def __init__(self) -> None:
        self._values: dict[str, tuple[Any, float]] = {}
        self._used: set[str] = set()
        self._inside = 0.0

    def once(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return the value ``name``, which is computed where it is not there yet."""
        self._used.add(name)
        if name not in self._values:
            start, before = time.process_time(), self._inside
            value = compute()
            took = time.process_time() - start
            # Values that this one needed have times of their own.
            self._values[name] = value, took - (self._inside - before)
            self._inside = before + took
        return self._values[name][0]

    def timed(self, work: Callable[[], Any]) -> tuple[Any, float]:
        """Return what ``work`` returns, and its time with that of every value it used."""
        self._used.clear()
        start, before = time.process_time(), self._inside
        result = work()
        own = time.process_time() - start - (self._inside - before)
        return result, own + sum(self._values[name][1] for name in self._used)
