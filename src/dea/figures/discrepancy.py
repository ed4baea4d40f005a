"""A diagnosis: the residual and where it is largest, the errors, the named law, what is present."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from dea.effect_label import labelled, name_and_place
from dea.figures import style
from dea.figures.laws import leave_out, parameters, shape, tell, text_height
from dea.figures.lettering import in_words
from dea.number_format import share
from dea.store import Role, Sources

# Ends of a logarithmic axis beyond what is drawn on it.
_BESIDE = 1.3
# What the bins of the direction of the motion, numbered from 0, are called.
_DIRECTIONS = "falling", "still", "rising"
# Upper limit of the axis over the largest value, which leaves room for the legend.
_HEADROOM = 1.3
# Most samples of the runs that are drawn: more would look like a filled area.
_RUN = 1000
# Bars, or gains, that a panel has room for: at least, so that one bar alone is not too thick, and
# at most.
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
# Where, in units of probability, the shares stand beside the presences, and where that axis ends.
_SHARES_AT, _PRESENCE_END = 1.25, 1.9


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
    shapes = [f"law_{k + 1}_value" in certificate for k in range(len(effects))]
    columns = len(effects) if any(shapes) else 1
    cells = grid[2, 0].subgridspec(1, columns)
    laws = [figure.add_subplot(cells[0, k]) for k in range(columns)]
    present = figure.add_subplot(grid[2, 1])
    _series(series, certificate, verdict)
    _runs(runs, certificate, verdict)
    _where(where, localisation, verdict)
    _ladder(ladder, verdict)
    if not effects:
        _gains(laws[0], candidates)
    elif any(shapes):
        for number, (ax, effect, shaped) in enumerate(zip(laws, effects, shapes, strict=True), 1):
            # The text of the first of two laws would leave the page on the left.
            tell(ax, effect, "left" if number < columns else "right")
            if shaped:
                shape(ax, certificate, number, verdict["unit"])
            else:
                leave_out(ax)
        drawn = [ax for ax, shaped in zip(laws, shapes, strict=True) if shaped]
        # It is read from the right edge of the last column, whichever law is drawn.
        laws[-1].legend(*drawn[-1].get_legend_handles_labels(), **_ABOVE, fontsize=6)
    else:
        parameters(laws[0], effects)
    _presence(present, verdict, candidates)
    for ax in (series, runs, *laws):
        if ax.get_xscale() == "log":
            continue
        beside = len(laws) > 1 and ax in laws
        ax.xaxis.set_major_locator(MaxNLocator(_TICKS_BESIDE if beside else _TICKS))
    style.panel_letters([series, runs, where, ladder])
    # Beside another law there is no room for the letter but above the text of its own.
    style.panel_letters([laws[0]], "E", drop=-text_height(laws[0]) if len(laws) > 1 else 0.0)
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
    if not verdict["whole"]:
        return f"certain part of the answer: {names}{removed}"
    if verdict["law_too_poor"]:
        laws = "its law is" if len(verdict["effects"]) == 1 else "their laws are"
        return f"probably: {names}{removed}; {laws} too poor"
    return f"{verdict['status']}: {names}{removed}"


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
    held = np.concatenate([[0], certificate["role"].values == Role.CERTIFY, [0]])
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
    highest, told = 0.0, False
    for when, colour in (("before", style.GREY), ("after", style.VERMILION)):
        low = localisation[f"{along}_low_{when}"].values
        high = localisation[f"{along}_high_{when}"].values
        edges = np.append(low, high[-1])
        rms = localisation[f"{along}_rms_{when}"]
        null = localisation[f"{along}_null_{when}"].values
        empty = (rms.values == 0.0) & ~(null > 0.0)  # bins without samples, as of those kept aside
        ax.stairs(np.where(empty, np.nan, rms.values), edges, color=colour, label=when, lw=1.1)
        chance = np.where(empty, np.nan, null)
        ax.stairs(chance, edges, color=colour, ls=":", lw=0.7)
        told |= bool(np.isfinite(chance).any())
        highest = max(highest, float(rms.max()), float(null.max()))
    if told:
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
    if along == "direction":
        ax.set_xticks(range(len(_DIRECTIONS)), _DIRECTIONS)
        ax.set_xlabel("while the simulated output is")
    else:
        ax.xaxis.set_major_locator(MaxNLocator(_TICKS))
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
        beside = "coloured noise" if verdict.get("coloured_level", 0.0) else "model error"
        ax.axvline(level, color=style.BLACK, lw=0.8, ls=":", label=f"with {beside}")
    ax.legend(**_ABOVE)
    ax.set_yticks(range(len(rungs)), [in_words(name) for name in rungs])
    ax.set_ylim(max(len(rungs), _FEW) - 0.5, -0.5)
    ax.set(xlabel=style.quantity("held-out RMSE", verdict["unit"]), xscale="log")
    ends = [end for end in (*errors, floor, level) if end > 0.0]
    if ends:
        ax.set_xlim(min(ends) / _BESIDE, max(ends) * _BESIDE)
    style.plain_log_ticks(ax.xaxis)


def _gains(ax: Axes, candidates: xr.Dataset) -> None:
    """Draw the gains of the best candidates; of one that was only screened none is held out."""
    candidates = candidates.isel(candidate=candidates["finished"].values > 0)
    order = np.argsort(candidates["gain"].values)[::-1][:_MOST_BARS]
    gain, low, high = (candidates[n].values[order] for n in ("gain", "gain_low", "gain_high"))
    ax.errorbar(
        gain, range(order.size), xerr=[gain - low, high - gain], fmt="o", color=style.BLUE, lw=1.0
    )
    ax.axvline(float(candidates["null_gain"]), color=style.BLACK, ls="--", lw=0.8)
    names = [in_words(str(n)) for n in candidates["candidate"].values[order]]
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
        for name in {effect["name"], labelled(effect["name"], effect["place"])}:
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
    ax.set_yticks(range(len(found)), [in_words(name) for name, _ in found])
    ax.set_ylim(max(len(found), _FEW) - 0.5, -0.5)
    ax.set(xlim=(0, _PRESENCE_END))
    ax.set_xlabel("probability that it is part of the answer,\nand share of the gap")
    ax.set_xticks([0.0, 0.5, 1.0])
    ax.spines["bottom"].set_bounds(0.0, 1.0)


def _share_alone(candidates: xr.Dataset, name: str) -> float:
    """Return the part of the gap that an effect removes alone, at its best force port."""
    labels = candidates["candidate"].values
    own = [name in (label, name_and_place(str(label))[0]) for label in labels]
    shares = candidates["share"].values[own]
    return float(np.nanmax(shares)) if np.isfinite(shares).any() else np.nan


def _percent(part: float) -> str:
    return share(max(0.0, part))
