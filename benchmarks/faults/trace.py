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

    def last_driven(self, until: float) -> float | None:
        """Return when the output was last other than zero, None where it never was."""
        driven = [min(end, until) for start, end, volts in self.spans(until) if volts != 0]
        return max(driven, default=None)
