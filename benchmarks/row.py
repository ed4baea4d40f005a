"""A row of the table of benchmarks."""

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Row:
    """What was compared, both times in s, and how the ratio stands against its target."""

    name: str
    ours_s: float
    peer_s: float
    ratio: float
    target: float
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
        return cls(name, ours_s, peer_s, peer_s / ours_s, target, detail, lost)

    @property
    def met(self) -> bool:
        """Whether the target is reached, with the lower error everywhere.

        A ratio that is not a number does not reach it.
        """
        return self.ratio >= self.target and not self.lost

    def leaves(self) -> dict[str, str | float | tuple[str, ...]]:
        """Return the row as it is stored."""
        return {name: value for name, value in asdict(self).items() if value not in (None, ())}
