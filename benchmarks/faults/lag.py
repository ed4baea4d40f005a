"""How far behind the host is: what it does to the campaign it does to the command as well."""

import asyncio
import time

PERIOD = 0.02  # s


class Lag:
    """Watches how late this process wakes up."""

    def __init__(self) -> None:
        self._late: list[tuple[float, float]] = []
        self._watch: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to watch, on the running loop."""
        self._watch = asyncio.get_running_loop().create_task(self._look())

    def stop(self) -> None:
        """End."""
        if self._watch is not None:
            self._watch.cancel()

    def worst(self, since: float) -> float:
        """Return the longest delay, s, since this time of the monotonic clock."""
        return max((late for when, late in self._late if when >= since), default=0.0)

    async def _look(self) -> None:
        while True:
            asleep = time.monotonic()
            await asyncio.sleep(PERIOD)
            late = time.monotonic() - asleep - PERIOD
            if late > PERIOD:
                self._late.append((asleep, late))
