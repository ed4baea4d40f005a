"""How every figure of the study looks, and how it is saved with the same bytes each time.

Figures are built on :class:`matplotlib.figure.Figure` itself, never on pyplot: there is no window,
no global state and nothing to close.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from math import floor, log10
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import LogLocator, MaxNLocator, MultipleLocator, NullFormatter
from matplotlib.typing import RcKeyType
from numpy.typing import NDArray

from dea.figures.lettering import told_apart
from dea.provenance import current_job
from dea.store import MINUTE, atomic

# A page of the journal, mm.
SINGLE_COLUMN = 84.0
FULL_WIDTH = 174.0
PAGE_HEIGHT = 230.0
_MM_PER_INCH = 25.4
_LONG = 300.0  # s; the time axis of a longer record is in minutes
_MOST_TICKS = 7
_DENSE, _THINNEST = 4000, 0.2  # samples of a line of one point across a page; points
_SHORT_RANGE = 5.0  # ratio of the ends of a logarithmic axis, below which 1, 2 and 5 are too few
# The same, above which the labels of 2 and 5 are too many: of an axis upwards, and of one across,
# where they are wider than high.
_LONG_RANGE, _LONG_RANGE_ACROSS = 1e3, 5e2

# Okabe and Ito (2008): distinguishable with common colour blindness.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
THREE = (BLUE, ORANGE, VERMILION)  # three times, in their order
GREY = "#6E6E6E"
PALE = "#D9D9D9"
CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)

# The same in every figure, and each of one thing alone.
MEASURED = "#A6A6A6"  # drawn wide, so that a simulation on top of it leaves its edges visible
FORECAST = VERMILION
FITTED = BLUE
ONE_STEP = BLACK
LINEAR = PURPLE
NARX = GREEN
NMSE = SKY
FPE = ORANGE

GAIN_MAP = "viridis"
TIME_MAP = "viridis"
PHASE_MAP = "cividis"

_STYLE: dict[RcKeyType, Any] = {
    "font.family": "DejaVu Sans",  # shipped with matplotlib: the same on every machine
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": cycler(color=CYCLE),
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "lines.linewidth": 0.9,
    "lines.markersize": 3.5,
    "hatch.linewidth": 0.4,
    "path.simplify": True,
    "agg.path.chunksize": 20000,
    "pdf.fonttype": 42,  # TrueType, so that journals and search engines read the text
    "svg.hashsalt": "dea-study",
}
_NO_DATE: dict[str, dict[str, str | None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None},
}
# PNG files are a tenth larger than with the default, and written in a third of the time.
_OPTIONS: dict[str, dict[str, Any]] = {"png": {"pil_kwargs": {"compress_level": 3}}, "pdf": {}}

# Of curves beyond those that a colour each tells apart.
_LINES = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (4, 1.5, 1, 1.5)))
_MARKERS = (".", "^", "s", "D")

_P = ParamSpec("_P")
_R = TypeVar("_R")


class Look(NamedTuple):
    """How one of several curves is told from the others."""

    colour: str
    line: Any
    marker: str

    @property
    def is_plain(self) -> bool:
        """Whether its colour alone tells it."""
        return bool(self.line == _LINES[0])


def look(number: int, colours: Sequence[str] = CYCLE) -> Look:
    """Return the look of a curve, counted from 0; where colours come again, the line is another."""
    again, place = divmod(number, len(colours))
    return Look(colours[place], _LINES[again % len(_LINES)], _MARKERS[again % len(_MARKERS)])


def styled(draw: Callable[_P, _R]) -> Callable[_P, _R]:
    """Make ``draw`` run with the study's fonts, sizes and line widths."""

    @wraps(draw)
    def with_style(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        with mpl.rc_context():
            mpl.rcdefaults()  # not the user's own matplotlibrc
            mpl.rcParams.update(_STYLE)
            return draw(*args, **kwargs)

    return with_style


def page_figure(width: float, height: float) -> Figure:
    """Return an empty figure of this many mm, with constrained layout."""
    figure = Figure(
        figsize=(width / _MM_PER_INCH, height / _MM_PER_INCH),
        layout=ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03),
    )
    # It keeps what measures text; without it every label of a contour makes one of its own.
    FigureCanvasAgg(figure)
    return figure


def cut(ax: Axes, low: float, high: float, reached: tuple[float, float]) -> None:
    """Let an axis upwards go from ``low`` to ``high``, and say how far what is drawn reaches."""
    ax.set_ylim(low, high)
    least, most, *_ = told_apart([*reached, low, high])
    ax.annotate(
        f"cut; reaches {least} to {most}", (1, 1), (0, 0), xycoords="axes fraction",
        textcoords="offset points", ha="right", va="top", fontsize=6,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8},
    )  # fmt: skip


@styled
def save(figure: Figure, paths: Iterable[Path], resolution: int) -> None:
    """Save ``figure`` at each path, PNG or PDF by its ending, at ``resolution`` dots per inch.

    The files hold no dates and no names of programs, but name the job that draws them: the same
    job gives the same bytes.
    """
    figure.set_dpi(resolution)
    engine = figure.get_layout_engine()
    if engine is not None:
        # Arranged once, so that every format has the same panels. `savefig` draws a figure that has
        # any engine, even "none", once more than one without.
        engine.execute(figure)
        figure.set_layout_engine(None)
    for path in paths:
        kind = path.suffix.lstrip(".")
        with atomic(path) as partial:
            figure.savefig(
                partial, format=kind, dpi=resolution, metadata=_metadata(kind), **_OPTIONS[kind]
            )


def _metadata(kind: str) -> dict[str, str | None]:
    """Return what the file says of itself: the job that draws it, where one does."""
    job = current_job()
    key = {"png": "Source", "pdf": "Subject"}[kind]
    return _NO_DATE[kind] | ({key: f"dea-study job: {job}"} if job else {})


def panel_letters(
    axes: Sequence[Axes], first: str = "A", x: float = 0.0, drop: float = 0.0
) -> None:
    """Set bold letters at the top left corners of ``axes``, moved ``x`` and ``drop`` points."""
    for number, ax in enumerate(axes):
        ax.annotate(
            chr(ord(first) + number),
            (0, 1),
            (x, 3 - drop),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=9,
            fontweight="bold",
            ha="left" if x == 0 else "right",
            va="bottom",
        )


def quantity(name: str, units: str) -> str:
    """Return an axis label: the quantity and its units, as in ``displacement (mm)``."""
    return name if units == "1" else f"{name} ({raised(units)})"


def raised(units: str) -> str:
    """Return units with their powers raised."""
    for power, shown in (("**", "^"), ("^2", "²"), ("^3", "³")):
        units = units.replace(power, shown)
    return units


def truncated(name: str, low: float = 0.0, high: float = 1.0) -> ListedColormap:
    """Return the part ``low`` to ``high`` (0 to 1) of a named colour map."""
    whole = mpl.colormaps[name]
    return ListedColormap([whole(low + (high - low) * i / 255) for i in range(256)], name=name)


def plain_log_ticks(axis: Axis, longest: float | None = None) -> None:
    """Label a logarithmic axis at 1, 2 and 5 of each decade, without powers of ten.

    What is drawn must be there by then: over a short range more values are labelled, over a long
    one fewer. ``longest`` is the ratio of its ends above which the labels of 2 and 5 are left out;
    a panel of less than 40 mm needs a smaller one.
    """
    low, high = axis.get_view_interval()
    short = low > 0.0 and high < _SHORT_RANGE * low
    # Every step divides one, so that one is labelled where it is shown.
    linear = MaxNLocator(4, steps=[1, 2, 2.5, 5, 10])
    if longest is None:
        longest = _LONG_RANGE_ACROSS if isinstance(axis, XAxis) else _LONG_RANGE
    subs = (1,) if high > longest * low else (1, 2, 5)
    axis.set_major_locator(linear if short else LogLocator(subs=subs))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def clock(time: NDArray[np.float64]) -> tuple[float, str]:
    """Return the unit of a record's time axis: its length in s, and its name."""
    return (MINUTE, "min") if time[-1] - time[0] > _LONG else (1.0, "s")


def moment(time: float, like: NDArray[np.float64]) -> str:
    """Return a time (s) in words, in the unit of :func:`clock` of the times ``like``.

    To a tenth of the unit; of a record shorter than one, to a tenth of its length's first digit.
    """
    unit, name = clock(like)
    length = (like[-1] - like[0]) / unit
    digits = 1 - floor(log10(length)) if 0.0 < length < 1.0 else 1
    return f"{round(time / unit, digits):g} {name}"


def line_width(samples: int) -> float:
    """Return the width (points) of the line of a whole record: thinner where samples are dense."""
    return float(np.clip(_DENSE / samples, _THINNEST, mpl.rcParams["lines.linewidth"]))


def time_axis(ax: Axes, time: NDArray[np.float64]) -> None:
    """Limit an axis of times (s) to a record and number it in the unit of :func:`clock`."""
    unit, name = clock(time)
    end = 2 * time[-1] - time[-2]  # where the last sample ends
    steps = (m * 10.0**e for e in range(-9, 6) for m in (1, 2, 5))
    step = next(s for s in steps if (end - time[0]) / (s * unit) <= _MOST_TICKS)
    ax.set_xlim(time[0], end)
    ax.xaxis.set_major_locator(MultipleLocator(step * unit))
    ax.xaxis.set_major_formatter(lambda seconds, _: f"{seconds / unit:g}")
    ax.set_xlabel(f"time ({name})")
