"""Controllers that followed a reference: the first and the last minute, and the error over time."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from dea.figures import style
from dea.store import MINUTE, Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``control.nc`` of an actuator."""
    (dataset,) = sources.datasets("control").values()
    return control(dataset)


@style.styled
def control(dataset: xr.Dataset) -> Figure:
    """Draw a trial of controllers (contract ``control``)."""
    figure = style.page_figure(style.FULL_WIDTH, 120)
    (first, last), (voltage, errors) = figure.subplots(2, 2)
    time = dataset["time"].values
    best = dataset.isel(controller=0)
    minute = time <= time[0] + MINUTE, time >= time[-1] - MINUTE
    for ax, inside, word in zip((first, last), minute, ("first", "last"), strict=True):
        _followed(ax, best, inside, f"{word} minute: {best['controller'].item()}")
    voltage.plot(time[minute[1]], best["voltage"].values[minute[1]], color=style.BLACK, lw=0.7)
    voltage.set(xlabel="time (s)", ylabel=style.quantity("voltage", best["voltage"].units))
    voltage.set_xlim(time[minute[1]][0], time[-1])
    if _say_if_stopped(voltage, best, best["voltage"].values[minute[1]]):
        voltage.set_yticks([])
    _errors(errors, dataset)
    first.legend(loc="upper right", ncols=2)
    figure.legend(*errors.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    style.panel_letters([first, last, voltage, errors], x=-22)
    return figure


def _followed(ax: Axes, best: xr.Dataset, inside: NDArray[np.bool_], title: str) -> None:
    time, measured = best["time"].values[inside], best["measured"].values[inside]
    ax.plot(time, measured, color=style.MEASURED, lw=2.4, label="measured")
    ax.plot(time, best["reference"].values[inside], color=style.BLACK, lw=0.6, label="wanted")
    _say_if_stopped(ax, best, measured)
    ax.set(xlabel="time (s)", ylabel=style.quantity("displacement", best["measured"].units))
    ax.set_xlim(time[0], time[-1])
    ax.margins(y=0.25)
    ax.set_title(title)


def _say_if_stopped(ax: Axes, best: xr.Dataset, drawn: NDArray[np.float64]) -> bool:
    """Say why nothing is ``drawn``, where that is so."""
    stopped = bool(np.isnan(drawn).all())
    if stopped:
        ax.text(0.5, 0.05, f"stopped: {best['outcome'].item()}", ha="center", va="bottom",
                transform=ax.transAxes)  # fmt: skip
    return stopped


def _errors(ax: Axes, dataset: xr.Dataset) -> None:
    """Draw the error of each controller, minute by minute."""
    share = 100.0 * dataset["rms_error"] / dataset["stroke"]
    minutes = dataset["minute"].values
    for name, colour in zip(dataset["controller"].values, style.CYCLE, strict=False):
        course = share.sel(controller=name).values
        label = str(name) if np.isfinite(course).any() else f"{name} (stopped)"
        ax.plot(minutes, course, ".-", ms=3, lw=0.8, color=colour, label=label)
    ax.axhline(1.0, color=style.GREY, lw=0.6, ls=":")
    ax.set(yscale="log", xlabel="time (min)", ylabel="RMS error (% of the stroke)")
    style.plain_log_ticks(ax.yaxis)
    ax.set_xlim(0.5, minutes.size + 0.5)
    ax.xaxis.set_major_locator(MultipleLocator(max(1, minutes.size // 6)))
