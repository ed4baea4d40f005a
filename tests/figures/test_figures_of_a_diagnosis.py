"""What the figure of a diagnosis plots, panel by panel."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba

from dea.figures import style
from dea.figures.discrepancy import discrepancy

TIME = np.arange(20.0)
MEASURED, NOMINAL, EXTENDED = np.sin(TIME), 0.5 * np.sin(TIME), 0.9 * np.sin(TIME)
CERTIFICATE = xr.Dataset(
    {
        "measured": ("time", MEASURED, {"units": "mm"}),
        "nominal": ("time", NOMINAL),
        "extended": ("time", EXTENDED),
        "role": ("time", np.where(TIME < 12, 1, 3)),
        "law_1_along": ("time", np.cos(TIME), {"units": "V", "long_name": "input"}),
        "law_1_value": ("time", np.cos(TIME) ** 3, {"units": "V", "long_name": "input that acts"}),
        "law_1_low": ("time", np.cos(TIME) ** 3 - 0.1),
        "law_1_high": ("time", np.cos(TIME) ** 3 + 0.2),
        "law_1_idle": ("time", np.cos(TIME)),
    },
    coords={"time": TIME},
)
BINS = {
    f"{along}_{what}_{when}": ("bin", values + shift, {"units": unit})
    for shift, along in enumerate(("input", "output"))
    for when, values in (
        ("before", np.array([3.0, 4.0, 5.0])),
        ("after", np.array([1.0, 2.0, 1.5])),
    )
    for what, unit in (("rms", "mm"), ("null", "mm"))
}
EDGES = {
    f"{along}_{end}_{when}": (
        "bin",
        np.array([0.0, 1.0, 2.0]) + (end == "high"),
        {"units": unit, "long_name": f"{along}: {end}er end"},
    )
    for along, unit in (("input", "V"), ("output", "mm"))
    for when in ("before", "after")
    for end in ("low", "high")
}
LOCALISATION = xr.Dataset(BINS | EDGES)
NAMES = ["dead_zone", "sensor_lag"]
PARTS = "along", "value", "low", "high", "idle"
CANDIDATES = xr.Dataset(
    {
        "gain": ("candidate", [0.1, 0.9]),
        "gain_low": ("candidate", [0.0, 0.7]),
        "gain_high": ("candidate", [0.3, 1.0]),
        "null_gain": ((), 0.2),
        "share": ("candidate", [0.8, 0.104]),
        "finished": ("candidate", [1.0, 1.0]),
    },
    coords={"candidate": NAMES},
)


def verdict(status="named"):
    law = {
        "width": {"value": 0.4, "low": 0.3, "high": 0.6, "unit": "V", "at_bound": False},
        "slope": {"value": 0.1, "low": -0.05, "high": 0.25, "unit": "1", "at_bound": False},
    }
    effect = {"name": "dead_zone", "port": "input path", "place": None, "share": 0.724}
    effects = [effect | {"parameters": law, "quoted": ["width", "slope"]}]
    return {
        "status": status,
        "whole": True,
        "law_too_poor": False,
        "effects": effects if status == "named" else [],
        "where": {"along": "input"},
        "ladder": [["nominal", 0.5], ["dead_zone", 0.1], ["noise floor", 0.05]],
        "unit": "mm",
        "model_error": {"white": 0.05, "level": 0.07},
        "presence": {"effects": {"sensor_lag": 0.04, "dead_zone": 0.97}},
    }


PANELS = "series", "runs", "where", "ladder", "law", "presence"


@pytest.fixture
def panels():
    axes = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, verdict()).axes
    return dict(zip(PANELS, axes, strict=False))


def test_the_series_is_measured_minus_simulated_and_the_certified_block_is_shaded(panels):
    ax = panels["series"]
    drawn = {line.get_label(): line for line in ax.lines}
    for name, simulated in (("nominal", NOMINAL), ("extended", EXTENDED)):
        np.testing.assert_array_equal(drawn[name].get_xdata(), TIME)
        np.testing.assert_array_equal(drawn[name].get_ydata(), MEASURED - simulated)
    block = ax.patches[0].get_extents().transformed(ax.transData.inverted())
    assert (block.x0, block.x1) == pytest.approx((12, 19))


def test_of_joint_records_each_certified_run_is_shaded_by_itself_and_the_worst_is_drawn():
    role = ("time", np.isin(TIME, [3, 4, 5, 13, 14]) * 2 + 1)
    measured = ("time", np.where(TIME == 13, 9.0, MEASURED), {"units": "mm"})
    joint = CERTIFICATE.assign(role=role, measured=measured).assign_attrs(records=2)
    series, runs = discrepancy(LOCALISATION, CANDIDATES, joint, verdict()).axes[:2]
    to_data = series.transData.inverted()
    shaded = [each.get_extents().transformed(to_data) for each in series.patches]
    assert [each.x0 for each in shaded] == pytest.approx([3, 13])
    assert [each.x1 for each in shaded] == pytest.approx([5, 14])
    np.testing.assert_array_equal(runs.lines[0].get_xdata(), [13, 14])
    assert runs.get_xlabel() == "time, records in a row (s)"


def test_residuals_are_shown_along_the_quantity_that_the_verdict_names(panels):
    ax = panels["where"]
    assert ax.get_xlabel() == "input (V)"
    steps = {patch.get_label(): patch.get_data() for patch in ax.patches}
    for when in ("before", "after"):
        np.testing.assert_array_equal(steps[when].values, LOCALISATION[f"input_rms_{when}"])
        np.testing.assert_array_equal(steps[when].edges, [0, 1, 2, 3])
    dotted = [p.get_data().values for p in ax.patches if p.get_linestyle() == ":"]
    expected = [LOCALISATION[f"input_null_{when}"] for when in ("before", "after")]
    np.testing.assert_array_equal(dotted, expected)


@pytest.mark.parametrize(
    ("along", "label", "title"),
    [
        ("input", "input (V)", ""),
        (None, "output (mm)", "no dependence found; along the output"),
    ],
)
def test_a_residual_that_depends_on_nothing_is_said_to(along, label, title):
    said = verdict() | {"where": {"along": along}}
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[2]
    assert (ax.get_xlabel(), ax.get_title(loc="right")) == (label, title)


def test_the_directions_of_the_motion_are_called_by_their_names():
    names = {
        name: name.replace("input", "direction")
        for name in LOCALISATION.variables
        if str(name).startswith("input")
    }
    moving = LOCALISATION.rename(names)
    said = verdict() | {"where": {"along": "direction"}}
    ax = discrepancy(moving, CANDIDATES, CERTIFICATE, said).axes[2]
    assert [text.get_text() for text in ax.get_xticklabels()] == ["falling", "still", "rising"]
    assert ax.get_xlabel() == "while the simulated output is"


def test_a_bin_without_samples_is_left_open():
    bare = LOCALISATION.copy(deep=True)
    for what in ("rms", "null"):
        bare[f"input_{what}_before"].values[1] = 0.0
    ax = discrepancy(bare, CANDIDATES, CERTIFICATE, verdict()).axes[2]
    steps = {patch.get_label(): patch.get_data().values for patch in ax.patches}
    np.testing.assert_array_equal(steps["before"], [3.0, np.nan, 5.0])
    np.testing.assert_array_equal(steps["after"], [1.0, 2.0, 1.5])


@pytest.mark.parametrize("known", [(), ("before",), ("after",), ("before", "after")])
def test_the_legend_names_chance_where_it_is_drawn(known):
    bare = LOCALISATION.copy(deep=True)
    for when in {"before", "after"}.difference(known):
        bare[f"input_null_{when}"].values[:] = np.nan
    ax = discrepancy(bare, CANDIDATES, CERTIFICATE, verdict()).axes[2]
    listed = [text.get_text() for text in ax.get_legend().get_texts()]
    assert listed == ["before", "after", *(["chance 95 %"] if known else [])]


def test_the_ladder_goes_from_the_nominal_error_down_to_the_noise_floor(panels):
    ax = panels["ladder"]
    points, *levels = ax.lines
    np.testing.assert_array_equal(points.get_xydata(), [[0.5, 0], [0.1, 1]])
    assert not ax.patches  # a bar has no beginning on a logarithmic axis
    from_floor = [segment[:, 0].tolist() for segment in ax.collections[0].get_segments()]
    assert from_floor == [[0.05, 0.5], [0.05, 0.1]]
    assert [text.get_text() for text in ax.get_yticklabels()] == ["nominal", "dead zone"]
    assert [line.get_xdata() for line in levels] == [[0.05, 0.05], [0.07, 0.07]]
    assert ax.get_xlim()[0] < 0.05 < 0.5 < ax.get_xlim()[1]
    assert ax.get_xlabel() == "held-out RMSE (mm)"
    assert ax.get_ylim()[0] > ax.get_ylim()[1]


@pytest.mark.parametrize(
    ("level", "label"),
    [({}, "with model error"), ({"coloured_level": 0.05}, "with coloured noise")],
)
def test_the_ladder_says_what_is_left_beyond_the_noise_floor(level, label):
    axes = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, verdict() | level).axes
    texts = axes[PANELS.index("ladder")].get_legend().get_texts()
    assert [text.get_text() for text in texts] == ["noise floor", label]


def test_the_runs_are_those_over_the_certified_block(panels):
    drawn = {line.get_label(): line for line in panels["runs"].lines}
    for name, values in (("measured", MEASURED), ("nominal", NOMINAL), ("extended", EXTENDED)):
        np.testing.assert_array_equal(drawn[name].get_xdata(), TIME[12:])
        np.testing.assert_array_equal(drawn[name].get_ydata(), values[12:])
    assert panels["runs"].get_ylabel() == "output (mm)"
    assert drawn["measured"].get_color() == style.MEASURED


def test_of_a_long_block_the_runs_are_those_where_it_disagrees_most():
    time = np.arange(5000.0)
    nominal = np.zeros(time.size)
    nominal[[600, 4200]] = 2.0, 1.0  # the first is not certified
    long = xr.Dataset(
        {
            "measured": ("time", np.zeros(time.size), {"units": "mm"}),
            "nominal": ("time", nominal),
            "extended": ("time", nominal),
            "role": ("time", np.where(time < 1000, 1, 3)),
        },
        coords={"time": time},
    )
    figure = discrepancy(LOCALISATION, CANDIDATES, long, verdict())
    drawn = figure.axes[1].lines[0].get_xdata()
    assert (drawn[0], drawn[-1], drawn.size) == (3700, 4699, 1000)


def test_the_law_is_drawn_over_the_record_beside_what_would_be_without_it(panels):
    ax = panels["law"]
    law, without = ax.lines
    along = np.sort(np.cos(TIME))
    np.testing.assert_array_equal(law.get_xdata(), along)
    np.testing.assert_array_equal(law.get_ydata(), along**3)
    np.testing.assert_array_equal(without.get_ydata(), along)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("input (V)", "input that acts (V)")
    assert ax.get_title("right").splitlines() == [
        "dead zone", "width = 0.4 ± 0.15 V", "slope = 0.1 ± 0.15",
    ]  # fmt: skip


def test_the_parameters_that_the_verdict_quotes_are_told_in_its_words():
    said = verdict()
    [effect] = said["effects"]
    more = {
        "ratio": {"value": 1.0, "low": 0.9, "high": 1.1, "unit": "1", "at_bound": True},
        "exponent": {"value": 0.6, "low": 0.5, "high": 1.7, "unit": "1", "at_bound": False},
    }
    effect["parameters"] |= more
    effect["parameters"]["width"]["unit"] = "mm/s^2"
    effect["quoted"] = ["exponent", "ratio", "width", "slope"]
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[4]
    assert ax.get_title("right").splitlines()[1:] == [
        "exponent = 0.5 to 1.7", "ratio = 1 at its bound", "width = 0.4 ± 0.15 mm/s²",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("units", "output", "shown", "factor"),
    [
        ("m", "mm", "mm", 1e3),
        ("m/s", "mm", "mm/s", 1e3),
        ("m", "V", "m", 1.0),
        ("V", "mm", "V", 1.0),
    ],
)
def test_lengths_of_a_law_are_in_the_unit_of_the_output(units, output, shown, factor):
    along = CERTIFICATE["law_1_along"].assign_attrs(units=units)
    said = verdict() | {"unit": output}
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE.assign(law_1_along=along), said).axes[4]
    assert ax.get_xlabel() == f"input ({shown})"
    np.testing.assert_allclose(ax.lines[0].get_xdata(), factor * np.sort(np.cos(TIME)))


@pytest.mark.parametrize(
    ("size", "units", "label", "tick"),
    [
        (2e6, "N/kg", "force ($10^{6}$ N/kg)", "−2"),
        (2e-6, "N", "force ($10^{-6}$ N)", "−2"),
        (2e6, "1", "force ($10^{6}$)", "−2"),
        (2e3, "N", "force (N)", "−2000"),
    ],
)
def test_a_power_of_ten_of_a_force_stands_in_its_label(size, units, label, tick):
    pushed = {
        f"law_1_{part}": size * CERTIFICATE[f"law_1_{part}"] for part in PARTS if part != "along"
    }
    pushed["law_1_value"] = pushed["law_1_value"].assign_attrs(units=units, long_name="force")
    figure = drawn_at_its_size(
        discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE.assign(pushed), verdict())
    )
    ax = figure.axes[4]
    assert ax.get_ylabel() == label
    assert ax.yaxis.get_offset_text().get_text() == ""
    assert tick in [text.get_text() for text in ax.get_yticklabels()]


def test_the_band_of_a_law_is_drawn_at_the_samples_of_the_record_alone(panels):
    band, rug = panels["law"].collections
    along = np.sort(np.cos(TIME))
    ends = np.array([[a, b] for a, b in zip(along**3 - 0.1, along**3 + 0.2, strict=True)])
    np.testing.assert_allclose([line[:, 1] for line in band.get_segments()], ends)
    for lines in (band, rug):
        np.testing.assert_array_equal([line[0, 0] for line in lines.get_segments()], along)
    legend = [text.get_text() for text in panels["law"].get_legend().get_texts()]
    assert legend == ["95 % band", "law", "without it"]


@pytest.mark.parametrize("far", [2.5, 100.0])
def test_a_band_that_would_flatten_the_law_is_cut(far):
    """The law and what would be without it reach from -1 to 1."""
    wide = CERTIFICATE.assign(law_1_high=CERTIFICATE["law_1_value"] + far)
    ax = discrepancy(LOCALISATION, CANDIDATES, wide, verdict()).axes[4]
    told = [text.get_text() for text in ax.texts]
    if far < 3.0:
        assert ax.get_ylim()[1] > 3.4
        assert not any("cut" in text for text in told)
    else:
        assert ax.get_ylim() == pytest.approx((float(wide["law_1_low"].min()), 3.0), abs=0.05)
        assert "cut; reaches \N{MINUS SIGN}1.1 to 1e+02" in told


def test_a_drift_is_told_by_its_ends_above_its_course():
    said = verdict()
    drift = {"name": "factor on gain", "unit": "1", "start": 1.0, "end": 0.8037}
    said["effects"][0]["change"] = drift
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[4]
    assert ax.get_title("right").splitlines()[1:] == ["factor on gain 1 to 0.804"]


def test_a_creep_is_drawn_over_the_time_after_a_step_and_told_by_what_it_amounts_to():
    said = verdict()
    amount = {"value": 20.0, "unit": "Pa", "low": 18.0, "high": 22.0, "prior": 1.0}
    amount |= {"origin": 0.0, "at_bound": False, "moved": 0.0}
    said["effects"][0]["quantities"] = {"relaxing_stiffness": amount}
    after = np.geomspace(0.5, 60.0, TIME.size)
    named = {"long_name": "time after a step", "units": "s"}
    relaxing = CERTIFICATE.assign(law_1_along=("time", after, named))
    figure = discrepancy(LOCALISATION, CANDIDATES, relaxing, said)
    ax = figure.axes[4]
    assert (ax.get_xscale(), ax.get_xlabel()) == ("log", "time after a step (s)")
    assert ax.get_xlim() == pytest.approx((0.5, 60.0))
    figure.draw_without_rendering()
    labelled = [text.get_text() for text in ax.get_xticklabels()]
    assert {"1", "10"} <= set(labelled)
    [law] = [line for line in ax.lines if line.get_label() == "law"]
    np.testing.assert_allclose(law.get_xdata(), after)
    assert ax.get_title("right").splitlines()[1:] == ["relaxing stiffness = 20 ± 2 Pa"]


def test_a_curve_is_told_by_its_bend_above_it():
    said = verdict()
    said["effects"][0]["bend"] = {
        "name": "reading", "unit": "mm", "largest": -0.3187, "along": "output",
        "unit_along": "mm", "at": 1.2, "slope": 0.9,
    }  # fmt: skip
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[4]
    assert ax.get_title("right").splitlines()[1:] == ["bent by up to -0.319 mm"]
    said["effects"][0]["bend"]["slope"] = -0.9
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[4]
    assert ax.get_title("right").splitlines()[1:] == ["opposite sign, bent by up to -0.319 mm"]


def test_a_law_is_not_drawn_at_samples_that_are_not_used():
    role = CERTIFICATE["role"].where(TIME >= 3, 0)
    start = CERTIFICATE.assign(
        role=role, law_1_value=CERTIFICATE["law_1_value"].where(TIME >= 3, 99)
    )
    ax = discrepancy(LOCALISATION, CANDIDATES, start, verdict()).axes[4]
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), np.sort(np.cos(TIME[3:])))
    assert ax.get_ylim()[1] < 2.0


def test_a_law_over_time_needs_no_marks_of_its_samples():
    over_time = CERTIFICATE["law_1_along"].assign_attrs(long_name="time", units="s")
    changed = CERTIFICATE.assign(law_1_along=over_time)
    figure = discrepancy(LOCALISATION, CANDIDATES, changed, verdict())
    ax = dict(zip(PANELS, figure.axes, strict=False))["law"]
    assert ax.get_xlabel() == "time (s)"
    assert len(ax.collections) == 1


def test_each_of_two_laws_has_axes_of_its_own():
    said = verdict()
    said["effects"] *= 2
    second = {f"law_2_{part}": CERTIFICATE[f"law_1_{part}"] for part in PARTS}
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE.assign(second), said)
    assert [ax.get_xlabel() for ax in figure.axes].count(
        "input (V)"
    ) == 3  # and where it is missing


@style.styled
def drawn_at_its_size(figure):
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    return figure


def test_the_texts_of_two_laws_stay_on_the_page_and_apart():
    said = verdict()
    label = "+ rate_independent_hysteresis@shoulder_motor>elbow_position"
    said["ladder"] = [*said["ladder"][:2], [label, 0.08], said["ladder"][2]]
    second = said["effects"][0] | {"name": "rate_independent_hysteresis", "place": "shoulder_motor"}
    said["effects"] = [*said["effects"], second]
    certificate = CERTIFICATE.assign(
        {f"law_2_{part}": CERTIFICATE[f"law_1_{part}"] for part in PARTS}
    )
    figure = drawn_at_its_size(discrepancy(LOCALISATION, CANDIDATES, certificate, said))
    first, other = figure.axes[4]._left_title, figure.axes[5]._right_title
    assert first.get_text().startswith("dead zone\n")
    assert other.get_text().startswith("rate independent hysteresis\n")
    boxes = [text.get_window_extent() for text in (first, other)]
    assert figure.bbox.x0 <= boxes[0].x0 < boxes[0].x1 < boxes[1].x0


@pytest.mark.parametrize("drawn", [1, 2])
def test_a_law_that_has_a_course_is_drawn_beside_one_that_has_none(drawn):
    said = verdict()
    second = said["effects"][0] | {"name": "coulomb_friction"}
    said["effects"] = [*said["effects"], second]
    course = {f"law_{drawn}_{part}": CERTIFICATE[f"law_1_{part}"] for part in PARTS}
    bare = CERTIFICATE.drop_vars([name for name in CERTIFICATE if name.startswith("law_")])
    figure = drawn_at_its_size(discrepancy(LOCALISATION, CANDIDATES, bare.assign(course), said))
    axes = figure.axes[4:6]
    shown, empty = axes if drawn == 1 else axes[::-1]
    np.testing.assert_array_equal(shown.lines[0].get_ydata(), np.sort(np.cos(TIME)) ** 3)
    assert not empty.lines
    assert any(text.get_text().startswith("not drawn") for text in empty.texts)
    assert not empty.axison
    assert axes[0].get_title("left").startswith("dead zone\nwidth = 0.4 ± 0.15 V")
    assert axes[1].get_title("right").startswith("coulomb friction\nwidth = 0.4 ± 0.15 V")
    assert axes[1].get_legend() is not None


def test_without_a_shape_each_parameter_has_its_interval_and_is_grey_where_it_may_be_zero():
    bare = CERTIFICATE.drop_vars([name for name in CERTIFICATE if name.startswith("law_")])
    figure = discrepancy(LOCALISATION, CANDIDATES, bare, verdict())
    ax = dict(zip(PANELS, figure.axes, strict=False))["law"]
    intervals = [line for line in ax.lines if len(line.get_xdata()) == 2][:2]
    np.testing.assert_allclose(intervals[0].get_xdata(), [-25, 50])
    np.testing.assert_allclose(intervals[1].get_xdata(), [-100, 100])
    assert [line.get_color() for line in intervals] == [style.VERMILION, style.GREY]
    texts = [text.get_text() for text in ax.get_yticklabels()]
    assert texts == ["width = 0.4 ± 0.15 V", "slope = 0.1 ± 0.15"]


def test_effects_stand_by_their_probability_and_the_named_one_stands_out(panels):
    ax = panels["presence"]
    assert [text.get_text() for text in ax.get_yticklabels()] == ["dead zone", "sensor lag"]
    assert [bar.get_width() for bar in ax.patches] == [0.97, 0.04]
    texts = [text.get_text() for text in ax.texts if text.get_text() != "F"]
    assert texts == ["0.97", "removes 72 %", "0.04", "alone 10 %"]
    first, second = (bar.get_facecolor() for bar in ax.patches)
    assert first == to_rgba(style.VERMILION) != second


def test_an_effect_at_a_port_or_input_has_the_share_of_its_best_place():
    names = ["end_stop@upper", "end_stop@lower", "dead_zone@left", "sensor_lag"]
    ported = CANDIDATES.isel(candidate=[0, 1, 0, 1]).assign_coords(candidate=names)
    ported["share"] = "candidate", [np.nan, 0.3, 0.2, np.nan]
    said = verdict("unknown")
    said["presence"] = {"effects": {"end_stop": 0.5, "dead_zone@left": 0.4, "sensor_lag": 0.1}}
    ax = discrepancy(LOCALISATION, ported, CERTIFICATE, said).axes[5]
    texts = [text.get_text() for text in ax.texts if text.get_text() != "F"]
    assert texts == ["0.50", "alone 30 %", "0.40", "alone 20 %", "0.10", "not fitted alone"]


def test_an_effect_that_acts_at_two_places_has_the_sum_of_its_shares():
    said = verdict()
    first = said["effects"][0] | {"place": "upper", "share": 0.6}
    said["effects"] = [first, first | {"place": "lower", "share": 0.1}]
    certificate = CERTIFICATE.assign(
        {f"law_2_{part}": CERTIFICATE[f"law_1_{part}"] for part in PARTS}
    )
    ax = discrepancy(LOCALISATION, CANDIDATES, certificate, said).axes[-1]
    assert "removes 70 %" in [text.get_text() for text in ax.texts]


def test_effects_that_were_only_fitted_together_have_no_shares_of_their_own():
    said = verdict()
    said["effects"][0]["share"] = None
    ax = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said).axes[5]
    texts = [text.get_text() for text in ax.texts if text.get_text() != "F"]
    assert texts == ["0.97", "0.04", "alone 10 %"]


def test_the_title_says_where_something_else_is_missing():
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, verdict() | {"whole": False})
    assert figure.get_suptitle() == "certain part of the answer: dead zone"


def test_the_title_says_where_a_law_is_too_poor():
    poor = verdict() | {"law_too_poor": True, "share": {"value": 0.7, "low": 0.6, "high": 0.8}}
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, poor)
    removed = "dead zone, which removes 70 % (60 to 80 %) of the gap"
    assert figure.get_suptitle() == f"probably: {removed}; its law is too poor"


@pytest.mark.parametrize(
    ("value", "low", "high", "part"),
    [(0.724, 0.63, 0.79, "72 % (63 to 79 %)"), (0.9999, 0.9998, 1.0, "over 99 %")],
)
def test_the_title_says_what_the_named_effect_removes(value, low, high, part):
    said = verdict() | {"share": {"value": value, "low": low, "high": high}}
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said)
    assert figure.get_suptitle() == f"named: dead zone, which removes {part} of the gap"


def test_the_title_does_not_say_that_an_effect_removes_less_than_nothing():
    said = verdict() | {"share": {"value": -0.05, "low": -0.3, "high": 0.1}}
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, said)
    assert figure.get_suptitle() == "named: dead zone"


def test_without_a_name_the_gains_of_the_candidates_are_shown_best_first():
    figure = discrepancy(LOCALISATION, CANDIDATES, CERTIFICATE, verdict("unknown"))
    assert [line.get_label() for line in figure.axes[0].lines] == ["nominal"]
    ax = figure.axes[4]
    marks, _, [interval] = ax.containers[0]
    np.testing.assert_array_equal(marks.get_xdata(), [0.9, 0.1])
    ends = [segment[:, 0] for segment in interval.get_segments()]
    np.testing.assert_allclose(ends, [[0.7, 1.0], [0.0, 0.3]])
    assert [text.get_text() for text in ax.get_yticklabels()] == ["sensor lag", "dead zone"]
    assert figure.get_suptitle() == "unknown"


def test_gains_that_are_not_held_out_are_not_shown():
    screened = CANDIDATES.assign(finished=("candidate", [1.0, 0.0]))
    ax = discrepancy(LOCALISATION, screened, CERTIFICATE, verdict("unknown")).axes[4]
    assert [text.get_text() for text in ax.get_yticklabels()] == ["dead zone"]
