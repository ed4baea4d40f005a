"""Outcomes of the blind trials by the strength of the hidden effect and by the excitation."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from dea.figures import style
from dea.figures.trials_gap import COLOURS
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``scores.nc`` of a set of trials."""
    return trials_strength(sources.dataset("scores"))


@style.styled
def trials_strength(scores: xr.Dataset) -> Figure:
    """Draw the outcomes of single effects and the interval of right names (contract ``scores``)."""
    figure = style.page_figure(style.FULL_WIDTH, 78)
    by_strength, by_excitation = figure.subplots(1, 2, sharey=True, width_ratios=[4, 6])
    _stack(by_strength, scores, "strength_bin")
    by_strength.set(
        xlabel="strength: residual RMS over noise RMS (1)", ylabel="trials with one effect (%)"
    )
    _stack(by_excitation, scores, "excitation_kind")
    by_excitation.set(xlabel="excitation (number of trials)")
    handles, names = by_strength.get_legend_handles_labels()
    trials = scores["strength_bin_outcomes"].sum("strength_bin")
    shown = [
        (handle, f"{name} ({count})")
        for handle, name in zip(handles, names, strict=True)
        if (count := int(trials.sel(possible_outcome=name)))
    ]
    if shown:
        figure.legend(*zip(*shown, strict=True), loc="outside upper center", ncols=len(shown))
    style.panel_letters([by_strength, by_excitation])
    return figure


def _stack(ax: Axes, scores: xr.Dataset, dim: str) -> None:
    """Stack the shares of the outcomes of single effects, right names at the bottom."""
    counts = scores[f"{dim}_outcomes"].values
    total = np.maximum(counts.sum(axis=1), 1)
    place, base = np.arange(counts.shape[0]), np.zeros(counts.shape[0])
    for column, name in enumerate(scores["possible_outcome"].values):
        if name not in ("one of two", "right none"):
            share = counts[:, column] / total
            ax.bar(place, share, 0.7, base, color=COLOURS[str(name)], label=str(name))
            base += share
    right = scores[f"{dim}_right"].values
    low, high = scores[f"{dim}_right_low"].values, scores[f"{dim}_right_high"].values
    ax.errorbar(
        place,
        right,
        [right - low, high - right],
        fmt="none",
        ecolor=style.BLACK,
        elinewidth=0.8,
        capsize=2,
    )
    names = [f"{name}\n({n})" for name, n in zip(scores[dim].values, counts.sum(1), strict=True)]
    ax.set_xticks(place, names)
    ax.set_ylim(0, 1)
    ax.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=""))
