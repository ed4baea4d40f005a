"""Progress of a long computation, step by step: ``with heard_by(print): ...`` prints it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock

_listeners: list[Callable[[str], None]] = []
_around: list[str] = []


def tell(step: str) -> None:
    """Pass on the present step, in a few words."""
    for listener in _listeners:
        listener(": ".join([*_around, step]))


@contextmanager
def part_of(whole: str) -> Iterator[None]:
    """Tell with every step, while the context lasts, which ``whole`` it is part of."""
    _around.append(whole)
    try:
        yield
    finally:
        _around.pop()


@contextmanager
def heard_by(listener: Callable[[str], None]) -> Iterator[None]:
    """Call ``listener`` with the steps of all threads, while the context lasts."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


class Counter:
    """Tells how many of ``total`` items a step is through with; any thread may count.

    Parameters
    ----------
    step
        What is done with each.
    total
        Number of items.
    """

    def __init__(self, step: str, total: int) -> None:
        self._step, self._total, self._done = step, total, 0
        self._lock = Lock()
        self._tell()

    def count(self) -> None:
        """Say that one more is done."""
        with self._lock:
            self._done += 1
            self._tell()

    def _tell(self) -> None:
        if self._total:
            tell(f"{self._step}, {self._done} of {self._total} done")
