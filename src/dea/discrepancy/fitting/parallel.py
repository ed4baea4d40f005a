"""Work on several threads."""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from dea.progress import Counter

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_parallel(
    task: Callable[[Item], Result], items: Iterable[Item], workers: int, step: str = ""
) -> list[Result]:
    """Apply ``task`` to each item, in order, on threads: the integrator releases the lock.

    A ``step`` with a name tells how many items are done.
    """
    items = list(items)
    counter = Counter(step, len(items) if step else 0)

    def counted(item: Item) -> Result:
        result = task(item)
        counter.count()
        return result

    if workers == 1:
        return [counted(item) for item in items]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(counted, items))
