"""Hidden sensors that are bent, against the law of each sensor, tested without its formula."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, slope, through

TRAVEL = CONDITIONS.travel
Y = np.linspace(CONDITIONS.bottom, CONDITIONS.top, 4001)


CURVES = [
    "calibration_polynomial", "interpolation_error", "loaded_potentiometer", "oblique_cable",
    "approached_magnet", "segmented_converter", "mismatched_bits", "optical_lever",
    "uneven_track", "light_probe", "knife_edge", "unbalanced_bridge", "lever_angle",
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
    lags = np.arange(3001, 12_000, 4)
    misfit = [np.abs(error[lag:] - error[:-lag]).max() for lag in lags]
    period = lags[int(np.argmin(misfit))] * (wide[1] - wide[0])
    assert 0.4 * TRAVEL < period < 0.95 * TRAVEL
    assert min(misfit) < 0.02 * np.ptp(error)


def test_the_bridge_is_a_hyperbola_through_both_ends():
    read = through(built("sensor_nonlinearity", "unbalanced_bridge", 0.5)[0], Y)
    assert read[[0, -1]] == pytest.approx([CONDITIONS.bottom, CONDITIONS.top], rel=1e-5)
    # Of y = (1 + b) x/(1 + b x), the quotient x/y is a straight line in x.
    x, y = (Y[10:] - Y[0]) / TRAVEL, (read[10:] - Y[0]) / TRAVEL
    line = np.polyval(np.polyfit(x, x / y, 1), x)
    np.testing.assert_allclose(x / y, line, atol=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_the_most_bent_bridge_reads_a_number_up_to_four_travels_above_its_range(seed):
    law = built("sensor_nonlinearity", "unbalanced_bridge", 1.2, seed)[0]
    assert np.isfinite(through(law, np.linspace(Y[0], Y[-1] + 4 * TRAVEL, 10_001))).all()


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


def test_the_load_bends_the_potentiometer_between_its_true_ends():
    for seed in range(4):
        read = through(built("sensor_nonlinearity", "loaded_potentiometer", 0.5, seed)[0], Y)
        assert read[[0, -1]] == pytest.approx([CONDITIONS.bottom, CONDITIONS.top], rel=0.01)
        # Of e = x/(1 + r x(1 - x)), x/e - 1 is a parabola with zeros at both ends.
        x, e = (Y - Y[0]) / TRAVEL, (read - Y[0]) / TRAVEL
        if np.argmax(np.abs(e - x)) < 2000:  # turned around
            x, e = 1.0 - x, 1.0 - e
        inside = (x > 0.02) & (x < 0.98)
        x, e = x[inside], e[inside]
        np.testing.assert_allclose((x / e - 1.0) / (x * (1.0 - x)), 2.5, rtol=2e-2)


def test_the_square_of_the_cable_s_length_is_a_parabola():
    read = through(built("sensor_nonlinearity", "oblique_cable", 0.5)[0], Y)
    assert read[[0, -1]] == pytest.approx([CONDITIONS.bottom, CONDITIONS.top], rel=1e-3)
    # (offset + scale y)² is a parabola: its third difference vanishes at one quotient of the two.
    even = read[::100]
    rate = np.array([np.diff(even**2, 3), 2.0 * np.diff(even, 3)])
    offset = -(rate[0] @ rate[1]) / (rate[1] @ rate[1])
    square = (even + offset) ** 2
    np.testing.assert_allclose(np.diff(square, 2), np.diff(square, 2).mean(), rtol=1e-2)
    assert slope(read, Y)[-1] > 1.1 * slope(read, Y)[10]


def test_the_magnet_s_field_is_that_of_its_rings_of_current():
    """By Biot and Savart's law for a stack of rings (Jackson, Classical Electrodynamics)."""
    from scipy.integrate import quad
    from scipy.optimize import minimize

    read = through(built("sensor_nonlinearity", "approached_magnet", 0.8)[0], Y)[::200]
    distance = CONDITIONS.top - Y[::200]

    def misfit(radius, length):
        near = 0.25 * radius
        field = np.array(
            [
                quad(
                    lambda s, z=z: radius**2 / ((z + s) ** 2 + radius**2) ** 1.5,
                    near,
                    near + length,
                )[0]
                for z in distance
            ]
        )
        return np.abs(read - np.polyval(np.polyfit(field, read, 1), field)).max()

    best = minimize(
        lambda p: misfit(*np.exp(p)), np.log([TRAVEL / 0.8] * 2), method="Nelder-Mead",
        options={"maxiter": 120},
    )  # fmt: skip
    assert best.fun < 1e-3 * TRAVEL
    assert 0.75 < np.exp(best.x[0]) * 0.8 / TRAVEL < 1.25


def test_the_segments_are_straight_and_the_reading_grows():
    for seed in range(4):
        read = through(built("sensor_nonlinearity", "segmented_converter", 1.5, seed)[0], Y)
        gain = np.diff(read) / np.diff(Y)
        bent = np.abs(np.diff(gain)) > 1e-6
        assert 4 <= np.count_nonzero(np.diff(np.flatnonzero(bent)) > 100) <= 8
        assert bent.mean() < 0.02
        assert gain.min() > 0.0
