"""The named laws of a diagnosis: their shapes, or where those are not known their parameters."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import Formatter
from numpy.typing import NDArray

from dea.effect_label import labelled
from dea.figures import style
from dea.figures.lettering import in_words
from dea.number_format import estimate, written_out
from dea.store import Role

# Most points of a law that are drawn, and most parameters in the text above it.
_MOST_POINTS = 3000
_TOLD = 3
# Points that the text above a law leaves for a legend of one line.
_LEGEND_HEIGHT = 13.0
_LINE_HEIGHT = 7.2  # points
# The band of a law, paler than the law.
_BAND = "#F3CDB2"
# Lengths that an output may have, in a metre.
_OF_A_METRE = {"mm": 1e3, "µm": 1e6, "um": 1e6}
# Part of a law's range on either side of it, beyond which its band is cut.
_ROOM = 1.0
# Powers of a thousand that numbers along an axis are written with in full.
_PLAIN = -3, 3
# What a law that relaxes is drawn over, on a logarithmic axis.
_AFTER_A_STEP = "time after a step"
# Height of the ticks that mark the samples of a law, in parts of its axis.
_RUG = 0.03


def shape(ax: Axes, certificate: xr.Dataset, number: int, unit: str) -> None:
    """Draw a named law with its band at the samples of the record, and what would be without it.

    Samples that are not used, such as those of the first second, say nothing of the law: they are
    left out, except of a course in time. Lengths are in the ``unit`` of the output, where that is
    one, as are all others of the figure.
    """
    names = [f"law_{number}_{part}" for part in ("along", "value", "low", "high", "idle")]
    along_units = certificate[names[0]].attrs["units"]
    value_units = certificate[names[1]].attrs["units"]
    called = certificate[names[0]].attrs["long_name"]
    over_time = called in ("time", _AFTER_A_STEP)
    if not over_time:
        certificate = certificate.isel(time=certificate["role"].values != Role.UNUSED)
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
    if called == _AFTER_A_STEP:
        ax.set(xscale="log", xlim=(along[0], along[-1]))
        style.plain_log_ticks(ax.xaxis)
    _leave_room_for_law(ax, np.concatenate([value, idle]), float(low.min()), float(high.max()))
    for variable, place in ((parts[0], ax.set_xlabel), (parts[1], ax.set_ylabel)):
        name = str(variable.attrs["long_name"]).replace("_", " ")
        place(style.quantity(name, variable.attrs["units"]))
    _raise_power(ax)


def _raise_power(ax: Axes) -> None:
    """Put a power of ten that all values have into the label, not above the axis: text is there."""
    power = 3 * int(np.floor(np.log10(max(map(abs, ax.get_ylim()))) / 3.0))
    if _PLAIN[0] <= power <= _PLAIN[1]:
        return
    name, _, units = ax.get_ylabel().partition(" (")
    ax.set_ylabel(f"{name} ($10^{{{power}}}${f' {units}' if units else ')'}")
    ax.yaxis.set_major_formatter(lambda value, _: Formatter.fix_minus(f"{value / 10.0**power:g}"))


def tell(ax: Axes, effect: Mapping[str, Any], side: Literal["left", "right"]) -> None:
    """Write the name of a law above it, and what the record says of its parameters."""
    told = [effect["name"].replace("_", " ")]
    if change := effect.get("change"):
        told.append(f"{change['name']} {change['start']:.3g} to {change['end']:.3g}")
    elif bend := effect.get("bend"):
        turned = "opposite sign, " if bend["slope"] < 0.0 else ""
        told.append(f"{turned}bent by up to {bend['largest']:.3g} {style.raised(bend['unit'])}")
    elif amounts := effect.get("quantities"):
        told += [_estimate(name, each) for name, each in amounts.items()]
    else:
        told += [_estimate(name, effect["parameters"][name]) for name in effect["quoted"][:_TOLD]]
    ax.set_title("\n".join(told), fontsize=_LINE_HEIGHT / 1.2, loc=side, pad=_LEGEND_HEIGHT)


def leave_out(ax: Axes) -> None:
    """Leave the axes of a law empty that has no course, beside one that has."""
    ax.set_axis_off()
    ax.text(
        0.5, 0.5, "not drawn: no course\nis known at its port", ha="center", va="center",
        fontsize=6, color=style.GREY, transform=ax.transAxes,
    )  # fmt: skip


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


def text_height(ax: Axes) -> float:
    """Return how far the text above a law reaches, in points."""
    lines = (ax.get_title(loc="left") or ax.get_title(loc="right")).count("\n") + 1
    return _LEGEND_HEIGHT + _LINE_HEIGHT * lines


def _estimate(name: str, found: Mapping[str, Any]) -> str:
    """Return a parameter as its name and what the sentence of the verdict would say of it."""
    value, low, high = (found[key] for key in ("value", "low", "high"))
    unit = style.raised(found["unit"])
    said = estimate(value, low, high, unit, at_bound=found["at_bound"])
    return written_out(f"{name.replace('_', ' ')} = {said}")


def parameters(ax: Axes, effects: Sequence[Mapping[str, Any]]) -> None:
    """Draw each named parameter with its interval."""
    labels: list[str] = []
    for effect in effects:
        if len(effects) > 1:
            header = in_words(labelled(effect["name"], effect["place"])).replace("\n", " ")
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
