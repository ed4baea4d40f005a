"""A trial with its seal open: what was hidden, what was said, and what that is worth."""

from typing import NamedTuple

from dea.trials.outcome import Label, Said

# The parameter of a verdict that estimates the hidden value of an effect and a meaning. Values
# whose laws have no such parameter, or one that means something else, are not compared.
COUNTERPARTS = {
    ("dead_zone", "threshold"): "threshold",
    ("input_saturation", "limit"): "limit",
    ("output_saturation", "limit"): "upper_end",
    ("backlash", "gap"): "gap",
    ("slew_limit", "rate"): "rate",
    ("transport_delay", "delay"): "delay",
    ("second_mode", "frequency"): "frequency",
    ("periodic_disturbance", "frequency"): "frequency",
    ("step_fault", "time"): "instant",
}


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
