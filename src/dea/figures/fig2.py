"""Fig. 2: choice of orders, and models against measurement on three windows.

Where the parameters come from is told by colour: *forecast* (estimated before the window), *fitted*
(to the very window that is shown, by the same criterion) and *one step ahead* (the published
approach: fitted to the window by least squares on the one-step error).
"""

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.typing import LineStyleType
from numpy.typing import NDArray

from dea.configuration.lags import largest_lag
from dea.figures import style
from dea.figures.lettering import in_lines
from dea.number_format import number
from dea.store import Sources

_LOOK: dict[str, tuple[str, LineStyleType, str, str]] = {
    "forecast": (style.FORECAST, "-", "forecast", "forecast: parameters from before the window"),
    "fitted": (style.FITTED, (0, (4, 2)), "fitted", "fitted to the window by the same criterion"),
    "fitted, one-step": (
        style.ONE_STEP, (0, (1, 1.5)), "one step ahead", "fitted to the window one step ahead"
    ),
}  # fmt: skip


def draw(sources: Sources) -> Figure:
    """Draw it from ``orders.nc`` and ``validation.nc`` of a system."""
    return fig2(sources.dataset("orders"), sources.dataset("validation"), sources.system)


@style.styled
def fig2(orders: xr.Dataset, validation: xr.Dataset, name: str) -> Figure:
    """Draw orders and validation of one actuator (contracts ``orders`` and ``validation``)."""
    figure = style.page_figure(style.FULL_WIDTH, 190)
    choice, simulations = figure.subfigures(2, 1, squeeze=False, height_ratios=[52, 138]).ravel()
    dynamic, polynomial, scatter = choice.subplots(1, 3)
    _order(dynamic, orders, "dynamic")
    _order(polynomial, orders, "polynomial")
    _predicted(scatter, validation)
    windows = validation["window"].size
    rows = simulations.subplots(1 + windows, 1)
    _window(rows[0], validation, "linear", 0)
    for window in range(windows):
        _window(rows[1 + window], validation, "narx", window)
    rows[-1].set_xlabel("time (s)")
    handles, labels = rows[0].get_legend_handles_labels()
    simulations.legend(handles, labels, loc="outside upper center", ncols=2)
    style.panel_letters([dynamic, polynomial, scatter], x=-22)
    style.panel_letters(rows, "D", x=-26)
    scatter.set_title(in_lines(name, style.FULL_WIDTH / 5), loc="right")
    return figure


def _order(ax: Axes, orders: xr.Dataset, kind: str) -> None:
    """Draw nmse and fpe against an order, each over its least, so that they part where they differ.

    The fpe is the mean square error times a charge for terms. On one axis, scaled alike, the two
    curves differ by that charge alone.
    """
    order = orders[f"{kind}_order"]
    for criterion, colour, look in (
        ("nmse", style.NMSE, {"marker": "o"}),
        ("fpe", style.FPE, {"marker": "s", "ms": 6, "mfc": "none", "ls": "--"}),
    ):
        values = orders[f"{kind}_{criterion}"]
        least = float(values.values.min())
        label = style.quantity(f"{criterion}, least {number(least)}", values.attrs["units"])
        # Where every model has diverged, or one has no error, there is no least to compare with.
        scale = least if 0.0 < least < np.inf else 1.0
        ax.plot(order, values / scale, color=colour, label=label, **look)
    ax.set_xlim(*ax.get_xlim())
    chosen = _chosen(orders, kind)
    if chosen is not None:
        # The line of an order beyond those compared lies beyond the axis.
        label = f"chosen: {chosen}" + (" \N{RIGHTWARDS ARROW}" if chosen > order.max() else "")
        ax.axvline(chosen, color=style.GREY, lw=0.8, ls=":", label=label, zorder=1)
    ax.set_yscale("log")
    low, high = ax.get_ylim()
    ax.set_ylim(low, high * (high / low) ** 0.6)  # room for the legend
    style.plain_log_ticks(ax.yaxis)
    ax.set_xticks(order.values)
    ax.set_xlabel(f"{kind} order")
    ax.set_ylabel("error over the least")
    # The line of the chosen order does not cross the words.
    ax.legend(loc="upper center", frameon=True, framealpha=0.9, edgecolor="none")


def _chosen(orders: xr.Dataset, kind: str) -> int | None:
    """Return the order of the models that were identified: of lags the largest number."""
    identification = json.loads(orders.attrs.get("settings", "{}")).get("identification")
    if identification is None:
        return None
    keys = ("y_lags", "u_lags") if kind == "dynamic" else ("degree",)
    return largest_lag(*(identification[key] for key in keys))


def _predicted(ax: Axes, validation: xr.Dataset) -> None:
    """Draw forecast against measured output of all windows."""
    measured = validation["measured"]
    forecast = validation["simulated"].sel(approach="forecast")
    for model, colour in (("linear", style.LINEAR), ("narx", style.NARX)):
        label = {"linear": "linear", "narx": "NARX"}[model]
        ax.plot(
            measured.values.ravel(), forecast.sel(model=model).values.ravel(), ".", ms=1.0, mew=0,
            color=colour, label=label, rasterized=True,
        )  # fmt: skip
    ends = _around(measured)
    ax.plot(ends, ends, color=style.GREY, lw=0.6, zorder=1)
    ax.set(xlim=ends, ylim=ends)
    ax.set_box_aspect(1)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(4))
    units = measured.attrs["units"]
    ax.set_xlabel(style.quantity("measured $y$", units))
    ax.set_ylabel(style.quantity(r"forecast $\hat y$", units))
    ax.legend(loc="upper left", markerscale=6, handletextpad=0.2)


def _window(ax: Axes, validation: xr.Dataset, model: str, window: int) -> None:
    part = validation.isel(window=window).sel(model=model)
    ax.plot(part["time"], part["measured"], color=style.MEASURED, lw=2.6, label="measured")
    for approach, (colour, dashes, _, label) in _LOOK.items():
        run = part["simulated"].sel(approach=approach)
        ax.plot(part["time"], run, color=colour, ls=dashes, lw=0.8, label=label)
    name = {"linear": "linear model", "narx": "NARX model"}[model]
    scores = ", ".join(
        f"{short} {number(float(part['nmse'].sel(approach=approach)))}"
        for approach, (_, _, short, _) in _LOOK.items()
    )
    ax.set_title(f"{name}; nmse: {scores}", loc="right")
    time = part["time"].values
    ax.set_xlim(time[0], 2 * time[-1] - time[-2])
    ax.set_ylim(_around(part["measured"]))
    ax.set_ylabel(style.quantity("$y$", part["measured"].attrs["units"]))
    lost = [each for each in _LOOK if not np.isfinite(part["simulated"].sel(approach=each)).all()]
    for line, approach in enumerate(lost):
        _mark_divergence(ax, time, part["simulated"].sel(approach=approach).values, approach, line)


def _mark_divergence(
    ax: Axes, time: NDArray[np.float64], run: NDArray[np.float64], approach: str, line: int
) -> None:
    """Mark the time after which a run that diverges stays off the axis, with a line of text."""
    low, high = ax.get_ylim()
    end = int(np.flatnonzero(~np.isfinite(run))[0])
    within = np.flatnonzero((run[:end] >= low) & (run[:end] <= high))
    left = time[min(end, within[-1] + 1 if within.size else 0)]
    colour, _, short, _ = _LOOK[approach]
    ax.axvline(left, color=colour, lw=0.6, ls=":")
    early = left < time.mean()
    ax.annotate(
        f"{short} diverged at {left:.4g} s", (left, 1), (4 if early else -4, -2 - 8 * line),
        xycoords=ax.get_xaxis_transform(), textcoords="offset points", fontsize=6.5, color=colour,
        ha="left" if early else "right", va="top",
    )  # fmt: skip


def _around(measured: xr.DataArray) -> tuple[float, float]:
    """Return limits of an axis from the measurement alone: a simulation may diverge."""
    low, high = float(measured.min()), float(measured.max())
    margin = 0.25 * (high - low)
    return low - margin, high + margin
