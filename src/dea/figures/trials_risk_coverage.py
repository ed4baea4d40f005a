"""Share of wrong names (risk) against the share of trials with a name (coverage)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from dea.figures import style
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``scores.nc`` of a set of trials."""
    return trials_risk_coverage(sources.dataset("scores"))


@style.styled
def trials_risk_coverage(scores: xr.Dataset) -> Figure:
    """Draw the risk-coverage curve (contract ``scores``) and the point of the verdicts."""
    figure = style.page_figure(style.SINGLE_COLUMN, 70)
    ax = figure.subplots()
    ax.step(
        scores["coverage"], scores["risk"], where="post", color=style.BLUE,
        label="best explanation, surest first",
    )  # fmt: skip
    names = scores.sel(measure="names given that are right")
    risk = float(scores["risk_of_names"])
    ends = [[risk - 1.0 + float(names["rate_high"])], [1.0 - float(names["rate_low"]) - risk]]
    ax.errorbar(
        [float(scores["coverage_of_names"])], [risk], np.abs(ends), fmt="o", ms=5,
        color=style.VERMILION, elinewidth=0.8, capsize=2,
        label=f"names as given ({int(names['rate_trials'])}), 95 %",
    )  # fmt: skip
    ax.set(xlim=(0, 1), ylim=(0, None))
    ax.set(xlabel="coverage: trials given a name (%)", ylabel="risk: names of no hidden effect (%)")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(PercentFormatter(1.0, symbol=""))
    figure.legend(loc="outside upper center", ncols=2)
    return figure
