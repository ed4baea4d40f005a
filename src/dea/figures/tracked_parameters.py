"""Tracked parameters with their bands, and the residuals of free-run simulation with them."""

from math import ceil
from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from dea.figures import style
from dea.number_format import number
from dea.store import Sources, signals
from dea.terms import Term

_COLUMNS = 3
_POINTS = 1200  # a panel is 600 pixels wide
_LINE = 120  # characters of a note
_PALENESS = 0.22
# Where a simulation diverges: the part of its residuals that is usual, and the axis over it.
_USUAL, _OVER_USUAL = 0.99, 5.0
# First part of a record, which may leave a cut axis, and the parts of the course after it, and of
# an end of its band, that may do so on a side.
_START, _CUT_COURSE, _CUT_BAND = 0.15, 0.02, 0.2
# Margins of a cut axis, and from where on an axis is cut, both over what the rest spans.
_MARGIN, _FLATTENED = 0.5, 2.5
_TRACKER = {
    "rls": ("recursive least squares", style.BLUE, "-"),
    "kalman": ("Kalman smoother", style.VERMILION, "-"),
    "output_error": ("output-error smoother", style.GREEN, "--"),
    "local": ("local output error", style.BLACK, "-"),
}
_SIMULATION = {"fixed": ("fixed parameters", style.GREY, "-"), **_TRACKER}


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``track.nc`` of a system."""
    return tracked_parameters(sources.dataset("record"), sources.dataset("track"), sources.system)


@style.styled
def tracked_parameters(record: xr.Dataset, track: xr.Dataset, name: str) -> Figure:
    """Draw the residuals of each simulation, then each parameter over time.

    Parameters
    ----------
    record, track
        Contracts ``record`` and ``track`` of one actuator.
    """
    terms = track["term"].values
    rows = ceil(terms.size / _COLUMNS)
    above, below = 10 + 17 * track["simulation"].size, 12 + 34 * rows
    figure = style.page_figure(style.FULL_WIDTH, min(above + below, style.PAGE_HEIGHT))
    upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=[above, below]).ravel()
    errors = upper.subplots(track["simulation"].size, 1, sharex=True)
    _errors(np.atleast_1d(errors), record, track)
    upper.suptitle(
        f"{name}: what free-run simulation leaves unexplained (each on its own scale)", fontsize=7
    )
    upper.supylabel(
        style.quantity("measured − simulated", track["rmse"].attrs["units"]), fontsize=7
    )
    panels = lower.subplots(rows, _COLUMNS, squeeze=False).ravel()
    thin = track.isel(time=slice(None, None, max(1, track["time"].size // _POINTS)))
    for place, (panel, term) in enumerate(zip(panels, terms, strict=False)):
        _parameter(panel, thin.sel(term=term), str(term))
        style.time_axis(panel, track["time"].values)
        if place < _COLUMNS * (rows - 1):  # a label of each would leave a gap above the last row
            panel.set_xlabel("")
    for panel in panels[terms.size :]:
        panel.set_visible(False)
    lower.supylabel("parameter (normalised)", fontsize=7)
    handles, labels = panels[0].get_legend_handles_labels()
    bands = _bands(track)
    labels += [str(band.get_label()) for band in bands]
    lines = ceil(sum(map(len, labels)) / _LINE)
    lower.legend(
        [*handles, *bands], labels,
        loc="outside upper center", ncols=ceil(len(labels) / lines),
        title=_reservations(track), title_fontsize=6,
    )  # fmt: skip
    return figure


def _banded(track: xr.Dataset) -> list[str]:
    """Return the trackers whose parameters have bands."""
    withheld = track["withheld"]
    return [
        each for each in _in_order(track["tracker"]) if not str(withheld.sel(tracker=each).values)
    ]


def _bands(track: xr.Dataset) -> list[Patch]:
    """Return the legend's entry for the bands, which says whose they are, if there are any."""
    banded = _banded(track)
    if not banded:
        return []
    everyone = len(banded) == track["tracker"].size
    of = "each" if everyone else " and ".join(_TRACKER[each][0] for each in banded)
    colour = _TRACKER[banded[0]][1] if len(banded) == 1 else style.GREY
    return [Patch(facecolor=colour, alpha=_PALENESS, label=f"95 % band of {of}")]


def _reservations(track: xr.Dataset) -> str:
    """Return which trackers have no band, and which fell back on another."""
    notes: dict[str, list[str]] = {}
    for tracker in _in_order(track["tracker"]):
        chosen, name = track.sel(tracker=tracker), _TRACKER[tracker][0]
        withheld, estimator = (str(chosen[each].values) for each in ("withheld", "estimator"))
        if withheld:
            notes.setdefault(f"no 95 % band, {withheld}", []).append(name)
        elif estimator != tracker:
            notes.setdefault(f"parameters of {estimator}", []).append(name)
    return "\n".join(
        line for note, names in notes.items() for line in wrap(f"{', '.join(names)}: {note}", _LINE)
    )


def _in_order(names: xr.DataArray) -> list[str]:
    return sorted(map(str, names.values), key=list(_SIMULATION).index)


def _errors(axes: NDArray[np.object_], record: xr.Dataset, track: xr.Dataset) -> None:
    whole = signals(record)
    time = track["time"].values
    measured = np.interp(time, whole.time, whole.y)
    for ax, simulation in zip(axes, _in_order(track["simulation"]), strict=True):
        label, colour, _ = _SIMULATION[simulation]
        chosen = track.sel(simulation=simulation)
        error = measured - chosen["simulated"].values
        end = _divergence(chosen)
        size = np.abs(error[:end])
        size = size[np.isfinite(size)]
        worst = float(size.max(initial=0.0))
        reach = worst
        if end < time.size and size.size:
            reach = min(worst, _OVER_USUAL * float(np.quantile(size, _USUAL)))
        reach = min(reach or worst, float(np.nanmax(whole.y) - np.nanmin(whole.y)))
        ax.set_ylim(-1.1 * reach, 1.1 * reach)
        ax.plot(
            time[:end], error[:end], lw=style.line_width(time.size), color=colour, rasterized=True
        )
        ax.plot([time[0], time[end - 1] if end else time[0]], [0, 0], color=style.BLACK, lw=0.4)
        if end < time.size:
            ax.axvline(time[end], color=colour, lw=0.8, ls="--")
        ax.set_title(f"{label}: {_success(chosen, end, cut=reach < worst)}", loc="right", pad=2)
    style.time_axis(axes[-1], time)


def _divergence(simulation: xr.Dataset) -> int:
    """Return the sample at which a simulation is no longer finite; their number, if it stays so."""
    lost = np.flatnonzero(np.isinf(simulation["simulated"].values))
    if not lost.size or np.isfinite(float(simulation["nmse"])):
        return int(simulation["time"].size)
    return int(lost[0])


def _success(simulation: xr.Dataset, end: int, *, cut: bool) -> str:
    """Return the scores of a simulation, or when it diverged, at the sample ``end``."""
    nmse, rmse = float(simulation["nmse"]), float(simulation["rmse"])
    time = simulation["time"].values
    said = f"nmse {number(nmse)}, rmse {number(rmse)} {simulation['rmse'].attrs['units']}"
    if not np.isfinite(nmse):
        said = "diverged" + (f" at {style.moment(time[end], time)}" if end < time.size else "")
    return f"{said} (axis cut)" if cut else said


def _parameter(ax: Axes, track: xr.Dataset, term: str) -> None:
    time, banded = track["time"].values, _banded(track)
    for tracker in _in_order(track["tracker"]):
        label, colour, dashes = _TRACKER[tracker]
        chosen = track.sel(tracker=tracker)
        ax.plot(time, chosen["parameter"].values, color=colour, ls=dashes, lw=0.8, label=label)
        if tracker in banded:
            ax.fill_between(
                chosen["instant"].values, chosen["band_low"].values, chosen["band_high"].values,
                color=colour, alpha=_PALENESS, lw=0,
            )  # fmt: skip
    ax.set_title(Term.parse(term).mathematics())
    _limits(ax, track.sel(tracker=banded) if banded else None)


def _limits(ax: Axes, banded: xr.Dataset | None) -> None:
    """Limit an axis to the central part of what is drawn, where the rest would flatten it.

    The first estimates of a record rest on few samples: they swing, and their bands are wide.
    """
    drawn = [np.asarray(line.get_ydata(), dtype=np.float64) for line in ax.lines]
    parts = [(each, _CUT_COURSE) for each in drawn]
    if banded is not None:
        parts += [(banded[end].values.ravel(), _CUT_BAND) for end in ("band_low", "band_high")]
    every = np.concatenate([each[np.isfinite(each)] for each, _ in parts])
    later = [(each[round(_START * each.size) :], share) for each, share in parts]
    later = [(each[np.isfinite(each)], share) for each, share in later]
    later = [(each, share) for each, share in later if each.size]
    if not later:
        return
    least, most = float(every.min()), float(every.max())
    low = min(float(np.quantile(each, share)) for each, share in later)
    high = max(float(np.quantile(each, 1.0 - share)) for each, share in later)
    if not most - least > _FLATTENED * (high - low) > 0.0:
        return
    margin = _MARGIN * (high - low)
    style.cut(ax, max(least, low - margin), min(most, high + margin), (least, most))
