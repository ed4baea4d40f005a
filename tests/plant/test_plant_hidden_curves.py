"""Hidden curves against a statement of each law, at the ends of what is drawn and in between."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, drawn
from numpy.polynomial.legendre import legval
from scipy.integrate import cumulative_trapezoid

LOW, HIGH, SPAN = UNEVEN.low, UNEVEN.high, UNEVEN.span
BOTTOM, TOP, TRAVEL = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel
U = np.linspace(0.0, 1.6 * HIGH, 16_001)
Y = np.linspace(BOTTOM - 0.4 * TRAVEL, TOP + 0.4 * TRAVEL, 16_001)


def line(x, first, last):
    """Return the line through two points."""
    return first[1] + (x - first[0]) * (last[1] - first[1]) / (last[0] - first[0])


def of_slope(x, slopes, start):
    """Return the curve of these slopes that begins at a value."""
    return start + cumulative_trapezoid(slopes, x, initial=0.0)


def rounded_threshold(size, d):
    threshold, knee = LOW + size * SPAN, d.at(0.01, 0.04) * HIGH
    return knee * np.log1p(np.exp((U - threshold) / knee)) * HIGH / (HIGH - threshold)


def overlapped_valve(size, d):
    threshold = LOW + size * SPAN
    edge = threshold, d.at(0.02, 0.08) * threshold
    return np.where(threshold > U, line(U, (0.0, 0.0), edge), line(U, edge, (HIGH, HIGH)))


def yield_stress(size, d):
    threshold = LOW + size * SPAN
    over = np.maximum(U - threshold, 0.0) / (HIGH - threshold)
    return HIGH * over ** (1.0 + size * d.at(0.5, 2.0))


def jumping_threshold(size, d):
    threshold = LOW + size * SPAN
    edge = threshold, d.at(0.3, 0.8) * threshold
    passed = np.where(threshold > U, 0.0, line(U, edge, (HIGH, HIGH)))
    return np.where(np.abs(U - threshold) < 2e-3, np.nan, passed)


def diode_drop(size, d):
    threshold = LOW + size * SPAN
    knee = threshold / d.at(5.0, 9.0)
    small = HIGH * np.exp(-threshold / knee)
    v = np.geomspace(1e-9, 2.0 * HIGH, 200_001) - 1e-9
    passed = np.interp(U, v + knee * np.log1p(v / small), v)
    return passed * HIGH / np.interp(HIGH, U, passed)


def square_law_foot(size, d):
    threshold = LOW + size * SPAN
    foot = d.at(0.15, 0.4) * (HIGH - threshold)
    passed = of_slope(U, np.clip((U - threshold) / foot, 0.0, 1.0), 0.0)
    return passed * HIGH / np.interp(HIGH, U, passed)


def parabolic_shoulder(size, d):
    limit = HIGH - size * SPAN
    width = d.at(0.05, 0.2) * limit
    return of_slope(U, np.clip((limit + width - U) / (2.0 * width), 0.0, 1.0), 0.0)


def residual_gain(size, d):
    limit = HIGH - size * SPAN
    return np.minimum(U, limit) + d.at(0.02, 0.12) * np.maximum(U - limit, 0.0)


def solid_state_amplifier(size, d):
    limit, order = HIGH - size * SPAN, 2.0 * d.at(2.0, 6.0)
    return (np.maximum(U, 1e-9) ** -order + limit**-order) ** (-1.0 / order)


def error_integral(size, d):
    limit = HIGH - size * SPAN
    knee = d.at(0.75, 0.92) * limit
    over = np.maximum(U - knee, 0.0) / (limit - knee)
    return of_slope(U, np.exp(-0.25 * np.pi * over**2), 0.0)


def falling_tube(size, d):
    # The crest, a room above the knee, is the limit.
    last = d.at(2.2, 3.0)
    knee = HIGH - size * SPAN * last / (last - 1.0)
    room = HIGH - size * SPAN - knee
    over = np.maximum(U - knee, 0.0) / room
    return np.minimum(U, knee) + room * over / (1.0 + over**2 / 4.0)


COMMAND = (
    rounded_threshold, overlapped_valve, yield_stress, jumping_threshold, diode_drop,
    square_law_foot, parabolic_shoulder, residual_gain, solid_state_amplifier, error_integral,
    falling_tube,
)  # fmt: skip


@pytest.mark.parametrize("law", COMMAND, ids=lambda law: law.__name__)
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 0.44])
def test_a_command_passes_as_the_law_says(law, share, size):
    made, defining, draws = drawn(law.__name__, size, share)
    expected = law(size, draws)
    known = np.isfinite(expected)
    np.testing.assert_allclose(through(made, U)[known], expected[known], atol=2e-4 * HIGH)
    assert not made.output
    places = {"threshold": LOW + size * SPAN, "limit": HIGH - size * SPAN}
    for name, value in defining.items():
        assert value == pytest.approx(places[name])


def bent(knee, left, bend):
    """Return the place up to a knee, and what a bend makes of ``left`` above it."""
    over = np.maximum(Y - knee, 0.0)
    return np.minimum(Y, knee) + bend(over / left) * left


def hyperbolic_rail(size, d):
    room = d.at(0.02, 0.08) * TRAVEL
    return bent(TOP - size * TRAVEL - room, room, lambda x: x / (1.0 + x))


def leaking_rail(size, d):
    limit = TOP - size * TRAVEL
    return np.minimum(Y, limit) + d.at(0.01, 0.05) * np.maximum(Y - limit, 0.0)


def overloaded_converter(size, d):
    floor = BOTTOM + d.at(0.0, 0.2) * size * TRAVEL
    return np.minimum(np.maximum(Y, floor), TOP - size * TRAVEL)


def paralysed_counter(size, d):
    crest = d.at(0.7, 1.0) * size * TRAVEL
    return bent(TOP - size * TRAVEL, crest, lambda x: x * np.exp(-x))


def exponential_rail(size, d):
    room = d.at(0.03, 0.10) * TRAVEL
    return bent(TOP - size * TRAVEL - room, room, lambda x: 1.0 - np.exp(-x))


def arctangent_rail(size, d):
    room = d.at(0.02, 0.07) * TRAVEL
    wave = bent(TOP - size * TRAVEL - room, room, lambda x: np.arctan(0.5 * np.pi * x) * 2 / np.pi)
    return wave


def calibration_polynomial(size, d):
    place = np.clip(2.0 * (Y - BOTTOM) / TRAVEL - 1.0, -1.5, 1.5)
    angle = d.at(0.0, 2.0 * np.pi)
    error = legval(place, [0.0, 0.0, np.cos(angle), 0.4 * np.sin(angle)])
    kinks = np.abs(np.abs(2.0 * (Y - BOTTOM) / TRAVEL - 1.0) - 1.5) < 3e-3
    return np.where(kinks, np.nan, Y + 0.5 * size * TRAVEL * error)


def interpolation_error(size, d):
    angle = 2.0 * np.pi * Y / (d.at(0.45, 0.9) * TRAVEL) + d.at(0.0, 2.0 * np.pi)
    return Y + 0.25 * size * TRAVEL * (np.sin(angle) + d.at(0.0, 0.4) * np.sin(2.0 * angle))


def loaded_potentiometer(size, d):
    x = np.clip((Y - BOTTOM) / TRAVEL, 0.0, 1.0)
    turned = d.share < 0.5
    x = 1.0 - x if turned else x
    # The track's lower part and the load, side by side, divide with the upper part.
    lower = x / (1.0 + 5.0 * size * x)
    divided = lower / (lower + 1.0 - x)
    read = BOTTOM + TRAVEL * (1.0 - divided if turned else divided)
    read += np.minimum(Y - BOTTOM, 0.0) + np.maximum(Y - TOP, 0.0)
    kinks = np.minimum(np.abs(Y - BOTTOM), np.abs(Y - TOP))
    return np.where(kinks < 3e-3 * TRAVEL, np.nan, read)


def true_at_ends(signal):
    """Return a reading of a function of the place that is true at both ends of the travel."""
    low, high = signal(BOTTOM), signal(TOP)
    return line(signal(Y), (low, BOTTOM), (high, TOP))


def oblique_cable(size, d):
    foot = BOTTOM - d.at(0.0, 0.2) * TRAVEL
    return true_at_ends(lambda y: np.sqrt((y - foot) ** 2 + (2.0 * size * TRAVEL) ** 2))


def approached_magnet(size, d):
    radius = TRAVEL * d.at(0.8, 1.2) / size
    length = d.at(0.5, 1.5) * radius

    def field(y):
        # The cosines of the angles under which the rims of both ends are seen.
        near = 0.25 * radius + TOP - y
        far = near + length
        return np.cos(np.arctan2(radius, far)) - np.cos(np.arctan2(radius, near))

    return true_at_ends(field)


def segmented_converter(size, d):
    segments = 5 + min(int(4 * d.share), 3)
    height = min(0.25 * size, 0.45 / segments) * TRAVEL
    error = height * d.side() * d.at(0.3, 1.0)
    edge = np.minimum(Y - BOTTOM, TOP - Y) / (TRAVEL / segments)
    return Y + error * np.clip(edge, 0.0, 1.0)


def unbalanced_bridge(size, d):
    x, bend = (Y - BOTTOM) / TRAVEL, min(size, 0.8) * d.side(-0.5, 1.0)
    return BOTTOM + TRAVEL * (1.0 + bend) * x / (1.0 + bend * x)


def lever_angle(size, d):
    steep = 2.5 * size
    x = 2.0 * (Y - BOTTOM) / TRAVEL - 1.0 - d.at(-0.6, 0.6)
    return UNEVEN.median + TRAVEL / (2.0 * steep) * np.arctan(steep * x)


def exponential_element(size, d):
    bend = 2.0 * size * d.side()
    return true_at_ends(lambda y: np.exp(bend * (y - BOTTOM) / TRAVEL))


RAILS = (
    hyperbolic_rail, leaking_rail, overloaded_converter, paralysed_counter, exponential_rail,
    arctangent_rail,
)  # fmt: skip
SENSORS = (
    calibration_polynomial, interpolation_error, loaded_potentiometer, oblique_cable,
    approached_magnet, segmented_converter, unbalanced_bridge, lever_angle, exponential_element,
)  # fmt: skip
READING = [(law, size) for law in RAILS for size in (0.1, 0.6)] + [
    (law, size) for law in SENSORS for size in (0.2, 0.7)
]


@pytest.mark.parametrize(("law", "size"), READING, ids=lambda law: getattr(law, "__name__", None))
@pytest.mark.parametrize("share", SHARES)
def test_a_place_is_read_as_the_law_says(law, size, share):
    made, defining, draws = drawn(law.__name__, size, share)
    expected = law(size, draws)
    known = np.isfinite(expected)
    np.testing.assert_allclose(through(made, Y)[known], expected[known], atol=5e-4 * TRAVEL)
    assert made.output
    assert defining == (
        {"limit": pytest.approx(TOP - size * TRAVEL)} if "limit" in defining else {}
    )


# The travels below the bottom and beyond the top where a sensor's curve has become a straight line.
STRAIGHT = {
    "calibration_polynomial": (0.3, 0.3), "unbalanced_bridge": (1.0, 1.6),
    "exponential_element": (1.1, 1.1), "segmented_converter": (0.1, 0.1),
    "loaded_potentiometer": (0.1, 0.1),
}  # fmt: skip


@pytest.mark.parametrize("form", STRAIGHT)
@pytest.mark.parametrize("share", SHARES)
def test_a_sensor_far_outside_of_the_travel_reads_a_straight_line(form, share):
    below, above = STRAIGHT[form]
    made = drawn(form, 0.7, share)[0]
    slope = 0.0 if form == "exponential_element" else 1.0
    for ends in ((-3.9, -below), (1.0 + above, 4.9)):
        far = BOTTOM + TRAVEL * np.linspace(*ends, 301)
        np.testing.assert_allclose(np.diff(through(made, far)), slope * np.diff(far), atol=1e-9)


@pytest.mark.parametrize(("form", "largest"), [("unbalanced_bridge", 0.8), ("lever_angle", 1.5)])
def test_a_sensor_is_not_bent_further_than_so_far(form, largest):
    most, more = (through(drawn(form, size, 1.0)[0], Y) for size in (largest, 1.1 * largest))
    less = through(drawn(form, 0.9 * largest, 1.0)[0], Y)
    np.testing.assert_array_equal(most, more)
    assert np.abs(most - less).max() > 1e-3 * TRAVEL
