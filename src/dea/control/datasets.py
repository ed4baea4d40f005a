"""What controllers did that were tried on an actuator, as a dataset."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from dea.arrays import Array
from dea.control.design import ControllerDesign
from dea.control.trial import Followed
from dea.store import MINUTE, Described, variable

_LOST = 2.0  # quality where a controller was stopped


def control_dataset(
    found: Mapping[str, Followed], design: ControllerDesign, u_units: str, y_units: str
) -> xr.Dataset:
    """Return how well each controller followed the reference of a design, after the run-in.

    ``found`` holds what came of each by its name. Measured output and voltage are missing where a
    controller was stopped.
    """
    lead = sum(design.task.run_in)
    reference = design.task.reference[lead:]
    size = reference.size
    trials = list(found.values())
    schemes = [trial.scheme for trial in trials]
    gains = [scheme.gains for scheme in schemes]

    def recorded(name: str, missing: float) -> Array:
        nothing = np.full(size, missing)
        records = [trial.record for trial in trials]
        return np.array([nothing if r is None else r[name].values[lead:] for r in records])

    def over_time(values: np.ndarray, units: str, long_name: str) -> Described:
        return variable(("controller", "time"), values, units, long_name)

    def of_each(values: Sequence[Any], units: str, long_name: str) -> Described:
        return variable("controller", _as_array(values), units, long_name)

    measured = recorded("displacement", np.nan)
    quality = recorded("quality", _LOST).astype(np.uint8)
    rms = _by_minute(measured - reference, design.sampling_rate)
    return xr.Dataset(
        {
            "reference": variable("time", reference, y_units, "displacement wanted"),
            "measured": over_time(measured, y_units, "displacement"),
            "voltage": over_time(recorded("voltage", np.nan), u_units, "applied output"),
            "quality": over_time(quality, "1", "quality flags, 0 is good"),
            "rms_error": variable(
                ("controller", "minute"),
                rms,
                y_units,
                "root mean square of measured minus wanted",
            ),
            "stroke": variable((), design.task.stroke, y_units, "reference from end to end"),
            "outcome": of_each(
                [trial.outcome for trial in trials],
                "1",
                "whether the controller came to the end, or what stopped it",
            ),
            "fallbacks": of_each(
                [trial.fallbacks for trial in trials],
                "1",
                "times that the model's own parameters replaced the tracked ones",
            ),
            "proportional": of_each(
                [np.nan if one is None else one.proportional for one in gains],
                "1",
                "K: of PI in input units per output unit, of an inverse a number",
            ),
            "integral_time": of_each(
                [np.nan if one is None else one.integral_time for one in gains], "s", "Ti"
            ),
            "inverse_error": of_each(
                [scheme.error for scheme in schemes],
                y_units,
                "root mean square error that the simulation itself has with its inverse",
            ),
            "effects": of_each(
                [scheme.effects for scheme in schemes],
                "1",
                "effects attached to the simulation that is inverted",
            ),
        },
        coords={
            "controller": ("controller", _as_array(list(found))),
            "minute": variable("minute", 1 + np.arange(rms.shape[1]), "1", "number of the minute"),
            "time": variable("time", np.arange(size) / design.sampling_rate, "s", "time"),
        },
        attrs={"contract": "control", "sampling_rate": design.sampling_rate},
    )


def _as_array(values: Sequence[Any]) -> np.ndarray:
    """Return values of each controller as an array, texts as objects."""
    text = any(isinstance(value, str) for value in values)
    return np.array(values, dtype=object if text else None)


def _by_minute(error: Array, rate: float) -> Array:
    """Return the root mean square of errors (rows, samples) over (rows, minutes).

    Minutes count from the first sample on. The last one ends with the last sample: of an error that
    does not last whole minutes, it begins within the minute before. A shorter error is one minute.
    """
    size, minute = error.shape[1], MINUTE * rate
    length = min(round(minute), size)
    before = math.ceil((size - 0.5) / minute) - 1  # half a sample, by which sizes are rounded
    starts = [*(round(number * minute) for number in range(before)), size - length]
    parts = [error[:, start : start + length] for start in starts]
    rms: Array = np.sqrt(np.mean(np.stack(parts, axis=1) ** 2, axis=2))
    return rms
