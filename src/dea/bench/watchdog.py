"""The watchdog of the device: it trips when the owner has been silent too long, and latches."""


class Watchdog:
    """Time since the owner was last heard, and what came of a silence that was too long.

    Parameters
    ----------
    timeout
        Silence of the owner, s, after which a driven output is taken to zero.
    """

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout
        self.last_heard = 0.0
        self.latched = False
        self.trips = 0

    def heard(self, now: float) -> None:
        """Note a request of the owner at ``now``, s."""
        self.last_heard = now

    def expired(self, now: float) -> bool:
        """Whether the owner has been silent too long at ``now``, s."""
        return now - self.last_heard > self.timeout

    def trip(self) -> None:
        """Count a trip and latch until :meth:`reset`."""
        self.latched = True
        self.trips += 1

    def reset(self) -> None:
        """Clear the latch."""
        self.latched = False
