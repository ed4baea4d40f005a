"""The trial of controllers on the actuators: ``control`` of config/config.yaml."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from dea.configuration.section import (
    LONGEST,
    Duration,
    NotNegative,
    Number,
    Part,
    Positive,
    Section,
    Share,
    key,
    refuse,
)


class Reference(Section):
    """What the displacement is to follow: turns of steps, a sine and noise."""

    shares: Annotated[list[Part], Field(min_length=2, max_length=2)] = key(
        "part used of the range that every minute of the record reaches, as shares of it"
    )
    turn: Positive = key("length of each kind", unit="s")
    hold: Positive = key("time from step to step", unit="s")
    rise: Positive = key("time that a step takes", unit="s")
    frequency: Positive = key("of the sine; noise goes up to twice of it", unit="Hz")

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if not self.shares[0] < self.shares[1]:
            raise refuse("shares", f"they are {self.shares}", "Give the smaller one first.")
        for name, longest in (("rise", "hold"), ("hold", "turn")):
            time, limit = getattr(self, name), getattr(self, longest)
            if time > limit:
                raise refuse(
                    name,
                    f"{time:g} s is longer than {longest}, {limit:g} s",
                    f"Shorten it, or lengthen {longest}.",
                )
        if 2.0 * self.frequency * self.turn < 1.0:
            raise refuse(
                "frequency",
                f"noise up to {2.0 * self.frequency:g} Hz has no period in the {self.turn:g} s of a"
                " turn",
                "Raise it, or lengthen turn.",
            )
        return self


class Adaptation(Section):
    """The online tracker of the controller."""

    forgetting: Share = key("lambda: a memory of 1/(1 - lambda) samples")
    leakage: NotNegative = key(
        "alpha, per sample: the parameters begun with count like alpha/(1 - lambda) samples"
    )
    delta: Positive = key("what those parameters count at the beginning", unit="samples")
    renewal: Positive = key(
        "after this time tracking begins anew from the mean of its parameters", unit="s"
    )


class Control(Section):
    """Controllers tried on the actuators (docs/control.md)."""

    duration: Number = key("time that the reference lasts", unit="s", ge=2, le=LONGEST)
    reference: Reference = key("what the displacement is to follow")
    hold: Duration = key("time at the first voltage before the reference begins", unit="s")
    approach: Duration = key("time of the way to the reference", unit="s")
    rate: Positive = key("largest change of the voltage", unit="V/s")
    horizon: Annotated[int, Field(ge=3)] = key("samples that the inverse looks ahead")
    smoothness: Positive = key("weight of the second differences of the voltage in the inverse")
    integral_time: Positive = key("Ti of the feedback", unit="s")
    filter_time: NotNegative = key("Tf of the feedback, of its low-pass filter", unit="s")
    largest_sensitivity: Number = key("Ms, which every response in the band keeps", gt=1)
    adaptation: Adaptation = key("the online tracker")
