"""Friction of contacts, of bristles and of a sheared film."""

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import T, forces
from scipy.integrate import solve_ivp

from dea.simulation import catalogue
from dea.simulation.signatures import MEMORY


def test_coulomb_friction_opposes_the_motion_with_one_force():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005)
    z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.1 * T)
    found, velocity = forces("coulomb_friction", q, z)[100:], np.diff(z)[100:]
    fast = np.abs(velocity) > 0.3 * np.abs(velocity).max()
    assert np.allclose(found[fast], -0.1 * np.sign(velocity[fast]))


def test_friction_may_be_larger_one_way():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005, asymmetry=0.3)
    slipped = np.zeros(MEMORY)
    law = catalogue()["coulomb_friction"].force
    for part, expected in ((1.0, -0.13), (-1.0, 0.07), (0.5, -0.0575)):
        slipped[:2] = part, 0.7
        assert law(0.7, 0.1, slipped, q) == pytest.approx(expected)


def test_friction_may_grow_with_the_load():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.005, load_growth=0.4)
    slipped, law = np.zeros(MEMORY), catalogue()["coulomb_friction"].force
    for place, expected in ((SCALES.z_low, 0.6), (SCALES.z_high, 1.4)):
        slipped[:2] = -1.0, place
        assert law(place, -0.1, slipped, q) == pytest.approx(0.1 * expected)


def test_friction_begins_with_the_deflection_at_the_start():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.01, start_deflection=-0.5)
    found = forces("coulomb_friction", q, np.linspace(0.3, 0.32, 21))
    assert np.allclose(found, -0.1 * np.minimum(-0.5 + np.arange(20) / 10, 1.0))


def test_friction_is_larger_the_slower_the_motion():
    """Stribeck's curve at creeping, at characteristic and at fast velocity."""
    own = {"force": 0.1, "slip_deflection": 0.005, "stiction_excess": 0.6, "stribeck_rate": 0.2}
    q = values("coulomb_friction", **own)
    slipped = np.zeros(MEMORY)
    slipped[:2] = 1.0, 0.7
    law = catalogue()["coulomb_friction"].force
    found = [law(0.7, w, slipped, q) for w in (1e-9, 0.2, -0.2, 1e9)]
    assert np.allclose(found, [-0.16, -0.13, -0.13, -0.1])
    # Before it slips the contact is a spring, which pulls back.
    slipped[0] = 0.0
    assert law(0.6975, 1e9, slipped, q) == pytest.approx(0.05)


def test_a_sheared_film_rubs_with_its_speed_alone():
    q = values("coulomb_friction", force=0.1, sheared_part=1.0, shear_rate=0.4,
               stiction_excess=0.5, stribeck_rate=2.0)  # fmt: skip
    z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.1 * T)
    found, speed = forces("coulomb_friction", q, z), np.diff(z) / DT
    expected = -0.1 * np.tanh(speed / 0.4) * (1.0 + 0.5 / (1.0 + (speed / 2.0) ** 2))
    assert np.allclose(found, expected)


def test_friction_that_is_elastic_nowhere_is_that_of_bristles():
    """Canudas de Wit et al. (1995) at one level of friction: b' = w - s |w| b / F, force s b."""
    level, largest, h = 0.1, 0.02, 1e-3

    def place(t):
        return 0.7 + 0.1 * np.sin(0.9 * t) * np.cos(0.17 * t)

    def speed(t):
        fast, slow = 0.9 * t, 0.17 * t
        return 0.09 * np.cos(fast) * np.cos(slow) - 0.017 * np.sin(fast) * np.sin(slow)

    t = np.arange(20_000) * h
    bristle = solve_ivp(
        lambda t, b: speed(t) - abs(speed(t)) * b / largest,
        (0, t[-1]), [0.0], t_eval=t, method="LSODA", rtol=1e-9, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    q = values(
        "coulomb_friction", force=level, slip_deflection=0.5 * largest, elastic_part=-1.0,
    )  # fmt: skip
    expected = -level / largest * bristle.y[0, :-1]
    assert np.abs(forces("coulomb_friction", q, place(t), h) - expected).max() < 1e-3 * level


def test_a_contact_is_elastic_up_to_a_part_of_its_largest_deflection():
    q = values("coulomb_friction", force=0.1, slip_deflection=0.02, elastic_part=0.4)
    found = forces("coulomb_friction", q, np.linspace(0.0, 0.05, 51))
    way = np.linspace(0.0, 0.05, 51)[:-1] / 0.02
    expected = np.where(way < 0.4, way, 1 - 0.6 * np.exp(-(way - 0.4) / 0.6))
    assert np.allclose(found, -0.1 * expected)
