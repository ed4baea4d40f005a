"""A row of the table of benchmarks, and the table as the documents quote it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

from benchmarks.markdown import markdown

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
    cases: Mapping[str, str] = field(default_factory=dict)  # what was found for each of several

    @classmethod
    def of_times(
        cls,
        name: str,
        ours_s: float,
        peer_s: float,
        target: float,
        detail: str | None = None,
        lost: tuple[str, ...] = (),
        cases: Mapping[str, str] | None = None,
    ) -> "Row":
        """Return the row whose ratio says how many times faster ours is."""
        return cls(name, peer_s / ours_s, target, ours_s, peer_s, detail, lost, cases or {})

    @property
    def met(self) -> bool:
        """Whether the target is reached, with the lower error everywhere.

        A ratio that is not a number does not reach it.
        """
        return self.ratio >= self.target and not self.lost

    def leaves(self) -> dict[str, object]:
        """Return the row as it is stored."""
        return {name: value for name, value in asdict(self).items() if value not in (None, (), {})}

    def numbers(self) -> tuple[str, str, str, str]:
        """Return both times, the ratio and its target, as they are printed."""
        if self.ours_s is None:
            ratio, target = (f"{100 * value:.5g} %" for value in (self.ratio, self.target))
        else:
            ratio, target = (f"{value:.3g}x" for value in (self.ratio, self.target))
        return _time(self.ours_s), _time(self.peer_s), ratio, target

    def lines(self) -> list[str]:
        """Return the row as it is printed below HEAD, and what there is to say of it."""
        ours, theirs, ratio, target = self.numbers()
        lines = [f"{self.name:<72}{ours:>10}{theirs:>10}{ratio:>9}{target:>9}"]
        if self.detail is not None:
            lines.append(f"    {self.detail}")
        if self.cases:
            lines.append("    " + ", ".join(f"{name} {said}" for name, said in self.cases.items()))
        if self.lost:
            lines.append(f"    lost: the peer's error is lower on {', '.join(self.lost)}")
        return lines


def table(rows: Sequence[Row]) -> list[str]:
    """Return the lines of a table of all rows in Markdown."""

    def missed(row: Row) -> str:
        what = ["the target"] if not row.ratio >= row.target else []
        return ", ".join([*what, *(f"a lower error on {name}" for name in row.lost)])

    return markdown(
        ["what", "ours", "peer", "ratio", "target", "missed"],
        ([row.name, *row.numbers(), missed(row)] for row in rows),
    )


def table_of_cases(rows: Sequence[Row]) -> list[str]:
    """Return the same of what was found for each case, of the rows that have some."""
    rows = [row for row in rows if row.cases]
    names = list(dict.fromkeys(name for row in rows for name in row.cases))
    return markdown(
        ["what", *names], ([row.name, *(row.cases.get(k, "") for k in names)] for row in rows)
    )


def _time(seconds: float | None) -> str:
    """Return a time with three digits and a prefix."""
    if seconds is None:
        return ""
    rounded = float(f"{seconds:.3g}")
    exponent = next((e for e in _PREFIXES if rounded >= 10.0**e), min(_PREFIXES))
    scaled = rounded / 10.0**exponent
    digits = f"{scaled:.0f}" if scaled >= 100.0 else f"{scaled:.3g}"
    return f"{digits} {_PREFIXES[exponent]}s"
