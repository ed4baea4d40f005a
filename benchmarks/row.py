"""A row of the table of benchmarks."""

from dataclasses import asdict, dataclass

_PREFIXES = {0: "", -3: "m", -6: "µ", -9: "n"}
HEAD = f"{'what':<72}{'ours':>10}{'peer':>10}{'ratio':>9}{'target':>9}"


@dataclass(frozen=True)
class Row:
    """What was compared, both times in s, and how the ratio stands against its target.

    Where no times are compared, the ratio is a share of one.
    """

    name: str
    ratio: float
    target: float
    ours_s: float | None = None
    peer_s: float | None = None
    detail: str | None = None
    lost: tuple[str, ...] = ()  # where the peer's error is the lower one

    @classmethod
    def of_times(
        cls,
        name: str,
        ours_s: float,
        peer_s: float,
        target: float,
        detail: str | None = None,
        lost: tuple[str, ...] = (),
    ) -> "Row":
        """Return the row whose ratio says how many times faster ours is."""
        return cls(name, peer_s / ours_s, target, ours_s, peer_s, detail, lost)

    @property
    def met(self) -> bool:
        """Whether the target is reached, with the lower error everywhere.

        A ratio that is not a number does not reach it.
        """
        return self.ratio >= self.target and not self.lost

    def leaves(self) -> dict[str, str | float | tuple[str, ...]]:
        """Return the row as it is stored."""
        return {name: value for name, value in asdict(self).items() if value not in (None, ())}

    def lines(self) -> list[str]:
        """Return the row as it is printed below HEAD, and what there is to say of it."""
        times = [_time(seconds) for seconds in (self.ours_s, self.peer_s)]
        if self.ours_s is None:
            ratio, target = (f"{100 * value:.5g} %" for value in (self.ratio, self.target))
        else:
            ratio, target = (f"{value:.3g}x" for value in (self.ratio, self.target))
        lines = [f"{self.name:<72}{times[0]:>10}{times[1]:>10}{ratio:>9}{target:>9}"]
        if self.detail is not None:
            lines.append(f"    {self.detail}")
        if self.lost:
            lines.append(f"    lost: the peer's error is lower on {', '.join(self.lost)}")
        return lines


def _time(seconds: float | None) -> str:
    """Return a time with three digits and a prefix."""
    if seconds is None:
        return ""
    rounded = float(f"{seconds:.3g}")
    exponent = next((e for e in _PREFIXES if rounded >= 10.0**e), min(_PREFIXES))
    scaled = rounded / 10.0**exponent
    digits = f"{scaled:.0f}" if scaled >= 100.0 else f"{scaled:.3g}"
    return f"{digits} {_PREFIXES[exponent]}s"
