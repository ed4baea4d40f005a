"""The virtual actuators: config/bench.yaml, every parameter with its unit and source."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, create_model, model_validator

from dea.configuration.files import read_yaml
from dea.configuration.problems import validated
from dea.configuration.section import Number, NumberOrInfinity, Section, key, partial, refuse

BENCH = "config/bench.yaml"


def _below(section: Section, lower: str, upper: str) -> None:
    low, high = getattr(section, lower), getattr(section, upper)
    if low >= high:
        problem = f"{lower} {low:g} is not below {upper} {high:g}"
        raise refuse("", problem, f"Make {lower} the smaller one.")


Modulus = Annotated[float, Field(ge=0.0, le=1e8, allow_inf_nan=False)]
Time = Annotated[float, Field(ge=0.005, le=1e6, allow_inf_nan=False)]


class Film(Section):
    """The film under its mass, between its electrodes."""

    frame_radius: Number = key("inner radius of the frame", unit="m", ge=1e-3, le=1.0)
    electrode_radius: Number = key(
        "radius of the electrodes, after stretching", unit="m", ge=1e-4, le=1.0
    )
    contact_radius: Number = key("radius of the ball's contact", unit="m", ge=1e-4, le=1.0)
    thickness: Number = key("before stretching", unit="m", ge=1e-5, le=1e-2)
    prestretch: Number = key("equibiaxial stretch in the frame", unit="1", ge=1.0, le=6.0)
    mass: Number = key("mass that the film carries", unit="kg", ge=1e-5, le=1.0)
    damping: Number = key("viscous damping", unit="N s/m", ge=0.0, le=100.0)
    yeoh_1: Number = key("first Yeoh modulus", unit="Pa", ge=1.0, le=1e8)
    yeoh_2: Number = key("second Yeoh modulus", unit="Pa", ge=-1e8, le=1e8)
    yeoh_3: Number = key("third Yeoh modulus", unit="Pa", ge=-1e8, le=1e8)
    branch_modulus: list[Modulus] = key("moduli of the Maxwell branches", unit="Pa")
    branch_time: list[Time] = key("time constants of the Maxwell branches", unit="s")
    permittivity: Number = key("relative permittivity", unit="1", ge=1.0, le=1e3)
    electrode_resistance: Number = key("in series with the film", unit="Ohm", ge=1.0, le=1e12)
    leak_resistance: Number = key("through the film", unit="Ohm", ge=1e3, le=1e18)
    stiffness_ageing: Number = key("relative change of all moduli", unit="1/h", ge=-0.5, le=10.0)
    leakage_ageing: Number = key(
        "relative change of the leakage conductance", unit="1/h", ge=-0.5, le=1e4
    )
    electrode_ageing: Number = key(
        "relative change of the electrode resistance", unit="1/h", ge=-0.5, le=1e4
    )
    pull_in_displacement: Number = key("displacement of collapse", unit="m", ge=1e-5, le=1.0)
    breakdown_field: Number = key("field of dielectric breakdown", unit="V/m", ge=1e6, le=1e10)
    rest: Number = key("between stretching the film and the run", unit="s", ge=0.0, le=1e6)

    @model_validator(mode="after")
    def _relations(self) -> Self:
        _below(self, "contact_radius", "electrode_radius")
        _below(self, "electrode_radius", "frame_radius")
        if len(self.branch_modulus) != len(self.branch_time):
            raise refuse(
                "branch_time",
                "the branches have different numbers of moduli and time constants",
                "Give one time constant for each modulus.",
            )
        return self


class Amplifier(Section):
    """The high-voltage amplifier."""

    gain: Number = key("output over command", unit="V/V", ge=1.0, le=1e5)
    output_limit: Number = key("largest output", unit="V", ge=1.0, le=1e5)
    slew_rate: Number = key("fastest change of the output", unit="V/s", ge=1.0, le=1e12)
    current_limit: Number = key("largest current", unit="A", ge=1e-9, le=10.0)
    cable_capacitance: Number = key("charged besides the film", unit="F", ge=0.0, le=1e-6)
    bandwidth: Number = key("-3 dB, large signal", unit="Hz", ge=0.1, le=1e6)


class Sensor(Section):
    """The displacement sensor."""

    cutoff: NumberOrInfinity = key("of the anti-alias filter; .inf for none", unit="Hz", ge=0.1)
    noise: Number = key("root mean square", unit="m", ge=0.0, le=1e-2)
    range_low: Number = key("lower end of the measuring span", unit="m", ge=-1.0, le=1.0)
    range_high: Number = key("upper end of the measuring span", unit="m", ge=-1.0, le=1.0)

    @model_validator(mode="after")
    def _relations(self) -> Self:
        _below(self, "range_low", "range_high")
        return self


class _Converter(Section):
    """A converter of 16 bits, between the values of its lowest and its highest count."""

    @model_validator(mode="after")
    def _relations(self) -> Self:
        _below(self, "low", "high")
        return self


class OutputConverter(_Converter):
    """The converter of the commanded voltage, 16 bits."""

    low: Number = key("voltage of count 0", unit="V", ge=-100.0, le=100.0)
    high: Number = key("voltage of count 65535", unit="V", ge=-100.0, le=100.0)


class DisplacementConverter(_Converter):
    """The converter of the measured displacement, 16 bits."""

    low: Number = key("displacement of count 0", unit="mm", ge=-1e3, le=1e3)
    high: Number = key("displacement of count 65535", unit="mm", ge=-1e3, le=1e3)


class Plant(Section):
    """Everything one virtual actuator is made of, in the units of its keys."""

    film: Film = key("the film under its mass")
    amplifier: Amplifier = key("the high-voltage amplifier")
    sensor: Sensor = key("the displacement sensor")
    output_converter: OutputConverter = key("converter of the commanded voltage")
    displacement_converter: DisplacementConverter = key("converter of the displacement")


def _sourced(section: type[Section]) -> Any:
    """Return ``section`` with each value in a mapping of ``value``, ``unit`` and ``source``."""
    entries: dict[str, Any] = {}
    for name, field in section.model_fields.items():
        extra = field.json_schema_extra
        assert isinstance(extra, dict)
        entry: dict[str, Any] = {
            "value": (field.annotation, field),
            "unit": (Literal[extra["unit"]], key("unit of the value")),
            "source": (str, key("where the value comes from")),
        }
        model = create_model(f"{section.__name__}_{name}", __base__=Section, **entry)
        entries[name] = (model, key(field.description or name))
    return create_model(f"Sourced{section.__name__}", __base__=Section, **entries)


_SECTIONS: dict[str, type[Section]] = {
    "film": Film,
    "amplifier": Amplifier,
    "sensor": Sensor,
    "output_converter": OutputConverter,
    "displacement_converter": DisplacementConverter,
}
_SomeFilm: Any = partial(Film) | None
_CHANGED: dict[str, Any] = {
    name: (partial(section), key(f"values that replace those of {name}", default={}))
    for name, section in _SECTIONS.items()
}
_FILE: dict[str, Any] = {
    name: (_sourced(section), key((section.__doc__ or name).strip()))
    for name, section in _SECTIONS.items()
} | {
    "plain": (
        create_model("Plain", __base__=Section, **_CHANGED),
        key("the actuator that blind trials hide effects in, where it differs"),
    ),
    "actuators": (
        dict[str, _SomeFilm],
        key("virtual actuators by name, where their film differs"),
    ),
}
BenchFile = create_model("BenchFile", __base__=Section, __doc__="The virtual actuators.", **_FILE)


@dataclass(frozen=True)
class VirtualBench:
    """What each virtual actuator, and the plain one of the blind trials, is made of."""

    actuators: Mapping[str, Plant]
    plain: Plant


def read_bench(path: str | Path) -> VirtualBench:
    """Read config/bench.yaml, or a file like it.

    Raises
    ------
    InputError
        The file cannot be read, a key is misspelt or missing, a unit is another, a value is out of
        range, or values contradict each other.
    """
    content = read_yaml(path, what="the bench configuration", example=BENCH)
    file = validated(BenchFile, content, path).model_dump(exclude_unset=True)
    shared = {
        name: {parameter: entry["value"] for parameter, entry in file[name].items()}
        for name in _SECTIONS
    }
    for name, section in _SECTIONS.items():
        validated(section, shared[name], path, name)
    plain = {
        name: validated(section, shared[name] | file["plain"].get(name, {}), path, f"plain.{name}")
        for name, section in _SECTIONS.items()
    }
    common = Plant.model_validate(shared)
    return VirtualBench(
        actuators={
            name: with_film(common, own or {}, path, f"actuators.{name}")
            for name, own in file["actuators"].items()
        },
        plain=Plant.model_validate(plain),
    )


def served_settings(
    section: Mapping[str, Any], served: str, path: str | Path, bench: VirtualBench
) -> dict[str, Any]:
    """Return the settings of jobs that drive a virtual actuator, and the parameters of its plant.

    They are those of the ``section`` of the study; ``path`` is the file that ``bench`` was read
    from.
    """
    plant = bench.actuators[served].model_dump()
    return {**section, "actuator": served, "config": str(path), "plant": plant}


def plain_settings(path: str | Path, bench: VirtualBench) -> dict[str, Any]:
    """Return the settings of jobs that depend on the plain actuator of ``bench`` alone.

    ``path`` is the file that it was read from.
    """
    return {"config": str(path), "plain": bench.plain.model_dump()}


def with_film(plant: Plant, values: Mapping[str, Any], path: str | Path, place: str) -> Plant:
    """Return ``plant`` with ``values`` of its film; ``place`` is where ``path`` has them.

    Raises
    ------
    InputError
        If a name or value is wrong.
    """
    film = validated(Film, plant.film.model_dump() | dict(values), path, place)
    return plant.model_copy(update={"film": film})
