"""Blind trials: ``trials`` of config/config.yaml."""

from typing import Literal

from dea.configuration.section import Count, Section, Whole, key


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
    count: Whole = key("trials of the campaign", ge=1, le=9999)
    batch: Count = key("trials of one job")
    seeds: Seeds = key("of the sets")
    device: str = key("file of the device description that trials are recorded by")
