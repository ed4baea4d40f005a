"""Fig. 4: magnitude of the second-order frequency response H2(f1, f2) at chosen times."""

from collections.abc import Mapping
from itertools import count

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from dea.figures import style
from dea.figures.frequency_maps import as_complex, colour_bar, explain, hatch, magnitude_scale
from dea.store import Sources

Array = NDArray[np.float64]
_MARGIN, _LARGEST_PANEL = 36.0, 52.0  # mm
_CONTOURS = 3
_FLAT = 0.01  # of the largest value; a map that varies less gets no contours
_BEYOND = 1.4  # upper limit of the axes over the highest excited frequency
_LABELLED = 0.6  # of the way from the middle to the edge: a label further out would be cut
_APART = 0.75  # of the way from the middle to the edge, between labels


def draw(sources: Sources) -> Figure:
    """Draw it from ``gfrf.nc`` of one or several systems."""
    return fig4_h2(sources.datasets("gfrf"))


@style.styled
def fig4_h2(responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw |H2| (contract ``gfrf``): a column per actuator, a row per time, one colour scale."""
    maps = {name: abs(as_complex(response["H2"])) for name, response in responses.items()}
    times = next(iter(maps.values()))["time_h2"].values
    unit, unit_name = style.clock(times)
    panel = min((style.FULL_WIDTH - _MARGIN) / len(maps), _LARGEST_PANEL)
    figure = style.page_figure(panel * len(maps) + _MARGIN, panel * times.size + _MARGIN / 2)
    axes = figure.subplots(times.size, len(maps), squeeze=False, sharex=True, sharey=True)
    norm = _scale(maps, responses)
    for column, (name, values) in enumerate(maps.items()):
        for row, time in enumerate(times):
            mesh = _panel(axes[row, column], responses[name], values.isel(time_h2=row), norm)
            axes[row, 0].set_ylabel(f"at {time / unit:.3g} {unit_name}\n$f_2$ (Hz)")
        axes[0, column].set_title(name)
        axes[-1, column].set_xlabel("$f_1$ (Hz)")
    units = next(iter(responses.values()))["H2"].attrs["units"]
    label = style.quantity(r"$|H_2(f_1, f_2)|$", units)
    colour_bar(figure, mesh, axes, label)
    explain(figure, maps)
    return figure


def _doubtful(response: xr.Dataset) -> NDArray[np.bool_]:
    """Return where either frequency was not excited, shape (f2, f1)."""
    excited = response["excited_h2"].transpose("frequency_2", "frequency_1").values
    return np.asarray(excited == 0)


def _scale(maps: Mapping[str, xr.DataArray], responses: Mapping[str, xr.Dataset]) -> Normalize:
    trusted = np.concatenate(
        [
            each.transpose("frequency_2", "frequency_1", "time_h2")
            .values[~_doubtful(responses[name])].ravel()
            for name, each in maps.items()
        ]
    )  # fmt: skip
    return magnitude_scale(trusted)


def _panel(ax: Axes, response: xr.Dataset, values: xr.DataArray, norm: Normalize) -> QuadMesh:
    f1, f2 = values["frequency_1"].values, values["frequency_2"].values
    mesh = ax.pcolormesh(
        f1, f2, values.transpose("frequency_2", "frequency_1").values, norm=norm,
        cmap=style.GAIN_MAP, shading="nearest", rasterized=True,
    )  # fmt: skip
    doubtful = _doubtful(response)
    ax.set_xlim(_view(f1, np.any(~doubtful, axis=0)))
    ax.set_ylim(_view(f2, np.any(~doubtful, axis=1)))
    ax.set_box_aspect(1)
    _contours(ax, values.where(xr.DataArray(~doubtful, dims=("frequency_2", "frequency_1"))))
    hatch(ax, f1, f2, doubtful)
    return mesh


def _view(frequency: Array, excited: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the limits of an axis: the excited frequencies and a margin above them."""
    highest = frequency[excited].max(initial=frequency[0])
    return frequency[0], min(frequency[-1], _BEYOND * highest)


def _contours(ax: Axes, trusted: xr.DataArray) -> None:
    """Draw contours at levels of the panel's own, since the common colour scale may be wide."""
    low, high = float(trusted.min()), float(trusted.max())
    if not high - low > _FLAT * high:
        return
    levels = np.linspace(low, high, _CONTOURS + 2)[1:-1]
    known = trusted.dropna("frequency_1", how="all").dropna("frequency_2", how="all")
    f1, f2 = known["frequency_1"].values, known["frequency_2"].values
    lines = ax.contour(
        f1,
        f2,
        known.transpose("frequency_2", "frequency_1"),
        levels,
        colors="white",
        linewidths=0.5,
    )
    places: list[Array] = []
    for path in lines.get_paths():
        place = _place_for_label(np.asarray(path.vertices), places, f1, f2)
        if place is not None:
            places.append(place)
    ax.clabel(
        lines,
        fmt=dict(zip(levels.tolist(), _labels(levels), strict=True)),
        fontsize=5,
        manual=places,
    )


def _place_for_label(
    line: Array,
    taken: list[Array],
    f1: Array,
    f2: Array,
) -> Array | None:
    """Return where a line (k, 2) is nearest to the middle of the map and away from other labels.

    Return ``None`` where every label would be cut by the edge or overlap another.
    """
    middle = np.array([f1[0] + f1[-1], f2[0] + f2[-1]]) / 2
    half = np.array([np.ptp(f1), np.ptp(f2)]) / 2
    off_centre = (np.abs(line - middle) / half).max(1)
    free = off_centre <= _LABELLED
    for place in taken:
        free &= (np.abs(line - place) / half).max(1) >= _APART
    if not free.any():
        return None
    nearest: Array = line[np.argmin(np.where(free, off_centre, np.inf))]
    return nearest


def _labels(levels: Array) -> list[str]:
    """Return the levels as text, with three digits or as many more as make them differ."""
    written = ([f"{level:.{digits}g}" for level in levels] for digits in count(3))
    return next(labels for labels in written if len(set(labels)) == levels.size)
