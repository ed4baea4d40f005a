"""Reading the bench's configuration: every parameter checked for name, unit and range."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from dea.errors import InputError
from dea.plant.amplifier import Amplifier
from dea.plant.converter import Converter
from dea.plant.film import Film
from dea.plant.ranges import LISTS, ORDERED, SECTIONS, Range
from dea.plant.sensor import Sensor


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
        if section not in SECTIONS:
            raise InputError(
                f"unknown key {section!r}", file=path, field="plain", remedy=_choices(SECTIONS)
            )
        own = _mapping(own, path, f"plain.{section}")
        _replace(values[section], own, section, path, f"plain.{section}")
    _replace(values["film"], film or {}, "film", path, "film")
    return _assemble(values, path)


def _read_content(path: Path) -> Mapping[str, Any]:
    content = _read_yaml(path)
    _check_keys(content, {*SECTIONS, "plain", "actuators"}, path, "the bench configuration")
    return content


def _read_sections(content: Mapping[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    return {
        name: _read_section(_mapping(content[name], path, name), name, path) for name in SECTIONS
    }


def _replace(
    values: dict[str, Any], own: Mapping[str, Any], section: str, path: Path, where: str
) -> None:
    """Put an actuator's own values in the place of a section's."""
    allowed = SECTIONS[section]
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
    _check_keys(content, SECTIONS[name], path, name)
    values = {}
    for key, allowed in SECTIONS[name].items():
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


def _checked(value: Any, allowed: Range, key: str, path: Path, field: str) -> Any:
    is_list = key in LISTS
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
    for section, lower, upper in ORDERED:
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
