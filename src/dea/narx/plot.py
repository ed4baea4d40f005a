"""A measured output and a model's run over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from dea.arrays import Array
from dea.narx.labels import Labels


def plot_run(labels: Labels, measured: Array, run: Array, axes: Axes | None = None) -> Axes:
    """Draw both over time in s, or over samples where the rate is not known.

    Without ``axes`` in a figure of its own, which pyplot does not know.
    """
    if axes is None:
        figure = Figure(figsize=(7.0, 3.0), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
    rate = labels.sampling_rate
    time = np.arange(measured.size) / (rate or 1.0)
    axes.plot(time, measured, color="#A6A6A6", lw=2.5, label="measured")
    axes.plot(time, run, color="#D55E00", lw=1.0, label="simulated")
    axes.set_xlabel("time (s)" if rate else "sample")
    units = "" if labels.y_units == "1" else f" ({labels.y_units})"
    axes.set_ylabel(f"{labels.y_name}{units}")
    axes.legend(frameon=False)
    return axes
