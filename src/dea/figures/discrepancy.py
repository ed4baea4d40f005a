"""A diagnosis: the residual and where it is largest, the errors, the named law, what is present."""

import re
from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from dea.figures import style
from dea.number_format import estimate, share, written_out
from dea.store import Sources

# Ends of a logarithmic axis beyond what is drawn on it.
_BESIDE = 1.3
# Upper limit of the axis over the largest value, which leaves room for the legend.
_HEADROOM = 1.3
# Most points of a law that are drawn, and most parameters in the text above it.
_MOST_POINTS = 3000
_TOLD = 3
# Most samples of the runs that are drawn: more would look like a filled area.
_RUN = 1000
# Letters of a line of a label beside an axis: longer ones leave the laws too little room.
_LABEL = 21
# Bars that a panel has room for: at least, so that one alone is not too thick, and at most.
_FEW, _MOST_BARS = 3, 8
# Intervals of an axis, so that labels as long as -1500 do not overlap.
_TICKS = 4
# The same where two laws stand side by side.
_TICKS_BESIDE = 2

# A legend of three entries above an axis of half the page's width, beside the letter of the panel.
_ABOVE: Mapping[str, Any] = {
    "ncols": 3, "loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.0,
    "columnspacing": 0.9, "handlelength": 1.1,
}  # fmt: skip
# Points that the text above a law leaves for such a legend.
_LEGEND_HEIGHT = 13.0
_LINE_HEIGHT = 7.2  # points
# Where, in units of probability, the shares stand beside the presences, and where that axis ends.
_SHARES_AT, _PRESENCE_END = 1.25, 1.9
# The band of a law, paler than the law.
_BAND = "#F3CDB2"
# Lengths that an output may have, in a metre.
_OF_A_METRE = {"mm": 1e3, "µm": 1e6, "um": 1e6}
# Part of a law's range on either side of it, beyond which its band is cut.
_ROOM = 1.0
# Height of the ticks that mark the samples of a law, in parts of its axis.
_RUG = 0.03


def draw(sources: Sources) -> Figure:
    """Draw it from the files of a diagnosis."""
    return discrepancy(
        sources.dataset("localisation"),
        sources.dataset("candidates"),
        sources.dataset("certificate"),
        sources.document("verdict"),
    )


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
    figure = style.page_figure(style.FULL_WIDTH, 160)
    grid = figure.add_gridspec(3, 2, height_ratios=[1.0, 1.0, 1.5])
    series, runs = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    where, ladder = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    effects = verdict["effects"]
    shapes = all(f"law_{k + 1}_value" in certificate for k in range(len(effects)))
    columns = len(effects) if effects and shapes else 1
    cells = grid[2, 0].subgridspec(1, columns)
    laws = [figure.add_subplot(cells[0, k]) for k in range(columns)]
    present = figure.add_subplot(grid[2, 1])
    _series(series, certificate, verdict)
    _runs(runs, certificate, verdict)
    _where(where, localisation, verdict)
    _ladder(ladder, verdict)
    if not effects:
        _gains(laws[0], candidates)
    elif shapes:
        for number, (ax, effect) in enumerate(zip(laws, effects, strict=True), 1):
            _shape(ax, certificate, number, effect, verdict["unit"])
            # The text of the first of two laws would leave the page on the left.
            _tell(ax, effect, "left" if number < columns else "right")
        laws[-1].legend(**_ABOVE, fontsize=6)
    else:
        _parameters(laws[0], effects)
    _presence(present, verdict, candidates)
    for ax in (series, runs, where, *laws):
        beside = len(laws) > 1 and ax in laws
        ax.xaxis.set_major_locator(MaxNLocator(_TICKS_BESIDE if beside else _TICKS))
    style.panel_letters([series, runs, where, ladder])
    # Beside another law there is no room for the letter but above the text of its own.
    style.panel_letters([laws[0]], "E", drop=-_text_height(laws[0]) if len(laws) > 1 else 0.0)
    style.panel_letters([present], "F")
    figure.suptitle(_title(verdict), fontsize=7.5)
    return figure


def _title(verdict: Mapping[str, Any]) -> str:
    names = " + ".join(map(_named, verdict["effects"]))
    if not names:
        return str(verdict["status"])
    removed = ""
    if verdict.get("share") and verdict["share"]["value"] > 0.0:
        removed = f", which removes {share(**verdict['share'])} of the gap"
    status = verdict["status"] if verdict["whole"] else "certain part of the answer"
    return f"{status}: {names}{removed}"


def _named(effect: Mapping[str, Any]) -> str:
    """Return an effect's name in words, with the input it acts at where there are several."""
    name = str(effect["name"]).replace("_", " ")
    pushes = effect["port"] == "force balance"
    return name if pushes or not effect["place"] else f"{name} at {effect['place']}"


def _simulations(verdict: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the simulations and their colours; without an effect there is no extended one."""
    nominal, extended = ("nominal", style.GREY), ("extended", style.VERMILION)
    return [nominal, extended] if verdict["effects"] else [nominal]


def _certified(certificate: xr.Dataset) -> list[slice]:
    """Return the runs of role certify; of several records one each."""
    held = np.concatenate([[0], certificate["role"].values == 3, [0]])
    edges = np.flatnonzero(np.diff(held)).tolist()
    return [slice(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _time_label(certificate: xr.Dataset) -> str:
    return "time, records in a row (s)" if certificate.attrs.get("records", 1) > 1 else "time (s)"


def _series(ax: Axes, certificate: xr.Dataset, verdict: Mapping[str, Any]) -> None:
    """Draw the residual of both simulations over time and shade the samples of role certify."""
    time, measured = certificate["time"].values, certificate["measured"].values
    unit = certificate["measured"].attrs["units"]
    for name, colour in _simulations(verdict):
        ax.plot(time, measured - certificate[name].values, color=colour, lw=0.5, label=name)
    for number, run in enumerate(_certified(certificate)):
        label = "" if number else "certified"
        ax.axvspan(time[run][0], time[run][-1], color=style.PALE, zorder=0, label=label)
    ax.set(
        xlabel=_time_label(certificate),
        ylabel=style.quantity("residual", unit),
        xlim=(time[0], time[-1]),
    )
    ax.legend(**_ABOVE)


def _runs(ax: Axes, certificate: xr.Dataset, verdict: Mapping[str, Any]) -> None:
    """Draw what was measured and simulated where the certified samples, or all, disagree most."""
    error = np.abs((certificate["measured"] - certificate["nominal"]).values)
    shown = _certified(certificate) or [slice(0, error.size)]
    run = max(shown, key=lambda each: float(np.nanmax(error[each])))
    worst = run.start + int(np.nanargmax(error[run]))
    first = max(run.start, min(worst - _RUN // 2, run.stop - _RUN))
    part = certificate.isel(time=slice(first, min(first + _RUN, run.stop)))
    time = part["time"].values
    ax.plot(time, part["measured"], color=style.MEASURED, lw=2.5, label="measured")
    for name, colour in _simulations(verdict):
        ax.plot(time, part[name], color=colour, lw=0.7, label=name)
    unit = certificate["measured"].attrs["units"]
    ax.set(
        xlabel=_time_label(certificate),
        ylabel=style.quantity("output", unit),
        xlim=(time[0], time[-1]),
    )
    ax.legend(**_ABOVE)


def _where(ax: Axes, localisation: xr.Dataset, verdict: Mapping[str, Any]) -> None:
    """Draw the RMS residual, before and after, along the quantity on which it depends most.

    Where it depends on none, that is the output.
    """
    found = verdict["where"]["along"]
    along = found or "output"
    highest = 0.0
    for when, colour in (("before", style.GREY), ("after", style.VERMILION)):
        low = localisation[f"{along}_low_{when}"].values
        high = localisation[f"{along}_high_{when}"].values
        edges = np.append(low, high[-1])
        rms = localisation[f"{along}_rms_{when}"]
        null = localisation[f"{along}_null_{when}"].values
        empty = (rms.values == 0.0) & ~(null > 0.0)  # bins without samples, as of those kept aside
        ax.stairs(np.where(empty, np.nan, rms.values), edges, color=colour, label=when, lw=1.1)
        ax.stairs(np.where(empty, np.nan, null), edges, color=colour, ls=":", lw=0.7)
        highest = max(highest, float(rms.max()), float(null.max()))
    ax.plot([], [], color=style.GREY, ls=":", lw=0.7, label="chance 95 %")
    ends = localisation[f"{along}_low_before"].attrs
    called = str(ends["long_name"]).removesuffix(": lower end").replace("_", " ")
    ax.set(
        xlabel=style.quantity(called, ends["units"]),
        ylabel=style.quantity("RMS residual", rms.attrs["units"]),
        ylim=(0, _HEADROOM * highest),
    )
    if not found:
        ax.set_title(f"no dependence found; along the {called}", loc="right")
    ax.locator_params(axis="x", nbins=6)
    ax.legend(ncols=3, loc="upper center", columnspacing=0.7, handlelength=0.9)


def _ladder(ax: Axes, verdict: Mapping[str, Any]) -> None:
    """Draw the held-out RMS error after each effect added, down to noise and model error."""
    rungs = dict(verdict["ladder"])
    floor = rungs.pop("noise floor")
    places, errors = range(len(rungs)), list(rungs.values())
    # No bars: a logarithmic axis has no zero from which they could begin.
    ax.hlines(places, floor, errors, color=style.BLUE, lw=1.0)
    ax.plot(errors, places, "o", color=style.BLUE, ms=5)
    ax.axvline(floor, color=style.BLACK, lw=0.8, ls="--", label="noise floor")
    level = verdict["model_error"].get("level", floor)
    if level > floor:
        ax.axvline(level, color=style.BLACK, lw=0.8, ls=":", label="with model error")
    ax.legend(**_ABOVE)
    ax.set_yticks(range(len(rungs)), [_in_words(name) for name in rungs])
    ax.set_ylim(max(len(rungs), _FEW) - 0.5, -0.5)
    ax.set(xlabel=style.quantity("held-out RMSE", verdict["unit"]), xscale="log")
    ends = [end for end in (*errors, floor, level) if end > 0.0]
    if ends:
        ax.set_xlim(min(ends) / _BESIDE, max(ends) * _BESIDE)
    style.plain_log_ticks(ax.xaxis)


def _in_words(label: str) -> str:
    """Return an effect's name in words and, below, the force port of the label, in short lines."""
    label = re.sub("@([^>+]*)>", r"\nfrom \1 to ", label.replace("_", " "))
    lines = label.replace("@", "\nat ").splitlines()
    return "\n".join(short for line in lines for short in wrap(line, _LABEL))


def _shape(
    ax: Axes, certificate: xr.Dataset, number: int, effect: Mapping[str, Any], unit: str
) -> None:
    """Draw a named law with its band at the samples of the record, and what would be without it.

    Samples that are not used, such as those of the first second, say nothing of the law: they are
    left out, except of a course in time. Lengths are in the ``unit`` of the output, where that is
    one, as are all others of the figure.
    """
    names = [f"law_{number}_{part}" for part in ("along", "value", "low", "high", "idle")]
    along_units = certificate[names[0]].attrs["units"]
    value_units = certificate[names[1]].attrs["units"]
    over_time = certificate[names[0]].attrs["long_name"] == "time"
    if not over_time:
        certificate = certificate.isel(time=certificate["role"].values > 0)
    parts = [
        _length_in(certificate[name], along_units if name == names[0] else value_units, unit)
        for name in names
    ]
    order = np.argsort(parts[0].values[:: -(-parts[0].size // _MOST_POINTS)], kind="stable")
    along, value, low, high, idle = (
        part.values[:: -(-part.size // _MOST_POINTS)][order] for part in parts
    )
    ax.vlines(along, low, high, color=_BAND, lw=1.2, label="95 % band", zorder=1.5)
    ax.plot(along, value, ".", ms=1.2, color=style.VERMILION, label="law")
    ax.plot(along, idle, color=style.GREY, ls="--", lw=0.8, label="without it")
    if not over_time:
        ax.vlines(along, 0.0, _RUG, color=style.BLACK, lw=0.15, transform=ax.get_xaxis_transform())
    _leave_room_for_law(ax, np.concatenate([value, idle]), float(low.min()), float(high.max()))
    for variable, place in ((parts[0], ax.set_xlabel), (parts[1], ax.set_ylabel)):
        name = str(variable.attrs["long_name"]).replace("_", " ")
        place(style.quantity(name, variable.attrs["units"]))


def _tell(ax: Axes, effect: Mapping[str, Any], side: Literal["left", "right"]) -> None:
    """Write the name of a law above it, and what the record says of its parameters."""
    told = [effect["name"].replace("_", " ")]
    if change := effect.get("change"):
        told.append(f"{change['name']} {change['start']:.3g} to {change['end']:.3g}")
    else:
        told += [_estimate(name, effect["parameters"][name]) for name in effect["quoted"][:_TOLD]]
    ax.set_title("\n".join(told), fontsize=_LINE_HEIGHT / 1.2, loc=side, pad=_LEGEND_HEIGHT)


def _leave_room_for_law(ax: Axes, drawn: NDArray[np.float64], low: float, high: float) -> None:
    """Cut a band from ``low`` to ``high`` that would flatten the law ``drawn``, and say so."""
    least, most = float(drawn.min()), float(drawn.max())
    room = _ROOM * (most - least)
    if not high - low > (1.0 + 2.0 * _ROOM) * (most - least) > 0.0:
        return
    style.cut(ax, max(low, least - room), min(high, most + room), (low, high))


def _length_in(values: xr.DataArray, units: str, wanted: str) -> xr.DataArray:
    """Return values in ``units`` of m or its rates in the length ``wanted``; others as they are."""
    length, *rest = units.split("/", 1)
    if length != "m" or wanted not in _OF_A_METRE:
        return values.assign_attrs(units=units)
    return (values * _OF_A_METRE[wanted]).assign_attrs(
        values.attrs | {"units": "/".join([wanted, *rest])}
    )


def _text_height(ax: Axes) -> float:
    """Return how far the text above a law reaches, in points."""
    lines = (ax.get_title(loc="left") or ax.get_title(loc="right")).count("\n") + 1
    return _LEGEND_HEIGHT + _LINE_HEIGHT * lines


def _estimate(name: str, found: Mapping[str, Any]) -> str:
    """Return a parameter as its name and what the sentence of the verdict would say of it."""
    value, low, high = (found[key] for key in ("value", "low", "high"))
    unit = style.raised(found["unit"])
    said = estimate(value, low, high, unit, at_bound=found["at_bound"])
    return written_out(f"{name.replace('_', ' ')} = {said}")


def _parameters(ax: Axes, effects: Sequence[Mapping[str, Any]]) -> None:
    """Draw each named parameter with its interval."""
    labels: list[str] = []
    for effect in effects:
        if len(effects) > 1:
            place = f"@{effect['place']}" if effect["place"] else ""
            header = _in_words(f"{effect['name']}{place}").replace("\n", " ")
            ax.text(-100, len(labels), header, va="center", fontsize=6)
            labels.append("")
        for name, found in effect["parameters"].items():
            value, low, high = (found[key] for key in ("value", "low", "high"))
            size = max(abs(value), 1e-12)
            ends = np.clip([100 * (end - value) / size for end in (low, high)], -100, 100)
            # The interval contains zero: its size relative to the estimate says nothing.
            colour = style.GREY if low <= 0 <= high else style.VERMILION
            y = len(labels)
            ax.plot(ends, [y, y], color=colour, lw=1.5)
            ax.plot(0, y, "o", color=colour)
            labels.append(_estimate(name, found))
    ticks = [y for y, label in enumerate(labels) if label]
    ax.set_yticks(ticks, [labels[y] for y in ticks])
    ax.set(xlabel="95 % interval about the estimate (%; grey: may be zero)", xlim=(-105, 105))
    ax.set_ylim(len(labels) - 0.5, -0.7)
    ax.axvline(0, color=style.PALE, lw=0.6, zorder=0)


def _gains(ax: Axes, candidates: xr.Dataset) -> None:
    """Draw the gains of the best candidates; of one that was only screened none is held out."""
    candidates = candidates.isel(candidate=candidates["finished"].values > 0)
    order = np.argsort(candidates["gain"].values)[::-1][:8]
    gain, low, high = (candidates[n].values[order] for n in ("gain", "gain_low", "gain_high"))
    ax.errorbar(
        gain, range(order.size), xerr=[gain - low, high - gain], fmt="o", color=style.BLUE, lw=1.0
    )
    ax.axvline(float(candidates["null_gain"]), color=style.BLACK, ls="--", lw=0.8)
    names = [_in_words(str(n)) for n in candidates["candidate"].values[order]]
    ax.set_yticks(range(order.size), names)
    ax.set(xlabel="gain, log ratio of held-out RMSE (dashed: chance)")
    ax.invert_yaxis()


def _presence(ax: Axes, verdict: Mapping[str, Any], candidates: xr.Dataset) -> None:
    """Draw the probability of each effect to be part of the answer; named ones stand out.

    Beside it stands the part of the gap that it removes: of those named one after the other, of the
    rest alone.
    """
    named: dict[str, float | None] = {}
    for effect in verdict["effects"]:
        for name in (effect["name"], f"{effect['name']}@{effect['place']}"):
            before, own = named.get(name), effect["share"]
            # An effect may act at two places.
            named[name] = own if before is None else before + (own or 0.0)
    found = sorted(verdict["presence"]["effects"].items(), key=lambda pair: -pair[1])[:_MOST_BARS]
    colours = [style.VERMILION if name in named else style.GREY for name, _ in found]
    values = [value for _, value in found]
    ax.barh(range(len(found)), values, color=colours, height=0.55)
    for y, (name, value) in enumerate(found):
        ax.text(value + 0.02, y, f"{value:.2f}", va="center", fontsize=6)
        alone = _share_alone(candidates, name)
        if (removed := named.get(name)) is not None:
            ax.text(_SHARES_AT, y, f"removes {_percent(removed)}", va="center", fontsize=6)
        elif name not in named:
            said = f"alone {_percent(alone)}" if np.isfinite(alone) else "not fitted alone"
            ax.text(
                _SHARES_AT, y, said, va="center", fontsize=6,
                color=style.GREY,
            )  # fmt: skip
    ax.set_yticks(range(len(found)), [_in_words(name) for name, _ in found])
    ax.set_ylim(max(len(found), _FEW) - 0.5, -0.5)
    ax.set(xlim=(0, _PRESENCE_END))
    ax.set_xlabel("probability that it is part of the answer,\nand share of the gap")
    ax.set_xticks([0.0, 0.5, 1.0])
    ax.spines["bottom"].set_bounds(0.0, 1.0)


def _share_alone(candidates: xr.Dataset, name: str) -> float:
    """Return the part of the gap that an effect removes alone, at its best force port."""
    labels = candidates["candidate"].values
    own = [label == name or str(label).startswith(f"{name}@") for label in labels]
    shares = candidates["share"].values[own]
    return float(np.nanmax(shares)) if np.isfinite(shares).any() else np.nan


def _percent(part: float) -> str:
    return share(max(0.0, part))
