"""Forces of springs and masses: stiffening, softening, end stops, a second mode."""

import numpy as np
import pytest
from law_values import SCALES, values
from made_signals import T, Z, forces
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline

from dea.simulation import catalogue
from dea.simulation.effects.strain_stiffening import MODES, curve_modes
from dea.simulation.signatures import MEMORY


def test_stiffening_is_a_power_law_and_a_smooth_curve():
    z = np.linspace(0.4, 1.0, 21)
    effect = catalogue()["strain_stiffening"]

    def found(z, **own):
        q = values("strain_stiffening", **own)
        return [effect.force(v, 0.0, effect.memory(q), q) for v in z]

    both_ways = np.linspace(-1, 1, 21)
    power = found(both_ways, stiffening=0.2, exponent=3.0)
    assert np.allclose(power, -0.2 * both_ways**3)
    modes = np.random.default_rng(3).uniform(-0.05, 0.05, MODES)
    bent = {"stiffening": 0.0, **{f"mode_{n + 1}": m for n, m in enumerate(modes)}}
    curve = found(z, **bent)
    pieces = MODES - 1
    knots = np.linspace(-1.0 - 6.0 / pieces, 1.0 + 6.0 / pieces, pieces + 7)
    weights = curve_modes()[0] @ modes
    spline = BSpline(knots, weights, 3)
    assert np.allclose(curve, -0.33 * spline((z - 0.7) / 0.33))
    beyond = found(np.array([0.2, 1.3]), **bent)
    ends = np.array([-1.0, 1.0])
    straight = spline(ends) + spline(ends, 1) * ((np.array([0.2, 1.3]) - 0.7) / 0.33 - ends)
    assert np.allclose(beyond, -0.33 * straight)


def test_a_bilinear_spring_is_nearly_a_smooth_curve():
    """A cable that goes taut within the motion: a power about rest fits it badly.

    The curve bends as its prior allows, with a stiffness that is measured to a thousandth.
    """
    z = np.linspace(0.4, 1.0, 201)
    taut = -2.0 * np.maximum(z - 0.75, 0.0)
    effect = catalogue()["strain_stiffening"]
    own = [p for p in effect.parameters(SCALES) if p.name.startswith("mode_")]

    def left(columns, spreads):
        X, prior = np.column_stack(columns), np.diag(1e-3 / np.array(spreads))
        weights = np.linalg.lstsq(np.vstack([X, prior]), np.r_[taut, 0.0 * prior[0]], rcond=None)[0]
        return (taut - X @ weights).std() / taut.std()

    free = [1e6, 1e6]
    straight = [z, np.ones(z.size)]
    power = min(left([*straight, z**n], [*free, 1e6]) for n in np.linspace(1.5, 15.0, 28))
    curve = [
        [effect.force(v, 0.0, effect.memory(q), q) for v in z]
        for q in (values("strain_stiffening", **{p.name: 1.0}) for p in own)
    ]
    assert left([*straight, *curve], [*free, *(p.spread for p in own)]) < 0.5 * power


def test_softening_grows_with_the_way_and_not_with_time():
    q = values("cyclic_softening", softening=0.3, travel=2.0, exponent=1.0)
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(Z)))])[:-1]
    expected = 0.3 * (1 - np.exp(-way / 2.0)) * Z[:-1]
    assert np.allclose(forces("cyclic_softening", q), expected)
    resting = forces("cyclic_softening", q, np.full(100, 0.7))
    assert np.allclose(resting, 0.0)
    law = catalogue()["cyclic_softening"]
    q = values("cyclic_softening", softening=0.3, travel=2.0, exponent=0.5)
    for way, exponent in ((0.5, 0.5), (2.0, 1.0), (8.0, 2.0)):
        law.update(0.7, 0.7 + way, 1.0, travelled := np.zeros(MEMORY), q)
        assert law.force(0.7, 0.0, travelled, q) == pytest.approx(0.21 * (1 - np.exp(-exponent)))


def test_below_its_largest_stroke_a_material_is_softer_by_the_energy_it_lacks():
    """The pseudo-elasticity of Ogden and Roxburgh with the tanh of Dorfmann and Ogden."""
    z = 0.1 + Z - Z[0] + 0.002 * T
    q = values(
        "cyclic_softening", softening=1e-4, stroke_softening=0.4, stroke=0.3, unstretched=0.1
    )
    energy = 0.5 * (z - 0.1) ** 2
    lacking = np.maximum.accumulate(energy) - energy
    virgin = -(z - 0.1)
    kept = 1.0 - 0.4 * np.tanh(lacking / (0.5 * 0.3**2))
    found = virgin[:-1] + forces("cyclic_softening", q, z)
    assert np.allclose(found, (kept * virgin)[:-1], atol=1e-3)
    assert np.allclose(found[lacking[:-1] == 0.0], virgin[:-1][lacking[:-1] == 0.0], atol=1e-3)
    assert (lacking > 0.05).any()


def test_what_the_largest_stroke_takes_for_good_depends_on_nothing_else():
    """Damage that is not healed at the largest stroke either, at both signs of the stretch."""
    q = values("cyclic_softening", softening=1e-4, stroke_softening=0.4, stroke=0.3, regained=0.0)
    z = np.r_[0.0, 0.2, -0.1, 0.1, -0.5, 0.2, 0.5]
    largest = np.r_[0.0, 0.2, 0.2, 0.2, 0.5, 0.5]
    expected = 0.4 * np.tanh((largest / 0.3) ** 2) * z[:-1]
    assert np.allclose(forces("cyclic_softening", q, z), expected, atol=1e-3)


def test_second_mode_resonates_at_its_frequency():
    q = values("second_mode", coupling=1.0, frequency=1.5, damping_ratio=0.05, start_position=0.0)
    omega, h = 2 * np.pi * 1.5, 1e-3
    t = np.arange(40_000) * h
    amplitude = np.abs(forces("second_mode", q, 0.01 * np.sin(omega * t), h)[-1000:]).max()
    # The absorber's own motion exceeds the base by 1/(2 ζ) at resonance.
    assert amplitude == pytest.approx(0.01 * np.abs(1 - 1 / (2j * 0.05)), rel=0.02)


@pytest.mark.parametrize("grounded", [0.0, 0.6])
def test_second_mode_follows_the_equations_of_two_masses(grounded):
    own = {"coupling": 0.7, "frequency": 1.2, "damping_ratio": 0.1, "hardening": 2.0}
    q = values("second_mode", start_position=0.5, grounded_damping=grounded, asymmetry=0.5, **own)
    omega, loss = 2 * np.pi * 1.2, 2 * 0.1 / (2 * np.pi * 1.2)

    def place(t):
        return 0.5 + 0.3 * np.sin(2.2 * t) + 0.2 * (1 - np.cos(5.1 * t))

    def speed(t):
        return 0.66 * np.cos(2.2 * t) + 1.02 * np.sin(5.1 * t)

    def pull(t, state):
        stretch = place(t) - state[0]
        slide = (1 - grounded) * loss * (speed(t) - state[1])
        side = np.exp(np.where(stretch > 0.0, 0.5, -0.5))
        return side * stretch * (1 + 2.0 * stretch**2) + slide

    h = 2e-3
    t = np.arange(5000) * h
    solved = solve_ivp(
        lambda t, x: [x[1], omega**2 * (pull(t, x) - grounded * loss * x[1])],
        (0, t[-1]), [0.5, 0.0], t_eval=t, rtol=1e-9,
    )  # fmt: skip
    found = forces("second_mode", q, place(t), h)
    expected = -0.7 * pull(t, solved.y)[:-1]
    assert np.abs(found - expected).max() < 0.02 * np.abs(expected).max()


def test_end_stop_pushes_back_only_beyond_its_stops():
    q = values(
        "end_stop", upper_stop=0.9, lower_stop=0.5, stiffness=10.0, corner_width=1e-9, exponent=1.0
    )
    law = catalogue()["end_stop"].force
    for z, expected in ((0.7, 0.0), (0.95, -0.5), (0.4, 1.0)):
        assert law(z, 0.0, np.zeros(MEMORY), q) == pytest.approx(expected)


def test_a_stop_resists_by_a_power_of_the_depth_with_a_rounded_corner():
    own = {"upper_stop": 0.9, "lower_stop": 0.5, "stiffness": 10.0, "exponent": 2.0}
    law = catalogue()["end_stop"].force
    q = values("end_stop", corner_width=1e-9, **own)
    # The reference depth, at which the exponent has no influence, is a tenth of the range.
    depth = 0.1 * 0.6
    for z, force in ((0.9 + depth, -0.6), (0.5 - depth, 0.6), (0.9 + 2 * depth, -2.4)):
        assert law(z, 0.0, np.zeros(MEMORY), q) == pytest.approx(force)
    # A parabola that meets zero and the line at a corner's width from the stop.
    q = values("end_stop", corner_width=0.02, **own | {"exponent": 1.0})
    beyond = (-0.02, -0.01, 0.0, 0.01, 0.02)
    felt = (0.0, 0.00125, 0.005, 0.01125, 0.02)
    for depth, size in zip(beyond, felt, strict=True):
        assert law(0.9 + depth, 0.0, np.zeros(MEMORY), q) == pytest.approx(-10.0 * size)
        assert law(0.5 - depth, 0.0, np.zeros(MEMORY), q) == pytest.approx(10.0 * size)


def test_a_ball_leaves_a_stop_as_hunt_and_crossley_say():
    """Their coefficient of restitution is 1 - alpha v; the force is k x^n (1 + 1.5 alpha v)."""
    alpha, speed = 0.05, 1.0
    own = {"upper_stop": 0.9, "lower_stop": 0.0, "corner_width": 1e-9, "stiffness": 300.0}
    q = values("end_stop", exponent=1.5, damping=1.5 * alpha, onset=0.0, **own)
    assert bounce(q, 0.9, speed) == pytest.approx(1 - alpha * speed, abs=0.003)
    assert bounce(q, 0.0, -speed) == pytest.approx(1 - alpha * speed, abs=0.003)


def test_a_ball_leaves_a_spring_with_a_dashpot_as_schwager_and_poeschel_say():
    """Granular Matter 9 (2007) 465: the contact ends where it would pull."""
    own = {"upper_stop": 0.9, "lower_stop": 0.0, "corner_width": 1e-9, "stiffness": 100.0}
    q = values("end_stop", exponent=1.0, damping=0.03, onset=1.0, **own)
    # A dashpot c = stiffness * reference * damping, of a unit mass.
    beta = 0.5 * 100.0 * 0.06 * 0.03
    omega = np.sqrt(100.0 - beta**2)
    expected = np.exp(-beta / omega * (np.pi - np.arctan(2 * beta * omega / (omega**2 - beta**2))))
    assert bounce(q, 0.9, 1.0) == pytest.approx(expected, abs=0.003)


def bounce(q, stop, speed):
    """The part of its speed with which a unit mass comes back from a stop."""
    law, empty = catalogue()["end_stop"].force, np.zeros(MEMORY)

    def away(t, x):
        return np.sign(speed) * (stop - x[0]) + (1e-9 if t < 1e-6 else 0.0)

    away.terminal, away.direction = True, 1
    solved = solve_ivp(
        lambda t, x: [x[1], law(x[0], x[1], empty, q)],
        (0, 10), [stop, speed], events=away, rtol=1e-9, atol=1e-12, max_step=1e-3,
    )  # fmt: skip
    return -solved.y[1, -1] / speed
