"""What the figures of one system plot: which numbers, on which axes, with which labels."""

import numpy as np
import pytest
from matplotlib.colors import same_color

import made_datasets as made
from dea.figures import style
from dea.figures.fig1 import fig1
from dea.figures.fig2 import fig2
from dea.figures.recovery import recovery
from dea.figures.residual_tests import residual_tests
from dea.figures.tracked_parameters import tracked_parameters
from dea.terms import Term


def line(ax, colour):
    """The data (x, y) of the only line of a colour."""
    [found] = [each for each in ax.lines if same_color(each.get_color(), colour)]
    return found.get_data()


def assert_line(ax, colour, x, y):
    drawn = line(ax, colour)
    np.testing.assert_array_equal(drawn[0], x)
    np.testing.assert_array_equal(drawn[1], y)


def labels(ax):
    return ax.get_xlabel(), ax.get_ylabel()


def test_fig1_plots_input_and_output_over_time_and_against_each_other():
    record = made.record(1)
    figure = fig1(record, "dea1", (100, 130))
    _, series, details = figure.subfigs
    time, u, y = (record[name].values for name in ("time", "voltage", "displacement"))
    top, bottom = series.axes
    assert_line(top, style.BLUE, time, u)
    assert_line(bottom, style.BLACK, time, y)
    assert (top.get_ylabel(), bottom.get_ylabel()) == ("input $u$ (V)", "output $y$ (mm)")
    assert (top.get_title(loc="right"), bottom.get_xlabel()) == ("dea1", "time (min)")
    for ax in (top, bottom):
        span = ax.patches[0].get_extents().transformed(ax.transData.inverted())
        assert (span.x0, span.x1) == pytest.approx((100, 130))
    zoomed_input, loop, zoomed_output, bar = details.axes
    inside = (time >= 100) & (time <= 130)
    assert_line(zoomed_input, style.BLUE, time[inside], u[inside])
    assert_line(zoomed_output, style.BLACK, time[inside], y[inside])
    assert labels(zoomed_input) == ("time (s)", "input $u$ (V)")
    assert labels(zoomed_output) == ("time (s)", "output $y$ (mm)")
    [points] = loop.collections
    drawn = np.column_stack([points.get_array(), points.get_offsets()])
    assert (np.diff(drawn[:100, 0]) < 0).any()  # late ones do not hide early ones
    in_time = drawn[np.argsort(drawn[:, 0])]
    np.testing.assert_array_equal(in_time, np.column_stack([time / 60, u, y]))
    assert labels(loop) == ("input $u$ (V)", "output $y$ (mm)")
    assert bar.get_title(loc="right") == "time (min)"


def test_fig1_of_a_short_record_is_in_seconds_and_not_faint():
    whole, short = (fig1(made.record(1, length), "dea1", (2, 8)) for length in (1800.0, 10.0))
    for figure, name in ((whole, "min"), (short, "s")):
        assert figure.subfigs[1].axes[1].get_xlabel() == f"time ({name})"
        assert figure.subfigs[2].axes[3].get_title(loc="right") == f"time ({name})"
    assert short.subfigs[2].axes[1].collections[0].get_clim() == pytest.approx((0, 10))
    thin, wide = (each.subfigs[1].axes[0].lines[0].get_linewidth() for each in (whole, short))
    assert thin < 0.25 < 0.8 < wide
    small, large = (
        each.subfigs[2].axes[1].collections[0].get_sizes()[0] for each in (whole, short)
    )
    assert small <= 1.2 < 3 < large


@pytest.mark.parametrize(("panel", "kind"), [(0, "dynamic"), (1, "polynomial")])
def test_fig2_plots_nmse_and_fpe_against_the_order_over_their_least(panel, kind):
    orders = made.orders(1)
    choice = fig2(orders, made.validation(1), "dea1").subfigs[0]
    ax = choice.axes[panel]
    order = orders[f"{kind}_order"].values
    for criterion, colour in (("nmse", style.NMSE), ("fpe", style.FPE)):
        values = orders[f"{kind}_{criterion}"].values
        assert_line(ax, colour, order, values / values.min())
    assert labels(ax) == (f"{kind} order", "error over the least")
    shown = [text.get_text() for text in ax.get_legend().get_texts()]
    least = float(orders[f"{kind}_fpe"].min())
    assert shown[1] == f"fpe, least {least:#.3g} (mm²)"


def test_orders_that_all_diverge_are_drawn_empty():
    orders = made.orders(1)
    diverged = orders["dynamic_nmse"].copy(data=np.full(orders["dynamic_nmse"].shape, np.inf))
    choice = fig2(orders.assign(dynamic_nmse=diverged), made.validation(1), "dea1").subfigs[0]
    assert np.isfinite(choice.axes[0].get_ylim()).all()


def test_fig2_plots_forecasts_against_the_measurement():
    validation = made.validation(1)
    scatter = fig2(made.orders(1), validation, "dea1").subfigs[0].axes[2]
    measured = validation["measured"].values.ravel()
    for model, colour in (("linear", style.LINEAR), ("narx", style.NARX)):
        simulated = validation["simulated"].sel(model=model, approach="forecast").values.ravel()
        assert_line(scatter, colour, measured, simulated)
    assert labels(scatter) == ("measured $y$ (mm)", r"forecast $\hat y$ (mm)")
    texts = [text.get_text() for text in scatter.get_legend().get_texts()]
    assert texts == ["linear", "NARX"]
    assert scatter.get_box_aspect() == 1
    assert scatter.get_xlim() == scatter.get_ylim()
    np.testing.assert_array_equal(scatter.get_xticks(), scatter.get_yticks())


@pytest.mark.parametrize(("row", "model", "window"), [(0, "linear", 0), (1, "narx", 0),
                                                      (2, "narx", 1), (3, "narx", 2)])  # fmt: skip
def test_fig2_plots_each_window_with_its_time_and_scores(row, model, window):
    validation = made.validation(1)
    ax = fig2(made.orders(1), validation, "dea1").subfigs[1].axes[row]
    part = validation.isel(window=window).sel(model=model)
    assert_line(ax, style.MEASURED, part["time"], part["measured"])
    for approach, colour in (
        ("forecast", style.FORECAST),
        ("fitted", style.FITTED),
        ("fitted, one-step", style.ONE_STEP),
    ):
        assert_line(ax, colour, part["time"], part["simulated"].sel(approach=approach))
    words = {"forecast": "forecast", "fitted": "fitted", "fitted, one-step": "one step ahead"}
    scores = [f"{short} {float(part['nmse'].sel(approach=a)):#.3g}" for a, short in words.items()]
    title = ax.get_title(loc="right")
    assert title.startswith("linear model" if model == "linear" else "NARX model")
    assert all(score in title for score in scores)


def test_residual_tests_plot_each_test_in_its_row_and_each_window_in_its_column():
    validation = made.validation(1)
    validation["band"].values[:] = np.linspace(0.05, 0.09, len(made.TESTS))
    axes = np.reshape(residual_tests(validation, "dea1").axes, (len(made.TESTS), 3))
    chosen = validation.sel(approach="forecast")
    for row, test in enumerate(made.TESTS):
        for window in range(3):
            ax = axes[row, window]
            part = chosen["tested_correlation"].sel(test=test).isel(window=window)
            for model, colour in (("linear", style.LINEAR), ("narx", style.NARX)):
                assert_line(ax, colour, part["lag"], part.sel(model=model))
            band = ax.patches[0].get_extents().transformed(ax.transData.inverted())
            reach = float(validation["band"].sel(test=test))
            assert (band.y0, band.y1) == pytest.approx((-reach, reach))
    titles = [ax.get_title() for ax in axes[0]]
    assert titles == ["100 to 130 s", "900 to 930 s", "1700 to 1730 s"]
    assert [ax.get_ylabel() for ax in axes[1:3, 0]] == [r"$\phi_{eu}$", r"$\phi_{e(eu)}$"]
    assert {ax.get_xlabel() for ax in axes[-1]} == {"lag (samples)"}


def test_each_panel_of_residual_tests_says_its_p_values():
    validation = made.validation(1)
    forecast = {"approach": "forecast", "test": "phi_u2e"}
    validation["p_value"].loc[{"model": "linear", **forecast}] = [0.004, 0.5, 0.5]
    validation["p_value"].loc[{"model": "narx", **forecast}] = [1e-9, 1.0, 0.5]
    axes = np.reshape(residual_tests(validation, "dea1").axes, (len(made.TESTS), 3))
    row = list(made.TESTS).index("phi_u2e")
    said = [[(t.get_text(), t.get_color()) for t in ax.texts] for ax in axes[row, :2]]
    assert said == [
        [("$p$ = 0.004", style.LINEAR), ("$p$ < 0.001", style.NARX)],
        [("$p$ = 0.5", style.LINEAR), ("$p$ = 1", style.NARX)],
    ]


def test_residual_tests_say_where_a_model_has_diverged():
    validation = made.validation(1)
    validation["tested_correlation"].loc[{"model": "narx", "approach": "forecast"}][1] = np.inf
    axes = np.reshape(residual_tests(validation, "dea1").axes, (len(made.TESTS), 3))
    assert [len(ax.texts) for ax in axes[0]] == [2, 1, 2]
    titles = [ax.get_title() for ax in axes[0]]
    assert titles == ["100 to 130 s", "900 to 930 s, NARX diverged", "1700 to 1730 s"]


COLOURS = {
    "fixed": style.GREY, "rls": style.BLUE, "kalman": style.VERMILION, "output_error": style.GREEN
}  # fmt: skip


def test_tracked_parameters_plot_what_each_simulation_leaves():
    record, track = made.record(1), made.track(1)
    axes = tracked_parameters(record, track, "dea1").subfigs[0].axes
    measured = record["displacement"].sel(time=track["time"]).values
    for ax, (simulation, colour) in zip(axes, COLOURS.items(), strict=True):
        chosen = track.sel(simulation=simulation)
        np.testing.assert_array_equal(line(ax, colour)[0], track["time"])
        np.testing.assert_allclose(line(ax, colour)[1], measured - chosen["simulated"], atol=1e-12)
        title = ax.get_title(loc="right")
        assert f"nmse {float(chosen['nmse']):#.3g}, rmse {float(chosen['rmse']):#.3g} mm" in title


def test_tracked_parameters_plot_each_parameter_with_its_95_percent_band():
    track = made.track(1)
    axes = tracked_parameters(made.record(1), track, "dea1").subfigs[1].axes
    thin = track.isel(time=slice(None, None, 3))
    for ax, term in zip(axes, track["term"].values, strict=False):
        assert ax.get_title() == Term.parse(term).mathematics()
        for band, tracker in zip(ax.collections, made.TRACKERS, strict=True):
            of = {"tracker": tracker, "term": term}
            assert_line(ax, COLOURS[tracker], thin["time"], thin["parameter"].sel(of).values)
            assert same_color(band.get_facecolor()[0][:3], COLOURS[tracker])
            edges = {tuple(point) for point in band.get_paths()[0].vertices}
            for end in ("band_low", "band_high"):
                expected = track[end].sel(of).values
                assert edges >= set(zip(track["instant"].values, expected, strict=True))


def test_a_withheld_band_is_not_drawn_and_the_figure_says_why():
    track = made.track(1)
    why = np.array(["", "biased", ""], dtype=object)
    track["withheld"] = track["withheld"].copy(data=why)
    track["estimator"] = track["estimator"].copy(
        data=np.array(["rls", "kalman", "kalman"], dtype=object)
    )
    lower = tracked_parameters(made.record(1), track, "dea1").subfigs[1]
    assert len(lower.axes[0].collections) == 2
    said = lower.legends[0].get_title().get_text()
    assert "Kalman smoother: no 95 % band, biased" in said
    assert "output-error smoother: parameters of kalman" in said
    legend = [text.get_text() for text in lower.legends[0].get_texts()]
    assert legend[-1] == "95 % band of recursive least squares and output-error smoother"
    track["withheld"][:] = ["", "biased", "biased"]
    lower = tracked_parameters(made.record(1), track, "dea1").subfigs[1]
    said = lower.legends[0].get_title().get_text()
    assert said == "Kalman smoother, output-error smoother: no 95 % band, biased"
    legend = [text.get_text() for text in lower.legends[0].get_texts()]
    assert legend[-1] == "95 % band of recursive least squares"
    track["withheld"][:] = ["biased"] * 3
    lower = tracked_parameters(made.record(1), track, "dea1").subfigs[1]
    assert not any("band" in text.get_text() for text in lower.legends[0].get_texts())


@pytest.mark.parametrize(("panel", "name"), [(0, "nmse"), (1, "h1_error"), (2, "h2_error")])
def test_recovery_plots_each_plant_in_its_row(panel, name):
    scores = made.recovery(1)
    ax = recovery(scores).axes[panel]
    drawn = {each.get_label(): each.get_data() for each in ax.lines}
    for excitation, words in (("coloured", "band-limited input"), ("white", "white input")):
        for search, how in (("forward", "forward selection"), ("refined", "with refinement")):
            x, y = drawn[f"{words}, {how}"]
            np.testing.assert_array_equal(x, scores[name].sel(excitation=excitation, search=search))
            np.testing.assert_array_equal(np.round(y), np.arange(6))
    assert ax.get_ylim()[0] > ax.get_ylim()[1]
