"""The parameters of a virtual actuator, from the models of config/bench.yaml."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dea.configuration.bench import Plant, read_bench, with_film
from dea.configuration.section import Section
from dea.errors import InputError
from dea.plant.amplifier import Amplifier
from dea.plant.converter import Converter
from dea.plant.membrane import Film
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
    actuators = read_bench(path).actuators
    if actuator not in actuators:
        raise InputError(
            f"there is no actuator {actuator!r}",
            file=path,
            field="actuators",
            remedy=f"Name one of {', '.join(actuators)}, or add an entry.",
        )
    return _parameters(actuators[actuator])


def read_plain(path: Path, film: Mapping[str, float] | None = None) -> Parameters:
    """Read the plain actuator of the configuration at ``path``, with values of ``film`` its own.

    Raises
    ------
    InputError
        As :func:`read_parameters`.
    """
    return _parameters(with_film(read_bench(path).plain, film or {}, path, "film"))


def _parameters(plant: Plant) -> Parameters:
    film = _values(plant.film)
    rest = film.pop("rest")
    return Parameters(
        film=Film(**film),
        rest=rest,
        amplifier=Amplifier(**_values(plant.amplifier)),
        sensor=Sensor(**_values(plant.sensor)),
        output_converter=Converter(**_values(plant.output_converter)),
        displacement_converter=Converter(**_values(plant.displacement_converter)),
    )


def _values(section: Section) -> dict[str, Any]:
    """Return the values as floats: compiled functions would be compiled again for an integer."""
    return {
        name: np.array(value, dtype=np.float64) if isinstance(value, list) else float(value)
        for name, value in section
    }
