"""What the simulation of a system is missing: ``discrepancy`` of config/config.yaml."""

from typing import Annotated

from dea.configuration.section import (
    Count,
    Different,
    NotNegative,
    Number,
    Positive,
    Section,
    Share,
    Whole,
    WholeNotNegative,
    key,
)


class Budget(Section):
    """How far the search goes."""

    finished: Count = key("candidates of a round that are fitted to the end")
    beam: Count = key("leading candidates that the next round builds on")
    effects: Whole = key("effects attached at most", ge=1, le=3)
    room: NotNegative = key(
        "part of the gap that must be left for larger sets to be tried, if it is more than "
        "`rules.further`",
        default=0.0,
    )
    long_room: NotNegative = key(
        "the same for a long record, where trying larger sets takes minutes", default=0.12
    )
    starts: Count = key("starts of the fit of the simulation alone", default=4)
    offered: Count = key(
        "effects that are screened beside another one, those that promise most by a linear step",
        default=8,
    )
    kept: Count = key("fits of one effect that go on after the screening, at least", default=2)
    screening: Count = key("steps of each fit of the screening", default=4)
    first_steps: Count = key("steps of every finished candidate", default=6)
    last_steps: Count = key("further steps of candidates near the leader", default=20)
    tolerance: Positive = key(
        "relative fall of the cost below which a fit of a finished candidate ends", default=1e-4
    )
    near: Number = key("errors of the leader up to which a candidate is near it", default=2.5, ge=1)
    shakes: WholeNotNegative = key(
        "perturbed starts from which the best single effects are fitted again", default=4
    )
    shake_above: Positive = key(
        "residual above which perturbed fits are made", unit="noise floors", default=1.15
    )
    shake_size: Positive = key(
        "standard deviation of the perturbation", unit="prior spreads", default=0.5
    )
    exchanges: WholeNotNegative = key(
        "times that one effect of the best pair is exchanged for another", default=3
    )
    exchange_above: Positive = key(
        "residual above which a pair is exchanged", unit="noise floors", default=1.05
    )
    exchange_misfit: Share = key(
        "part of the best single effect's misfit up to which a pair is exchanged, and its partners "
        "are extended",
        default=0.8,
    )
    exchange_gain: Share = key("part of a pair's error that its exchange may leave", default=0.9)
    restarted: WholeNotNegative = key(
        "leading candidates that are fitted once more from the prior means of the simulation, "
        "if they are ``near`` the best one and it leaves more than ``exchange_above``",
        default=8,
    )
    decimated: Count = key(
        "length below which no record is decimated; one of twice that and more is, where it is "
        "sampled much faster than it moves and than its simulation takes steps",
        unit="samples",
        default=5_000,
    )
    long_record: Count = key(
        "length of a record, before decimation, above which most of this is halved",
        unit="samples",
        default=30_000,
    )


class Rules(Section):
    """When an effect is named."""

    margin: Number = key(
        "part of the held-out error that an effect must remove; twice that of two at once",
        gt=0,
        lt=0.5,
    )
    clean: Positive = key("residual up to which the record counts as explained", unit="floors")
    misfit: Share = key("part of the gap that may remain")
    grow: Positive = key(
        "residual above which a further effect is looked for; several effects may leave more if "
        "each is certain and it is coloured noise",
        unit="floors",
    )
    room: Share = key("part of the gap that is more than the error of a law")
    further: Share = key(
        "part of the gap from which on a further effect is looked for", default=0.03
    )
    second: Share = key("part of the remaining misfit that a further effect must remove")
    rival_margin: Number = key(
        "factor by which a rival's misfit must be larger for it to be beaten; for a set of several"
        " effects, its error",
        ge=1,
    )
    predictable: Share = key(
        "part of the error that a flexible model must leave where nothing else is missing, or what"
        " is left is coloured noise"
    )
    noise_like: Positive = key(
        "residual up to which it counts as noise if nothing reduces it, and up to which a small"
        " drift of the reading counts as noise",
        unit="floors",
        default=1.5,
    )
    negligible: NotNegative = key(
        "misfit below which two candidates are not distinguished",
        unit="noise floors",
        default=0.05,
    )
    near: Number = key(
        "errors of the chosen candidate up to which others are compared with it on blocks that"
        " neither was fitted to",
        default=2.5,
        ge=1,
    )
    law_error: Share = key(
        "part of the gap that the law of a right effect may leave, and that a certain part which "
        "is named with others must remove by itself",
        default=0.05,
    )
    certain: Share = key("presence from which an effect is certain", default=0.9)
    part: Share = key(
        "part of the held-out gap that a certain part must remove, by itself or in the best"
        " explanation that holds it, and an effect that the evidence alone names; also the part of"
        " what the others leave that each of several effects must remove, and the part of the"
        " residual's energy that must be removed for coloured noise that is left to count as noise",
        default=0.5,
    )
    ahead: Share = key(
        "part by which a certain part must leave less misfit than any explanation without its"
        " family",
        default=0.35,
    )
    at_bound: NotNegative = key(
        "log-odds that a parameter at its bound costs the presence of its effect", default=3.0
    )
    shaped: Number = key(
        "probability that the shape of an effect's law is other than expected in one respect",
        default=0.5,
        gt=0,
        lt=1,
    )
    likely: Share = key(
        "presence from which the sentence calls an effect, or a family, likely; one with less is"
        " named only if it leaves only noise and its presence is more than 1 - ``certain``",
        default=0.6,
    )
    certified: Share = key(
        "part of the gap elsewhere from which the certified gap must be removed, too",
        default=0.5,
    )
    upheld: Share = key(
        "part of the share removed elsewhere that must then be removed of the certified gap",
        default=0.4,
    )
    poor: Number = key(
        "certified error over that of a complete simulation, above which the verdict calls a law"
        " too poor",
        default=1.3,
        ge=1,
    )
    detectable: NotNegative = key(
        "sensitivity to an effect, beyond what the simulation's own parameters absorb, below which"
        " the record cannot show it",
        unit="noise deviations",
        default=0.2,
    )


class Discrepancy(Section):
    """What the simulation of a system is missing (docs/discrepancy.md)."""

    simulation: str = key("simulation of the actuators, by name or as a Python file")
    effects: Annotated[list[str], Different] = key(
        "names of the effects offered; all of the catalogue where empty"
    )
    warm_up: NotNegative = key(
        "time at the start of a record that no error counts; no more than 2 % of the record",
        unit="s",
    )
    budget: Budget = key("how far the search goes")
    rules: Rules = key("when an effect is named")


class Split(Section):
    """How a case's record is split for the diagnosis."""

    slowest_time: Positive | None = key(
        "slowest time constant of the device, where better known than simulated",
        unit="s",
        default=None,
    )
    warm_up: NotNegative | None = key(
        "time at the start of each record that no error counts, no more than 2 % of the record;"
        " `discrepancy.warm_up` where it is not given",
        unit="s",
        default=None,
    )
