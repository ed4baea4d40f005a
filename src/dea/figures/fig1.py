"""Fig. 1: the bench, the actuator, and its record."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dea.errors import InputError
from dea.figures import style
from dea.figures.bench_drawing import draw_bench, draw_cone
from dea.store import Record, Sources, signals

_FIGURE = "The figure of a record"
# Samples that show output against input at most: more cover each other. Samples that
# are drawn as points of size one (square points), and the sizes of more and of fewer.
_MOST, _DENSE, _SIZES = 30_000, 20_000, (0.25, 4.0)


def draw(sources: Sources, zoom: tuple[float, float]) -> Figure:
    """Draw it from ``record.nc`` of an actuator; ``zoom`` is the stretch to enlarge, s."""
    return fig1(sources.dataset("record"), sources.system, zoom)


@style.styled
def fig1(record: xr.Dataset, name: str, zoom: tuple[float, float]) -> Figure:
    """Draw the set-up and the record of one actuator.

    Parameters
    ----------
    record
        Contract ``record`` or ``imported_record``.
    name
        What the actuator is called.
    zoom
        First and last time of the enlarged stretch, s.

    Raises
    ------
    InputError
        Where the stretch lies outside the record.
    """
    whole = signals(record)
    if not whole.time[0] <= zoom[0] < zoom[1] <= whole.time[-1] + whole.time[1]:
        raise InputError(
            f"{zoom[0]:g} to {zoom[1]:g} s is no stretch of the record of {name}, which lasts from "
            f"{whole.time[0]:g} to {whole.time[-1]:g} s",
            file="config/config.yaml",
            field="figures.zoom",
            remedy="Give its first and last second to enlarge.",
        )
    inside = (whole.time >= zoom[0]) & (whole.time <= zoom[1])
    figure = style.page_figure(style.FULL_WIDTH, 168)
    drawings, series, details = figure.subfigures(
        3, 1, squeeze=False, height_ratios=[62, 50, 56]
    ).ravel()
    bench, cone = drawings.subplots(1, 2, width_ratios=[104, 74])
    draw_bench(bench)
    draw_cone(cone)
    top, bottom = series.subplots(2, 1, sharex=True)
    _whole_record(top, bottom, whole, zoom)
    zoomed_input, loop, zoomed_output = details.subplots(1, 3)
    u_units = whole.unit_of_one_input(_FIGURE)
    for ax, values, label, colour in (
        (
            zoomed_input,
            whole.u,
            style.quantity("input $u$", u_units),
            style.BLUE,
        ),
        (zoomed_output, whole.y, style.quantity("output $y$", whole.y_units), style.BLACK),
    ):
        ax.plot(whole.time[inside], values[inside], color=colour)
        ax.set(xlabel="time (s)", ylabel=label, xlim=zoom)
    _input_output(figure, loop, whole)
    top.set_title(name, loc="right")
    style.panel_letters([bench, cone], drop=10)
    style.panel_letters([top], "C", x=-26)
    style.panel_letters([zoomed_input, loop, zoomed_output], "D", x=-22)
    return figure


def _whole_record(top: Axes, bottom: Axes, whole: Record, zoom: tuple[float, float]) -> None:
    for ax, values, units, symbol, colour in (
        (top, whole.u, whole.unit_of_one_input(_FIGURE), "input $u$", style.BLUE),
        (bottom, whole.y, whole.y_units, "output $y$", style.BLACK),
    ):
        width = style.line_width(whole.time.size)
        ax.plot(whole.time, values, lw=width, color=colour, rasterized=True)
        ax.axvspan(*zoom, color=style.ORANGE, alpha=0.45, lw=0)
        ax.set_ylabel(style.quantity(symbol, units))
    style.time_axis(bottom, whole.time)


def _input_output(figure: Figure, ax: Axes, whole: Record) -> None:
    unit, name = style.clock(whole.time)
    # In no order of time, so that late samples do not hide early ones; the same each time.
    order = np.random.default_rng(0).permutation(whole.time.size)[:_MOST]
    points = ax.scatter(
        whole.u[order],
        whole.y[order],
        c=whole.time[order] / unit,
        s=float(np.clip(_DENSE / order.size, *_SIZES)),
        lw=0,
        cmap=style.TIME_MAP,
        rasterized=True,
    )
    ax.set_xlabel(style.quantity("input $u$", whole.unit_of_one_input(_FIGURE)))
    ax.set_ylabel(style.quantity("output $y$", whole.y_units))
    points.set_clim(0, (whole.time[-1] + whole.time[1]) / unit)
    bar = figure.colorbar(points, ax=ax, pad=0.02, aspect=28)
    bar.ax.set_title(f"time ({name})", loc="right")  # beside the bar it would touch what follows
