"""What a link logs of its exchanges."""

import time
from collections import Counter
from dataclasses import dataclass, field, replace


@dataclass
class LinkLog:
    """The exchanges with the device, an element each; times in s since ``started``.

    ``jitter`` has an element per polled sample: s behind its deadline.
    """

    started: float = field(default_factory=time.monotonic)
    send_time: list[float] = field(default_factory=list)
    receive_time: list[float] = field(default_factory=list)
    retries: list[int] = field(default_factory=list)
    samples: list[int] = field(default_factory=list)
    errors: Counter[str] = field(default_factory=Counter)
    jitter: list[float] = field(default_factory=list)
    reconnects: int = 0

    def cut(self) -> "LinkLog":
        """Return what has been logged since the last cut, and forget it."""
        since = replace(self)
        self.send_time, self.receive_time, self.retries = [], [], []
        self.samples, self.jitter = [], []
        self.errors, self.reconnects = Counter(), 0
        return since

    def add(self, later: "LinkLog") -> None:
        """Append what another log with the same start holds."""
        self.send_time += later.send_time
        self.receive_time += later.receive_time
        self.retries += later.retries
        self.samples += later.samples
        self.jitter += later.jitter
        self.errors += later.errors
        self.reconnects += later.reconnects
