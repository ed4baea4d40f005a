"""The look is the study's own, and the bytes depend on the figure alone."""

import os
import subprocess
import sys
from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest

from dea.figures import style

DRAW = """
import sys
from pathlib import Path
import made_datasets as made
from dea.figures import style
from dea.figures.fig4_h2 import fig4_h2
style.save(fig4_h2({"dea1": made.gfrf(1)}), [Path(p) for p in sys.argv[1:]], 80)
"""


@pytest.fixture
def draw(tmp_path, request):
    def run(folder, **environment):
        paths = [tmp_path / folder / f"f.{kind}" for kind in ("png", "pdf")]
        subprocess.run(
            [sys.executable, "-c", DRAW, *map(str, paths)],
            check=True,
            env={**os.environ, "PYTHONPATH": str(request.path.parents[1]), **environment},
        )
        return [path.read_bytes() for path in paths]

    return run


@pytest.mark.slow
def test_two_processes_write_the_same_bytes(draw):
    once = draw("a", PYTHONHASHSEED="1", TZ="UTC")
    again = draw("b", PYTHONHASHSEED="2", TZ="Asia/Tokyo", MPLBACKEND="pdf")
    assert once == again
    assert once[0].startswith(b"\x89PNG")
    assert once[1].startswith(b"%PDF")
    assert b"CreationDate" not in once[1]


def test_styled_leaves_no_trace_and_ignores_the_users_settings():
    @style.styled
    def size():
        return mpl.rcParams["font.size"]

    with mpl.rc_context({"font.size": 30.0, "axes.facecolor": "red"}):
        assert size() < 10
        assert mpl.rcParams["font.size"] == 30.0


def test_no_colour_has_two_meanings():
    roles = ("MEASURED", "FORECAST", "FITTED", "ONE_STEP", "LINEAR", "NARX", "NMSE", "FPE")
    assert len({getattr(style, role) for role in roles}) == len(roles)


def test_a_page_figure_has_the_size_asked_for():
    width, height = style.page_figure(style.FULL_WIDTH, 100).get_size_inches()
    assert (width * 25.4, height * 25.4) == pytest.approx((174.0, 100.0))


def test_drawing_needs_no_window_system():
    code = "import sys, dea.figures.fig1; assert 'matplotlib.pyplot' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("reached", "limits", "said"),
    [
        ((-0.4842, -0.4766), (-0.4825, -0.4775), "−0.4842 to −0.4766"),
        ((-0.48, -0.4766), (-0.48, -0.4775), "−0.48 to −0.4766"),
        ((-1.1, 100.9), (-1.1, 3.0), "−1.1 to 1e+02"),
    ],
)
def test_a_cut_axis_says_what_tells_the_ends_from_its_limits(reached, limits, said):
    ax = style.page_figure(style.SINGLE_COLUMN, 40).subplots()
    style.cut(ax, *limits, reached)
    assert ax.get_ylim() == limits
    [text] = ax.texts
    assert text.get_text() == f"cut; reaches {said}"


@pytest.mark.parametrize(
    ("units", "label"), [("mm", "x (mm)"), ("mm^2", "x (mm²)"), ("mm/V^2", "x (mm/V²)"), ("1", "x")]
)
def test_a_label_holds_the_units(units, label):
    assert style.quantity("x", units) == label


@pytest.mark.parametrize(
    ("duration", "label", "ticks"),
    [(1800, "time (min)", ["0", "5", "30"]), (10, "time (s)", ["0", "2", "10"])],
)
def test_a_record_is_read_in_minutes_where_it_is_long(duration, label, ticks):
    figure = style.page_figure(style.FULL_WIDTH, 40)
    ax = figure.subplots()
    style.time_axis(ax, np.arange(0, duration, 0.5))
    figure.draw_without_rendering()
    shown = [text.get_text() for text in ax.get_xticklabels()]
    assert ax.get_xlabel() == label
    assert set(ticks) <= set(shown)
    assert ax.get_xlim() == (0, duration)


@pytest.mark.parametrize(
    ("duration", "moments"),
    [
        (0.09, ["0.009 s", "0.045 s", "0.081 s"]),
        (9e-4, ["9e-05 s", "0.00045 s", "0.00081 s"]),
        (9.0, ["0.9 s", "4.5 s", "8.1 s"]),
        (900.0, ["1.5 min", "7.5 min", "13.5 min"]),
    ],
)
def test_the_moments_of_a_record_are_told_apart_however_short_it_is(duration, moments):
    like = np.array([0.0, duration])
    assert [style.moment(part * duration, like) for part in (0.1, 0.5, 0.9)] == moments


def test_the_axis_of_a_record_of_less_than_a_millisecond_is_numbered():
    ax = style.page_figure(style.FULL_WIDTH, 40).subplots()
    style.time_axis(ax, np.arange(900) * 1e-6)
    low, high = ax.get_xlim()
    assert sum(low <= tick <= high for tick in ax.get_xticks()) > 3


@pytest.mark.parametrize(
    ("values", "labels"),
    [([1, 1.6], ["1", "1.6"]), ([1, 4], ["1", "2", "3"]), ([1, 300], ["1", "2", "5", "200"])],
)
def test_a_logarithmic_axis_has_several_labels_over_any_range(values, labels):
    figure = style.page_figure(style.FULL_WIDTH, 60)
    ax = figure.subplots()
    ax.semilogy([0, 1], values)
    style.plain_log_ticks(ax.yaxis)
    figure.draw_without_rendering()
    shown = [text.get_text() for text in ax.get_yticklabels()]
    assert set(labels) <= set(shown)


@pytest.mark.parametrize("longest", [3.0, 30.0, 400.0, 900.0, 5e4])
def test_labels_below_a_narrow_logarithmic_axis_stand_apart(longest):
    figure = style.page_figure(50, 40)
    ax = figure.subplots()
    ax.semilogx([0.052, 0.052 * longest], [0, 1])
    style.plain_log_ticks(ax.xaxis)
    figure.draw_without_rendering()
    shown = [text for text in ax.get_xticklabels() if text.get_text()]
    low, high = ax.get_xlim()
    boxes = [t.get_window_extent() for t in shown if low <= t.get_position()[0] <= high]
    boxes.sort(key=lambda box: box.x0)
    gap = boxes[0].height / 6.0
    assert len(boxes) >= 2
    assert all(right.x0 - left.x1 > gap for left, right in pairwise(boxes))
