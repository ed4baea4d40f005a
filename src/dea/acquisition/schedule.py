"""When the samples of a polled device are due, and what becomes of those whose time has passed.

Its clock goes on while the computer is suspended, as the device does: a suspension is a hold-up.
"""

import time

from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import LONGEST_SLEEP

APART = 0.25  # periods between a reply and the next write at least
LONGEST_PAUSE, PERIODS = 1.0, 5  # s, or periods if that is longer, that a hold-up may last


# That of Linux which counts a suspension; elsewhere the one that there is.
_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)


def _now() -> float:
    return time.clock_gettime(_CLOCK)


class Schedule:
    """The deadlines of samples, and what becomes of those that pass."""

    def __init__(self, panel: Panel, samples: int, longest_step: int) -> None:
        self.link, self.period = panel.link, 1.0 / panel.device.sampling_rate
        self.total, self.counted = samples, "device_index" in panel
        self.longest_pause = max(LONGEST_PAUSE, PERIODS * self.period)
        self.longest_step = longest_step
        self.start = _now() + self.period
        self._last = panel.zero
        self._done, self._behind = self.start - self.period, False

    def wait(self, number: int) -> float:
        """Sleep until the deadline of a sample; return how many seconds late it is then.

        Not before a part of the period has passed since the last reply: its write may have been
        held up until then.
        """
        deadline = self.start + number * self.period
        begin = max(deadline, self._done + APART * self.period)
        while (early := begin - _now()) > 0:
            if early > LONGEST_SLEEP:
                self.link.rest(early - LONGEST_SLEEP / 2)
            else:
                time.sleep(early)
        lateness = _now() - deadline
        self.link.log.jitter.append(lateness)
        return lateness

    def approach(self, count: int) -> int:
        """Return what to write for ``count``: after samples were left out, it is approached.

        No step is larger than the largest that the sequence may have.
        """
        if self._behind:
            step = min(max(count - self._last, -self.longest_step), self.longest_step)
            self._behind = self._last + step != count
            return self._last + step
        return count

    def written(self, count: int) -> None:
        """Note what has been written, and answered now."""
        self._last, self._done = count, _now()

    def missed(self, number: int, lateness: float) -> int:
        """Return how many samples from ``number`` on are left out since their time has passed."""
        passed = int(lateness / self.period)
        if self.counted:
            self.start += passed * self.period
            return 0
        missed = min(passed, self.total - 1 - number)
        self._behind |= missed > 0
        return missed
