"""config/config.yaml as a whole, and what its sections must agree on."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from dea.configuration.acquisition import Acquisition, Actuator, Bench
from dea.configuration.confirmation import Confirmation
from dea.configuration.control import Control
from dea.configuration.discrepancy import Discrepancy
from dea.configuration.excitation import Excitation
from dea.configuration.figures import Figures
from dea.configuration.gfrf import Gfrf
from dea.configuration.identification import (
    ROUNDING,
    Forecast,
    Identification,
    Orders,
    Validation,
)
from dea.configuration.problems import did_you_mean, validated
from dea.configuration.recovery import Recovery
from dea.configuration.resolution import Resolution
from dea.configuration.section import Section, Whole, key, refuse
from dea.configuration.tracking import Tracking
from dea.configuration.trials import Trials
from dea.errors import InputError

FILE = "config/config.yaml"
# Folders of results/ that belong to no system.
RESERVED = (
    "benchmark", "discrepancy", "figures", "log", "provenance", "resolve", "tables", "trials",
)  # fmt: skip


class Study(Section):
    """Every number of the study that a user may change."""

    seed: Whole = key("every random draw derives from it and the job's own name", ge=0)
    actuators: Annotated[list[Actuator], Field(min_length=1)] = key("the systems under study")
    excitation: Excitation = key("the voltages played")
    acquisition: Acquisition = key("how an actuator is driven and recorded")
    bench: Bench = key("virtual actuators alone")
    identification: Identification = key("linear and NARX models")
    orders: Orders = key("comparison of orders")
    validation: Validation = key("windows of comparison")
    forecast: Forecast = key("errors of forecasts beside those of simpler models")
    recovery: Recovery = key("published models identified from their own records")
    figures: Figures = key("how figures are drawn")
    tracking: Tracking = key("parameters that change with time")
    gfrf: Gfrf = key("frequency responses over time")
    confirmation: Confirmation = key("frequency responses measured without a model")
    control: Control = key("controllers tried on the actuators")
    trials: Trials = key("blind trials")
    discrepancy: Discrepancy = key("what the simulation of a system is missing")
    resolution: Resolution = key(
        "designed records that leave one explanation", default=Resolution()
    )

    @model_validator(mode="after")
    def _names(self) -> Self:
        taken = set(RESERVED)
        for index, actuator in enumerate(self.actuators):
            if actuator.name in taken:
                raise refuse(
                    f"actuators[{index}].name",
                    f"{actuator.name!r} is taken",
                    "Give each actuator and case another name.",
                )
            taken.add(actuator.name)
        return self

    @model_validator(mode="after")
    def _inside_the_record(self) -> Self:
        duration = self.excitation.record.duration
        windows = {f"validation.windows[{i}]": w for i, w in enumerate(self.validation.windows)}
        for place, (first, last) in {"figures.zoom": self.figures.zoom, **windows}.items():
            if not 0 <= first < last <= duration:
                raise refuse(
                    place,
                    f"[{first:g}, {last:g}] s lies outside the record of {duration:g} s"
                    " (excitation.record.duration)",
                    "Give the first and last second of a stretch inside the record.",
                )
        segment = self.identification.start + self.identification.length
        # Independent data begin after the segment unless it is said where.
        independent = segment if self.orders.start is None else self.orders.start
        if independent < segment - ROUNDING:
            raise refuse(
                "orders.start",
                f"{independent:g} s lies before the end of the segment that models are identified"
                f" from, {segment:g} s",
                "Begin the independent data later, or leave it out.",
            )
        for section, end in (
            ("identification", segment),
            ("orders", independent + self.orders.length),
        ):
            if end > duration + ROUNDING:
                raise refuse(
                    f"{section}.length",
                    f"the segment ends at {end:g} s, after the record of {duration:g} s"
                    " (excitation.record.duration)",
                    "Choose a segment inside the record.",
                )
        return self

    @model_validator(mode="after")
    def _forecast_inside_the_record(self) -> Self:
        end, duration = (
            self.forecast.start + self.forecast.horizons[-1],
            (self.excitation.record.duration),
        )
        if end > duration + ROUNDING:
            raise refuse(
                "forecast.start",
                f"the first forecast ends at {end:g} s, after the record of {duration:g} s"
                " (excitation.record.duration)",
                "Begin earlier, or take shorter horizons.",
            )
        return self

    @model_validator(mode="after")
    def _probing_inside_the_record(self) -> Self:
        probing, duration = self.excitation.probing, self.excitation.record.duration
        if probing is None:
            return self
        ends = [*sorted(probing.times)[1:], duration]
        for begin, end in zip(sorted(probing.times), ends, strict=True):
            if begin + probing.duration > end + ROUNDING:
                raise refuse(
                    "excitation.probing.times",
                    f"the stretch from {begin:g} s on, {probing.duration:g} s long, does not end"
                    f" before {end:g} s, where the next or the record does",
                    "Leave room for each, or shorten them.",
                )
        return self

    @model_validator(mode="after")
    def _probing_inside_the_band(self) -> Self:
        band, probing = getattr(self.excitation.record, "band", None), self.excitation.probing
        if band is not None and probing is not None and probing.lowest > band:
            raise refuse(
                "excitation.probing.lowest",
                f"{probing.lowest:g} Hz lies above the band of the record, {band:g} Hz, where alone"
                " models are identified",
                "Lower it, or raise excitation.record.band.",
            )
        return self

    @model_validator(mode="after")
    def _tracker_runs(self) -> Self:
        check_tracker(self.gfrf, self.tracking)
        return self


def check_tracker(gfrf: Gfrf, tracking: Tracking) -> None:
    """Raise the error of a validator unless the tracker of the responses is one that runs."""
    if gfrf.tracker not in tracking.trackers.names:
        raise refuse(
            "gfrf.tracker",
            f"{gfrf.tracker!r} is not among tracking.trackers",
            f"Use one of {', '.join(tracking.trackers.names)}, or add it there.",
        )


def check_study(content: Mapping[str, Any]) -> Study:
    """Return the checked content of config/config.yaml.

    Raises
    ------
    InputError
        Naming the file, the key and the remedy.
    """
    return validated(Study, content, FILE)


def check_simulation(name: str, known: Collection[str], file: str | Path, field: str) -> None:
    """Check the name of a simulation: one of ``known``, or a Python file.

    Raises
    ------
    InputError
        Naming the file, the key and the remedy.
    """
    if name in known or (name.endswith(".py") and Path(name).is_file()):
        return
    raise InputError(
        f"there is no file {name!r}"
        if name.endswith(".py")
        else f"there is no simulation {name!r}",
        file=file,
        field=field,
        remedy=f"{did_you_mean(name, known)}Name one of {', '.join(known)}, or a Python file that"
        " defines `simulation`.",
    )


def check_names(study: Study, simulations: Collection[str], effects: Collection[str]) -> None:
    """Check the names of the simulation and of the effects offered.

    Raises
    ------
    InputError
        Naming the key and the nearest name.
    """
    check_simulation(study.discrepancy.simulation, simulations, FILE, "discrepancy.simulation")
    for index, name in enumerate(study.discrepancy.effects):
        if name not in effects:
            raise InputError(
                f"there is no effect {name!r}",
                file=FILE,
                field=f"discrepancy.effects[{index}]",
                remedy=f"{did_you_mean(name, effects)}Known: {', '.join(effects)}.",
            )


def settings(section: Section) -> dict[str, Any]:
    """Return a section as it was written, its numbers no longer text.

    Defaults are left out, and so are nulls, which say that an optional key is not given.
    """
    return section.model_dump(exclude_unset=True, exclude_none=True)
