"""What the simulation of a system is missing: ``discrepancy`` of config/config.yaml."""

from dea.configuration.section import Count, NotNegative, Positive, Section, Share, Whole, key


class Budget(Section):
    """How far the search goes."""

    finished: Count = key("candidates of a round that are fitted to the end")
    beam: Count = key("candidates that the next round builds on")
    effects: Whole = key("effects attached at most", ge=1, le=3)


class Rules(Section):
    """When an effect is named."""

    margin: Positive = key("part of the held-out error that an effect must remove")
    clean: Positive = key(
        "residual up to which the record counts as explained", unit="noise floors"
    )
    misfit: Share = key("part of the nominal misfit that may remain")
    further: Share = key("factor on it for each effect beyond the first")
    grow: Positive = key("residual above which a further effect is looked for", unit="noise floors")
    second: Share = key("part of the remaining misfit that a further effect must remove")
    rival_margin: Positive = key("factor by which a beaten rival's misfit is larger")
    predictable: Share = key("part of the error that a flexible model must leave")


class Discrepancy(Section):
    """What the simulation of a system is missing (docs/discrepancy.md)."""

    simulation: str = key("simulation of the actuators, by name or as a Python file")
    effects: list[str] = key("names of the effects offered; all of the catalogue where empty")
    warm_up: NotNegative = key("time at the start of a record that no error counts", unit="s")
    budget: Budget = key("how far the search goes")
    rules: Rules = key("when an effect is named")


class Split(Section):
    """How a case's record is split for the diagnosis."""

    slowest_time: NotNegative | None = key(
        "slowest time constant of the device, where better known than simulated",
        unit="s",
        default=None,
    )
    warm_up: NotNegative | None = key(
        "time at the start of the record that no error counts; `discrepancy.warm_up` where it is"
        " not given",
        unit="s",
        default=None,
    )
