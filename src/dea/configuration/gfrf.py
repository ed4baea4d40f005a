"""Frequency responses over time: ``gfrf`` of config/config.yaml."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from dea.configuration.section import Count, Number, Part, Section, Share, Whole, key, refuse

# Frequencies beyond half the sampling rate repeat those below.
HALF = 0.5


class Gfrf(Section):
    """Frequency responses over time (docs/method/frequency.md).

    Frequencies are shares of the sampling rate, so that they suit a record of any rate.
    """

    tracker: Literal["rls", "kalman", "output_error", "local"] = key(
        "the tracker whose parameters are turned into responses"
    )
    instants: Count = key("number of times at which H1 is taken")
    lowest: Number = key("first frequency of H1", gt=0, le=HALF)
    highest: Number = key("last frequency of H1", gt=0, le=HALF)
    count: Whole = key("frequencies of H1, in equal ratios", ge=2)
    plane_highest: Number = key("highest frequency of H2 and H3", gt=0, le=HALF)
    plane_count: Whole = key("frequencies of H2 and H3 each way", ge=2)
    plane_times: Annotated[list[Part], Field(min_length=1)] = key(
        "times of H2 and H3, as shares of the record"
    )
    third_frequency: Number = key("f3 of H3(f1, f2, f3)", gt=0, le=HALF)
    excited_above: Share = key(
        "share of the largest power density above which the input excites a frequency"
    )

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if not self.lowest < self.highest:
            raise refuse(
                "lowest",
                f"{self.lowest:g} is not below highest, {self.highest:g}",
                "Make lowest the smaller one.",
            )
        return self
