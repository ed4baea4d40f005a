"""Frequency responses of higher order over time: maps on a plane of frequencies, and curves."""

from collections.abc import Mapping, Sequence
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

from dea.arrays import Array
from dea.figures import style
from dea.figures.contours import contours
from dea.figures.frequency_maps import (
    colour_bar,
    common_moment,
    hatch,
    missing_handles,
    reservations,
    veil_handle,
)
from dea.figures.lettering import in_lines

_MARGIN, _LARGEST_PANEL = 36.0, 44.0  # mm
_CURVES = 34.0  # mm, height of the last row
_TICKS_ACROSS = 8  # intervals of an axis that is as wide as the page
_WIDE = 150.0  # mm, from where a legend of three columns is not cut
_TITLE = 10.0  # mm, above a row of maps alone
_PALENESS = 0.3
_BEYOND = 1.4  # upper limit of the axes over the highest excited frequency


class PlaneQuantity(NamedTuple):
    """What is shown of a response to two frequencies.

    ``maps`` over ``time_h2`` and both frequencies on the colour scale ``norm``; ``curves``
    likewise, drawn where both frequencies are one, in the units of ``low`` and ``high``, the ends
    of their bands, which are empty where there is none. ``curve_labels`` say what they are. Where
    zero means nothing, as of a phase, the axes of the curves need not begin there (``from_zero``),
    and are alike for all systems.
    """

    maps: Mapping[str, xr.DataArray]
    norm: Normalize
    colours: str
    map_label: str
    curves: Mapping[str, xr.DataArray]
    low: Mapping[str, xr.DataArray]
    high: Mapping[str, xr.DataArray]
    curve_labels: Mapping[str, str]
    from_zero: bool


def planes_over_time(responses: Mapping[str, xr.Dataset], shown: PlaneQuantity) -> Figure:
    """Draw a column per system, a row per time, on one colour scale; in the last row the curves.

    A page of one system is not tall and narrow: its times stand beside each other.

    Parameters
    ----------
    responses
        Contract ``gfrf``, by the systems' names.
    """
    times = _moments([responses[name] for name in shown.maps])
    draw = _one_system if len(shown.maps) == 1 else _several_systems
    figure, width = draw(times, responses, shown)
    veiled = any(_extrapolates(responses[name]) for name in shown.maps)
    handles = [
        *([veil_handle()] if veiled else []),
        *_curve_handles(times, shown),
        *missing_handles(shown.maps),
    ]
    figure.legend(
        handles=handles, loc="outside lower center", ncols=3 if width > _WIDE else 2,
        title=reservations(responses, width, banded=bool(shown.low)), title_fontsize=6,
    )  # fmt: skip
    return figure


def _moments(responses: Sequence[xr.Dataset]) -> list[str]:
    """Say of each row when it is."""
    times = [each["time_h2"].values for each in responses]
    parts = times[0] / float(responses[0]["time"].values[-1])
    return [
        common_moment((style.moment(own[row], own) for own in times), part)
        for row, part in enumerate(parts)
    ]


def _several_systems(
    times: Sequence[str], responses: Mapping[str, xr.Dataset], shown: PlaneQuantity
) -> tuple[Figure, float]:
    """Draw a column per system, and return the figure with its width (mm)."""
    panel = min((style.FULL_WIDTH - _MARGIN) / len(shown.maps), _LARGEST_PANEL)
    height = panel * len(times) + _CURVES + _MARGIN
    width = panel * len(shown.maps) + _MARGIN
    figure = style.page_figure(width, min(height, style.PAGE_HEIGHT))
    ratios = [*[panel] * len(times), _CURVES]
    axes = figure.subplots(len(times) + 1, len(shown.maps), squeeze=False, height_ratios=ratios)
    for column, (name, values) in enumerate(shown.maps.items()):
        for row, time in enumerate(times):
            ax = axes[row, column]
            mesh = _panel(ax, responses[name], values.isel(time_h2=row), shown)
            ax.tick_params(labelleft=column == 0, labelbottom=row == len(times) - 1)
            axes[row, 0].set_ylabel(f"at {time}\n$f_2$ (Hz)")
        axes[0, column].set_title(in_lines(name.replace(", ", "\n"), panel))
        axes[-2, column].set_xlabel("$f_1$ (Hz)")
        _diagonal(axes[-1, column], name, responses[name], shown)
    if not shown.from_zero:
        limits = np.array([ax.get_ylim() for ax in axes[-1]])
        for ax in axes[-1]:
            ax.set_ylim(limits[:, 0].min(), limits[:, 1].max())
    labels = list(shown.curve_labels.values())
    for column in range(len(labels) if len(set(labels)) > 1 else 1):
        axes[-1, column].set_ylabel(labels[column])
    colour_bar(figure, mesh, axes[:-1], shown.map_label)
    return figure, width


def _one_system(
    times: Sequence[str], responses: Mapping[str, xr.Dataset], shown: PlaneQuantity
) -> tuple[Figure, float]:
    """Draw a column per time of the only system, and return the figure with its width (mm)."""
    [(name, values)] = shown.maps.items()
    panel = min((style.FULL_WIDTH - _MARGIN) / len(times), _LARGEST_PANEL)
    width = max(panel * len(times), 2 * _LARGEST_PANEL) + _MARGIN
    figure = style.page_figure(width, panel + _TITLE + _CURVES + _MARGIN)
    grid = figure.add_gridspec(2, len(times), height_ratios=[panel + _TITLE, _CURVES])
    axes = np.array([figure.add_subplot(grid[0, column]) for column in range(len(times))])
    for column, (ax, time) in enumerate(zip(axes, times, strict=True)):
        mesh = _panel(ax, responses[name], values.isel(time_h2=column), shown)
        ax.tick_params(labelleft=column == 0)
        ax.set_xlabel("$f_1$ (Hz)")
        ax.set_title(f"at {time}")
    axes[0].set_ylabel("$f_2$ (Hz)")
    curves = figure.add_subplot(grid[1, :])
    _diagonal(curves, name, responses[name], shown)
    curves.xaxis.set_major_locator(MaxNLocator(_TICKS_ACROSS))
    curves.set_ylabel(shown.curve_labels[name])
    colour_bar(figure, mesh, axes, shown.map_label)
    figure.suptitle(name, fontsize=7)
    return figure, width


def excited_values(maps: Mapping[str, xr.DataArray], responses: Mapping[str, xr.Dataset]) -> Array:
    """Return the values (k,) of all maps where the input held power at both frequencies."""
    return np.concatenate(
        [
            each.transpose("frequency_2", "frequency_1", "time_h2")
            .values[~_doubtful(responses[name])].ravel()
            for name, each in maps.items()
        ]
    )  # fmt: skip


def _diagonal(ax: Axes, name: str, response: xr.Dataset, shown: PlaneQuantity) -> None:
    """Draw the curves where f is excited, at each time with its band."""
    f = response["frequency_1"].values
    known = np.flatnonzero(np.diagonal(response["excited_h2"].values))

    def along(values: xr.DataArray, row: int) -> Array:
        plane = values.transpose("time_h2", "frequency_1", "frequency_2").values[row]
        return np.asarray(np.diagonal(plane)[known])

    for row in range(shown.curves[name]["time_h2"].size):
        look = style.look(row, style.THREE)
        if shown.low:
            low, high = along(shown.low[name], row), along(shown.high[name], row)
            ax.fill_between(f[known], low, high, color=look.colour, alpha=_PALENESS, lw=0)
        values = along(shown.curves[name], row)
        ax.plot(f[known], values, color=look.colour, ls=look.line, lw=0.9)
    if shown.from_zero:
        ax.set_ylim(bottom=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(3))
    ax.yaxis.set_major_locator(MaxNLocator(3))
    ax.set_xlabel("$f$ (Hz)")


def _curve_handles(times: Sequence[str], shown: PlaneQuantity) -> list[Line2D | Patch]:
    looks = [style.look(row, style.THREE) for row in range(len(times))]
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=look.colour, ls=look.line, lw=0.9, label=f"at {time}")
        for look, time in zip(looks, times, strict=True)
    ]
    if not shown.low:
        handles.append(Line2D([], [], ls="none", label="no band is computed"))
    elif any(bool(np.isfinite(low.values).any()) for low in shown.low.values()):
        handles.append(Patch(facecolor=style.GREY, alpha=_PALENESS, label="95 % band"))
    return handles


def _extrapolates(response: xr.Dataset) -> bool:
    """Whether frequencies are shown at which the input held no power."""
    doubtful = _doubtful(response)
    f1, f2 = (response[f"frequency_{k}"].values for k in (1, 2))
    low_1, high_1 = _view(f1, np.any(~doubtful, axis=0))
    low_2, high_2 = _view(f2, np.any(~doubtful, axis=1))
    seen = ((f2 >= low_2) & (f2 <= high_2))[:, None] & ((f1 >= low_1) & (f1 <= high_1))
    return bool((doubtful & seen).any())


def _doubtful(response: xr.Dataset) -> NDArray[np.bool_]:
    """Return where either frequency was not excited, shape (f2, f1)."""
    excited = response["excited_h2"].transpose("frequency_2", "frequency_1").values
    return np.asarray(excited == 0)


def _panel(ax: Axes, response: xr.Dataset, values: xr.DataArray, shown: PlaneQuantity) -> QuadMesh:
    f1, f2 = values["frequency_1"].values, values["frequency_2"].values
    mesh = ax.pcolormesh(
        f1, f2, values.transpose("frequency_2", "frequency_1").values, norm=shown.norm,
        cmap=shown.colours, shading="nearest", rasterized=True,
    )  # fmt: skip
    if values.notnull().all() and not values.any():
        ax.text(
            0.5, 0.5, "zero", transform=ax.transAxes, ha="center", va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip
    doubtful = _doubtful(response)
    ax.set_xlim(_view(f1, np.any(~doubtful, axis=0)))
    ax.set_ylim(_view(f2, np.any(~doubtful, axis=1)))
    ax.set_box_aspect(1)
    trusted = values.where(xr.DataArray(~doubtful, dims=("frequency_2", "frequency_1")))
    contours(ax, trusted, mesh)
    hatch(ax, f1, f2, doubtful)
    return mesh


def _view(frequency: Array, excited: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the limits of an axis: the excited frequencies and a margin above them."""
    highest = frequency[excited].max(initial=frequency[0])
    return frequency[0], min(frequency[-1], _BEYOND * highest)
