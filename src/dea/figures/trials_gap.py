"""Certified errors of the blind trials before and after the verdict, in noise floors."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.store import Sources

COLOURS = {
    "right name": style.BLUE,
    "one of two": style.SKY,
    "right class": style.GREEN,
    "abstained": style.PALE,
    "missed": style.GREY,
    "wrong name": style.VERMILION,
    "right none": style.BLACK,
}

_LEAST = 0.8  # noise floors, from which the axes begin at the latest


def draw(sources: Sources, clean: float) -> Figure:
    """Draw it from ``scores.nc`` of a set of trials; ``clean`` is that of the verdicts' rules."""
    return trials_gap(sources.dataset("scores"), clean)


@style.styled
def trials_gap(scores: xr.Dataset, clean: float) -> Figure:
    """Draw certified errors after against before, in noise floors.

    Parameters
    ----------
    scores
        Contract ``scores``.
    clean
        Noise floors up to which a simulation counts as complete.
    """
    figure = style.page_figure(style.SINGLE_COLUMN, 92)
    ax = figure.subplots()
    before = (scores["error_before"] / scores["noise_floor"]).values
    after = (scores["error_after"] / scores["noise_floor"]).values
    for outcome, colour in COLOURS.items():
        chosen = scores["outcome"].values == outcome
        if chosen.any():
            ax.plot(
                before[chosen], after[chosen], "o", mfc=colour, mec=style.GREY, mew=0.3, ms=4,
                label=f"{outcome} ({chosen.sum()})",
            )  # fmt: skip
    every = np.concatenate([before, after])
    shown = every[np.isfinite(every) & (every > 0.0)]
    ends = np.array([0.9 * shown.min(initial=_LEAST / 0.9), 1.2 * shown.max(initial=2.0)])
    ax.plot(ends, ends, color=style.GREY, lw=0.6, ls=":")
    ax.axhline(1.0, color=style.GREY, lw=0.6)
    ax.axhline(clean, color=style.GREY, lw=0.6, ls="--")
    ax.set(xscale="log", yscale="log", xlim=tuple(ends), ylim=tuple(ends))
    ax.set(
        xlabel="certified error of the nominal simulation\n(noise floors)",
        ylabel="certified error after the verdict (noise floors)",
    )
    for axis in (ax.xaxis, ax.yaxis):
        style.plain_log_ticks(axis)
    figure.legend(loc="outside upper center", ncols=3)
    return figure
