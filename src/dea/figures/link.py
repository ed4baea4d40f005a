"""Quality of the acquisition: round trips, lateness, retries and errors of every actuator."""

from collections.abc import Mapping, Sequence
from math import ceil

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from dea.figures import style
from dea.figures.lettering import in_lines
from dea.store import Sources

_MILLI = 1e3
_MARGIN = 1.2  # factor, beyond the bins that hold round trips
_LONG_RANGE = 100.0  # ratio of the longest round trip to the shortest, with 2 and 5 labelled
_LINE = 0.09  # of the table's height, at most, a line of it
_SPACE = 0.45  # of a line, around the text of a row
_TEXT = 2.7  # mm, a line of the table at least
_COLUMNS = {"exchanges": 13.5, "retries": 9.5, "reconnects": 14.0, "errors": 16.0}  # mm
_NAMES = 22.0  # mm, at most, for a name in the table
_LETTER, _FEW = 1.4, 5  # mm, and the least letters of a name that the table has room for
_ROOM = 134.0  # mm, for the table and two panels beside it
_LEGEND_LETTERS, _HANDLE = 105, 7  # of a line of the legend, and what a line and gap take of them


def draw(sources: Sources) -> Figure:
    """Draw it from ``link.nc`` of every actuator."""
    return link(sources.datasets("link"))


@style.styled
def link(links: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the quality of each link (contract ``link``), by the actuators' names."""
    polled = {name: each["jitter"].values for name, each in links.items() if each["jitter"].size}
    across = min(len(links), 8, max(1, _LEGEND_LETTERS // (max(map(len, links)) + _HANDLE)))
    rows = _rows(links)
    panel = max(44, 6 * len(links), _TEXT * sum(_heights(rows)))
    above = 4 * ceil(len(links) / across)
    if polled:
        figure = style.page_figure(style.FULL_WIDTH, 2 * panel + 20 + above)
        axes = figure.subplot_mosaic("tc;lr")
    else:
        figure = style.page_figure(style.FULL_WIDTH, panel + 18 + above)
        table = sum(_widths(rows))
        panels = [0.5 * (_ROOM - table)] * 2
        axes = figure.subplot_mosaic("tcr", width_ratios=[*panels, table])
    trips, course, repairs = axes["t"], axes["c"], axes["r"]
    looks = {name: style.look(number) for number, name in enumerate(links)}
    _round_trips(trips, links, looks)
    _course(course, links, looks)
    if polled:
        _lateness(axes["l"], polled, looks)
    _repairs(repairs, rows)
    handles = [
        handle if look.is_plain else Line2D([], [], color=look.colour, ls=look.line, lw=1.0,
                                            marker=look.marker, ms=2, mew=0)
        for handle, look in zip(trips.get_legend_handles_labels()[0], looks.values(), strict=True)
    ]  # fmt: skip
    figure.legend(handles, list(looks), loc="outside upper center", ncols=across)
    style.panel_letters(list(axes.values()), x=-22)
    return figure


def _round_trips(
    ax: Axes, links: Mapping[str, xr.Dataset], looks: Mapping[str, style.Look]
) -> None:
    used = [np.inf, 0.0]
    for name, dataset in links.items():
        low, high = (dataset[f"round_trip_{end}"].values * _MILLI for end in ("low", "high"))
        count = dataset["round_trip_count"].values
        edges = np.append(low, high[-1])
        look = looks[name]
        ax.stairs(count, edges, color=look.colour, ls=look.line, lw=1.0, label=name)
        filled = np.flatnonzero(count)
        used = [min(used[0], low[filled[0]]), max(used[1], high[filled[-1]])]
    ax.set(xscale="log", xlabel="round trip (ms)", ylabel="exchanges per bin")
    ax.set_xlim(used[0] / _MARGIN, used[1] * _MARGIN)
    ax.set_yscale("symlog", linthresh=1)
    most = max(int(dataset["round_trip_count"].max()) for dataset in links.values())
    ax.set_ylim(0, 2 * most)
    style.plain_log_ticks(ax.xaxis, longest=_LONG_RANGE)
    ax.yaxis.set_major_formatter("{x:g}")


def _course(ax: Axes, links: Mapping[str, xr.Dataset], looks: Mapping[str, style.Look]) -> None:
    for name, dataset in links.items():
        sent = dataset["send_time"].values
        trip = (dataset["receive_time"].values - sent) * _MILLI
        look = looks[name]
        ax.plot(sent, trip, look.marker, ms=2, mew=0, color=look.colour, rasterized=True)
    ax.set(yscale="log", xlabel="time of the request, host's clock (s)", ylabel="round trip (ms)")
    style.plain_log_ticks(ax.yaxis)


def _lateness(
    ax: Axes, polled: Mapping[str, NDArray[np.float64]], looks: Mapping[str, style.Look]
) -> None:
    """Draw the share of samples against their lateness, of the links that the host paces."""
    ax.set(xlabel="lateness behind the deadline (ms)", ylabel="share at least as late")
    for name, jitter in polled.items():
        late = np.sort(jitter)[::-1] * _MILLI
        share = np.arange(1, late.size + 1) / late.size
        look = looks[name]
        ax.plot(late, share, color=look.colour, ls=look.line, rasterized=True)
    ax.set(yscale="log", ylim=(None, 1), xlim=(0, None))


def _rows(links: Mapping[str, xr.Dataset]) -> list[list[str]]:
    """Return the texts of a row per actuator: name, exchanges, retries, reconnects and errors."""
    return [
        [
            in_lines(name, _NAMES),
            f"{dataset['send_time'].size}",
            f"{int(dataset['retries'].sum())}",
            f"{int(dataset['reconnects'])}",
            _errors(dataset),
        ]
        for name, dataset in links.items()
    ]


def _widths(rows: Sequence[Sequence[str]]) -> list[float]:
    """Return the widths (mm) of the columns, of which the first is as wide as the names."""
    longest = max(len(line) for name, *_ in rows for line in name.split("\n"))
    return [_LETTER * max(longest, _FEW), *_COLUMNS.values()]


def _heights(rows: Sequence[Sequence[str]]) -> list[float]:
    """Return the heights of the header and the rows, in lines."""
    lines = (max(text.count("\n") for text in row) + 1 for row in rows)
    return [1 + _SPACE, *(count + _SPACE for count in lines)]


def _repairs(ax: Axes, rows: Sequence[Sequence[str]]) -> None:
    """Write the table of the rows."""
    ax.axis("off")
    widths, heights = np.array(_widths(rows)), _heights(rows)
    table = ax.table(
        rows, colLabels=["", *_COLUMNS], loc="upper left", cellLoc="left", colLoc="left",
        edges="horizontal", colWidths=list(widths / widths.sum()),
    )  # fmt: skip
    table.auto_set_font_size(False)
    table.set_fontsize(6)
    line = min(_LINE, 1.0 / sum(heights))
    for (row, _), cell in table.get_celld().items():
        cell.set_linewidth(0.4)
        cell.set_height(line * heights[row])


def _errors(dataset: xr.Dataset) -> str:
    kinds = [
        f"{int(count)} {kind}"
        for kind, count in zip(dataset["error_kind"].values, dataset["errors"].values, strict=True)
        if count
    ]
    return "\n".join(kinds) or "none"
