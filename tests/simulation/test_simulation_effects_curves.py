"""Curves of an input and of a reading: dead zones, limits, bends."""

from dataclasses import replace

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import T, U, Y
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

from dea.simulation import catalogue
from dea.simulation.effects.sensor_nonlinearity import MODES, curve_modes


def test_dead_zone_subtracts_its_threshold_and_lets_nothing_through_below():
    u = np.linspace(-4, 4, 801)
    q = values("dead_zone", threshold=1.5, corner_width=1e-6, negative_ratio=0.5)
    expected = np.where(u > 1.5, u - 1.5, np.where(u < -0.75, u + 0.75, 0.0))
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, q, DT), expected, atol=1e-5)
    steep = values("dead_zone", threshold=1.5, corner_width=1e-6, slope=2.0)
    expected = 2.0 * np.sign(u) * np.maximum(np.abs(u) - 1.5, 0.0)
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, steep, DT), expected, atol=1e-5)
    gated = values("dead_zone", threshold=1.5, gate=1.0, jump_width=1e-6)
    away = np.abs(np.abs(u) - 1.5) > 1e-3
    expected = np.where(np.abs(u) > 1.5, u, 0.0)
    assert np.allclose(catalogue()["dead_zone"].shape_input(u, gated, DT)[away], expected[away])


def test_a_gate_opens_over_its_width_as_a_logistic_curve():
    u = np.linspace(0.5, 2.5, 401)
    gated = values("dead_zone", threshold=1.5, gate=1.0, jump_width=0.2)
    passed = catalogue()["dead_zone"].shape_input(u, gated, DT) / u
    np.testing.assert_allclose(passed, 0.5 + 0.5 * np.tanh((u - 1.5) / 0.2), atol=1e-9)


def test_beyond_its_threshold_a_dead_zone_may_flow_as_a_power_or_bend():
    """Above a yield stress a flow is a power of the excess; a valve's pressure rises with it."""
    u = np.linspace(-4, 4, 801)
    law, peak = catalogue()["dead_zone"].shape_input, SCALES.u_peak
    excess = np.maximum(np.abs(u) - 1.5, 0.0) / peak
    power = values("dead_zone", threshold=1.5, corner_width=1e-6, exponent=1.7)
    assert np.allclose(law(u, power, DT), np.sign(u) * peak * excess**1.7, atol=1e-5)
    bent = values("dead_zone", threshold=1.5, corner_width=1e-6, bend=0.4)
    expected = np.sign(u) * peak * (excess + 0.4 * excess**2)
    assert np.allclose(law(u, bent, DT), expected, atol=1e-5)


@pytest.mark.parametrize(("low", "high"), [(1.1, 3.75), (0.0, 5.0), (-2.0, 4.0)])
def test_the_largest_input_passes_a_dead_zone_unchanged_wherever_its_fit_starts(low, high):
    effect, scales = catalogue()["dead_zone"], replace(SCALES, u_low=low, u_high=high)
    thresholds = [start[0] for start in effect.starts(scales)]
    assert (np.array(thresholds) > max(low, 0.0)).all()
    assert (np.array(thresholds) < high).all()
    for start in effect.starts(scales):
        passed = effect.shape_input(np.array([high]), np.array(start), DT)
        np.testing.assert_allclose(passed, high, rtol=1e-6)


@pytest.mark.parametrize("name", ["dead_zone", "input_saturation"])
def test_a_law_has_a_negative_side_of_its_own_where_the_input_goes_there(name):
    for low, free in ((1.1, False), (-1.1, True)):
        told = catalogue()[name].parameters(replace(SCALES, u_low=low))
        [ratio] = [each for each in told if each.name == "negative_ratio"]
        assert (ratio.nominal, ratio.spread > 0.0) == (1.0, free)


@pytest.mark.parametrize("effect", ["dead_zone", "input_saturation"])
def test_a_negative_input_has_the_starts_of_its_mirror_image(effect):
    positive = replace(SCALES, u_low=1.0, u_high=5.0)
    mirrored = replace(SCALES, u_low=-5.0, u_high=-1.0)
    resting = replace(SCALES, u_low=-0.9, u_high=0.0)
    starts = catalogue()[effect].starts
    assert starts(mirrored) == starts(positive)
    assert all(0.0 < start[0] < 0.9 for start in starts(resting))


@pytest.mark.parametrize("exponent", [0.4, 1.0, 3.0])
@pytest.mark.parametrize("bend", [-0.28, 5.0])
def test_a_dead_zone_never_falls(exponent, bend):
    """Otherwise it would be a sensor that folds."""
    [lowest] = [p.low for p in catalogue()["dead_zone"].parameters(SCALES) if p.name == "bend"]
    u = np.linspace(-1, 1, 2001) * SCALES.u_peak
    q = values("dead_zone", threshold=0.0, exponent=exponent, bend=max(bend, lowest))
    assert lowest == -0.28
    assert np.diff(catalogue()["dead_zone"].shape_input(u, q, DT)).min() >= 0.0


def test_sharp_saturations_clip_and_soft_ones_follow_their_formula():
    q = values("input_saturation", limit=2.5, sharpness=200.0)
    found = catalogue()["input_saturation"].shape_input(U, q, DT)
    assert np.allclose(found, np.clip(U, -2.5, 2.5), atol=0.01)
    q = values("input_saturation", limit=2.5, sharpness=3.0, remaining_slope=0.2)
    soft = U / (1 + (U / 2.5) ** 3) ** (1 / 3)
    found = catalogue()["input_saturation"].shape_input(U, q, DT)
    assert np.allclose(found, 0.8 * soft + 0.2 * U)
    q = values("output_saturation", upper_end=1.0, lower_end=0.5, sharpness=200.0, middle=0.8)
    law = catalogue()["output_saturation"].shape_output
    assert np.allclose(law(Y, T, q, DT), np.clip(Y, 0.5, 1.0), atol=2e-3)


@pytest.mark.parametrize(("slope", "limits"), [(0.1, True), (0.4, False)])
def test_a_bend_that_passes_most_of_what_comes_is_no_limit(slope, limits):
    u = np.linspace(0.0, SCALES.u_peak, 200)
    knee = 0.5 * SCALES.u_peak
    bent = np.where(u < knee, u, knee + slope * (u - knee))
    effect = catalogue()["input_saturation"]
    limit, sharpness, remaining = effect.parameters(SCALES)[:3]
    low, high = zip(*((p.low, p.high) for p in (limit, sharpness, remaining)), strict=True)
    fitted = least_squares(
        lambda q: effect.shape_input(u, np.array([*q, 1.0, 0.0]), DT) - bent,
        [knee, 30.0, 0.05], bounds=(low, high), x_scale=[knee, 30.0, 0.1],
    )  # fmt: skip
    left = np.sqrt(np.mean(fitted.fun**2)) / SCALES.u_peak
    assert bool(left < 0.003) is limits


def test_what_an_output_limit_takes_is_kept_in_part_at_either_end():
    own = {"upper_end": 1.0, "lower_end": 0.5, "middle": 0.8, "sharpness": 200.0}
    law = catalogue()["output_saturation"].shape_output
    y = np.array([0.1, 0.7, 0.9, 1.4])
    found = law(y, y, values("output_saturation", remaining_slope=0.25, **own), DT)
    assert np.allclose(found, [0.4, 0.7, 0.9, 1.1], atol=2e-3)
    soft = law(y, y, values("output_saturation", **own | {"sharpness": 1.0}), DT)
    # At sharpness 1 a distance d from the middle becomes d / (1 + d / limit).
    expected = [0.8 - 0.7 * 0.3 / 1.0, 0.8 - 0.1 * 0.3 / 0.4, 0.8 + 0.1 * 0.2 / 0.3, 0.8 + 0.15]
    assert np.allclose(soft, expected)


@pytest.mark.parametrize("unit", [1e-11, 1e13])
def test_a_limit_of_the_sensor_is_the_same_in_every_unit(unit):
    law = catalogue()["output_saturation"].shape_output
    y, t = np.linspace(0.0, 3.0, 50), np.arange(50.0)
    q = np.array([2.0, 0.5, 20.0, 0.1, 1.0])
    scaled = q * np.array([unit, unit, 1.0, 1.0, unit])
    np.testing.assert_allclose(law(unit * y, t, scaled, 1.0), unit * law(y, t, q, 1.0), rtol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_a_bent_reading_never_falls_while_the_output_rises(seed):
    """Whatever its modes; a curve that nowhere falls as fast as the output rises is as they say."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-2.0, 0.5)
    modes = {f"mode_{n}": size * m for n, m in enumerate(rng.standard_normal(11), 1)}
    q = values("sensor_nonlinearity", **modes, fold=SCALES.y_low - 10.0)
    y = np.linspace(SCALES.y_low, SCALES.y_high, 2001)
    read = catalogue()["sensor_nonlinearity"].shape_output(y, y, q, DT)
    assert np.diff(read).min() > 0.0
    # Uniform cubic B-splines over the range of the output.
    half, weights = 0.5 * (SCALES.y_high - SCALES.y_low), curve_modes()[0] @ q[:11]
    knots = SCALES.y_low + half * 2.0 / 9.0 * np.arange(-3, 13)
    bent = y + half * BSpline(knots, weights, 3)(np.minimum(y, y[-1] - 1e-12))
    steepest = np.diff(weights).min() * 9.0 / 2.0
    if steepest > -0.98:
        np.testing.assert_allclose(read, bent, atol=1e-9)
    else:
        assert np.abs(read - bent).max() > 1e-6


def test_sensor_nonlinearity_bends_and_folds():
    law = catalogue()["sensor_nonlinearity"].shape_output
    for place in (0.0, 0.7):
        q = values("sensor_nonlinearity", fold=place, corner_width=1e-9)
        signed = Y - 0.8 + place
        assert np.allclose(law(signed, T, q, DT), place + np.abs(signed - place))
    modes = np.random.default_rng(3).uniform(-0.05, 0.05, MODES)
    weights = curve_modes()[0] @ modes
    q = values("sensor_nonlinearity", **{f"mode_{n + 1}": m for n, m in enumerate(modes)})
    knots = np.linspace(-1 - 6 / 9, 1 + 6 / 9, 16)
    bend = BSpline(knots, weights, 3)((Y - 0.8) / 0.4)
    assert np.allclose(law(Y, T, q, DT), Y + 0.4 * bend)
    # Beyond its range the curve is as it was at the end.
    assert law(np.array([1.2, 1.5]), T[:2], q, DT) @ [-1, 1] == pytest.approx(0.3)
