"""Probability of each explanation against the seconds driven in designed records.

Its stage draws it, since no rule knows how many records there will be.
"""

from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from dea.effect_label import parted
from dea.figures import style
from dea.figures.lettering import in_lines

_SHOWN = 6
# Probabilities nearer to zero or one than this are drawn there.
_NEAREST = 1e-4
# Letters of a line of the legend, and its height in mm.
_LETTERS, _LINE = 50, 2.8


@style.styled
def resolution(found: xr.Dataset, name: str) -> Figure:
    """Draw the leading hypotheses, first of which those that are likeliest in the end."""
    driven, probability = found["driven"].values, found["probability"].values
    near = np.clip(probability, _NEAREST, 1.0 - _NEAREST)
    highest = np.nan_to_num(probability).max(axis=0)
    last = np.nan_to_num(probability[-1])
    order = np.lexsort((-highest, -last))
    chosen = [k for k in order if highest[k] > 0.02][:_SHOWN]
    labels = [_in_words(str(found["hypothesis"].values[k])) for k in chosen]
    more = sum(label.count("\n") for label in labels)
    figure = style.page_figure(style.SINGLE_COLUMN, 90 + _LINE * more)
    ax = figure.subplots()
    for drawn, (k, label, colour) in enumerate(zip(chosen, labels, style.CYCLE, strict=False)):
        # Several may have the same probability: what is drawn later is smaller.
        size = 7.0 - 0.9 * drawn
        ax.plot(driven, near[:, k], "o-", color=colour, label=label, ms=size, lw=0.25 * size)
        out = np.flatnonzero(found["rejected"].values[:, k])
        ax.plot(driven[out], near[out, k], "x", color=style.BLACK, ms=5)
    ax.plot([], [], "x", color=style.BLACK, ms=5, label="rejected")
    ax.set_yscale("logit")
    ax.set_ylim(0.5 * _NEAREST, 1.0 - 0.5 * _NEAREST)
    ax.set_yticks([1e-4, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999])
    ax.set_yticklabels(["≤ 0.0001", "0.01", "0.1", "0.5", "0.9", "0.99", "≥ 0.9999"])
    ax.yaxis.set_minor_locator(NullLocator())
    ax.margins(x=0.03)
    ax.set(xlabel="time driven in designed records (s)", ylabel="probability")
    ax.set_title(in_lines(name, style.SINGLE_COLUMN))
    figure.legend(loc="outside lower center", ncols=1)
    return figure


def _in_words(hypothesis: str) -> str:
    """Return the effects of a hypothesis in lines that are broken between them."""
    whole = " + ".join(parted(hypothesis.replace("_", "\N{NO-BREAK SPACE}")))
    return "\n".join(wrap(whole, _LETTERS)).replace("\N{NO-BREAK SPACE}", " ")
