"""Extended simulations as files: they load and simulate without the record they came from."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from dea.configuration.files import read_yaml
from dea.errors import InputError
from dea.simulation.attached import Attached
from dea.simulation.effects import catalogue
from dea.simulation.extended import ExtendedSimulation
from dea.simulation.loading import load_simulation
from dea.simulation.normalisation import Normalisation
from dea.simulation.scales import Scales
from dea.simulation.simulation import Simulation


def save_extended(
    extended: ExtendedSimulation, values: np.ndarray, interval: float, path: str | Path
) -> None:
    """Write the simulation, its effects and all parameter values as YAML.

    Raises
    ------
    InputError
        If the simulation, unchanged, is neither of a file nor one that comes with the library.
    """
    import yaml

    from dea.store import atomic

    own = extended.simulation
    if not own.source and not _comes_with_the_library(own):
        raise InputError(
            f"the simulation {own.name} was made or changed in memory, and could not be loaded",
            file=path,
            field="simulation",
            remedy="Define it in a Python file, and load it by its path.",
        )
    content = {
        "simulation": own.source or own.name,
        "input_interpolation": extended.simulation.input_interpolation,
        "interval": float(interval),
        "substeps": extended.substeps,
        "normalisations": [
            {key: float(value) for key, value in asdict(each).items()}
            for each in extended.normalisations
        ],
        "effects": [
            {
                "name": a.effect.name,
                "port": str(a.effect.port),
                "place": a.place,
                "upstream": a.upstream,
                "scales": _plain(asdict(a.scales)),
            }
            for a in extended.attached
        ],
        "parameters": {
            p.name: {"value": float(value), "unit": p.unit}
            for p, value in zip(extended.layout.parameters, values, strict=True)
        },
    }
    with atomic(Path(path)) as partial:
        partial.write_text(yaml.safe_dump(content, sort_keys=False))


def _comes_with_the_library(simulation: Simulation) -> bool:
    try:
        own = load_simulation(simulation.name)
    except InputError:
        return False
    # What the input does between samples is saved.
    return own.interpolated(simulation.input_interpolation) == simulation


def load_extended(path: str | Path) -> tuple[ExtendedSimulation, np.ndarray, float]:
    """Read an extended simulation; return it with its parameter values and interval (s).

    Raises
    ------
    InputError
        If the file cannot be read, is no extended simulation, or names an unknown effect or
        parameter.
    """
    file = Path(path)
    content = read_yaml(
        file, what="the extended simulation", example="a file that a diagnosis has saved"
    )
    try:
        effects = content["effects"]
        unknown = sorted({e["name"] for e in effects} - set(catalogue()))
        if unknown:
            raise InputError(
                f"there is no effect {unknown[0]!r}",
                file=file,
                field="effects",
                remedy=f"Known are {', '.join(catalogue())}",
            )
        attached = tuple(
            Attached(
                catalogue()[e["name"]], Scales(**_tuples(e["scales"])), e["place"], e["upstream"]
            )
            for e in effects
        )
        extended = ExtendedSimulation(
            load_simulation(content["simulation"]).interpolated(content["input_interpolation"]),
            attached,
            tuple(Normalisation(**each) for each in content["normalisations"]),
            content["substeps"],
        )
        values = [_value_of(name, content["parameters"], file) for name in extended.layout.names]
        return extended, np.array(values), float(content["interval"])
    except InputError:
        raise
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"it is no extended simulation ({type(error).__name__}: {error})",
            file=file,
            remedy="Make it again with `dea.diagnose` or the rule diagnose",
        ) from error


def _value_of(name: str, parameters: Mapping[str, Any], file: Path) -> float:
    """Return the value that a file gives a parameter."""
    field = f"parameters.{name}"
    if name not in parameters:
        raise InputError(
            f"it has no value of {name}, which this version of the law has",
            file=file,
            field=field,
            remedy="Make it again with `dea.diagnose` or the rule diagnose",
        )
    value = parameters[name]["value"]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(
            f"it is {value!r}",
            file=file,
            field=f"{field}.value",
            remedy="Give a number; YAML takes 5e0 for text, and 5.0e+0 for a number",
        )
    return float(value)


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    def plain(value: Any) -> Any:
        if isinstance(value, tuple):
            return [float(each) for each in value]
        return value if isinstance(value, bool | str) else float(value)

    return {key: plain(value) for key, value in values.items()}


def _tuples(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key: tuple(v) if isinstance(v, list) else v for key, v in values.items()}
