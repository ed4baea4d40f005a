"""Every figure draws from datasets of the contracts, says its units and hides no text."""

import itertools
import json
import re

import numpy as np
import pytest
from matplotlib import colors as mcolors
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.contour import ContourSet
from matplotlib.figure import FigureBase
from matplotlib.text import Text

import made_datasets as made
from dea.errors import InputError
from dea.figures import style
from dea.figures.confirmation import confirmation
from dea.figures.control import control
from dea.figures.fig1 import fig1
from dea.figures.fig2 import fig2
from dea.figures.fig3 import fig3
from dea.figures.fig3_phase import fig3_phase
from dea.figures.fig4_h2 import fig4_h2
from dea.figures.fig4_h2_phase import fig4_h2_phase
from dea.figures.fig4_h3 import fig4_h3
from dea.figures.frequency_maps import as_complex
from dea.figures.lettering import in_lines, told_apart
from dea.figures.link import link
from dea.figures.recovery import recovery
from dea.figures.residual_tests import as_mathematics, residual_tests
from dea.figures.tracked_parameters import tracked_parameters

OF_ONE = {
    "control": lambda: control(made.control(1)),
    "fig1": lambda: fig1(made.record(1), "dea1", (100, 130)),
    "fig2": lambda: fig2(made.orders(1), made.validation(1), "dea1"),
    "recovery": lambda: recovery(made.recovery(1)),
    "residual_tests": lambda: residual_tests(made.validation(1), "dea1"),
    "tracked_parameters": lambda: tracked_parameters(made.record(1), made.track(1), "dea1"),
}
OF_ALL = {
    "fig3": lambda each: fig3(each(made.record), each(made.gfrf)),
    "fig3_phase": lambda each: fig3_phase(each(made.record), each(made.gfrf)),
    "fig4_h2": lambda each: fig4_h2(each(made.gfrf)),
    "fig4_h2_phase": lambda each: fig4_h2_phase(each(made.record), each(made.gfrf)),
    "fig4_h3": lambda each: fig4_h3(each(made.gfrf)),
    "link": lambda each: link(each(made.link)),
    "link_polled": lambda each: link(each(made.link, polled=True)),
}
WITHOUT_UNITS = re.compile(
    r"nmse( of the simulated output)?|fpe|relative error of .*|share of terms found"
    r"|\$\|H_[123].*\$ / .*"
    r"|(dynamic|polynomial) order|exchanges per bin|error over the least"
    r"|share at least as late|\$\\phi_\{.*\}\$"
)


@style.styled
def texts(figure):
    """Every text a reader sees, with its box in pixels."""
    figure.set_dpi(100)
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()  # which places every text, and colours no pixel
    found = []
    for ax in figure.axes:
        found += [ax.title, ax._left_title, ax._right_title, *ax.texts]
        if ax.get_legend():
            found += ax.get_legend().get_texts()
        if ax.axison and ax.get_visible():
            for axis in filter(Axis.get_visible, (ax.xaxis, ax.yaxis)):
                low, high = sorted(axis.get_view_interval())
                ticks = zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
                found += [axis.label, *(text for at, text in ticks if low <= at <= high)]
    for part in parts(figure):
        found += part.texts
        found += [text for legend in part.legends for text in legend.get_texts()]
    shown = [text for text in found if text.get_visible() and text.get_text().strip()]
    return [(text.get_text(), Text.get_window_extent(text)) for text in shown]


def parts(figure: FigureBase):
    yield figure
    for part in figure.subfigs:
        yield from parts(part)


def assert_readable(figure):
    """Return what is written on the figure."""
    page = figure.bbox.padded(1)
    boxes = texts(figure)
    assert len(boxes) > 5
    for text, box in boxes:
        assert page.contains(box.x0, box.y0), text
        assert page.contains(box.x1, box.y1), text
    for (a, one), (b, other) in itertools.combinations(boxes, 2):
        x = min(one.x1, other.x1) - max(one.x0, other.x0)
        y = min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(x, y) < 1.5, f"{a!r} overlaps {b!r}"
    return [text for text, _ in boxes]


def assert_units(figure):
    labels = [
        axis.label.get_text()
        for ax in figure.axes
        if ax.axison and ax.get_visible()
        for axis in (ax.xaxis, ax.yaxis)
        if axis.label.get_text()
    ]
    assert len(labels) >= 2
    for label in labels:
        assert re.search(r"\(.+\)$", label) or WITHOUT_UNITS.fullmatch(label), label


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_ONE)
def test_a_figure_of_one_actuator_is_readable_and_says_its_units(name):
    figure = OF_ONE[name]()
    assert_units(figure)
    assert_readable(figure)


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_ALL)
def test_a_figure_of_all_actuators_is_readable_and_says_its_units(name, each, names):
    figure = OF_ALL[name](each)
    assert_units(figure)
    assert set(names) <= set(assert_readable(figure))
    assert all(ax.has_data() or not ax.axison or ax.texts for ax in figure.axes if ax.get_visible())


LONG = "electrode_silicone_batch_2024_sample_"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fig3", "fig4_h2", "link", "link_polled"])
def test_a_figure_of_all_actuators_with_long_names_is_readable(name, names):
    def each(make, **options):
        return {LONG + name: make(seed, **options) for seed, name in enumerate(names)}

    assert_readable(OF_ALL[name](each))


@pytest.mark.parametrize(
    "draw",
    [
        lambda name: fig2(made.orders(1), made.validation(1), name),
        lambda name: residual_tests(made.validation(1), name),
        lambda name: confirmation(made.confirmation(1), name),
    ],
)
def test_a_figure_of_one_actuator_with_a_long_name_is_readable(draw):
    assert_readable(draw(f"{LONG}dea1"))


@pytest.mark.parametrize("stretches", [1, 3, 5])
def test_a_confirmation_of_several_stretches_is_readable(stretches):
    found = made.confirmation(1).isel(stretch=np.arange(stretches) % 3)
    # As the study's: from a twentieth of a Hz to twenty.
    axis = np.geomspace(0.05, 20.0, found.sizes["frequency"])
    found = found.assign_coords(frequency=found["frequency"].copy(data=axis))
    figure = confirmation(found, "dea1")
    said = assert_readable(figure)
    assert said.count("frequency (Hz)") == (stretches if stretches <= 3 else 1)


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("dea1", "dea1"),
        ("dea1, pump_left", "dea1, pump_left"),
        ("cascade, pump_left", "cascade\npump_left"),
        (LONG + "dea1", "electrode_\nsilicone_batch_\n2024_sample_dea1"),
        ("a-" + "x" * 30, "a-\n" + "x" * 15 + "…"),
    ],
)
def test_a_long_name_is_broken_behind_its_parts(name, lines):
    assert in_lines(name, 25.0) == lines


def test_a_controller_that_was_stopped_is_said_to_be():
    figure = control(made.control(1).isel(controller=[1, 0]))
    shown = assert_readable(figure)
    assert shown.count("stopped: it hung") == 3
    assert "PI (stopped)" in shown
    assert not figure.axes[2].get_yticks().size


def test_the_legend_of_the_controllers_is_as_large_as_others():
    figure = control(made.control(1))
    figure.draw_without_rendering()
    sizes = {text.get_fontsize() for text in figure.legends[0].get_texts()}
    assert sizes == {text.get_fontsize() for text in figure.axes[0].get_legend().get_texts()}


def test_fig1_shows_every_sample_of_the_record():
    record = made.record(1)
    figure = fig1(record, "dea1", (100, 130))
    drawn = [line.get_ydata() for ax in figure.axes for line in ax.lines]
    for name in ("voltage", "displacement"):
        whole = record[name].values
        inside = record[name].sel(time=slice(100, 130)).values
        assert any(np.array_equal(line, whole) for line in drawn)
        assert any(np.array_equal(line, inside) for line in drawn)


def test_fig2_tells_by_colour_where_parameters_come_from():
    validation = made.validation(1)
    figure = fig2(made.orders(1), validation, "dea1")
    for window, ax in enumerate(figure.subfigs[1].axes[1:]):
        by_colour = {line.get_color(): line.get_ydata() for line in ax.lines}
        for approach, colour in (
            ("forecast", style.FORECAST),
            ("fitted", style.FITTED),
            ("fitted, one-step", style.ONE_STEP),
        ):
            expected = validation["simulated"].sel(model="narx", approach=approach)
            assert np.array_equal(by_colour[colour], expected.isel(window=window))


def test_a_simulation_that_runs_away_does_not_hide_the_measurement():
    validation = made.validation(1)
    validation["simulated"].loc[{"approach": "forecast", "model": "linear"}] = 1e9
    figure = fig2(made.orders(1), validation, "dea1")
    low, high = figure.subfigs[1].axes[0].get_ylim()
    assert high - low < 2 * np.ptp(validation["measured"].values)


def test_a_forecast_that_diverges_is_marked_where_it_leaves_the_axis():
    validation = made.validation(1)
    run = validation["simulated"].sel(approach="forecast", model="narx").isel(window=1)
    run.values[100:103], run.values[103:] = 1e3, np.inf
    rows = fig2(made.orders(1), validation, "dea1").subfigs[1].axes
    assert [text.get_text() for text in rows[2].texts] == ["forecast diverged at 910 s", "F"]
    mark = rows[2].lines[-1]
    assert mark.get_xdata() == [910.0, 910.0]
    assert mark.get_color() == style.FORECAST
    assert [len(ax.texts) for ax in rows] == [1, 1, 2, 1]


@pytest.mark.parametrize(("lags", "chosen"), [(2, 3), ([2, 4], 4), ([[1, 2], [1, 2, 4]], 4)])
def test_the_chosen_orders_are_marked(lags, chosen):
    settings = {"identification": {"y_lags": 3, "u_lags": lags, "degree": 2}}
    orders = made.orders(1).assign_attrs(settings=json.dumps(settings))
    choice = fig2(orders, made.validation(1), "dea1").subfigs[0].axes
    for ax, order in zip(choice, (chosen, 2), strict=False):
        [mark] = [line for line in ax.lines if line.get_label() == f"chosen: {order}"]
        assert mark.get_xdata() == [order, order]


def test_a_larger_order_than_those_compared_is_told_and_does_not_stretch_the_axis():
    settings = {"identification": {"y_lags": 4, "u_lags": [1, 23], "degree": 2}}
    orders = made.orders(1).assign_attrs(settings=json.dumps(settings))
    ax = fig2(orders, made.validation(1), "dea1").subfigs[0].axes[0]
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert "chosen: 23 \N{RIGHTWARDS ARROW}" in labels
    assert ax.get_xlim()[1] < orders["dynamic_order"].max() + 1


def test_fig3_maps_hold_the_gain_and_the_phase():
    record, gfrf = made.record(1), made.gfrf(1)
    h1 = gfrf["H1"].values[..., 0] + 1j * gfrf["H1"].values[..., 1]
    delay = 360.0 * 0.1 * gfrf["frequency"].values  # one sample of the record
    relative = np.abs(h1) / np.abs(h1)[90, 0]
    for draw, expected in ((fig3, relative), (fig3_phase, np.degrees(np.angle(h1)) + delay)):
        figure = draw({"dea1": record}, {"dea1": gfrf})
        mesh = next(c for ax in figure.axes for c in ax.collections if c.get_array() is not None)
        np.testing.assert_allclose(np.reshape(mesh.get_array(), expected.T.shape), expected.T)


def test_the_colour_scale_is_set_where_the_excitation_held_power():
    record, gfrf = made.record(1), made.gfrf(1)
    silent = gfrf["excited"].values == 0
    gfrf["H1"].values[:, silent] *= 1e6
    figure = fig3({"dea1": record}, {"dea1": gfrf})
    mesh = next(c for ax in figure.axes for c in ax.collections if c.get_array() is not None)
    gain = abs(as_complex(gfrf["H1"])).values
    assert mesh.norm.vmax == pytest.approx(gain[:, ~silent].max() / gain[90, 0])


def test_what_was_not_excited_is_hatched_and_only_that():
    gfrf = made.gfrf(1)
    ax = fig4_h2({"dea1": gfrf}).axes[0]
    hatched = [c for c in ax.collections if any(getattr(c, "hatches", ()))]
    assert len(hatched) == 1
    area = hatched[0].get_paths()[0]
    assert area.contains_point((1.5, 1.5))
    assert area.contains_point((0.5, 1.5))
    assert not area.contains_point((0.5, 0.5))
    everywhere = gfrf.assign(excited_h2=gfrf["excited_h2"] * 0 + 1)
    bare = fig4_h2({"dea1": everywhere}).axes[0]
    assert not [c for c in bare.collections if any(getattr(c, "hatches", ()))]


@pytest.mark.parametrize(("spread", "lines"), [(1.0, 3), (0.03, 1), (1e-3, 0), (0.0, 0)])
def test_contours_have_different_labels_inside_their_panel_and_apart(spread, lines):
    gfrf = made.gfrf(1)
    f1, f2 = gfrf["frequency_1"], gfrf["frequency_2"]
    gfrf["H2"][..., 0] = 0.0123456 * (1 + spread * (f1 + f2) / 4)
    gfrf["H2"][..., 1] = 0.0
    ax = fig4_h2({"dea1": gfrf}).axes[0]
    labels = ax.texts
    assert sum(len(contour.levels) for contour in contours(ax)) == lines
    assert bool(labels) is bool(lines)
    assert len({label.get_text() for label in labels}) == len(labels)
    assert all(len(label.get_text().strip("0.").replace(".", "")) <= 3 for label in labels)
    excited = f1.values[gfrf["excited_h2"].any("frequency_2").values]
    half = 0.5 * np.ptp(excited)
    places = [(np.array(label.get_position()) - excited[0]) / half - 1.0 for label in labels]
    assert all(np.abs(place).max() <= 0.6 for place in places)
    for one, other in itertools.combinations(places, 2):
        assert np.abs(one - other).max() >= 0.7


def contours(ax):
    """The contours of a map, without the edge of what was excited."""
    lines = [c for c in ax.collections if isinstance(c, ContourSet) and not c.filled]
    return [c for c in lines if mcolors.same_color(c.get_edgecolor()[0], "w")]


def test_no_contour_is_drawn_without_its_level():
    gfrf = made.gfrf(1)
    f1, f2 = gfrf["frequency_1"], gfrf["frequency_2"]
    gfrf["H2"][..., 0] = 0.5 + np.exp(-3.0 * (f1 + f2))
    gfrf["H2"][..., 1] = 0.0
    ax = fig4_h2({"dea1": gfrf}).axes[0]
    [lines] = contours(ax)
    levels = [f"{level:.2g}" for level in lines.levels]
    assert levels
    assert [text.get_text() for text in ax.texts] == levels


def test_levels_of_a_logarithmic_map_are_in_equal_ratios():
    gfrf = made.gfrf(1)
    f1, f2 = gfrf["frequency_1"], gfrf["frequency_2"]
    gfrf["H2"][..., 0] = np.exp(1.5 * (f1 + f2))
    gfrf["H2"][..., 1] = 0.0
    figure = fig4_h2({"dea1": gfrf})
    mesh = next(c for c in figure.axes[0].collections if c.get_array() is not None)
    assert isinstance(mesh.norm, mcolors.LogNorm)
    [lines] = contours(figure.axes[0])
    assert len(lines.levels) == 3
    np.testing.assert_allclose(np.diff(np.log(lines.levels), 2), 0.0, atol=1e-9)


def test_contours_are_seen_on_any_colour():
    gfrf = made.gfrf(1)
    f1, f2 = gfrf["frequency_1"], gfrf["frequency_2"]
    gfrf["H2"][..., 0] = 1 + f1 + f2
    gfrf["H2"][..., 1] = 0.0
    ax = fig4_h2({"dea1": gfrf}).axes[0]
    mesh = next(c for c in ax.collections if c.get_array() is not None)
    [lines] = contours(ax)
    levels = {f"{level:.2g}": level for level in lines.levels}
    letters = {}
    for text in ax.texts:
        level = levels[text.get_text()]
        letters[level] = mcolors.to_rgb(text.get_color())[0]
        assert abs(np.mean(mesh.to_rgba(level)[:3]) - letters[level]) > 0.35
    assert [letters[level] for level in sorted(letters)] == [1.0, 1.0, 0.0]
    drawn = [mcolors.to_rgb(colour)[0] for colour in lines.get_edgecolor()]
    assert drawn == [1.0, 1.0, 0.0]


def test_levels_of_a_phase_have_a_minus_sign():
    ax = fig4_h2_phase({"dea1": made.record(1)}, {"dea1": made.gfrf(1)}).axes[0]
    written = [text.get_text() for text in ax.texts]
    assert any(label.startswith("\N{MINUS SIGN}") for label in written)
    assert not any("-" in label for label in written)


@pytest.mark.parametrize("draw", [fig4_h2, fig4_h3])
def test_a_page_of_one_system_is_wide_and_readable(draw):
    gfrf = made.gfrf(1).assign_attrs(withheld="biased " * 20, estimator="kalman")
    figure = draw({"dea1": gfrf})
    width, height = figure.get_size_inches()
    assert width > height
    curves = next(ax for ax in figure.axes if ax.get_xlabel() == "$f$ (Hz)")
    low, high = curves.get_xlim()
    assert sum(low <= tick <= high for tick in curves.get_xticks()) >= 5
    said = assert_readable(figure)
    assert {"dea1", "at 5 min", "at 15 min", "at 25 min"} <= set(said)


def test_curves_of_records_of_unequal_length_are_after_a_part_of_each():
    records = {name: made.record(seed) for seed, name in ((1, "dea1"), (2, "dea2"))}
    responses = {name: made.gfrf(seed) for seed, name in ((1, "dea1"), (2, "dea2"))}
    said = [text.get_text() for text in fig3(records, responses).legends[0].get_texts()]
    assert not any("of the record" in text for text in said)
    short = responses["dea2"]
    responses["dea2"] = short.assign_coords(
        {name: short[name] / 6.0 for name in ("time", "time_h2")}
    )
    for names in (["dea1", "dea2"], ["dea2", "dea1"]):
        figure = fig3({n: records[n] for n in names}, {n: responses[n] for n in names})
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert [text for text in said if text.startswith("at ")] == [
            "at 5 % of the record", "at 50 % of the record", "at 95 % of the record",
        ]  # fmt: skip
        figure = fig4_h2({n: responses[n] for n in names})
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert all("% of the record" in text for text in said if text.startswith("at "))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_legend_of_maps_without_a_steady_state_fits_the_page(count):
    responses = {f"dea{seed}": made.gfrf(seed) for seed in range(1, count + 1)}
    for name in ("H2", "H2_gain_low", "H2_gain_high"):
        responses["dea1"][name].values[0] = np.nan
    said = assert_readable(fig4_h2(responses))
    assert "the model of that time has no steady state" in said


def test_the_legend_promises_no_band_where_none_is_drawn():
    gfrf = made.gfrf(1)
    for name in ("H2_gain_low", "H2_gain_high"):
        gfrf[name] = gfrf[name] * np.nan
    said = [text.get_text() for text in fig4_h2({"dea1": gfrf}).legends[0].get_texts()]
    assert "95 % band" not in said


def test_nothing_is_said_of_extrapolation_where_all_that_is_shown_was_excited():
    gfrf = made.gfrf(1)
    known = gfrf["frequency"].values[-1]
    excited = (gfrf["frequency"] < known).astype(np.int8)  # up to a sliver below the last
    gfrf["excited"] = gfrf["excited"].copy(data=excited)
    gfrf["excited_h2"].values[:] = 1
    for figure in (fig3({"dea1": made.record(1)}, {"dea1": gfrf}), fig4_h2({"dea1": gfrf})):
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert not any("extrapolates" in text for text in said)


def test_every_tracker_stands_once_in_the_legend_and_the_band_too():
    legend = tracked_parameters(made.record(1), made.track(1), "dea1").subfigs[1].legends[0]
    assert [text.get_text() for text in legend.get_texts()] == [
        "recursive least squares",
        "Kalman smoother",
        "output-error smoother",
        "95 % band of each",
    ]


@pytest.mark.parametrize("zoom", [(2000, 2030), (1790, 1820), (130, 100), (-5, 20)])
def test_a_stretch_outside_the_record_is_refused(zoom):
    with pytest.raises(InputError, match=r"from 0 to 1799.9 s") as caught:
        fig1(made.record(1), "dea1", zoom)
    assert caught.value.field == "figures.zoom"


def test_a_time_without_a_steady_state_is_left_white_and_explained():
    gfrf = made.gfrf(1)
    gfrf["H1"].values[100:] = np.nan
    figure = fig3({"dea1": made.record(1)}, {"dea1": gfrf})
    mesh = next(c for ax in figure.axes for c in ax.collections if c.get_array() is not None)
    shown = np.ma.getmaskarray(mesh.get_array()).reshape(gfrf["H1"].shape[1::-1])
    assert not shown[:, :100].any()
    assert shown[:, 100:].all()
    assert any("no steady state" in text for text, _ in texts(figure))


def test_the_first_row_of_residual_tests_holds_the_correlations_and_the_band():
    validation = made.validation(1)
    figure = residual_tests(validation, "dea1", approach="fitted, one-step")
    lines = [line.get_ydata() for line in figure.axes[0].lines]
    chosen = (
        validation["tested_correlation"]
        .sel(approach="fitted, one-step", test="phi_ee")
        .isel(window=0)
    )
    assert [np.array_equal(a, b) for a, b in zip(lines, chosen.values, strict=True)] == [True, True]
    band = figure.axes[0].patches[0].get_extents().transformed(figure.axes[0].transData.inverted())
    assert band.y1 == pytest.approx(float(validation["band"][0]))


def test_residual_tests_say_what_is_correlated_and_where_a_short_window_ends():
    validation = made.validation(1)
    validation["time"][0] = 40.0 + np.arange(300) * 0.0222
    figure = residual_tests(validation, "dea1")
    said = figure.legends[0].get_title().get_text()
    assert said == (
        "dea1, forecast\n"
        r"correlations $\phi$ of residual $e$ and input $u$, below the first row made white;"
        " $p$ of all lags together"
    )
    assert figure.axes[0].get_title() == "40 to 46.66 s"


def test_the_recovery_shows_every_error_that_is_finite():
    scores = made.recovery(1)
    axes = recovery(scores).axes
    for ax, name in zip(axes, ("nmse", "h1_error", "h2_error"), strict=False):
        drawn = np.sort(np.concatenate([line.get_xdata() for line in ax.lines]))
        assert np.array_equal(drawn, np.sort(scores[name].values.ravel()))
    share = np.concatenate([line.get_xdata() for line in axes[-1].lines])
    assert np.array_equal(np.sort(share), np.sort(scores["terms_common"].values.ravel() / 10))


def test_a_fixed_model_that_diverges_is_said_to_have_and_keeps_its_axis():
    track = made.track(1)
    track["simulated"].values[0, 500:] = np.inf
    track["nmse"].values[0] = track["rmse"].values[0] = np.inf
    track["simulated"].values[0, 495:500] = 1e6  # on its way
    ax = tracked_parameters(made.record(1), track, "dea1").subfigs[0].axes[0]
    when = track["time"].values[500]
    assert when / 60 == pytest.approx(4.17, abs=0.01)
    assert ax.get_title(loc="right") == "fixed parameters: diverged at 4.2 min (axis cut)"
    residual, zero, mark = ax.lines
    assert residual.get_xdata()[-1] < when
    assert zero.get_xdata()[-1] < when
    assert mark.get_xdata() == [when, when]
    assert ax.get_ylim()[1] < 2.0  # five times what was usual before, 0.3 mm


def test_a_course_that_begins_far_off_does_not_flatten_the_rest():
    track = made.track(1)
    term = track["term"].values[1]
    track["band_high"].loc[{"tracker": "rls", "term": term}][:20] = 1e3
    axes = tracked_parameters(made.record(1), track, "dea1").subfigs[1].axes
    assert axes[1].get_ylim()[1] < 100.0
    [said] = [text.get_text() for text in axes[1].texts]
    assert said.startswith("cut; reaches ")
    assert said.endswith(" to 1e+03")
    assert not axes[0].texts


def test_first_estimates_that_swing_do_not_flatten_the_rest():
    track = made.track(1)
    term = track["term"].values[1]
    course = track["parameter"].sel(tracker="rls", term=term).values
    first = track["time"].values < 240.0  # of half an hour
    swing = np.where(first, 100.0 * np.sin(track["time"].values / 10.0), course)
    track["parameter"].loc[{"tracker": "rls", "term": term}] = swing
    ax = tracked_parameters(made.record(1), track, "dea1").subfigs[1].axes[1]
    later = track["parameter"].sel(term=term).values[:, ~first]
    low, high = ax.get_ylim()
    assert low < later.min() < later.max() < high
    assert high - low < 4 * np.ptp(later)
    assert any(text.get_text().startswith("cut; reaches ") for text in ax.texts)


def test_every_panel_of_tracked_parameters_shows_its_times():
    axes = tracked_parameters(made.record(1), made.track(1), "dea1").subfigs[1].axes
    shown = [ax for ax in axes if ax.get_visible()]
    assert all(ax.xaxis.get_tick_params()["labelbottom"] for ax in shown)
    assert [bool(ax.get_xlabel()) for ax in shown] == [False] * 3 + [True] * 3


@pytest.mark.parametrize(
    ("test", "mathematics"),
    [
        ("phi_ee", r"$\phi_{ee}$"),
        ("phi_e(eu)", r"$\phi_{e(eu)}$"),
        ("phi_u2e2", r"$\phi_{u^2e^2}$"),
        ("phi_u2e, u12", r"$\phi_{u^2e}$, $u_{12}$"),
        ("phi_uue, u1u12", r"$\phi_{uue}$, $u_{1}u_{12}$"),
    ],
)
def test_a_residual_test_as_mathematics(test, mathematics):
    assert as_mathematics(test) == mathematics


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([0.0, -0.0, 1.0], ["0", "0", "1"]),
        ([0.123, 0.124, -2.0], ["0.123", "0.124", "\N{MINUS SIGN}2"]),
    ],
)
def test_numbers_have_as_many_digits_as_tell_them_apart(values, texts):
    assert told_apart(values) == texts
