"""Published models identified again: errors of output, H1 and H2, and the terms found."""

from itertools import product

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dea.figures import style
from dea.store import Sources

_ERRORS = {
    "nmse": "nmse of the simulated output",
    "h1_error": "relative error of $H_1$",
    "h2_error": "relative error of $H_2$",
}
_MARKER = {"coloured": ("band-limited input", "o", -0.14), "white": ("white input", "s", 0.14)}
_SEARCH = {
    "forward": ("forward selection", style.BLUE, "none", 5.0),
    "refined": ("with refinement", style.VERMILION, style.VERMILION, 3.5),
}


def draw(sources: Sources) -> Figure:
    """Draw it from ``recovery.nc``."""
    return recovery(sources.dataset("recovery"))


@style.styled
def recovery(scores: xr.Dataset) -> Figure:
    """Draw ``recovery.nc``: a row per plant, a mark per excitation and search."""
    plants = [str(plant) for plant in scores["plant"].values]
    figure = style.page_figure(style.FULL_WIDTH, 34 + 9 * len(plants))
    axes = figure.subplots(1, len(_ERRORS) + 1, sharey=True)
    for ax, (name, label) in zip(axes, _ERRORS.items(), strict=False):
        _marks(ax, scores, scores[name])
        ax.set_xscale("log")
        ax.set_xlabel(label)
    _marks(axes[-1], scores, scores["terms_common"] / scores["plant_terms"])
    axes[-1].set(xlim=(-0.05, 1.05), xlabel="share of terms found")
    for ax in axes:
        ax.grid(axis="x", color=style.PALE, lw=0.4)
        ax.set_axisbelow(True)
        ax.tick_params(axis="y", length=0)
    axes[0].set_yticks(range(len(plants)), plants)
    axes[0].set_ylim(len(plants) - 0.5, -0.5)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    style.panel_letters(axes)
    return figure


def _marks(ax: Axes, scores: xr.Dataset, values: xr.DataArray) -> None:
    rows = np.arange(scores["plant"].size)
    for excitation, search in product(scores["excitation"].values, scores["search"].values):
        input_name, marker, shift = _MARKER[str(excitation)]
        search_name, edge, face, size = _SEARCH[str(search)]
        chosen = values.sel(excitation=excitation, search=search)
        ax.plot(
            chosen, rows + shift, ls="none", marker=marker, mec=edge, mfc=face, ms=size, mew=0.9,
            label=f"{input_name}, {search_name}",
        )  # fmt: skip
