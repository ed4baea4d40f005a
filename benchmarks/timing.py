"""Times of tasks that run in this process, on one thread."""

import time
from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")


def shortest(task: Callable[[], Result], repeats: int) -> tuple[Result, float]:
    """Return what a task returns the last time, and the shortest of its times in s.

    Times are of the processor, which other programs on the machine hardly stretch.
    """
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = task()
        times.append(time.process_time() - start)
    return result, min(times)
