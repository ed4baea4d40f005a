"""How well the tracked models' frequency responses are confirmed on each actuator."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from dea.store import Sources
from dea.tables.table import Table, rounded

_BEYOND = (2.0, 5.0, 10.0)  # Hz, at which the error of the extrapolation is given
# What readers see above the columns whose names, which documents quote from the CSV, are short.
_SHOWN = {
    "of phase (degrees)": "largest difference of phase (degrees)",
    "joint band of gain (%)": "joint band of gain, median (%)",
    "band of the model": "the model's own band",
    "noise (%)": "noise, median (%)",
    "odd distortion (%)": "odd distortion, median (%)",
    "even distortion (%)": "even distortion, median (%)",
    "median ratio": "even lines, measured over predicted, median",
    **{f"gain at {f:g} Hz (%)": f"error of extrapolated gain at {f:g} Hz (%)" for f in _BEYOND},
}
_OWN_BAND = {"in it": "in the joint band"}


def tabulate(sources: Sources) -> Table:
    """Make it from ``confirmation.nc`` of every actuator."""
    return confirmation(sources.datasets("confirmation"))


def confirmation(found: Mapping[str, xr.Dataset]) -> Table:
    """Agreement at each stretch of each actuator (contract ``confirmation``)."""
    rows = []
    for name, dataset in found.items():
        for stretch in range(dataset.sizes["stretch"]):
            part = dataset.isel(stretch=stretch)
            rows.append({"actuator": name, "time (min)": float(part["time"]) / 60} | _row(part))
    exact, shown = rounded(pd.DataFrame(rows))
    own = shown["band of the model"].replace(_OWN_BAND)
    return Table(exact, shown.assign(**{"band of the model": own}).rename(columns=_SHOWN))


def _row(part: xr.Dataset) -> dict[str, str | float]:
    band = part.isel(frequency=part["in_band"].values == 1)
    even = part.isel(even_frequency=part["even_judged"].values == 1)
    gain = np.hypot(*band["response"].transpose("part", "frequency").values)
    sizes = np.hypot(*even["ratio"].transpose("part", "even_frequency").values)
    reason = part.attrs["model_band_withheld"]
    row: dict[str, str | float] = {
        "lines": int(band["inside"].size),
        "lines in band": int(band["inside"].sum()),
        "largest difference of gain (%)": 100 * _largest(band["gain_difference"]),
        "of phase (degrees)": _largest(band["phase_difference"]),
        "joint band of gain (%)": 100 * float(band["gain_band"].median()),
        "band of the model": f"withheld: {reason}" if reason else "in it",
        "noise (%)": 100 * float(np.median(band["response_noise"].values / gain)),
        "odd distortion (%)": 100 * float(np.median(band["distortion"].values / gain)),
        "even distortion (%)": 100 * _even_distortion(part),
        "even lines": int(even["even_inside"].size),
        "even lines in band": int(even["even_inside"].sum()),
        "median ratio": float(np.median(sizes)) if sizes.size else np.nan,
    }  # fmt: skip
    for beyond in _BEYOND:
        row[f"gain at {beyond:g} Hz (%)"] = 100 * _extrapolated(part, beyond)
    return row


def _even_distortion(part: xr.Dataset) -> float:
    """Return the median level of even lines in the band, less noise, over that of excited lines."""
    excited = part.isel(frequency=part["in_band"].values == 1)
    highest = excited["frequency"].max()
    lines = (part["odd"] == 0) & (part["detection_frequency"] <= highest)
    even = part.isel(detection_frequency=lines.values)
    power = even["output_level"].values ** 2 - even["output_noise"].values ** 2
    whole = np.mean(excited["excited_level"].values ** 2)
    return float(np.median(np.sqrt(np.maximum(power, 0.0) / whole))) if power.size else np.nan


def _extrapolated(part: xr.Dataset, beyond: float) -> float:
    """Return the difference of gain at the line nearest to ``beyond`` Hz.

    It is NaN where that line is in the band, or the last one more than a spacing below.
    """
    frequency = part["frequency"].values
    nearest = int(np.argmin(np.abs(np.log(frequency / beyond))))
    if part["in_band"][nearest] == 1 or beyond > frequency[-1] ** 2 / frequency[-2]:
        return np.nan
    return float(part["gain_difference"][nearest])


def _largest(values: xr.DataArray) -> float:
    return float(values.values[np.argmax(np.abs(values.values))])
