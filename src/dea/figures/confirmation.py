"""Frequency responses of the tracked model against those measured without a model."""

from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from dea.figures import style
from dea.figures.frequency_maps import as_complex
from dea.store import Sources

# One colour for what the model says, another for what was measured.
_MODEL = style.BLUE
_MEASURED = style.BLACK
_CUT = 0.1  # of the model's gain, below which its band is not drawn, as it may reach zero
_WIDE = 3  # stretches, up to which a column has room for all labels of its axes
_LINEAR = 2.0  # % or degrees, up to which the axis of differences is linear
_LINE = 110  # letters of a line above the legend


def draw(sources: Sources) -> Figure:
    """Draw it from ``confirmation.nc`` of an actuator."""
    return confirmation(sources.dataset("confirmation"), sources.system)


@style.styled
def confirmation(found: xr.Dataset, name: str) -> Figure:
    """Draw gains, differences and lines not excited (rows) at each stretch (columns)."""
    count = found.sizes["stretch"]
    figure = style.page_figure(style.FULL_WIDTH, 205)
    axes = figure.subplots(4, count, squeeze=False, sharey="row", height_ratios=[6, 4, 4, 5])
    times = np.append(0.0, found["time"].values)
    for column in range(count):
        part = found.isel(stretch=column)
        _gain(axes[0, column], part)
        _difference(axes[1, column], part, "gain", 100.0)
        _difference(axes[2, column], part, "phase", 1.0)
        _even(axes[3, column], part)
        axes[0, column].set_title(style.moment(float(part["time"]), times))
        for ax in axes[:2, column]:
            ax.sharex(axes[2, column])
            ax.tick_params(labelbottom=False)
        for ax in axes[:3, column]:
            ax.set_xscale("log")
            style.plain_log_ticks(ax.xaxis)
            if count > _WIDE:
                ax.xaxis.set_major_locator(LogLocator(subs=(1,)))
            _band_edge(ax, found)
        if count <= _WIDE or column == count // 2:
            axes[2, column].set_xlabel("frequency (Hz)")
            axes[3, column].set_xlabel("frequency of the line (Hz)")
    shown = [f"even_{kind}" for kind in ("measured", "predicted", "noise")]
    levels = [*(found[name].values for name in shown), _odd_lines(found)["output_level"].values]
    least = min(each[each > 0.0].min(initial=np.inf) for each in levels)
    if np.isfinite(least):
        axes[3, 0].set_ylim(bottom=0.7 * least)  # not the end of a band, which may be zero
    units = found["response"].attrs["units"]
    axes[0, 0].set_ylabel(style.quantity("gain, standard deviations", units))
    axes[1, 0].set_ylabel("difference\nof gain (%)")
    axes[2, 0].set_ylabel("difference\nof phase (degrees)")
    even_units = found["even_measured"].attrs["units"]
    axes[3, 0].set_ylabel(style.quantity("lines that are not\nexcited, of the output", even_units))
    handles, labels = axes[0, 0].get_legend_handles_labels()
    # What was measured, which is an error bar, and so last among the handles, comes first.
    first = [*handles[-1:], *handles[:-1]], [*labels[-1:], *labels[:-1]]
    last = axes[3, 0].get_legend_handles_labels()
    figure.legend(
        *first, loc="outside upper center", ncols=2, title=_title(found, name), title_fontsize=7
    )
    figure.legend(*last, loc="outside lower center", ncols=3, columnspacing=1.2)
    return figure


def _title(found: xr.Dataset, name: str) -> str:
    """Return the actuator's name, and why its model has no band where it is withheld."""
    reason = found.attrs["model_band_withheld"]
    return "\n".join(
        [name, *wrap(f"no 95 % band of the model: {reason}", _LINE)] if reason else [name]
    )


def _band_edge(ax: Axes, found: xr.Dataset) -> None:
    """Shade the frequencies beyond those at which the model was identified."""
    frequency = found["frequency"].values
    inside = frequency[found["in_band"].values == 1]
    if inside.size < frequency.size:
        ax.axvspan(
            np.sqrt(inside[-1] * frequency[inside.size]), ax.get_xlim()[1], color=style.PALE,
            alpha=0.5, lw=0, zorder=0,
        )  # fmt: skip


def _gain(ax: Axes, part: xr.Dataset) -> None:
    withheld, its_band = part.attrs["model_band_withheld"], "with its 95 % band"
    frequency = part["frequency"].values
    gain = np.hypot(*part["response"].transpose("part", "frequency").values)
    modelled = np.abs(as_complex(part["model"]).values)
    low = np.maximum(part["model_gain_low"].values, _CUT * modelled)
    ax.fill_between(frequency, low, part["model_gain_high"], color=_MODEL, alpha=0.3, lw=0)
    ax.plot(
        frequency, modelled, color=_MODEL,
        label=f"$H_1$ of the tracked model, {'whose band is withheld' if withheld else its_band}",
    )  # fmt: skip
    reach = np.stack([gain - part["gain_low"].values, part["gain_high"].values - gain])
    ax.errorbar(
        frequency, gain, np.abs(reach), fmt="o", ms=1.8, lw=0.7, color=_MEASURED,
        label=f"best linear approximation, {its_band}",
    )  # fmt: skip
    for kind, marker, colour, label in (
        ("distortion", "x", style.VERMILION, "odd nonlinear distortion, one realisation"),
        ("response_noise", ".", style.GREEN, "noise of the average"),
    ):
        values = part[kind].values
        shown = np.where(values > 0, values, np.nan)
        ax.plot(frequency, shown, marker, ms=2.5, mew=0.6, color=colour, label=label)
    ax.plot([], [], color=style.SKY, alpha=0.4, lw=5, label="joint 95 % band of a difference")
    ax.plot(
        [], [], "o", ms=2.4, mew=0.6, mec=_MEASURED, mfc="white",
        label="outside the 95 % ellipse of gain and phase together",
    )  # fmt: skip
    ax.plot([], [], color=style.PALE, lw=5, label="not excited in the record: extrapolated")
    ax.set_yscale("log")
    ax.set_xlim(0.9 * frequency[0], 1.1 * frequency[-1])


def _difference(ax: Axes, part: xr.Dataset, kind: str, scale: float) -> None:
    """Draw measured less modelled, with its joint band, hollow where gain and phase disagree."""
    frequency, inside = part["frequency"].values, part["inside"].values == 1
    values, half = scale * part[f"{kind}_difference"].values, scale * part[f"{kind}_band"].values
    ax.fill_between(frequency, -half, half, color=style.SKY, alpha=0.4, lw=0)
    ax.axhline(0.0, color=_MODEL, lw=0.6)
    for which, fill in ((inside, _MEASURED), (~inside, "white")):
        ax.plot(frequency[which], values[which], "o", ms=2.4, mew=0.6, mec=_MEASURED, mfc=fill)
    ax.set_yscale("symlog", linthresh=_LINEAR, linscale=2.0)
    ax.yaxis.set_major_formatter("{x:g}")
    ax.set_xlim(0.9 * frequency[0], 1.1 * frequency[-1])


def _even(ax: Axes, part: xr.Dataset) -> None:
    frequency = part["even_frequency"].values
    predicted, radius = part["even_predicted"].values, part["ratio_radius"].values
    ax.vlines(
        frequency, predicted * np.maximum(1 - radius, _CUT), predicted * (1 + radius),
        color=style.SKY, alpha=0.6, lw=3, label="joint 95 % band of measured over predicted",
    )  # fmt: skip
    for kind, marker, size, colour, label in (
        ("predicted", "_", 5.0, _MODEL, "predicted from $H_2$ of the tracked model"),
        ("measured", "o", 2.2, _MEASURED, "even lines, measured"),
        ("noise", ".", 2.5, style.GREEN, "noise"),
    ):
        ax.plot(
            frequency, part[f"even_{kind}"], marker, ms=size, mew=1.0, color=colour, label=label
        )
    outside = part["even_inside"].values != 1
    ax.plot(
        frequency[outside], part["even_measured"].values[outside], "o", ms=2.2, mew=0.6,
        mec=_MEASURED, mfc="white", label="measured, outside of it in size and phase together",
    )  # fmt: skip
    odd = _odd_lines(part)
    ax.plot(
        odd["detection_frequency"], odd["output_level"], "x", ms=2.5, mew=0.6,
        color=style.VERMILION, label="odd lines that are not excited, measured",
    )  # fmt: skip
    ax.set_yscale("log")


def _odd_lines(found: xr.Dataset) -> xr.Dataset:
    """Return the odd lines that are not excited, as far as even lines are drawn."""
    drawn = found["detection_frequency"] <= found["even_frequency"].max()
    return found.isel(detection_frequency=((found["odd"] == 1) & drawn).values)
