"""A trial with its seal open: what was hidden, what was said, and what that is worth."""

from typing import NamedTuple

from dea.trials.outcome import Label, Said

# A hidden value of that meaning, and the parameter of a verdict that estimates the same.
COUNTERPARTS: dict[tuple[str, str], str] = {}


class Opened(NamedTuple):
    """A trial with its seal open."""

    name: str
    label: Label
    said: Said
    kind: str
    outcome: str

    @property
    def covered(self) -> list[bool]:
        """Whether each defining value with a counterpart lies in the verdict's 95 % interval."""
        inside = []
        for (effect, meaning), value in self.label.defining.items():
            interval = self.said.intervals.get((effect, COUNTERPARTS.get((effect, meaning), "")))
            if interval is not None:
                inside.append(interval[0] <= value <= interval[1])
        return inside
