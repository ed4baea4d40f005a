"""Hidden curves: each obeys the law that it is named after, tested without its formula."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, bend, built, slope, through

LOW, HIGH = CONDITIONS.low, CONDITIONS.high
SPAN, TRAVEL = CONDITIONS.span, CONDITIONS.travel
U = np.linspace(0.0, HIGH, 4001)
Y = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 4001)


@pytest.mark.parametrize(
    "form",
    [
        "rounded_threshold",
        "overlapped_valve",
        "yield_stress",
        "jumping_threshold",
        "cracking_valve",
        "glow_lamp",
        "diode_drop",
        "square_law_foot",
    ],
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


def test_the_flow_above_a_yield_stress_is_a_power():
    law, defining = built("dead_zone", "yield_stress", 0.3)
    passed = through(law, U)
    assert (passed[defining["threshold"] - 1e-3 > U] == 0.0).all()
    over = U - defining["threshold"]
    inside = over > 0.05
    logarithms = np.log(over[inside]), np.log(passed[inside])
    assert 1.15 <= np.polyfit(*logarithms, 1)[0] <= 1.6
    assert bend(logarithms[0], logarithms[1]) < 1e-3


def test_the_threshold_jumps_to_a_line():
    law, defining = built("dead_zone", "jumping_threshold", 0.3)
    passed = through(law, U)
    below, above = defining["threshold"] - 2e-3 > U, defining["threshold"] + 2e-3 < U
    assert (passed[below] == 0.0).all()
    assert 0.3 < passed[above][0] / defining["threshold"] < 0.81
    np.testing.assert_allclose(np.diff(passed[above], 2), 0.0, atol=1e-9)


def test_the_diode_and_its_load_share_the_voltage():
    passed = through(built("dead_zone", "diode_drop", 0.3)[0], U)
    # u = v + n ln(1 + v/s) has du/dv - 1 = n/(v + s), whose inverse is a straight line in v.
    inside = (U > 0.5 * HIGH) & (U < 0.99 * HIGH)
    v, resistance = passed[inside], 1.0 / slope(passed, U)[inside]
    scale = max(np.linspace(0.8, 3.0, 221), key=lambda s: -bend(v, 1.0 / (s * resistance - 1.0)))
    assert bend(v, 1.0 / (scale * resistance - 1.0)) < 0.01


def test_the_square_law_has_a_parabola_between_nothing_and_a_line():
    law, defining = built("dead_zone", "square_law_foot", 0.3)
    passed = through(law, U)
    second = np.diff(passed, 2) / (U[1] - U[0]) ** 2
    place = U[1:-1]
    threshold = defining["threshold"]
    assert (np.abs(passed[threshold - 0.01 > U]) < 1e-12).all()
    curved = second > 0.5 * second[(place > threshold + 0.05) & (place < threshold + 0.1)].mean()
    assert place[curved].min() == pytest.approx(threshold, abs=0.01)
    np.testing.assert_allclose(second[place > place[curved].max() + 0.01], 0.0, atol=1e-6)


@pytest.mark.parametrize(
    "form",
    ["parabolic_shoulder", "residual_gain", "stored_charge", "error_integral", "falling_tube"],
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
    second = np.diff(passed, 2) / (U[1] - U[0]) ** 2
    shoulder = np.flatnonzero(second < -1e-3)
    np.testing.assert_allclose(second[shoulder[3:-3]], second[shoulder[3:-3]].mean(), rtol=0.05)


def test_the_residual_gain_is_kept_beyond_the_limit():
    law, defining = built("input_saturation", "residual_gain", 0.3)
    gain = slope(through(law, U), U)
    beyond = gain[defining["limit"] + 0.01 < U]
    np.testing.assert_allclose(beyond, beyond[-1], rtol=1e-6)
    assert 0.02 <= beyond[-1] <= 0.12


def test_the_solid_state_amplifier_bends_as_rapp_s_model():
    law, defining = built("input_saturation", "solid_state_amplifier", 0.3)
    passed, limit = through(law, U), defining["limit"]
    assert limit == pytest.approx(HIGH - 0.3 * SPAN)
    # 1/v^2p is the sum of 1/u^2p and 1/limit^2p, so that the two meet at 2^(-1/2p) of the limit.
    order = -np.log(2.0) / np.log(np.interp(limit, U, passed) / limit)
    assert 4.0 <= order <= 12.0
    inside = U > 0.5
    np.testing.assert_allclose(
        passed[inside] ** -order, U[inside] ** -order + limit**-order, rtol=1e-3
    )


def test_the_rail_sags_to_its_limit_and_recovers():
    law = built("input_saturation", "sagging_rail", 0.3)[0]
    limit = HIGH - 0.3 * SPAN
    passed = through(law, np.repeat([1.0, HIGH, 1.0, HIGH], [10, 40_000, 40_000, 40_000]))
    assert passed[39_990] == pytest.approx(limit, rel=1e-3)
    assert passed[10] > 1.05 * limit
    assert passed[80_010] == pytest.approx(passed[10], rel=1e-3)
    left = passed[10:8000] - limit
    assert (np.diff(left) <= 0.0).all()
    rate = np.diff(np.log(left[:2000:100]))
    np.testing.assert_allclose(rate, rate[0], rtol=1e-6)
    np.testing.assert_array_equal(passed[40_010:80_010], 1.0)


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


@pytest.mark.parametrize("size", [0.02, 0.2, 0.45])
@pytest.mark.parametrize("seed", range(3))
def test_the_tube_falls_within_the_commands_from_a_crest_at_its_limit(size, seed):
    commands = np.linspace(LOW, HIGH, 20_001)
    passed = through(built("input_saturation", "falling_tube", size, seed)[0], commands)
    limit = HIGH - size * SPAN
    assert passed.max() == pytest.approx(limit, abs=1e-3 * SPAN)
    assert 0.0 < (limit - passed[-1]) / (size * SPAN) < 0.1
    assert passed[0] == LOW


@pytest.mark.parametrize(
    "form",
    [
        "hyperbolic_rail",
        "leaking_rail",
        "overloaded_converter",
        "overload_recovery",
        "blocking_grid",
        "exponential_rail",
        "arctangent_rail",
    ],
)
@pytest.mark.parametrize("seed", range(3))
def test_a_reading_ends_near_its_limit(form, seed):
    law, defining = built("output_saturation", form, 0.4, seed)
    read = through(law, Y)
    limit = CONDITIONS.top - 0.4 * TRAVEL
    assert defining["limit"] == pytest.approx(limit)
    assert read[-1] == pytest.approx(limit, abs=0.03 * TRAVEL)
    true = (limit - 0.15 * TRAVEL > Y) & (CONDITIONS.bottom + 0.1 * TRAVEL < Y)
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


def test_the_converter_clips_at_both_ends():
    read = through(built("output_saturation", "overloaded_converter", 0.4, 1)[0], Y)
    inside = (read > read.min() + 0.02) & (read < read.max() - 0.02)
    np.testing.assert_allclose(read[inside], Y[inside], atol=1e-9)
    assert read.max() == pytest.approx(CONDITIONS.top - 0.4 * TRAVEL)
    assert 0.005 * TRAVEL < read.min() - CONDITIONS.bottom < 0.08 * TRAVEL


def test_the_paralysed_counter_loses_exponentially_more():
    read = through(built("output_saturation", "paralysed_counter", 0.4)[0], Y)
    knee = CONDITIONS.top - 0.4 * TRAVEL
    np.testing.assert_allclose(read[knee > Y], Y[knee > Y], atol=1e-6)
    over = Y - knee > 0.01
    share = np.log((read[over] - knee) / (Y[over] - knee))
    assert bend(Y[over], share) < 1e-3
    # Not folded: the crest is hardly above the reading at the top.
    assert 0.92 * (read.max() - knee) < read[-1] - knee <= read.max() - knee


def test_an_overload_is_worked_off_before_the_reading_returns():
    law, defining = built("output_saturation", "overload_recovery", 0.4)
    limit = defining["limit"]
    late = {}
    for over in (0.01, 0.02, 3.0):
        law = built("output_saturation", "overload_recovery", 0.4)[0]
        path = np.repeat([limit - 1.0, limit + over, limit - 1.0], [10, 1000, 2000])
        read = through(law, path)
        np.testing.assert_array_equal(read[:10], path[:10])
        np.testing.assert_array_equal(read[10:1010], limit)
        late[over] = np.count_nonzero(read[1010:] == limit)
    assert late[0.02] == pytest.approx(2 * late[0.01], abs=2)
    assert 20 < late[3.0] < 130
