"""Residual correlations, as the joint tests have them, with their 95 % bands and p-values."""

import re

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dea.figures import style
from dea.store import Sources

_SQUARE = re.compile(r"([a-z])2")
_NUMBERED = re.compile(r"([a-z])(\d+)")
_LEAST = 1e-3  # of a p-value that is written out
_LINE = 7.5  # points
_MODEL = {"linear": ("linear", style.LINEAR), "narx": ("NARX", style.NARX)}


def draw(sources: Sources) -> Figure:
    """Draw it from ``validation.nc`` of a system."""
    return residual_tests(sources.dataset("validation"), sources.system)


@style.styled
def residual_tests(validation: xr.Dataset, name: str, approach: str = "forecast") -> Figure:
    """Draw every test (rows) on every window (columns) for the linear and the NARX model.

    Parameters
    ----------
    validation
        Contract ``validation`` of one actuator.
    approach
        One of the contract, as ``forecast``.
    """
    chosen = validation.sel(approach=approach)
    tests, windows = chosen["test"].values, chosen["window"].values
    figure = style.page_figure(style.FULL_WIDTH, min(20 + 34 * tests.size, style.PAGE_HEIGHT))
    axes = figure.subplots(tests.size, windows.size, squeeze=False, sharex=True, sharey="row")
    for row, test in enumerate(tests):
        for column in range(windows.size):
            part = chosen.sel(test=test).isel(window=column)
            ax = axes[row, column]
            reach = float(part["band"])
            ax.axhspan(-reach, reach, color=style.PALE, lw=0, label="95 % band of white noise")
            for model, (label, colour) in _MODEL.items():
                values = part["tested_correlation"].sel(model=model)
                ax.plot(values["lag"], values, color=colour, lw=0.8, label=label)
            _write_p_values(ax, part)
            if row == 0:
                ax.set_title(_heading(part))
        axes[row, 0].set_ylabel(as_mathematics(str(test)))
    for ax in axes[-1]:
        ax.set_xlabel("lag (samples)")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    said = (
        f"{name}, {approach}\ncorrelations $\\phi$ of residual $e$ and input $u$,"
        " below the first row made white; $p$ of all lags together"
    )
    legend = figure.legend(
        handles, labels, loc="outside upper center", ncols=3, title=said, title_fontsize=7
    )
    legend.get_title().set_multialignment("center")
    return figure


def _write_p_values(ax: Axes, part: xr.Dataset) -> None:
    """Write the p-values of a panel's joint test; of a model that diverged there is none."""
    shown = [
        (colour, float(part["p_value"].sel(model=model)))
        for model, (_, colour) in _MODEL.items()
        if np.isfinite(part["tested_correlation"].sel(model=model)).any()
    ]
    for line, (colour, p) in enumerate(shown):
        said = f"= {p:.2g}" if p >= _LEAST else f"< {_LEAST:g}"
        ax.annotate(
            f"$p$ {said}", (1, 1), (-1, -_LINE * line), xycoords="axes fraction",
            textcoords="offset points", ha="right", va="top", fontsize=6, color=colour,
        )  # fmt: skip


def _heading(part: xr.Dataset) -> str:
    """Say which window a column shows, and which model has no residual there."""
    time = part["time"].values
    diverged = [
        f"{label} diverged"
        for model, (label, _) in _MODEL.items()
        if not np.isfinite(part["tested_correlation"].sel(model=model)).any()
    ]
    end = 2 * time[-1] - time[-2]  # where the last sample ends
    return ", ".join([f"{_plain(time[0])} to {_plain(end)} s", *diverged])


def _plain(time: float) -> str:
    """Return a time with two decimals at most."""
    return f"{time:.2f}".rstrip("0").rstrip(".")


def as_mathematics(test: str) -> str:
    """Return a residual test such as ``phi_u2e`` as ``$\\phi_{u^2 e}$``.

    The names of inputs, where there are several, follow it.
    """
    test, _, signal = test.partition(", ")
    letters = test.removeprefix("phi_").removeprefix("φ_").replace("²", "2").replace("^", "")
    subscript = _SQUARE.sub(r"\1^2", letters)
    numbered = _NUMBERED.sub(r"\1_{\2}", signal)
    return rf"$\phi_{{{subscript}}}$" + (f", ${numbered}$" if signal else "")
