"""What a device has truly put out, against the monotonic clock of the device."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Applied:
    """An output from ``time`` on, s of the monotonic clock."""

    time: float
    volts: float
    counts: int
    displacement: int  # counts
    index: int  # of the sample, where the device counts them


@dataclass
class Trace:
    """The outputs of one run in order of time; the last lasts until the run is over."""

    applied: list[Applied] = field(default_factory=list)

    def spans(self, until: float) -> list[tuple[float, float, float]]:
        """Return (start, end, volts) of each output."""
        ends = [entry.time for entry in self.applied[1:]] + [until]
        return [
            (entry.time, end, entry.volts)
            for entry, end in zip(self.applied, ends, strict=True)
            if end > entry.time
        ]

    def before(self, until: float) -> "Trace":
        """Return the outputs that began until then."""
        return Trace([entry for entry in self.applied if entry.time <= until])

    def driven(self, until: float) -> list[tuple[float, float]]:
        """Return (start, end) of each time for which the output was on without a break."""
        found: list[tuple[float, float]] = []
        for start, end, volts in self.spans(until):
            if volts and found and found[-1][1] == start:
                found[-1] = found[-1][0], end
            elif volts:
                found.append((start, end))
        return found
