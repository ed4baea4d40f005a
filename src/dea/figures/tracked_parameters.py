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
    panels = lower.subplots(rows, _COLUMNS, squeeze=False, sharex=True).ravel()
    thin = track.isel(time=slice(None, None, max(1, track["time"].size // _POINTS)))
    for panel, term in zip(panels, terms, strict=False):
        _parameter(panel, thin.sel(term=term), str(term))
    for panel in panels[terms.size :]:
        panel.set_visible(False)
    for panel in panels[max(0, terms.size - _COLUMNS) : terms.size]:
        panel.tick_params(labelbottom=True)
        style.time_axis(panel, track["time"].values)
    lower.supylabel("parameter (normalised)", fontsize=7)
    handles, labels = panels[0].get_legend_handles_labels()
    band = Patch(facecolor=style.GREY, alpha=_PALENESS, label="95 % band of each")
    lower.legend(
        [*handles, band], [*labels, band.get_label()],
        loc="outside upper center", ncols=len(handles) + 1,
        title=_reservations(track), title_fontsize=6,
    )  # fmt: skip
    return figure


def _reservations(track: xr.Dataset) -> str:
    """Return which trackers have no band, and which fell back on another."""
    notes: dict[str, list[str]] = {}
    for tracker in _in_order(track["tracker"]):
        chosen, name = track.sel(tracker=tracker), _TRACKER[tracker][0]
        withheld, estimator = (
            str(chosen[each].values) for each in ("parameters_withheld", "estimator")
        )
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
        worst = float(np.abs(error[np.isfinite(error)]).max(initial=0.0))
        spread = float(np.nanmax(whole.y) - np.nanmin(whole.y))
        reach = min(worst, spread)  # a simulation may diverge
        ax.set_ylim(-1.1 * reach, 1.1 * reach)
        ax.plot(time, error, lw=0.2, color=colour, rasterized=True)
        ax.axhline(0, color=style.BLACK, lw=0.4)
        ax.set_title(f"{label}: {_success(chosen)}", loc="right", pad=2)
    style.time_axis(axes[-1], time)


def _success(simulation: xr.Dataset) -> str:
    nmse, rmse = float(simulation["nmse"]), float(simulation["rmse"])
    if not np.isfinite(nmse):
        return "diverged"
    return f"nmse {number(nmse)}, rmse {number(rmse)} {simulation['rmse'].attrs['units']}"


def _parameter(ax: Axes, track: xr.Dataset, term: str) -> None:
    time = track["time"].values
    for tracker in _in_order(track["tracker"]):
        label, colour, dashes = _TRACKER[tracker]
        chosen = track.sel(tracker=tracker)
        ax.plot(time, chosen["parameter"].values, color=colour, ls=dashes, lw=0.8, label=label)
        if not str(chosen["parameters_withheld"].values):
            ax.fill_between(
                chosen["instant"].values, chosen["band_low"].values, chosen["band_high"].values,
                color=colour, alpha=_PALENESS, lw=0, rasterized=True,
            )  # fmt: skip
    ax.set_title(Term.parse(term).mathematics())
