"""What the figure of a confirmation plots."""

import numpy as np
import pytest
from matplotlib.colors import same_color

import made_datasets as made
from dea.figures import style
from dea.figures.confirmation import confirmation
from dea.figures.frequency_maps import as_complex


@pytest.fixture(scope="module")
def drawn():
    found = made.confirmation(1)
    figure = confirmation(found, "dea1")
    return found, np.reshape(figure.axes, (4, 3))


def test_gains_of_model_and_measurement_are_drawn_at_each_stretch(drawn):
    found, axes = drawn
    for stretch in range(3):
        part = found.isel(stretch=stretch)
        data = [line.get_data() for line in axes[0, stretch].lines if len(line.get_xdata()) == 5]
        for name in ("model", "response"):
            expected = np.abs(as_complex(part[name]).values)
            assert any(np.allclose(y, expected, rtol=1e-12) for _, y in data), name
        assert axes[0, stretch].get_yscale() == "log"
    assert [ax.get_title() for ax in axes[0]] == ["5 min", "16.7 min", "28.3 min"]
    assert axes[0, 0].figure.legends[0].get_title().get_text() == "dea1"
    assert axes[0, 0].get_ylabel() == "gain, standard deviations (mm/V)"


@pytest.mark.parametrize(("row", "name", "scale"), [(1, "gain", 100.0), (2, "phase", 1.0)])
def test_differences_are_filled_inside_the_joint_band_and_hollow_outside(drawn, row, name, scale):
    found, axes = drawn
    part = found.isel(stretch=1)
    inside = part["inside"].values == 1
    by_fill = {
        line.get_markerfacecolor(): line.get_data()
        for line in axes[row, 1].lines
        if line.get_marker() == "o"
    }
    for fill, which in ((style.BLACK, inside), ("white", ~inside)):
        [(x, y)] = [data for colour, data in by_fill.items() if same_color(colour, fill)]
        np.testing.assert_array_equal(x, part["frequency"][which])
        np.testing.assert_allclose(y, scale * part[f"{name}_difference"][which])


def test_the_legend_says_what_a_hollow_point_is(drawn):
    _, axes = drawn
    handles, labels = axes[0, 0].get_legend_handles_labels()
    label = "outside the 95 % ellipse of gain and phase together"
    hollow = dict(zip(labels, handles, strict=True))[label]
    assert same_color(hollow.get_markerfacecolor(), "white")


def test_the_legend_begins_with_what_was_measured_and_modelled(drawn):
    _, axes = drawn
    said = [text.get_text() for text in axes[0, 0].figure.legends[0].get_texts()]
    assert said[:2] == [
        "best linear approximation, with its 95 % band",
        "$H_1$ of the tracked model, with its 95 % band",
    ]
    assert len(set(said)) == 7


def test_even_lines_are_drawn_beside_their_prediction_and_the_noise(drawn):
    found, axes = drawn
    part = found.isel(stretch=2)
    labelled = {line.get_label(): line.get_ydata() for line in axes[3, 2].lines}
    for label, name in (("even lines, measured", "measured"), ("noise", "noise"),
                        ("predicted from $H_2$ of the tracked model", "predicted")):  # fmt: skip
        np.testing.assert_array_equal(labelled[label], part[f"even_{name}"])


def test_odd_lines_that_are_not_excited_are_drawn_apart_from_even_ones(drawn):
    found, axes = drawn
    for stretch in range(3):
        [odd] = [
            line
            for line in axes[3, stretch].lines
            if line.get_label() == "odd lines that are not excited, measured"
        ]
        part = found.isel(stretch=stretch)
        which = part["odd"].values == 1
        np.testing.assert_array_equal(odd.get_xdata(), part["detection_frequency"].values[which])
        np.testing.assert_array_equal(odd.get_ydata(), part["output_level"].values[which])
        assert same_color(odd.get_color(), style.VERMILION)


def test_the_interval_of_each_even_line_is_drawn_and_those_outside_are_hollow(drawn):
    found, axes = drawn
    part = found.isel(stretch=2)
    [band] = axes[3, 2].collections
    ends = np.array([segment[:, 1] for segment in band.get_segments()])
    np.testing.assert_allclose(ends, part["even_predicted"].values[:, None] * [0.8, 1.2])
    [hollow] = [line for line in axes[3, 2].lines if same_color(line.get_markerfacecolor(), "w")]
    outside = part["even_inside"].values == 0
    np.testing.assert_array_equal(hollow.get_xdata(), part["even_frequency"].values[outside])


def test_a_band_that_reaches_zero_ends_a_decade_below_the_model():
    found = made.confirmation(1)
    found["model_gain_low"][0, 3] = -1.0
    found["ratio_radius"][0, 1] = 1.5
    axes = np.reshape(confirmation(found, "dea1").axes, (4, 3))
    gain = np.abs(as_complex(found["model"]).values)[0, 3]
    lowest = axes[0, 0].collections[0].get_paths()[0].vertices[:, 1].min()
    assert lowest == pytest.approx(0.1 * gain)
    assert axes[3, 0].get_ylim()[0] == pytest.approx(0.7 * 3e-5)


def test_the_reason_why_the_models_band_is_withheld_stands_above():
    found = made.confirmation(1).assign_attrs(model_band_withheld="the residual is not white")
    legend = confirmation(found, "dea1").legends[0]
    assert legend.get_title().get_text() == (
        "dea1\nno 95 % band of the model: the residual is not white"
    )
    said = [text.get_text() for text in legend.get_texts()]
    assert "$H_1$ of the tracked model, whose band is withheld" in said
