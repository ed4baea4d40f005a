"""What the figures of all systems plot: each system in its panel, each value in its place."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from matplotlib.colors import same_color, to_hex
from matplotlib.lines import Line2D

import made_datasets as made
from dea.figures import style
from dea.figures.fig3 import fig3
from dea.figures.fig3_phase import fig3_phase
from dea.figures.fig4_h2 import fig4_h2
from dea.figures.fig4_h2_phase import fig4_h2_phase
from dea.figures.fig4_h3 import fig4_h3
from dea.figures.frequency_maps import as_complex
from dea.figures.link import link

EACH = {"dea1": 1, "dea2": 2, "dea3": 3}


def meshes(figure):
    """The maps of a figure with their axes; the colour bar's has no data of its own."""
    found = [(ax, c) for ax in figure.axes for c in ax.collections if isinstance(c, QuadMesh)]
    return [(ax, mesh) for ax, mesh in found if ax.get_label() != "<colorbar>"]


def centres(mesh):
    """The values of x and y at which the cells of a mesh lie."""
    corners = mesh.get_coordinates()
    x, y = corners[0, :, 0], corners[:, 0, 1]
    return 0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])


def asymmetric(seed):
    """Responses whose H2 differs with the order of its frequencies and with time."""
    gfrf = made.gfrf(seed)
    f1, f2, t = gfrf["frequency_1"], gfrf["frequency_2"], gfrf["time_h2"]
    real = seed * (1 + t / 1800) * (1 + f1 + 3 * f2**2)
    gfrf["H2"].loc[{"part": "real"}] = real.transpose("time_h2", "frequency_1", "frequency_2")
    gfrf["H2"].loc[{"part": "imag"}] = 0.0
    return gfrf


@pytest.mark.parametrize("draw", [fig3, fig3_phase])
def test_maps_of_h1_lie_below_their_own_record_over_time_and_frequency(draw):
    records = {name: made.record(seed) for name, seed in EACH.items()}
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    for response in responses.values():  # equal steps, so that a cell's centre is its value
        response["frequency"] = np.linspace(0.1, 2.0, 60)
    figure = draw(records, responses)
    drawn = meshes(figure)
    assert len(drawn) == len(EACH)
    for (ax, mesh), (name, response) in zip(drawn, responses.items(), strict=True):
        h1 = as_complex(response["H1"]).values
        if draw is fig3:
            expected = np.abs(h1) / np.abs(h1)[90, 0]  # own gain at half time
        else:
            expected = np.degrees(np.angle(h1)) + 360.0 * 0.1 * response["frequency"].values
        np.testing.assert_allclose(mesh.get_array().reshape(expected.T.shape), expected.T)
        time, frequency = centres(mesh)
        np.testing.assert_allclose(time, response["time"])
        np.testing.assert_allclose(frequency, response["frequency"])
        position = ax.get_subplotspec()
        [series] = [other for other in figure.axes if other.get_title() == name]
        assert series.get_subplotspec().rowspan.start == position.rowspan.start - 1
        x, y = series.lines[0].get_data()
        np.testing.assert_array_equal(x, records[name]["time"])
        np.testing.assert_array_equal(y, records[name]["displacement"])


def test_fig4_has_a_column_for_each_system_a_row_for_each_time_and_f1_along_x():
    responses = {name: asymmetric(seed) for name, seed in EACH.items()}
    figure = fig4_h2(responses)
    axes = dict(meshes(figure))
    assert len(axes) == 9
    for ax, mesh in axes.items():
        spec = ax.get_subplotspec()
        name, instant = list(EACH)[spec.colspan.start], spec.rowspan.start
        h2 = abs(as_complex(responses[name]["H2"])).isel(time_h2=instant)
        middle = abs(as_complex(responses[name]["H2"])).values[1, 0, 0]
        expected = h2.transpose("frequency_2", "frequency_1").values / middle
        np.testing.assert_allclose(mesh.get_array().reshape(expected.shape), expected)
        for drawn, axis in zip(centres(mesh), ("frequency_1", "frequency_2"), strict=True):
            np.testing.assert_allclose(drawn, responses[name][axis])
        if spec.is_first_row():
            assert ax.get_title() == name
        if spec.is_first_col():
            assert ax.get_ylabel() == f"at {(5, 15, 25)[instant]} min\n$f_2$ (Hz)"
        if instant == 2:
            assert ax.get_xlabel() == "$f_1$ (Hz)"
    bar = next(ax for ax in figure.axes if ax.get_label() == "<colorbar>")
    assert bar.get_ylabel() == "$|H_2(f_1, f_2)|$ / own at lowest $f$, middle time"


def test_curves_of_h1_lie_within_their_bands_at_three_times():
    response = made.gfrf(1)
    figure = fig3({"dea1": made.record(1)}, {"dea1": response})
    ax = next(ax for ax in figure.axes if ax.get_ylabel() == "gain $|H_1|$ (mm/V)")
    gain = np.abs(as_complex(response["H1"]).values)
    silent = response["excited"].values == 0
    for row, line, band in zip((9, 90, 171), ax.lines[::2], ax.collections, strict=True):
        np.testing.assert_allclose(line.get_ydata()[~silent], gain[row][~silent])
        assert np.isnan(line.get_ydata()[silent]).all()
        points = {tuple(point) for path in band.get_paths() for point in path.vertices}
        for end in ("gain_low", "gain_high"):
            ends = response[end].values[row][~silent]
            assert points >= set(zip(response["frequency"].values[~silent], ends, strict=True))


def test_axes_of_gains_span_the_same_multiples_of_each_systems_own():
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    responses["dea2"]["H1"] = 100.0 * responses["dea2"]["H1"]
    figure = fig3({name: made.record(1) for name in EACH}, responses)
    axes = [ax for ax in figure.axes if ax.get_ylabel() == "gain $|H_1|$ (mm/V)"]
    relative = []
    for ax, response in zip(axes, responses.values(), strict=True):
        own = np.abs(as_complex(response["H1"]).values)[90, 0]
        relative.append(np.array(ax.get_ylim()) / own)
        assert all(np.nanmax(line.get_ydata()) <= ax.get_ylim()[1] for line in ax.lines)
    np.testing.assert_allclose(relative, relative[:1] * 3)
    assert relative[0][0] >= 0.0


def test_axes_of_phases_are_the_same():
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    responses["dea2"]["H1"][..., 1] *= 0.1
    figure = fig3_phase({name: made.record(1) for name in EACH}, responses)
    axes = [ax for ax in figure.axes if ax.get_ylabel() == "phase of $H_1$ (degrees)"]
    assert len({ax.get_ylim() for ax in axes}) == 1
    for ax in axes:
        x, y = np.concatenate([line.get_xydata() for line in ax.lines]).T
        drawn = y[x <= ax.get_xlim()[1]]
        assert ax.get_ylim()[0] < np.nanmin(drawn)
        assert np.nanmax(drawn) < ax.get_ylim()[1]


@pytest.mark.parametrize("draw", [fig3, fig3_phase])
def test_each_of_several_inputs_has_a_map_of_h1(draw):
    response = made.gfrf_of_inputs()
    figure = draw({"dea1": made.record(1)}, {"dea1": response})
    titles = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert titles == ["dea1, left", "dea1, right"]
    labels = {ax.get_ylabel() for ax in figure.axes}
    if draw is fig3:
        assert {"gain $|H_1|$ (mm/V)", "gain $|H_1|$ (mm/%)"} <= labels
        for k, (_, mesh) in enumerate(meshes(figure)):
            gain = abs(as_complex(response["H1"].isel(input=k))).values
            np.testing.assert_allclose(mesh.get_array().ravel(), (gain / gain[90, 0]).T.ravel())


def test_the_gain_of_an_input_without_linear_effect_is_drawn_as_zero():
    response = made.gfrf_of_inputs()
    response["H1"].loc[{"input": "right"}] = 0.0
    figure = fig3({"dea1": made.record(1)}, {"dea1": response})
    _, mesh = meshes(figure)[1]
    np.testing.assert_array_equal(np.ma.filled(mesh.get_array(), np.nan), 0.0)
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "the model of that time has no steady state" not in said


def test_each_pair_of_inputs_has_a_map_of_h2_and_one_without_terms_says_so():
    response = made.gfrf_of_inputs()
    response["H2"].loc[{"pair": "right × right"}] = 0.0
    given = {name: each.attrs["units"] for name, each in response.data_vars.items()}
    figure = fig4_h2({"dea1": response})
    assert {name: each.attrs["units"] for name, each in response.data_vars.items()} == given
    titles = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert titles == ["dea1\nleft × left", "dea1\nleft × right", "dea1\nright × right"]
    curves = [ax.get_ylabel() for ax in figure.axes if ax.get_xlabel() == "$f$ (Hz)"]
    assert curves == [f"$|H_2(f, f)|$ ({unit})" for unit in ("mm/V²", "mm/(V %)", "mm/%²")]
    zero = [ax for ax, _ in meshes(figure) if "zero" in [text.get_text() for text in ax.texts]]
    assert {ax.get_subplotspec().colspan.start for ax in zero} == {2}
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "the model of that time has no steady state" not in said


def test_the_last_row_of_fig4_is_the_diagonal_with_its_band():
    response = made.gfrf(1)
    figure = fig4_h2({"dea1": response})
    ax = next(ax for ax in figure.axes if ax.get_ylabel() == "$|H_2(f, f)|$ (mm/V²)")
    excited = np.diagonal(response["excited_h2"].values) == 1
    f = response["frequency_1"].values[excited]
    for row, (line, band) in enumerate(zip(ax.lines, ax.collections, strict=True)):
        size = np.diagonal(np.abs(as_complex(response["H2"]).values[row]))[excited]
        np.testing.assert_allclose(line.get_xydata(), np.column_stack([f, size]))
        points = {tuple(point) for path in band.get_paths() for point in path.vertices}
        low = np.diagonal(response["H2_gain_low"].values[row])[excited]
        assert points >= set(zip(f, low, strict=True))


def test_the_phase_of_h2_is_unwrapped_and_without_the_delay_of_a_sample():
    response, record = made.gfrf(1), made.record(1)
    f1, f2 = response["frequency_1"].values, response["frequency_2"].values
    # Two poles and three samples of 0.1 s: more than a turn at the highest frequencies.
    angle = -np.degrees(np.arctan(f1[:, None] / 0.8) + np.arctan(f2 / 0.8))
    lagging = angle - 3 * 36.0 * (f1[:, None] + f2)
    h2 = np.broadcast_to(np.exp(1j * np.radians(lagging)), (3, f1.size, f2.size))
    response["H2"].values[:] = np.stack([h2.real, h2.imag], axis=-1)
    response["H2_phase_low"].values[:] = np.degrees(np.angle(h2)) - 2.0
    figure = fig4_h2_phase({"dea1": record}, {"dea1": response})
    expected = lagging + 36.0 * (f1[:, None] + f2)
    for _, mesh in meshes(figure):
        np.testing.assert_allclose(mesh.get_array().reshape(expected.T.shape), expected.T)
    ax = next(ax for ax in figure.axes if ax.get_ylabel().startswith("phase of\n"))
    excited = np.diagonal(response["excited_h2"].values) == 1
    for line, band in zip(ax.lines, ax.collections, strict=True):
        along = np.diagonal(expected)[excited]
        np.testing.assert_allclose(line.get_ydata(), along)
        ends = band.get_paths()[0].vertices[:, 1]
        assert np.abs(ends[:, None] - (along - 2.0)).min(axis=0).max() < 1e-9


def test_axes_of_phases_of_h2_are_the_same():
    systems = {f"dea{seed}": made.gfrf(seed) for seed in (1, 2, 3)}
    systems["dea2"]["H2_phase_low"] = systems["dea2"]["H2_phase_low"] - 40.0
    figure = fig4_h2_phase({name: made.record(1) for name in systems}, systems)
    curves = [ax for ax in figure.axes if ax.get_xlabel() == "$f$ (Hz)"]
    assert len(curves) == 3
    assert len({ax.get_ylim() for ax in curves}) == 1
    for ax in curves:
        low, high = ax.get_ylim()
        drawn = np.concatenate([line.get_ydata() for line in ax.lines])
        assert low <= drawn.min() <= drawn.max() <= high


def test_an_h2_without_terms_has_no_phase_to_show():
    response = made.gfrf(1)
    response["H2"].values[:] = 0.0
    figure = fig4_h2_phase({"dea1": made.record(1)}, {"dea1": response})
    assert all("zero" in [text.get_text() for text in ax.texts] for ax, _ in meshes(figure))
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "the model of that time has no steady state" not in said


def test_the_map_of_h3_says_its_third_frequency_and_claims_no_band():
    response = made.gfrf(1)
    figure = fig4_h3({"dea1": response})
    size = np.abs(as_complex(response["H3"]).values)
    _, mesh = meshes(figure)[1]
    expected = (size[1] / size[1, 0, 0]).T
    np.testing.assert_allclose(mesh.get_array().reshape(expected.shape), expected)
    bar = next(ax for ax in figure.axes if ax.get_label() == "<colorbar>")
    assert "0.5 Hz" in bar.get_ylabel()
    ax = next(ax for ax in figure.axes if ax.get_ylabel() == "$|H_3(f, f,$ 0.5 Hz$)|$ (mm/V³)")
    assert len(ax.lines) == 3
    assert not ax.collections
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "95 % band" not in said
    assert "no band is computed" in said


def test_the_map_of_h3_names_the_third_frequency_of_each_rate():
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    last = list(responses)[-1]
    responses[last] = responses[last].assign_coords(frequency_3=1.25)
    figure = fig4_h3(responses)
    bar = next(ax for ax in figure.axes if ax.get_label() == "<colorbar>")
    assert "0.5, 1.25 Hz" in bar.get_ylabel()


@pytest.mark.parametrize("draw", [fig3, fig3_phase])
def test_what_has_no_band_or_another_estimate_is_said_below(draw):
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    responses["dea1"].attrs["withheld"] = "biased"
    responses["dea2"].attrs["estimator"] = "kalman"
    figure = draw({name: made.record(1) for name in EACH}, responses)
    said = figure.legends[0].get_title().get_text()
    assert said == "dea1: no 95 % band: biased\ndea2: parameters of kalman, not output_error"


def test_what_has_no_band_anyway_says_another_estimate_alone():
    responses = {name: made.gfrf(seed) for name, seed in EACH.items()}
    responses["dea1"].attrs["withheld"] = "biased"
    responses["dea2"].attrs["estimator"] = "kalman"
    said = fig4_h3(responses).legends[0].get_title().get_text()
    assert said == "dea2: parameters of kalman, not output_error"


def test_link_plots_the_round_trips_and_the_lateness_of_each_system():
    links = {name: made.link(seed, polled=True) for name, seed in EACH.items()}
    trips, course, lateness, repairs = link(links).axes
    for place, (name, dataset) in enumerate(links.items()):
        colour = style.CYCLE[place]
        edges = dataset["round_trip_low"].values * 1e3, dataset["round_trip_high"].values * 1e3
        step = trips.patches[place]
        assert step.get_label() == name
        assert same_color(step.get_edgecolor(), colour)
        np.testing.assert_array_equal(step.get_data().values, dataset["round_trip_count"])
        np.testing.assert_array_equal(step.get_data().edges, [*edges[0], edges[1][-1]])
        x, y = course.lines[place].get_data()
        np.testing.assert_array_equal(x, dataset["send_time"])
        np.testing.assert_allclose(y, 1e3 * (dataset["receive_time"] - dataset["send_time"]))
        late, share = lateness.lines[place].get_data()
        jitter = 1e3 * dataset["jitter"].values
        for at in (0, 10, late.size - 1):
            assert share[at] == pytest.approx(np.mean(jitter >= late[at]))
        cells = repairs.tables[0].get_celld()
        row = [cells[place + 1, column].get_text().get_text() for column in range(5)]
        retries, reconnects = int(dataset["retries"].sum()), int(dataset["reconnects"])
        errors = f"{int(dataset['errors'][0])} no reply\n2 short reply"
        assert row == [name, "900", str(retries), str(reconnects), errors]


def looks(artists, colour):
    """How lines or steps look, each as often as it is there."""
    return [(to_hex(getattr(each, colour)()), str(each.get_linestyle())) for each in artists]


def test_links_of_more_systems_than_there_are_colours_are_told_from_each_other():
    links = {f"dea{seed}": made.link(seed, polled=True) for seed in range(1, 10)}
    figure = link(links)
    trips, course, lateness, _ = figure.axes
    assert len(set(looks(trips.patches, "get_edgecolor"))) == 9
    assert len(set(looks(lateness.lines, "get_color"))) == 9
    assert len({(line.get_color(), line.get_marker()) for line in course.lines}) == 9
    handles = figure.legends[0].legend_handles
    assert [to_hex(each.get_color()) for each in handles] == [
        to_hex(line.get_color()) for line in course.lines
    ]
    assert [each.get_marker() for each in handles[6:]] == [
        line.get_marker() for line in course.lines[6:]
    ]


def test_more_times_of_h2_than_there_are_colours_are_told_from_each_other():
    response = made.gfrf(1).isel(time_h2=[0, 1, 2, 2, 2])
    times = np.linspace(300.0, 1500.0, 5)
    figure = fig4_h2({"dea1": response.assign_coords(time_h2=response["time_h2"].copy(data=times))})
    ax = next(ax for ax in figure.axes if ax.get_ylabel() == "$|H_2(f, f)|$ (mm/V²)")
    drawn = looks(ax.lines, "get_color")
    assert len(set(drawn)) == 5
    handles = figure.legends[0].legend_handles
    told = [each for each in handles if isinstance(each, Line2D)]
    assert looks(told, "get_color") == drawn


@pytest.mark.parametrize("ratio", [20.0, 60.0, 300.0, 2e4])
def test_labels_of_round_trips_stand_apart_in_their_narrow_panel(ratio):
    dataset = made.link(1)
    low = dataset["round_trip_low"].values
    count = (low >= 4.9e-5) & (low <= 4.9e-5 * ratio)
    slow = dataset.assign(round_trip_count=dataset["round_trip_count"].copy(data=1 * count))
    figure = link({"dea1": slow, "dea2": slow})
    figure.draw_without_rendering()
    ax = figure.axes[0]
    low, high = ax.get_xlim()
    shown = [t for t in ax.get_xticklabels() if t.get_text() and low <= t.get_position()[0] <= high]
    boxes = sorted((t.get_window_extent() for t in shown), key=lambda box: box.x0)
    assert len(boxes) >= 2
    assert all(right.x0 - left.x1 > boxes[0].height / 6.0 for left, right in pairwise(boxes))


def test_link_shows_every_bar_whole_and_says_whose_clock_it_is():
    links = {name: made.link(seed) for name, seed in EACH.items()}
    figure = link(links)
    trips, course, repairs = figure.axes
    (left, right), (_, top) = trips.get_xlim(), trips.get_ylim()
    for step in trips.patches:
        count, edges, _ = step.get_data()
        filled = np.flatnonzero(count)
        assert left < edges[filled[0]]
        assert edges[filled[-1] + 1] < right
        assert count.max() < top
    assert course.get_xlabel() == "time of the request, host's clock (s)"
    figure.draw_without_rendering()
    cells = repairs.tables[0].get_celld().values()
    for cell in cells:
        box, text = cell.get_window_extent(), cell.get_text().get_window_extent()
        assert box.x0 <= text.x0
        assert text.x1 <= box.x1
    assert min(cell.get_window_extent().y0 for cell in cells) >= repairs.get_window_extent().y0 - 1
