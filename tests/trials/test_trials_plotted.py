"""What the figures of the blind trials plot."""

import re

import numpy as np
import pytest
from made_trials import FAMILY, campaign
from matplotlib.colors import same_color

from dea import trials
from dea.figures import style
from dea.figures.trials_confusion import trials_confusion
from dea.figures.trials_gap import COLOURS, trials_gap
from dea.figures.trials_risk_coverage import trials_risk_coverage
from dea.figures.trials_strength import trials_strength
from dea.tables.trials_effects import effects


@pytest.fixture(scope="module")
def scores():
    return trials.scores(*campaign(60), FAMILY)


def test_the_confusion_counts_what_was_hidden_in_rows_and_said_in_columns(scores):
    ax = trials_confusion(scores).axes[0]
    rows = [text.get_text().replace(" ", "_") for text in ax.get_yticklabels()]
    columns = [text.get_text().replace(" ", "_") for text in ax.get_xticklabels()]
    names = {str(name).replace(" ", "_"): name for name in scores["hidden_effect"].values}
    said = {str(name).replace(" ", "_"): name for name in scores["said_effect"].values}
    written = {text.get_position(): int(text.get_text()) for text in ax.texts}
    for row, hidden in enumerate(rows):
        counts = scores["confusion"].sel(hidden_effect=names[hidden])
        for column, name in enumerate(columns):
            count = int(counts.sel(said_effect=said[name]))
            assert written.get((column, row), 0) == count
            share = ax.images[0].get_array()[row, column]
            assert share == pytest.approx(count / int(counts.sum()))
    assert sum(written.values()) == 60
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("verdict", "hidden")


def test_the_errors_are_in_noise_floors_before_along_x_and_after_along_y(scores):
    ax = trials_gap(scores, 1.3).axes[0]
    floor = scores["noise_floor"]
    shown = 0
    for outcome, colour in COLOURS.items():
        chosen = scores["outcome"].values == outcome
        points = [
            line
            for line in ax.lines
            if line.get_marker() == "o" and line.get_label() == f"{outcome} ({chosen.sum()})"
        ]
        assert len(points) == chosen.any()
        for line in points:
            assert same_color(line.get_markerfacecolor(), colour)
            assert same_color(line.get_markeredgecolor(), style.GREY)  # pale dots are seen too
            np.testing.assert_array_equal(
                line.get_data(),
                [(scores[n] / floor).values[chosen] for n in ("error_before", "error_after")],
            )
            shown += line.get_xdata().size
    assert shown == 60
    dashed = [line for line in ax.lines if line.get_linestyle() == "--"]
    assert [list(line.get_ydata()) for line in dashed] == [[1.3, 1.3]]


def test_no_point_lies_off_the_axes_of_errors_and_missing_ones_are_left_out(scores):
    odd = scores.copy(deep=True)
    odd["error_after"].values[0] = np.nan
    odd["error_after"].values[1] = 0.3 * float(odd["noise_floor"][1])
    ax = trials_gap(odd, 1.3).axes[0]
    for low, high in (ax.get_xlim(), ax.get_ylim()):
        assert 0.2 < low < 0.3
        assert high > np.nanmax((odd["error_before"] / odd["noise_floor"]).values)
    assert trials_gap(scores, 1.3).axes[0].get_ylim()[0] == pytest.approx(0.8)


def test_the_legend_of_outcomes_has_those_that_occur_with_their_numbers(scores):
    bare = scores.copy(deep=True)
    for dim in ("strength_bin", "excitation_kind"):
        bare[f"{dim}_outcomes"].loc[{"possible_outcome": "right class"}] = 0
    said = [text.get_text() for text in trials_strength(bare).legends[0].get_texts()]
    counts = bare["strength_bin_outcomes"].sum("strength_bin").to_pandas()
    bars = counts.drop(["one of two", "right none"])
    assert said == [f"{name} ({count})" for name, count in bars[bars > 0].items()]
    assert "right class (0)" not in said
    empty = bare.assign(strength_bin_outcomes=0 * bare["strength_bin_outcomes"])
    assert not trials_strength(empty).legends


def test_the_curve_of_risk_and_the_point_of_the_verdicts(scores):
    ax = trials_risk_coverage(scores).axes[0]
    curve, point, *_ = ax.lines
    np.testing.assert_array_equal(curve.get_data(), [scores["coverage"], scores["risk"]])
    assert point.get_xdata() == float(scores["coverage_of_names"])
    assert point.get_ydata() == float(scores["risk_of_names"])
    [[_, _, [interval]]] = ax.containers
    names = scores.sel(measure="names given that are right")
    expected = [1.0 - float(names["rate_high"]), 1.0 - float(names["rate_low"])]
    np.testing.assert_allclose(interval.get_segments()[0][:, 1], expected)
    assert 0.0 <= expected[0] < point.get_ydata()[0] < expected[1] <= 1.0
    [count] = re.findall(r"names as given \((\d+)\)", ax.containers[0].get_label())
    assert int(count) == round(60 * float(scores["coverage_of_names"]))


@pytest.mark.parametrize(("panel", "dim"), [(0, "strength_bin"), (1, "excitation_kind")])
def test_outcomes_are_stacked_shares_with_the_interval_of_right_names(scores, panel, dim):
    ax = trials_strength(scores).axes[panel]
    counts = scores[f"{dim}_outcomes"].to_pandas()
    total = counts.sum(axis=1).clip(lower=1)
    *bars, interval = ax.containers
    assert bars
    for stack in bars:
        heights = [bar.get_height() for bar in stack]
        np.testing.assert_allclose(heights, counts[stack.get_label()] / total)
        assert same_color(stack[0].get_facecolor(), COLOURS[stack.get_label()])
    ends = np.array([segment[:, 1] for segment in interval[2][0].get_segments()])
    known = np.isfinite(scores[f"{dim}_right"].values)
    expected = np.column_stack([scores[f"{dim}_right_low"], scores[f"{dim}_right_high"]])
    np.testing.assert_allclose(ends[known], expected[known])
    texts = [text.get_text() for text in ax.get_xticklabels()]
    names = zip(scores[dim].values, counts.sum(axis=1), strict=True)
    assert texts == [f"{name}\n({count})" for name, count in names]


def test_what_gives_no_name_is_not_what_an_effect_was_taken_for(scores):
    table = effects(scores).exact.set_index("hidden")
    for hidden, given in table["taken for"].items():
        names = re.findall(r"(\w[\w ]*) \(", given)
        assert not {"none", "unknown", "ambiguous", hidden}.intersection(names)
        row = scores["confusion"].sel(hidden_effect=hidden).to_pandas()
        wrong = row[(row > 0) & ~row.index.isin([hidden, "none", "unknown", "ambiguous"])]
        assert names == ([] if hidden == "two effects" else list(wrong.index))
