"""Contours on a map, with levels of its own that are written on them."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm

from dea.arrays import Array
from dea.figures import style
from dea.figures.lettering import told_apart

_CONTOURS = 3
_LIGHTNESS, _LIGHT = np.array([0.2126, 0.7152, 0.0722]), 0.5  # of red, green, blue; black from here
_MOST_DIGITS = 3  # of a contour's label
_FLAT = 0.01  # of the largest value; a map that varies less gets no contours
_LABELLED = 0.6  # of the way from the middle to the edge: a label further out would be cut
_APART = 0.9  # of the way from the middle to the edge, between labels


def contours(ax: Axes, trusted: xr.DataArray, mesh: QuadMesh) -> None:
    """Draw contours at levels of the panel's own, since the common colour scale may be wide.

    They are white, or black where the ``mesh`` below is light. A level without a place for its
    label is left out.
    """
    low, high = float(trusted.min()), float(trusted.max())
    if not high - low > _FLAT * max(abs(low), abs(high)):
        return
    levels = _levels(low, high, logarithmic=isinstance(mesh.norm, LogNorm))
    known = trusted.dropna("frequency_1", how="all").dropna("frequency_2", how="all")
    f1, f2 = known["frequency_1"].values, known["frequency_2"].values
    heights = known.transpose("frequency_2", "frequency_1").values
    every = ax.contour(f1, f2, heights, levels)
    places: list[Array] = []
    labelled: list[float] = []
    for level, path in zip(levels, every.get_paths(), strict=True):
        place = _place_for_label(np.asarray(path.vertices), places, f1, f2)
        if place is not None:
            places.append(place)
            labelled.append(level)
    every.remove()
    if not labelled:
        return
    lightness = mesh.to_rgba(np.array(labelled))[:, :3] @ _LIGHTNESS
    colours = ["white" if light < _LIGHT else style.BLACK for light in lightness]
    lines = ax.contour(
        f1, f2, heights, labelled, colors=colours, linewidths=0.5, linestyles="solid"
    )
    written = dict(zip(labelled, told_apart(labelled), strict=True))
    ax.clabel(lines, fmt=written, fontsize=6, manual=places)


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


def _levels(low: float, high: float, *, logarithmic: bool) -> Array:
    """Return levels of contours, one alone where so many digits do not tell more of them apart."""
    spaced = np.geomspace if logarithmic and low > 0.0 else np.linspace
    levels = spaced(low, high, _CONTOURS + 2)[1:-1]
    three = {f"{level:.{_MOST_DIGITS}g}" for level in levels}
    return levels if len(three) == levels.size else levels[levels.size // 2 :][:1]
