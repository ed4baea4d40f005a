"""Maps of the first-order frequency response over time, each below its system's raw output."""

from collections.abc import Mapping
from math import ceil
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from dea.figures import style
from dea.figures.frequency_maps import colour_bar, explain, hatch
from dea.store import signals

_COLUMNS = 2


class Scale(NamedTuple):
    """The colour scale of all maps: range, name of the colour map, label of the colour bar."""

    norm: Normalize
    colours: str
    label: str


def h1_over_time(
    records: Mapping[str, xr.Dataset],
    responses: Mapping[str, xr.Dataset],
    maps: Mapping[str, xr.DataArray],
    scale: Scale,
) -> Figure:
    """Draw the map of each system, all on one colour scale.

    Parameters
    ----------
    records, responses
        Contracts ``record`` and ``gfrf``, by the systems' names.
    maps
        What is shown of each response, over ``time`` and ``frequency``.
    """
    columns = min(_COLUMNS, len(records))
    rows = ceil(len(records) / columns)
    figure = style.page_figure(style.FULL_WIDTH, 22 + 66 * rows)
    axes = figure.subplots(
        2 * rows, columns, squeeze=False, sharex=True, height_ratios=[1, 2] * rows
    )
    for number, name in enumerate(records):
        row, column = divmod(number, columns)
        series, panel = axes[2 * row, column], axes[2 * row + 1, column]
        _series(series, records[name])
        mesh = _panel(panel, responses[name], maps[name], scale)
        series.set_title(name)
        panel.set_ylabel("frequency (Hz)" if column == 0 else "")
        if number + columns >= len(records):  # the lowest of its column
            style.time_axis(panel, signals(records[name]).time)
            panel.tick_params(labelbottom=True)
    for number in range(len(records), rows * columns):
        row, column = divmod(number, columns)
        axes[2 * row, column].set_visible(False)
        axes[2 * row + 1, column].set_visible(False)
    colour_bar(figure, mesh, axes, scale.label)
    explain(figure, maps)
    return figure


def excited_values(
    maps: Mapping[str, xr.DataArray], responses: Mapping[str, xr.Dataset]
) -> NDArray[np.float64]:
    """Return the values (k,) of all maps at the frequencies at which the input held power."""
    return np.concatenate(
        [
            each.transpose("frequency", "time").values[_excited(responses[name])].ravel()
            for name, each in maps.items()
        ]
    )


def _excited(response: xr.Dataset) -> NDArray[np.bool_]:
    return response["excited"].values.astype(np.bool_)


def _series(ax: Axes, record: xr.Dataset) -> None:
    whole = signals(record)
    ax.plot(whole.time, whole.y, lw=0.15, color=style.BLACK, rasterized=True)
    ax.set_ylabel(style.quantity("$y$", whole.y_units))
    ax.set_xlim(whole.time[0], whole.time[-1])


def _panel(ax: Axes, response: xr.Dataset, values: xr.DataArray, scale: Scale) -> QuadMesh:
    time, frequency = values["time"].values, values["frequency"].values
    mesh = ax.pcolormesh(
        time, frequency, values.transpose("frequency", "time").values,
        norm=scale.norm, cmap=scale.colours, shading="nearest", rasterized=True,
    )  # fmt: skip
    if frequency[0] > 0 and frequency[-1] > 30 * frequency[0]:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter("{x:g}")
    ax.set_ylim(frequency[0], frequency[-1])
    doubtful = ~_excited(response)
    hatch(ax, np.array(ax.get_xlim()), frequency, np.column_stack([doubtful, doubtful]))
    return mesh
