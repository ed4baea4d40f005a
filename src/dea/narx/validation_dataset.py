"""Runs of models on windows, with their scores and residual tests, as labelled data."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea.arrays import Array
from dea.store import Text, each_text, variable
from dea.units import power

_RUN = ("model", "approach", "window")
_OVER = ("window", "sample")
_Variable = tuple[tuple[str, ...], NDArray[Any], str, str]  # dimensions, values, units, label


class Validated(NamedTuple):
    """What each model does by each approach on each window."""

    simulated: Array  # (models, approaches, windows, samples)
    scores: Mapping[str, Array]  # (models, approaches, windows) by name
    correlation: Array  # (models, approaches, windows, tests, lags)
    tested: Array  # the same, of the signals of the joint tests
    p_value: Array  # (models, approaches, windows, tests)
    explained: Array  # as the p-values
    band: float  # half-width of the 95 % band of the correlation
    verdicts: list[str]  # (models,)


class Measured(NamedTuple):
    """The windows of the record; ``inputs`` are the names of several inputs."""

    time: Array  # (windows, samples) s
    input: Array  # (windows, samples) or (windows, samples, inputs)
    output: Array  # (windows, samples), NaN where it is missing
    units: tuple[Text, str]
    inputs: list[str]


def validation_dataset(
    measured: Measured, found: Validated, coordinates: Mapping[str, NDArray[Any]]
) -> xr.Dataset:
    """Return the dataset that ``validation.nc`` holds.

    Parameters
    ----------
    coordinates
        Of ``model``, ``approach``, ``test`` and ``lag``.
    """
    u_units, y_units = measured.units
    of_inputs = ", ".join(dict.fromkeys(each_text(u_units)))
    score_units = {"rmse": y_units, "fpe": power(y_units, 2)}
    several = measured.input.ndim == 3
    tests = (*_RUN, "test")
    variables: dict[str, _Variable] = {
        "time": (_OVER, measured.time, "s", "time"),
        "input": ((*_OVER, *["signal"] * several), measured.input, of_inputs, "input"),
        "measured": (_OVER, measured.output, y_units, "measured output"),
        "simulated": (
            ("model", "approach", *_OVER), found.simulated, y_units, "free-run simulation"
        ),
        **{
            name: (_RUN, values, score_units.get(name, "1"), name)
            for name, values in found.scores.items()
        },
        "correlation": (
            (*tests, "lag"), found.correlation, "1",
            "correlation coefficient of the free run's residual",
        ),
        "tested_correlation": (
            (*tests, "lag"), found.tested, "1",
            "correlation coefficient that a joint test is of: but in phi_ee, of the whitened"
            " residual",
        ),
        "band": (
            ("test",), np.full(coordinates["test"].size, found.band), "1",
            "half-width of the 95 % band",
        ),
        "p_value": (
            tests, found.p_value, "1",
            "probability of as much in a residual without that relation, all lags together",
        ),
        "explained": (
            tests, found.explained, "1",
            "share of the whitened residual's power that all lags explain",
        ),
        "verdict": (
            ("model",), np.array(found.verdicts), "1", "what the residuals of forecasts hold"
        ),
    }  # fmt: skip
    along: dict[str, NDArray[Any]] = {"signal": np.array(measured.inputs)} if several else {}
    along |= {"model": coordinates["model"], "approach": coordinates["approach"]}
    along |= {"window": np.arange(len(measured.time))}
    along |= {"test": coordinates["test"], "lag": coordinates["lag"]}
    return xr.Dataset(
        {name: variable(*each) for name, each in variables.items()},
        coords={name: variable(name, values, "1", name) for name, values in along.items()},
    )
