"""What several methods need is computed once, and its time counts for each of them.

The time to compile, or to load what was compiled, is left out: it would count for the first alone.
"""

import time
from collections.abc import Callable
from typing import Any

from numba.core import event


class _Compiling(event.Listener):
    """The time of a processor (s) that this process has compiled for."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth, self._since = 0, 0.0

    def on_start(self, event: Any) -> None:
        """Start the clock, unless one function is compiled for another."""
        if not self._depth:
            self._since = time.process_time()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Stop the clock with the outermost function."""
        self._depth -= 1
        if not self._depth:
            self.seconds += time.process_time() - self._since


_compiling = _Compiling()
event.register("numba:compiler_lock", _compiling)


def _clock() -> float:
    return time.process_time() - _compiling.seconds


class Shared:
    """Values by name, with the time of a processor (s) that each took, compiling left out."""

    def __init__(self) -> None:
        self._values: dict[str, tuple[Any, float]] = {}
        self._used: set[str] = set()
        self._inside = 0.0

    def once(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return the value ``name``, which is computed where it is not there yet."""
        self._used.add(name)
        if name not in self._values:
            start, before = _clock(), self._inside
            value = compute()
            took = _clock() - start
            # Values that this one needed have times of their own.
            self._values[name] = value, took - (self._inside - before)
            self._inside = before + took
        return self._values[name][0]

    def timed(self, work: Callable[[], Any]) -> tuple[Any, float]:
        """Return what ``work`` returns, and its time with that of every value it used."""
        self._used.clear()
        start, before = _clock(), self._inside
        result = work()
        own = _clock() - start - (self._inside - before)
        return result, own + sum(self._values[name][1] for name in self._used)
