"""Fig. 3: first-order frequency response of every actuator over time, below its raw output."""

from collections.abc import Mapping
from math import ceil
from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import as_complex, colour_bar, explain, hatch, magnitude_scale
from dea.store import signals

_COLUMNS = 2


@style.styled
def fig3(
    records: Mapping[str, xr.Dataset],
    responses: Mapping[str, xr.Dataset],
    quantity: Literal["gain", "phase"] = "gain",
) -> Figure:
    """Draw gain or phase of H1(f, t) of each actuator, all on one colour scale.

    Parameters
    ----------
    records, responses
        Contracts ``record`` and ``gfrf``, by the actuators' names.
    """
    columns = min(_COLUMNS, len(records))
    rows = ceil(len(records) / columns)
    figure = style.page_figure(style.FULL_WIDTH, 22 + 66 * rows)
    axes = figure.subplots(
        2 * rows, columns, squeeze=False, sharex=True, height_ratios=[1, 2] * rows
    )
    maps = {name: _map(response, quantity) for name, response in responses.items()}
    norm, colours, label = _scale(maps, responses, quantity)
    for number, name in enumerate(records):
        row, column = divmod(number, columns)
        series, panel = axes[2 * row, column], axes[2 * row + 1, column]
        _series(series, records[name])
        mesh = _panel(panel, responses[name], maps[name], norm, colours)
        series.set_title(name)
        panel.set_ylabel("frequency (Hz)" if column == 0 else "")
        if number + columns >= len(records):  # the lowest of its column
            style.time_axis(panel, signals(records[name]).time)
            panel.tick_params(labelbottom=True)
    for number in range(len(records), rows * columns):
        row, column = divmod(number, columns)
        axes[2 * row, column].set_visible(False)
        axes[2 * row + 1, column].set_visible(False)
    colour_bar(figure, mesh, axes, label)
    explain(figure, maps)
    return figure


def _map(response: xr.Dataset, quantity: str) -> xr.DataArray:
    h1 = as_complex(response["H1"])
    if quantity == "gain":
        return abs(h1)
    unwrapped = np.unwrap(np.angle(h1), axis=h1.get_axis_num("frequency"))
    return h1.copy(data=np.degrees(unwrapped))


def _scale(
    maps: Mapping[str, xr.DataArray], responses: Mapping[str, xr.Dataset], quantity: str
) -> tuple[Normalize, str, str]:
    """One scale for all, set by what lies where the excitation held power."""
    trusted = np.concatenate(
        [
            each.transpose("frequency", "time").values[_excited(responses[name])].ravel()
            for name, each in maps.items()
        ]
    )
    if quantity == "gain":
        units = next(iter(responses.values()))["H1"].attrs["units"]
        label = style.quantity(r"gain $|H_1(f, t)|$", units)
        return magnitude_scale(trusted), style.GAIN_MAP, label
    finite = trusted[np.isfinite(trusted)]
    degrees = Normalize(finite.min(), finite.max()) if finite.size else Normalize(-180.0, 0.0)
    return degrees, style.PHASE_MAP, r"phase $\angle H_1(f, t)$ (degrees)"


def _excited(response: xr.Dataset) -> np.ndarray:
    return response["excited"].values.astype(bool)


def _series(ax: Axes, record: xr.Dataset) -> None:
    whole = signals(record)
    ax.plot(whole.time, whole.y, lw=0.15, color=style.BLACK, rasterized=True)
    ax.set_ylabel(style.quantity("$y$", whole.y_units))
    ax.set_xlim(whole.time[0], whole.time[-1])


def _panel(
    ax: Axes, response: xr.Dataset, values: xr.DataArray, norm: Normalize, colours: str
) -> QuadMesh:
    time, frequency = values["time"].values, values["frequency"].values
    mesh = ax.pcolormesh(
        time, frequency, values.transpose("frequency", "time").values,
        norm=norm, cmap=colours, shading="nearest", rasterized=True,
    )  # fmt: skip
    if frequency[0] > 0 and frequency[-1] > 30 * frequency[0]:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter("{x:g}")
    ax.set_ylim(frequency[0], frequency[-1])
    doubtful = ~_excited(response)
    hatch(ax, np.array(ax.get_xlim()), frequency, np.column_stack([doubtful, doubtful]))
    return mesh
