"""Reading the bench's configuration: every parameter checked for name, unit and range."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from dea.bench.amplifier import Amplifier
from dea.bench.converter import Converter
from dea.bench.membrane import Film
from dea.bench.sensor import Sensor
from dea.errors import InputError


class _Range(NamedTuple):
    """The unit a parameter must be given in and the values that make sense."""

    unit: str
    low: float
    high: float


_FILM = {
    "frame_radius": _Range("m", 1e-3, 1.0),
    "contact_radius": _Range("m", 1e-4, 1.0),
    "thickness": _Range("m", 1e-5, 1e-2),
    "prestretch": _Range("1", 1.0, 6.0),
    "mass": _Range("kg", 1e-5, 1.0),
    "damping": _Range("N s/m", 0.0, 100.0),
    "yeoh_1": _Range("Pa", 1.0, 1e8),
    "yeoh_2": _Range("Pa", -1e8, 1e8),
    "yeoh_3": _Range("Pa", -1e8, 1e8),
    "branch_modulus": _Range("Pa", 0.0, 1e8),
    "branch_time": _Range("s", 0.05, 1e6),
    "permittivity": _Range("1", 1.0, 1e3),
    "electrode_resistance": _Range("Ohm", 1.0, 1e12),
    "leak_resistance": _Range("Ohm", 1e3, 1e18),
    "stiffness_ageing": _Range("1/h", -0.5, 10.0),
    "leakage_ageing": _Range("1/h", -0.5, 1e4),
    "electrode_ageing": _Range("1/h", -0.5, 1e4),
    "pull_in_displacement": _Range("m", 1e-5, 1.0),
    "breakdown_field": _Range("V/m", 1e6, 1e10),
    "rest": _Range("s", 0.0, 1e6),
}
_SECTIONS: dict[str, dict[str, _Range]] = {
    "film": _FILM,
    "amplifier": {
        "gain": _Range("V/V", 1.0, 1e5),
        "output_limit": _Range("V", 1.0, 1e5),
        "slew_rate": _Range("V/s", 1.0, 1e12),
        "current_limit": _Range("A", 1e-9, 10.0),
        "cable_capacitance": _Range("F", 0.0, 1e-6),
        "bandwidth": _Range("Hz", 0.1, 1e6),
    },
    "sensor": {
        "cutoff": _Range("Hz", 0.1, np.inf),
        "noise": _Range("m", 0.0, 1e-2),
        "range_low": _Range("m", -1.0, 1.0),
        "range_high": _Range("m", -1.0, 1.0),
    },
    "output_converter": {"low": _Range("V", -100.0, 100.0), "high": _Range("V", -100.0, 100.0)},
    "displacement_converter": {"low": _Range("mm", -1e3, 1e3), "high": _Range("mm", -1e3, 1e3)},
}
_LISTS = ("branch_modulus", "branch_time")
_ORDERED = (
    ("film", "contact_radius", "frame_radius"),
    ("sensor", "range_low", "range_high"),
    ("output_converter", "low", "high"),
    ("displacement_converter", "low", "high"),
)


@dataclass(frozen=True)
class Parameters:
    """Everything one actuator's bench is made of; ``rest`` in s is the film's age at the start."""

    film: Film
    rest: float
    amplifier: Amplifier
    sensor: Sensor
    output_converter: Converter
    displacement_converter: Converter


def read_parameters(path: Path, actuator: str) -> Parameters:
    """Read what ``actuator`` is made of from the bench configuration at ``path``.

    Raises
    ------
    InputError
        The file cannot be read, a key is misspelt or missing, a unit is another, a value is out of
        range, or there is no such actuator.
    """
    content = _read_content(path)
    actuators = _mapping(content["actuators"], path, "actuators")
    if actuator not in actuators:
        raise InputError(
            f"there is no actuator {actuator!r}",
            file=path,
            field="actuators",
            remedy=f"Name one of {', '.join(actuators)}, or add an entry.",
        )
    values = _read_sections(content, path)
    own = _mapping(actuators[actuator] or {}, path, f"actuators.{actuator}")
    _replace(values["film"], own, "film", path, f"actuators.{actuator}")
    return _assemble(values, path)


def read_plain(path: Path, film: Mapping[str, float] | None = None) -> Parameters:
    """Read the plain actuator of the configuration at ``path``, with values of ``film`` its own.

    Raises
    ------
    InputError
        As :func:`read_parameters`.
    """
    content = _read_content(path)
    values = _read_sections(content, path)
    for section, own in _mapping(content["plain"], path, "plain").items():
        if section not in _SECTIONS:
            raise InputError(
                f"unknown key {section!r}", file=path, field="plain", remedy=_choices(_SECTIONS)
            )
        own = _mapping(own, path, f"plain.{section}")
        _replace(values[section], own, section, path, f"plain.{section}")
    _replace(values["film"], film or {}, "film", path, "film")
    return _assemble(values, path)


def _read_content(path: Path) -> Mapping[str, Any]:
    content = _read_yaml(path)
    _check_keys(content, {*_SECTIONS, "plain", "actuators"}, path, "the bench configuration")
    return content


def _read_sections(content: Mapping[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    return {
        name: _read_section(_mapping(content[name], path, name), name, path) for name in _SECTIONS
    }


def _replace(
    values: dict[str, Any], own: Mapping[str, Any], section: str, path: Path, where: str
) -> None:
    """Put an actuator's own values in the place of a section's."""
    allowed = _SECTIONS[section]
    for key, value in own.items():
        field = f"{where}.{key}"
        if key not in allowed:
            raise InputError(
                f"unknown key {key!r}", file=path, field=field, remedy=_choices(allowed)
            )
        values[key] = _checked(value, allowed[key], key, path, field)


def _assemble(values: dict[str, dict[str, Any]], path: Path) -> Parameters:
    _check_relations(values, path)
    rest = values["film"].pop("rest")
    return Parameters(
        film=Film(**values["film"]),
        rest=rest,
        amplifier=Amplifier(**values["amplifier"]),
        sensor=Sensor(**values["sensor"]),
        output_converter=Converter(**values["output_converter"]),
        displacement_converter=Converter(**values["displacement_converter"]),
    )


def _read_yaml(path: Path) -> Mapping[str, Any]:
    try:
        content = yaml.safe_load(Path(path).read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(
            f"the bench configuration cannot be read: {error}",
            file=path,
            remedy="Name config/bench.yaml or a file written like it.",
        ) from error
    return _mapping(content, path, None)


def _mapping(content: Any, path: Path, field: str | None) -> Mapping[str, Any]:
    if not isinstance(content, Mapping):
        raise InputError(
            f"expected keys and values, found {content!r}",
            file=path,
            field=field,
            remedy="Write it as in config/bench.yaml.",
        )
    return content


def _choices(names: Any) -> str:
    return f"The keys are {', '.join(sorted(names))}."


def _check_keys(content: Mapping[str, Any], expected: Any, path: Path, where: str) -> None:
    for key in [*content, *expected]:
        if (key in content) != (key in expected):
            problem = f"unknown key {key!r}" if key in content else f"missing key {key!r}"
            raise InputError(problem, file=path, field=where, remedy=_choices(expected))


def _read_section(content: Mapping[str, Any], name: str, path: Path) -> dict[str, Any]:
    _check_keys(content, _SECTIONS[name], path, name)
    values = {}
    for key, allowed in _SECTIONS[name].items():
        field = f"{name}.{key}"
        entry = _mapping(content[key], path, field)
        _check_keys(entry, ("value", "unit", "source"), path, field)
        if entry["unit"] != allowed.unit:
            raise InputError(
                f"the unit is {entry['unit']!r}",
                file=path,
                field=f"{field}.unit",
                remedy=f"Give the value in {allowed.unit}.",
            )
        values[key] = _checked(entry["value"], allowed, key, path, field)
    return values


def _checked(value: Any, allowed: _Range, key: str, path: Path, field: str) -> Any:
    is_list = key in _LISTS
    numbers = value if is_list and isinstance(value, list) else [value]
    good = isinstance(value, list) == is_list and all(
        isinstance(number, int | float)
        and not isinstance(number, bool)
        and allowed.low <= number <= allowed.high
        for number in numbers
    )
    if not good:
        kind = "a list of numbers" if is_list else "a number"
        raise InputError(
            f"the value is {value!r}",
            file=path,
            field=field,
            remedy=f"Give {kind} between {allowed.low:g} and {allowed.high:g} {allowed.unit}.",
        )
    return np.array(value, dtype=np.float64) if is_list else float(value)


def _check_relations(values: Mapping[str, Mapping[str, Any]], path: Path) -> None:
    for section, lower, upper in _ORDERED:
        if values[section][lower] >= values[section][upper]:
            raise InputError(
                f"{lower} {values[section][lower]:g} is not below {upper} "
                f"{values[section][upper]:g}",
                file=path,
                field=section,
                remedy=f"Make {lower} the smaller one.",
            )
    if values["film"]["branch_modulus"].shape != values["film"]["branch_time"].shape:
        raise InputError(
            "the branches have different numbers of moduli and time constants",
            file=path,
            field="film.branch_time",
            remedy="Give one time constant for each modulus.",
        )
