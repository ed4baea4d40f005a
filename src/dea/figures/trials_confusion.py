"""Confusion matrix of the blind trials: hidden effects against named ones."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from dea.figures import style
from dea.store import Sources

_CELL = 5.0  # mm
_LABELS = 52.0  # mm, beside and above the matrix
_SHARES = style.truncated("Blues", 0.0, 0.85)


def draw(sources: Sources) -> Figure:
    """Draw it from ``scores.nc`` of a set of trials."""
    return trials_confusion(sources.dataset("scores"))


@style.styled
def trials_confusion(scores: xr.Dataset) -> Figure:
    """Draw the counts (contract ``scores``) of every effect that was hidden at least once."""
    counts = scores["confusion"].values
    hidden = np.flatnonzero(counts.sum(axis=1))
    counts = counts[hidden]
    rows = [_spaced(name) for name in scores["hidden_effect"].values[hidden]]
    columns = [_spaced(name) for name in scores["said_effect"].values]
    figure = style.page_figure(style.FULL_WIDTH, _LABELS + _CELL * len(rows))
    ax = figure.subplots()
    shares = counts / counts.sum(axis=1, keepdims=True)
    ax.imshow(shares, cmap=_SHARES, vmin=0, vmax=1, aspect="auto")
    _write_counts(ax, counts, shares)
    _outline_right_answers(ax, rows, columns)
    ax.set_xticks(range(len(columns)), columns, rotation=90)
    ax.set_yticks(range(len(rows)), rows)
    ax.tick_params(length=0)
    ax.xaxis.tick_top()
    ax.xaxis.set_label_position("top")
    ax.set(xlabel="verdict", ylabel="hidden")
    ax.spines[:].set_visible(False)
    ax.set_xticks(np.arange(len(columns) + 1) - 0.5, minor=True)
    ax.set_yticks(np.arange(len(rows) + 1) - 0.5, minor=True)
    ax.tick_params(which="minor", length=0)
    ax.grid(which="minor", color=style.PALE, lw=0.4)
    return figure


def _write_counts(ax: Axes, counts: NDArray[np.int64], shares: NDArray[np.float64]) -> None:
    for (row, column), count in np.ndenumerate(counts):
        if count:
            colour = "white" if shares[row, column] > 0.6 else style.BLACK
            ax.text(column, row, str(count), ha="center", va="center", color=colour, fontsize=6)


def _outline_right_answers(ax: Axes, rows: list[str], columns: list[str]) -> None:
    """Outline the name itself or, for an effect outside the catalogue, the verdicts without one."""
    for row, name in enumerate(rows):
        right = [name] if name in columns else ["ambiguous", "unknown"]
        for column in map(columns.index, right):
            cell = Rectangle((column - 0.5, row - 0.5), 1, 1, fill=False, ec=style.VERMILION)
            cell.set(lw=0.8, zorder=3)
            ax.add_patch(cell)


def _spaced(name: str) -> str:
    return str(name).replace("_", " ")
