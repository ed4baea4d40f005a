"""config/config.yaml as a whole, and what its sections must agree on."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from dea.configuration.acquisition import Acquisition, Actuator, Bench
from dea.configuration.control import Control
from dea.configuration.device import DeviceDescription
from dea.configuration.discrepancy import Discrepancy
from dea.configuration.excitation import Excitation
from dea.configuration.figures import Figures
from dea.configuration.files import read_yaml
from dea.configuration.gfrf import Gfrf
from dea.configuration.identification import Forecast, Identification, Orders, Validation
from dea.configuration.problems import did_you_mean, validated
from dea.configuration.recovery import Recovery
from dea.configuration.register import NEEDED
from dea.configuration.resolution import Resolution
from dea.configuration.safety import refuse_unkept_heartbeat
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
        for section, end in (
            ("identification", segment),
            ("orders", independent + self.orders.length),
        ):
            if end > duration:
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
        if end > duration:
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
            if begin + probing.duration > end:
                raise refuse(
                    "excitation.probing.times",
                    f"the stretch from {begin:g} s on, {probing.duration:g} s long, does not end"
                    f" before {end:g} s, where the next or the record does",
                    "Leave room for each, or shorten them.",
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


def check_study(content: Mapping[str, Any], file: str | Path = FILE) -> Study:
    """Return the checked content of config/config.yaml.

    Raises
    ------
    InputError
        Naming the file, the key and the remedy.
    """
    return validated(Study, content, file)


def check_actuators(
    study: Study, served: Sequence[str], bench: str | Path, file: str | Path = FILE
) -> None:
    """Check every device description, and that ``bench`` has every virtual actuator.

    Raises
    ------
    InputError
        Naming the actuator and the names in ``served`` that its ``bench`` may be, or what is wrong
        with a device description.
    """
    devices = {
        f"actuators[{index}].device": actuator.device
        for index, actuator in enumerate(study.actuators)
    } | {"trials.device": study.trials.device}
    for place, device in devices.items():
        _require_file(device, file, place, "copy a description of config/devices there")
    for device in dict.fromkeys(devices.values()):
        content = read_yaml(
            device, what="the device description", example="one of config/devices/*.yaml"
        )
        described = validated(DeviceDescription, content, device)
        for name in NEEDED:
            if name not in described.registers:
                raise InputError(
                    f"there is no register {name!r}",
                    file=device,
                    field="registers",
                    remedy="Describe it, or correct the name of the register that is meant.",
                )
        refuse_unkept_heartbeat(
            described.safety, study.acquisition.mode, described.sampling_rate, device
        )
    for index, actuator in enumerate(study.actuators):
        if actuator.bench is not None and actuator.bench not in served:
            raise InputError(
                f"{actuator.name} is to be {actuator.bench!r}, which {bench} does not have",
                file=file,
                field=f"actuators[{index}].bench",
                remedy=f"Name one of {', '.join(served)}, or add an entry there.",
            )


def check_files(study: Study, file: str | Path = FILE) -> None:
    """Check that there is every other file that the study names.

    Raises
    ------
    InputError
        Naming the key.
    """
    _require_file(
        study.recovery.models, file, "recovery.models", "name config/published_models.yaml"
    )


def _require_file(named: str, file: str | Path, field: str, remedy: str) -> None:
    if not Path(named).is_file():
        raise InputError(
            f"there is no file {named!r}",
            file=file,
            field=field,
            remedy=f"Correct the path, or {remedy}.",
        )


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


def check_names(
    study: Study, simulations: Collection[str], effects: Collection[str], file: str | Path = FILE
) -> None:
    """Check the names of the simulation and of the effects offered.

    Raises
    ------
    InputError
        Naming the key and the nearest name.
    """
    check_simulation(study.discrepancy.simulation, simulations, file, "discrepancy.simulation")
    for index, name in enumerate(study.discrepancy.effects):
        if name not in effects:
            raise InputError(
                f"there is no effect {name!r}",
                file=file,
                field=f"discrepancy.effects[{index}]",
                remedy=f"{did_you_mean(name, effects)}Known: {', '.join(effects)}.",
            )


def settings(section: Section) -> dict[str, Any]:
    """Return a section as it was written, its numbers no longer text.

    Defaults are left out, and so are nulls, which say that an optional key is not given.
    """
    return section.model_dump(exclude_unset=True, exclude_none=True)
