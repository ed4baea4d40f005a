"""A diagnosis in one picture: where, the ladder of gaps, the law, and the record's confusion."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dea.figures import style

_WIDEST_NAME = 34


@style.styled
def discrepancy(
    localisation: xr.Dataset,
    candidates: xr.Dataset,
    certificate: xr.Dataset,
    verdict: Mapping[str, Any],
) -> Figure:
    """Draw a diagnosis.

    Parameters
    ----------
    localisation, candidates, certificate
        Contracts of the same names.
    verdict
        The content of ``verdict.json``.
    """
    figure = style.page_figure(style.FULL_WIDTH, 150)
    grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 1.0, 1.15])
    series = figure.add_subplot(grid[0, :])
    where, ladder = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    law, confusion = figure.add_subplot(grid[2, 0]), figure.add_subplot(grid[2, 1])
    _series(series, certificate)
    _where(where, localisation, verdict)
    _ladder(ladder, verdict)
    _law(law, verdict, candidates)
    _confusion(confusion, candidates)
    style.panel_letters([series, where, ladder, law, confusion])
    figure.suptitle(_title(verdict), fontsize=7.5)
    return figure


def _title(verdict: Mapping[str, Any]) -> str:
    names = " + ".join(effect["name"] for effect in verdict["effects"])
    return f"{verdict['status']}: {names}" if names else str(verdict["status"])


def _series(ax: Axes, certificate: xr.Dataset) -> None:
    """Draw the gap of both simulations over the record; the certified block is shaded."""
    time, measured = certificate["time"].values, certificate["measured"].values
    unit = certificate["measured"].attrs["units"]
    for name, colour in (("nominal", style.GREY), ("extended", style.VERMILION)):
        ax.plot(time, measured - certificate[name].values, color=colour, lw=0.5, label=name)
    held = certificate["role"].values == 3
    if held.any():
        ax.axvspan(time[held][0], time[held][-1], color=style.PALE, zorder=0, label="certified")
    ax.set(xlabel="time (s)", ylabel=style.quantity("gap", unit), xlim=(time[0], time[-1]))
    ax.legend(ncols=3, loc="upper right")


def _where(ax: Axes, localisation: xr.Dataset, verdict: Mapping[str, Any]) -> None:
    """Draw the gap along the quantity it is concentrated on, before and after."""
    along = verdict["where"]["along"] or "output"
    for when, colour in (("before", style.GREY), ("after", style.VERMILION)):
        low = localisation[f"{along}_low_{when}"].values
        high = localisation[f"{along}_high_{when}"].values
        edges = np.append(low, high[-1])
        gap = localisation[f"{along}_gap_{when}"]
        ax.stairs(gap.values, edges, color=colour, label=when, lw=1.1)
        null = localisation[f"{along}_null_{when}"].values
        ax.stairs(null, edges, color=colour, ls=":", lw=0.7)
    ax.plot([], [], color=style.GREY, ls=":", lw=0.7, label="chance, 95 %")
    unit = localisation[f"{along}_low_before"].attrs["units"]
    ax.set(
        xlabel=style.quantity(along.replace("_", " "), unit),
        ylabel=style.quantity("RMS gap", gap.attrs["units"]),
        ylim=(0, None),
    )
    ax.legend()


def _ladder(ax: Axes, verdict: Mapping[str, Any]) -> None:
    """Draw the held-out error, one effect at a time, down to the noise floor."""
    rungs = dict(verdict["ladder"])
    floor = rungs.pop("noise floor")
    ax.bar(range(len(rungs)), list(rungs.values()), color=style.BLUE, width=0.55)
    ax.axhline(floor, color=style.BLACK, lw=0.8, ls="--", label="noise floor")
    ax.legend(loc="upper right")
    ax.set_xticks(range(len(rungs)), [name.replace("_", " ") for name in rungs])
    ax.set(ylabel=style.quantity("held-out RMSE", verdict["unit"]), yscale="log")
    style.plain_log_ticks(ax.yaxis)


def _law(ax: Axes, verdict: Mapping[str, Any], candidates: xr.Dataset) -> None:
    """Draw each named parameter with its interval, or every effect's gain where none is named."""
    rows = [
        (effect["name"], name, estimate)
        for effect in verdict["effects"]
        for name, estimate in effect["parameters"].items()
    ]
    if not rows:
        _gains(ax, candidates)
        return
    for y, (_, _, estimate) in enumerate(rows):
        size = max(abs(estimate["value"]), 1e-12)
        ends = [100 * (estimate[end] - estimate["value"]) / size for end in ("low", "high")]
        ax.plot(np.clip(ends, -100, 100), [y, y], color=style.VERMILION, lw=1.5)
        ax.plot(0, y, "o", color=style.VERMILION)
    labels = [
        f"{name.replace('_', ' ')} = {e['value']:.3g}"
        + (f" {e['unit']}" if e["unit"] != "1" else "")
        for _, name, e in rows
    ]
    ax.set_yticks(range(len(rows)), labels)
    ax.set(xlabel="95 % interval about the estimate (%)", xlim=(-105, 105))
    ax.invert_yaxis()
    ax.axvline(0, color=style.PALE, lw=0.6, zorder=0)


def _gains(ax: Axes, candidates: xr.Dataset) -> None:
    order = np.argsort(candidates["gain"].values)[::-1][:8]
    gain, low, high = (candidates[n].values[order] for n in ("gain", "gain_low", "gain_high"))
    ax.errorbar(
        gain, range(order.size), xerr=[gain - low, high - gain], fmt="o", color=style.BLUE, lw=1.0
    )
    ax.axvline(float(candidates["null_gain"]), color=style.BLACK, ls="--", lw=0.8)
    ax.set_yticks(range(order.size), [str(n) for n in candidates["candidate"].values[order]])
    ax.set(xlabel="gain, log ratio of held-out RMSE (dashed: chance)")
    ax.invert_yaxis()


def _confusion(ax: Axes, candidates: xr.Dataset) -> None:
    """Draw how likely an effect, present at its fitted size, is called another."""
    matrix = candidates["confusion"].values
    names = [str(name)[:_WIDEST_NAME] for name in candidates["present"].values]
    image = ax.imshow(matrix, cmap="Blues", vmin=0, vmax=1)
    for (i, j), value in np.ndenumerate(matrix):
        if value >= 0.01:
            colour = "white" if value > 0.6 else style.BLACK
            ax.text(j, i, f"{value:.2f}", ha="center", va="center", fontsize=5.5, color=colour)
    ax.set_yticks(range(len(names)), names)
    ax.set_xticks(range(len(names)), [str(n + 1) for n in range(len(names))])
    ax.set(xlabel="called (same order)", ylabel="present")
    ax.figure.colorbar(image, ax=ax, label="probability", shrink=0.8)
