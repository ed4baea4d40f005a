"""Hidden friction and stops against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import resist, steady, sweep
from made_draws import SHARES, UNEVEN, drawn

from dea.plant import forces
from dea.plant.film import SUBSTEP

K, TRAVEL, TIME, REST = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.time, UNEVEN.rest
BOTTOM, TOP, SPEED = UNEVEN.bottom, UNEVEN.top, UNEVEN.path / UNEVEN.duration
SLIDING = 0.05 * K * TRAVEL
SPEEDS = SPEED * np.array([-4.0, -0.5, -0.02, 0.01, 0.3, 1.0, 5.0])
EACH = pytest.mark.parametrize("share", SHARES)


def friction(name, share):
    """Return a form's law, which has no defining value, and its draws."""
    made, defining, draws = drawn(name, 0.05, share)
    assert not defining
    return made, draws


def near_standstill(v):
    """Return the share of the friction that acts at a speed, the sine of an angle."""
    return np.sin(np.arctan(v / (0.03 * SPEED)))


@EACH
def test_bristles_bend_until_they_slide(share):
    made, draws = friction("lugre", share)
    bend, static = draws.at(1e-3, 4e-3) * TRAVEL, draws.at(1.0, 1.4) * SLIDING
    slow = draws.at(0.1, 0.4) * SPEED
    for v in (-2.0 * SPEED, -0.05 * SPEED, 0.01 * SPEED, 0.2 * SPEED):
        sliding = SLIDING + (static - SLIDING) / np.exp(v**2 / slow**2)
        # By Euler's implicit rule: the way that is left falls in equal ratios.
        for steps in (1, 5, 500):
            ratio = 1.0 + SLIDING / bend * abs(v) * SUBSTEP / sliding
            expected = np.sign(v) * sliding * (1.0 - ratio**-steps)
            assert steady(made, [v], steps * SUBSTEP)[0] == pytest.approx(expected, rel=1e-9)


@EACH
def test_tustin_s_friction_falls_exponentially_with_the_speed(share):
    made, draws = friction("stribeck_curve", share)
    excess, slow = draws.at(0.1, 0.6), draws.at(0.2, 0.8) * SPEED
    expected = SLIDING * (1.0 + excess * np.exp(-np.abs(SPEEDS) / slow)) * near_standstill(SPEEDS)
    np.testing.assert_allclose(steady(made, SPEEDS), expected, rtol=1e-9)


@EACH
def test_the_age_of_contacts_is_a_length_over_the_speed_in_the_end(share):
    made, draws = friction("ageing_contacts", share)
    growth, slip = draws.at(0.05, 0.12), draws.at(0.005, 0.02) * TRAVEL
    for seconds in (0.003, 1.0):
        steps = round(seconds / SUBSTEP)
        ratio = 1.0 + np.abs(SPEEDS) * SUBSTEP / slip
        age = slip / np.abs(SPEEDS) * (1.0 - ratio**-steps)
        # A logarithm of the age over that at the mean speed.
        strength = 1.0 + growth * np.log(1.0 + age * SPEED / slip)
        expected = SLIDING * strength * near_standstill(SPEEDS)
        np.testing.assert_allclose(steady(made, SPEEDS, seconds), expected, rtol=1e-9)


@EACH
def test_a_bearing_s_friction_is_in_proportion_to_a_load_of_the_place(share):
    made, draws = friction("loaded_bearing", share)
    growth = draws.at(0.6, 1.1)
    stacked = forces.stack([made])
    for y in np.linspace(BOTTOM - 1.5 * TRAVEL, TOP, 11):
        load = max(1.0 + growth * ((y - BOTTOM) / TRAVEL - 0.5), 0.0)
        felt = [forces.total_force(stacked, y, v) for v in SPEEDS]
        np.testing.assert_allclose(felt, SLIDING * load * near_standstill(SPEEDS), atol=1e-9)


@EACH
def test_dahl_s_force_is_left_behind_exponentially_after_each_reversal(share):
    made, draws = friction("dahl", share)
    length = draws.at(0.008, 0.025) * TRAVEL
    path = sweep(REST + 0.2, REST - 0.1, REST + 0.05, start=REST)
    felt = resist(made, path)
    for start, side in ((0, 1.0), (400, -1.0), (800, 1.0)):
        way = np.abs(path[start : start + 401] - path[start])
        left = (felt[start] - side * SLIDING) * np.exp(-way / length)
        np.testing.assert_allclose(felt[start : start + 401], side * SLIDING + left, atol=1e-9)
    assert felt[0] == 0.0


@EACH
def test_makkar_s_friction_is_three_tanh_terms(share):
    made, draws = friction("makkar", share)
    v = SPEEDS / SPEED
    quick, slow = draws.at(15.0, 25.0), draws.at(1.0, 3.0)
    excess = draws.at(0.1, 0.5) * (np.tanh(quick * v) - np.tanh(slow * v))
    uneven = 1.0 + draws.at(-0.2, 0.2) * np.tanh(20.0 * v)
    expected = SLIDING * (excess + np.tanh(20.0 * v)) * uneven
    np.testing.assert_allclose(steady(made, SPEEDS), expected, rtol=1e-9)


PLACE = TOP - 0.4 * TRAVEL
DEPTHS = np.concatenate([[-0.1, 0.0], np.geomspace(1e-3, 0.39, 60)]) * TRAVEL


def pressed(name, share, v=0.0):
    """Return the force of a form's stop at each depth, and its draws."""
    made, defining, draws = drawn(name, 0.4, share)
    assert defining == {"limit": pytest.approx(PLACE)}
    stacked = forces.stack([made])
    return np.array([forces.total_force(stacked, PLACE + d, v) for d in DEPTHS]), draws


@EACH
@pytest.mark.parametrize("v", [-20.0 * SPEED, -SPEED, 0.0, 3.0 * SPEED])
def test_hertz_contact_is_a_power_of_the_depth_and_damped(share, v):
    felt, draws = pressed("hertz_contact", share, v)
    d = np.maximum(DEPTHS, 0.0)
    damped = max(1.0 + draws.at(0.0, 0.2) * v / SPEED, 0.0)
    expected = draws.at(5.0, 20.0) * K * d * np.sqrt(d / (0.02 * TRAVEL)) * damped
    np.testing.assert_allclose(felt, expected, atol=1e-9)


@EACH
@pytest.mark.parametrize("v", [-40.0 * SPEED, -SPEED, 0.0, 3.0 * SPEED])
def test_a_sprung_contact_has_a_dashpot_and_never_pulls(share, v):
    felt, draws = pressed("sprung_contact", share, v)
    stiffness = draws.at(8.0, 30.0) * K
    push = stiffness * (DEPTHS + draws.at(0.0, 0.02) * TIME * v)
    np.testing.assert_allclose(felt, np.where(DEPTHS > 0.0, np.maximum(push, 0.0), 0.0), atol=1e-9)


@EACH
def test_a_pad_has_two_stiffnesses(share):
    felt, draws = pressed("stepped_pad", share)
    soft, hard = draws.at(2.0, 6.0) * K, draws.at(15.0, 40.0) * K
    corners = [0.0, draws.at(0.02, 0.06) * TRAVEL, TRAVEL]
    at_corners = [0.0, soft * corners[1], soft * corners[1] + hard * (TRAVEL - corners[1])]
    np.testing.assert_allclose(felt, np.interp(DEPTHS, corners, at_corners), atol=1e-9)


@EACH
def test_disc_springs_press_as_almen_and_laszlo_say(share):
    felt, draws = pressed("disc_springs", share)
    height = draws.at(0.02, 0.06) * TRAVEL
    thickness, stiffness = height / draws.at(0.9, 1.35), draws.at(10.0, 30.0) * K
    d = np.clip(DEPTHS, 0.0, height)
    press = d * ((height - d) * (height - d / 2.0) * thickness + thickness**3)
    press *= stiffness / (height**2 * thickness + thickness**3)
    flat = 2.0 * stiffness * np.maximum(DEPTHS - height, 0.0)
    np.testing.assert_allclose(felt, press + flat, atol=1e-9)


@EACH
def test_a_bumper_s_stiffness_grows_exponentially_up_to_thirty_of_its_depths(share):
    felt, draws = pressed("rubber_bumper", share)
    depth, stiffness = draws.at(0.01, 0.03) * TRAVEL, draws.at(1.0, 4.0) * K
    grown = np.exp(np.clip(DEPTHS / depth, 0.0, 30.0)) - 1.0
    np.testing.assert_allclose(felt, stiffness * depth * grown, rtol=1e-9)


@EACH
def test_a_cushion_is_compressed_adiabatically_and_then_along_its_tangent(share):
    felt, draws = pressed("air_cushion", share)
    length, stiffness = draws.at(0.06, 0.15) * TRAVEL, draws.at(1.5, 4.0) * K
    # By its stiffness, which grows with the pressure over the volume left.
    fine = np.linspace(0.0, 0.4 * TRAVEL, 400_001)
    slopes = stiffness * np.maximum(1.0 - fine / length, 0.05) ** -2.4
    work = np.append(0.0, np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(fine)))
    np.testing.assert_allclose(felt, np.interp(DEPTHS, fine, work), rtol=1e-4)
