"""Blind trials: ``trials`` of config/config.yaml."""

from typing import Literal, Self

from pydantic import model_validator

from dea.configuration.section import Count, Section, Whole, key, refuse

# Numbers have four digits.
_LAST = 9999


class Seeds(Section):
    """A seed for each set of trials."""

    tuning: Whole = key("seed of the tuning set", ge=0)
    reporting: Whole = key("seed of the reporting set", ge=0)
    ambiguous: Whole = key("seed of the ambiguous set, for reporting", ge=0)
    ambiguous_tuning: Whole = key("seed of the ambiguous set, for tuning", ge=0)


class Trials(Section):
    """Blind trials (docs/trials.md); a trial follows from its set's seed and its number alone."""

    set: Literal["tuning", "reporting", "ambiguous", "ambiguous_tuning"] = key(
        "tuning, to improve the diagnosis on; reporting, to judge it by; ambiguous ones leave "
        "rivals open on one record"
    )
    first: Whole = key("number of the campaign's first trial", ge=0, le=_LAST)
    count: Whole = key("trials of the campaign", ge=1, le=_LAST)
    batch: Count = key("trials of one job")
    seeds: Seeds = key("of the sets")
    device: str = key("file of the device description that trials are recorded by")

    @model_validator(mode="after")
    def _numbered(self) -> Self:
        last = self.first + self.count - 1
        if last > _LAST:
            raise refuse(
                "count",
                f"the last trial would be number {last}, beyond {_LAST}",
                "Take fewer trials, or earlier ones.",
            )
        return self
