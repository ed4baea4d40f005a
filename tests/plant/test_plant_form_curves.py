"""Hidden curves: each obeys the law that it is named after, tested without its formula."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, through

LOW, HIGH = CONDITIONS.low, CONDITIONS.high
SPAN, TRAVEL = CONDITIONS.span, CONDITIONS.travel
U = np.linspace(0.0, HIGH, 4001)
Y = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 4001)


def slope(values, grid):
    return np.gradient(values, grid)


@pytest.mark.parametrize(
    "form", ["rounded_threshold", "overlapped_valve", "diode_drop", "square_law_foot"]
)
@pytest.mark.parametrize("seed", range(3))
def test_a_dead_zone_passes_little_below_and_everything_at_the_top(form, seed):
    law, defining = built("dead_zone", form, 0.3, seed)
    passed = through(law, U)
    threshold = LOW + 0.3 * SPAN
    assert defining.get("threshold", threshold) == pytest.approx(threshold)
    assert passed[-1] == pytest.approx(HIGH, rel=1e-3)
    assert (np.diff(passed) >= -1e-9).all()
    assert passed[0.6 * threshold > U].max() < 0.1 * HIGH
    assert slope(passed, U)[threshold + 0.5 * (HIGH - threshold) < U].min() > 1.0


def test_the_rounded_threshold_has_half_its_slope_there_and_a_logistic_slope_around():
    law, defining = built("dead_zone", "rounded_threshold", 0.3)
    fine = np.linspace(0.0, 2.0 * HIGH, 8001)
    passed = through(law, fine)
    gain = slope(passed, fine)
    share = gain / gain[-2]
    inside = (share > 0.05) & (share < 0.95)
    logit = np.log(share[inside] / (1.0 - share[inside]))
    line = np.polyfit(fine[inside], logit, 1)
    assert -line[1] / line[0] == pytest.approx(defining["threshold"], rel=1e-3)
    np.testing.assert_allclose(logit, np.polyval(line, fine[inside]), atol=0.05)


def test_the_overlapped_valve_has_two_slopes():
    law, defining = built("dead_zone", "overlapped_valve", 0.3)
    gain = slope(through(law, U), U)
    away = np.abs(U - defining["threshold"]) > 0.01
    assert np.unique(np.round(gain[away], 6)).size == 2
    assert 0.0 < gain[5] < 0.1


def test_the_diode_and_its_load_share_the_voltage():
    passed = through(built("dead_zone", "diode_drop", 0.3)[0], U)
    # u = v + n ln(1 + v/s) has du/dv - 1 = n/(v + s), whose inverse is a straight line in v.
    inside = (U > 0.5 * HIGH) & (U < 0.99 * HIGH)
    v, resistance = passed[inside], 1.0 / slope(passed, U)[inside]
    scale = max(np.linspace(0.8, 3.0, 221), key=lambda s: -_bend(v, 1.0 / (s * resistance - 1.0)))
    assert _bend(v, 1.0 / (scale * resistance - 1.0)) < 0.01


def _bend(x, y):
    if not np.isfinite(y).all() or (y < 0).any():
        return np.inf
    return np.abs(y - np.polyval(np.polyfit(x, y, 1), x)).max() / np.ptp(y)


def test_the_square_law_has_a_parabola_between_nothing_and_a_line():
    law, defining = built("dead_zone", "square_law_foot", 0.3)
    passed = through(law, U)
    bend = np.diff(passed, 2) / (U[1] - U[0]) ** 2
    place = U[1:-1]
    threshold = defining["threshold"]
    assert (np.abs(passed[threshold - 0.01 > U]) < 1e-12).all()
    curved = bend > 0.5 * bend[(place > threshold + 0.05) & (place < threshold + 0.1)].mean()
    assert place[curved].min() == pytest.approx(threshold, abs=0.01)
    np.testing.assert_allclose(bend[place > place[curved].max() + 0.01], 0.0, atol=1e-6)


@pytest.mark.parametrize(
    "form", ["parabolic_shoulder", "residual_gain", "error_integral", "falling_tube"]
)
@pytest.mark.parametrize("seed", range(3))
def test_a_saturation_is_transparent_below_and_flat_at_the_top(form, seed):
    passed = through(built("input_saturation", form, 0.3, seed)[0], U)
    low = U < 0.3 * HIGH
    np.testing.assert_allclose(passed[low], U[low], atol=1e-6)
    assert passed[-1] < 0.9 * HIGH
    assert np.abs(slope(passed, U)[-20:]).max() < 0.3


def test_the_shoulder_is_a_parabola_tangent_to_line_and_limit():
    law, defining = built("input_saturation", "parabolic_shoulder", 0.3)
    passed = through(law, U)
    assert passed[-1] == pytest.approx(defining["limit"], rel=1e-6)
    bend = np.diff(passed, 2) / (U[1] - U[0]) ** 2
    shoulder = np.flatnonzero(bend < -1e-3)
    np.testing.assert_allclose(bend[shoulder[3:-3]], bend[shoulder[3:-3]].mean(), rtol=0.05)


def test_the_residual_gain_is_kept_beyond_the_limit():
    law, defining = built("input_saturation", "residual_gain", 0.3)
    gain = slope(through(law, U), U)
    beyond = gain[defining["limit"] + 0.01 < U]
    np.testing.assert_allclose(beyond, beyond[-1], rtol=1e-6)
    assert 0.02 <= beyond[-1] <= 0.12


def test_the_error_integral_has_a_gaussian_slope():
    law, defining = built("input_saturation", "error_integral", 0.3)
    wide = np.linspace(0.0, 2.0 * HIGH, 8001)
    passed = through(law, wide)
    assert passed[-1] == pytest.approx(defining["limit"], rel=1e-4)
    gain = slope(passed, wide)
    inside = (gain < 0.9) & (gain > 0.05)
    # The logarithm of a Gaussian is a parabola.
    parabola = np.polyfit(wide[inside], np.log(gain[inside]), 2)
    np.testing.assert_allclose(np.log(gain[inside]), np.polyval(parabola, wide[inside]), atol=0.05)


def test_the_tube_falls_beyond_its_crest():
    wide = np.linspace(0.0, 2.0 * HIGH, 8001)
    passed = through(built("input_saturation", "falling_tube", 0.3)[0], wide)
    crest = int(np.argmax(passed))
    assert 0.7 * HIGH < wide[crest] < 1.5 * HIGH
    assert passed[-1] < passed[crest]


@pytest.mark.parametrize(
    "form", ["hyperbolic_rail", "leaking_rail", "exponential_rail", "arctangent_rail"]
)
@pytest.mark.parametrize("seed", range(3))
def test_a_reading_ends_near_its_limit(form, seed):
    law, defining = built("output_saturation", form, 0.4, seed)
    read = through(law, Y)
    limit = CONDITIONS.top - 0.4 * TRAVEL
    assert defining["limit"] == pytest.approx(limit)
    assert read[-1] == pytest.approx(limit, abs=0.03 * TRAVEL)
    true = limit - 0.15 * TRAVEL > Y
    np.testing.assert_allclose(read[true], Y[true], atol=1e-6)
    assert (np.diff(read) >= -1e-12).all()


@pytest.mark.parametrize(
    ("form", "straight"),
    [
        # What is a straight line in the place for each way to approach a limit.
        ("hyperbolic_rail", lambda left, gain: 1.0 / left),
        ("exponential_rail", lambda left, gain: np.log(left)),
        ("arctangent_rail", lambda left, gain: np.sqrt(1.0 / gain - 1.0)),
    ],
)
def test_a_rail_is_approached_as_its_name_says(form, straight):
    law, defining = built("output_saturation", form, 0.4)
    fine = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 200_001)
    read = through(law, fine)
    left, gain = defining["limit"] - read, slope(read, fine)
    inside = (gain < 0.9) & (gain > 0.1)
    values = straight(left[inside], gain[inside])
    line = np.polyval(np.polyfit(fine[inside], values, 1), fine[inside])
    assert np.abs(values - line).max() < 0.06 * np.ptp(values)


CURVES = [
    "calibration_polynomial", "interpolation_error", "unbalanced_bridge", "lever_angle",
    "exponential_element",
]  # fmt: skip


@pytest.mark.parametrize("form", CURVES)
@pytest.mark.parametrize("seed", range(3))
def test_a_bent_sensor_errs_as_a_function_of_the_place_alone(form, seed):
    law = built("sensor_nonlinearity", form, 0.5, seed)[0]
    there, back = through(law, Y), through(law, Y[::-1])
    np.testing.assert_array_equal(there, back[::-1])
    line = np.polyval(np.polyfit(Y, there, 1), Y)
    assert np.abs(there - line).max() > 0.01 * TRAVEL


def test_the_calibration_error_is_a_cubic_without_offset_or_gain():
    error = through(built("sensor_nonlinearity", "calibration_polynomial", 0.5)[0], Y) - Y
    cubic = np.polyval(np.polyfit(Y, error, 3), Y)
    np.testing.assert_allclose(error, cubic, atol=1e-5 * TRAVEL)
    assert abs(np.polyfit(Y, error, 1)[0]) < 0.01
    assert abs(error.mean()) < 0.01 * np.abs(error).max()


def test_the_interpolation_error_repeats_within_the_scale():
    wide = np.linspace(CONDITIONS.bottom - TRAVEL, CONDITIONS.top + TRAVEL, 30_000)
    error = through(built("sensor_nonlinearity", "interpolation_error", 0.5)[0], wide) - wide
    lags = np.arange(1, 12_000)
    misfit = [np.abs(error[lag:] - error[:-lag]).max() for lag in lags]
    period = lags[int(np.argmin(misfit[3000:])) + 3000] * (wide[1] - wide[0])
    assert 0.4 * TRAVEL < period < 0.95 * TRAVEL
    assert min(misfit[3000:]) < 0.02 * np.ptp(error)


def test_the_bridge_is_a_hyperbola_through_both_ends():
    read = through(built("sensor_nonlinearity", "unbalanced_bridge", 0.5)[0], Y)
    assert read[[0, -1]] == pytest.approx([CONDITIONS.bottom, CONDITIONS.top], rel=1e-5)
    # Of y = (1 + b) x/(1 + b x), the quotient x/y is a straight line in x.
    x, y = (Y[10:] - Y[0]) / TRAVEL, (read[10:] - Y[0]) / TRAVEL
    line = np.polyval(np.polyfit(x, x / y, 1), x)
    np.testing.assert_allclose(x / y, line, atol=1e-4)


def test_the_lever_s_tangent_is_straight():
    read = through(built("sensor_nonlinearity", "lever_angle", 0.5)[0], Y)
    steep = 2.5 * 0.5
    tangent = np.tan(steep * (read - CONDITIONS.median) / (0.5 * TRAVEL))
    line = np.polyval(np.polyfit(Y, tangent, 1), Y)
    np.testing.assert_allclose(tangent, line, atol=1e-4)


def test_the_element_s_slope_is_exponential():
    read = through(built("sensor_nonlinearity", "exponential_element", 0.5)[0], Y)
    assert read[[0, -1]] == pytest.approx([CONDITIONS.bottom, CONDITIONS.top], rel=1e-5)
    logarithm = np.log(slope(read, Y))[2:-2]
    line = np.polyval(np.polyfit(Y[2:-2], logarithm, 1), Y[2:-2])
    np.testing.assert_allclose(logarithm, line, atol=2e-3)
