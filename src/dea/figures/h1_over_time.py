"""The first-order frequency response over time: output, map, and curves at several times."""

from collections.abc import Mapping
from math import ceil
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from dea.figures import style
from dea.figures.frequency_maps import (
    colour_bar,
    common_moment,
    hatch,
    missing_handles,
    reservations,
    veil_handle,
)
from dea.figures.lettering import in_lines
from dea.store import signals

_COLUMNS = 2
_NAME = 0.35  # of the width of a column, for a name above its map
_TIMES = (0.05, 0.5, 0.95)  # of the record, at which curves are drawn
_PALENESS = 0.3
_MARGIN = 0.08  # of an axis, over what its curves span
_LINEAR_TICKS = 4
_FEW_DECADES = 2  # powers of ten on an axis, below which two and five of each are labelled too
_BEYOND = 2.0  # highest frequency shown over the highest excited one
_SLIVER = 1.2  # the same: what is excited up to less than this below the end is shown to there


class H1Quantity(NamedTuple):
    """What is shown of H1.

    ``maps`` over ``time`` and ``frequency`` on the colour scale ``norm``; ``curves`` likewise, in
    the units of the variables ``low`` and ``high`` of the response, the ends of their bands;
    ``curve_labels`` say what they are. The axes of the curves are the same; where ``references``
    are given, one for each curve, they span the same multiples of them, so that equal shares look
    equal.
    """

    maps: Mapping[str, xr.DataArray]
    norm: Normalize
    colours: str
    map_label: str
    curves: Mapping[str, xr.DataArray]
    low: str
    high: str
    curve_labels: Mapping[str, str]
    references: Mapping[str, float] | None = None


def h1_over_time(
    records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset], shown: H1Quantity
) -> Figure:
    """Draw for each system its output, its map below, and curves with their bands beside them.

    Parameters
    ----------
    records, responses
        Contracts ``record`` and ``gfrf``, by the systems' names.
    """
    columns = min(_COLUMNS, len(records))
    rows = ceil(len(records) / columns)
    figure = style.page_figure(style.FULL_WIDTH, min(30 + 64 * rows, style.PAGE_HEIGHT))
    grid = figure.add_gridspec(
        2 * rows, 2 * columns, height_ratios=[1, 2.6] * rows, width_ratios=[1.25, 1] * columns
    )
    of_curves: dict[str, Axes] = {}
    for number, (name, response) in enumerate(responses.items()):
        row, column = divmod(number, columns)
        panel = figure.add_subplot(grid[2 * row + 1, 2 * column])
        series = figure.add_subplot(grid[2 * row, 2 * column], sharex=panel)
        curves = figure.add_subplot(grid[2 * row : 2 * row + 2, 2 * column + 1])
        _series(series, records[name])
        series.set_title(in_lines(name, _NAME * style.FULL_WIDTH / columns))
        mesh = _map(panel, response, shown.maps[name], shown)
        style.time_axis(panel, signals(records[name]).time)
        panel.set_ylabel("frequency (Hz)")
        _curves(curves, response, shown.curves[name], shown)
        curves.set_ylabel(shown.curve_labels[name])
        of_curves[name] = curves
    _span_alike(of_curves, responses, shown)
    colour_bar(figure, mesh, np.array(figure.axes), shown.map_label)
    veiled = any(map(_extrapolates, responses.values()))
    handles = [
        *([veil_handle()] if veiled else []),
        *_curve_handles(responses, shown),
        *missing_handles(shown.maps),
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=3,
        title=reservations(responses, style.FULL_WIDTH), title_fontsize=6,
    )  # fmt: skip
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


def _highest(response: xr.Dataset) -> float:
    """Return the highest frequency shown: a little beyond the highest excited one."""
    frequency = response["frequency"].values
    known = frequency[_excited(response)].max(initial=frequency[0])
    highest = min(frequency[-1], max(_BEYOND * known, frequency[1]))
    return float(known if frequency[0] < known and highest < _SLIVER * known else highest)


def _extrapolates(response: xr.Dataset) -> bool:
    """Whether frequencies are shown at which the input held no power."""
    shown = response["frequency"].values <= _highest(response)
    return bool((shown & ~_excited(response)).any())


def _series(ax: Axes, record: xr.Dataset) -> None:
    whole = signals(record)
    width = style.line_width(whole.time.size)
    ax.plot(whole.time, whole.y, lw=width, color=style.BLACK, rasterized=True)
    ax.set_ylabel(style.quantity("$y$", whole.y_units))
    ax.yaxis.set_major_locator(MaxNLocator(2))
    ax.tick_params(labelbottom=False)


def _map(ax: Axes, response: xr.Dataset, values: xr.DataArray, shown: H1Quantity) -> QuadMesh:
    time, frequency = values["time"].values, values["frequency"].values
    mesh = ax.pcolormesh(
        time, frequency, values.transpose("frequency", "time").values,
        norm=shown.norm, cmap=shown.colours, shading="nearest", rasterized=True,
    )  # fmt: skip
    ax.set_ylim(frequency[0], _highest(response))
    _log_if_wide(ax, "y")
    doubtful = ~_excited(response)
    hatch(ax, np.array(ax.get_xlim()), frequency, np.column_stack([doubtful, doubtful]))
    return mesh


def _curves(ax: Axes, response: xr.Dataset, values: xr.DataArray, shown: H1Quantity) -> None:
    frequency, excited = values["frequency"].values, _excited(response)
    for share, colour in zip(_TIMES, style.THREE, strict=True):
        row = round(share * (values["time"].size - 1))
        curve = values.isel(time=row).values
        low, high = (response[end].isel(time=row).values for end in (shown.low, shown.high))
        ax.fill_between(
            frequency, np.where(excited, low, np.nan), np.where(excited, high, np.nan),
            color=colour, alpha=_PALENESS, lw=0,
        )  # fmt: skip
        ax.plot(frequency, np.where(excited, curve, np.nan), color=colour, lw=0.9)
        ax.plot(frequency, curve, color=colour, lw=0.6, ls=":")
    ax.set_xlim(frequency[0], _highest(response))
    _log_if_wide(ax, "x")
    seen = _seen(response, values)
    if seen.size and np.ptp(seen) > 0.0:
        margin = _MARGIN * np.ptp(seen)
        ax.set_ylim(seen.min() - margin, seen.max() + margin)
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.set_xlabel("frequency (Hz)")


def _seen(response: xr.Dataset, values: xr.DataArray) -> NDArray[np.float64]:
    """Return what the curves show, where it is known."""
    rows = [round(share * (values["time"].size - 1)) for share in _TIMES]
    near = values["frequency"].values <= _highest(response)
    seen = values.isel(time=rows, frequency=near).values
    return np.asarray(seen[np.isfinite(seen)])


def _span_alike(
    axes: Mapping[str, Axes], responses: Mapping[str, xr.Dataset], shown: H1Quantity
) -> None:
    """Limit the axes of the curves alike, or to the same multiples of references, not below 0."""
    given = dict.fromkeys(axes, 1.0) if shown.references is None else shown.references
    references = {k: v for k, v in given.items() if np.isfinite(v) and v > 0.0}
    relative = [_seen(responses[k], shown.curves[k]) / v for k, v in references.items()]
    every = np.concatenate(relative) if relative else np.empty(0)
    if not every.size or np.ptp(every) == 0.0:
        return
    margin = _MARGIN * np.ptp(every)
    least = -np.inf if shown.references is None else 0.0
    low, high = max(least, every.min() - margin), every.max() + margin
    for name, reference in references.items():
        axes[name].set_ylim(low * reference, high * reference)


def _log_if_wide(ax: Axes, which: str) -> None:
    low, high = ax.get_ylim() if which == "y" else ax.get_xlim()
    axis = ax.yaxis if which == "y" else ax.xaxis
    axis.set_major_locator(MaxNLocator(_LINEAR_TICKS))
    if low > 0 and high > 20 * low:
        ax.set(**{f"{which}scale": "log"})
        decades = np.floor(np.log10(high)) - np.ceil(np.log10(low)) + 1
        if decades < _FEW_DECADES:
            style.plain_log_ticks(axis)
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")


def _curve_handles(responses: Mapping[str, xr.Dataset], shown: H1Quantity) -> list[Line2D | Patch]:
    """Return the handles of the times at which some curve is drawn, and of bands if there are.

    Where systems were recorded for different times, a curve is after that part of its record.
    """
    handles: list[Line2D | Patch] = []
    times = [each["time"].values for each in responses.values()]
    for share, colour in zip(_TIMES, style.THREE, strict=True):
        rows = [
            each.isel(time=round(share * (each["time"].size - 1))) for each in shown.curves.values()
        ]
        if any(bool(np.isfinite(row.values).any()) for row in rows):
            of_each = (style.moment(own[round(share * (own.size - 1))], own) for own in times)
            label = f"at {common_moment(of_each, share)}"
            handles.append(Line2D([], [], color=colour, lw=0.9, label=label))
    if any(bool(np.isfinite(each[shown.low].values).any()) for each in responses.values()):
        handles.append(Patch(facecolor=style.GREY, alpha=_PALENESS, label="95 % band"))
    return handles
