"""Creep and stress relaxation, against a generalised Maxwell body and Prony series."""

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import T, Z, forces
from scipy.integrate import solve_ivp

from dea.simulation import catalogue

# Moduli of a creep's branches over the first one's 0.05, and what the film has gone through.
BRANCHES = (1.0, 0.4, 3.0, 0.1, 0.7, 2.0, 0.05, 1.5)
HISTORY = {"start_position": 0.3, "stretch": 2.0, "age": 9.0}


def creep(**changed):
    """The parameters of a creep, and the moduli and times of its branches."""
    own = {f"branch_{i}": np.log(k) for i, k in enumerate(BRANCHES, 1)}
    q = values("viscoelastic_creep", stiffness=0.05, branch_ratio=0.8, **own, **changed)
    return q, 0.05 * np.array(BRANCHES) * 0.8 ** np.arange(8), np.geomspace(2 * DT, 80.0, 8)


@pytest.mark.parametrize("exponent", [0.0, 1.0, -0.6])
def test_creep_follows_the_equations_of_a_generalised_maxwell_body(exponent):
    """With dashpots that flow as a power of the stress (Norton) from a stretch on."""
    q, stiffness, tau = creep(
        tilt=0.6, curve=-0.4, rate_exponent=exponent, rate_stretch=0.3, **HISTORY
    )

    def place(t):
        return 0.9 * np.sin(1.3 * t) * np.cos(0.4 * t)

    def strain(x):
        return x - 0.4 * x**2 / (1 + abs(x))

    def rest(t, dashpots):
        return (0.3 - dashpots) / tau

    def flow(t, dashpots):
        branches = strain(place(t)) - dashpots
        stretch = stiffness @ branches / stiffness.sum()
        return branches / tau * (1 + (stretch / 0.3) ** 2) ** exponent

    # Stretched by 2 and then held for 9 s, before it moves.
    before = solve_ivp(rest, (-9, 0), np.full(8, 0.3 - 2.0), method="LSODA", rtol=1e-9)
    h = 1e-3
    t = np.arange(8000) * h
    solved = solve_ivp(
        flow, (0, t[-1]), before.y[:, -1], t_eval=t, method="LSODA", rtol=1e-9, atol=1e-11
    )
    stress = stiffness @ (strain(place(t)) - solved.y)
    grown = 0.6 * place(t) + np.sqrt(1 + (0.6 * place(t)) ** 2)
    found = forces("viscoelastic_creep", q, 0.7 + 0.3 * place(t), h)
    error = found + 0.3 * (grown * stress)[:-1]
    assert np.abs(error).max() < 0.01 * np.abs(found).max()


def test_creep_relaxes_as_a_prony_series():
    q, stiffness, tau = creep()
    # At rest in the middle, then held at the end of the range.
    found = forces("viscoelastic_creep", q, np.r_[0.7, np.full(1999, 1.0)])[1:]
    after = np.arange(1998) * DT
    expected = -0.3 * np.exp(-after[:, None] / tau) @ (stiffness * np.exp(-DT / tau))
    assert np.allclose(found, expected, rtol=1e-9)


def test_what_a_creep_amounts_to_is_what_its_force_loses_after_a_step():
    """From when the motion has crossed its range, and the time at which half of that is lost."""
    q, *_ = creep(curve=0.5)
    h, step = 1e-3, 1e-3
    # A small step from the middle, about which the law is as at rest.
    held = np.full(round(SCALES.duration / h) + 1, 0.7 + step)
    force = forces("viscoelastic_creep", q, np.r_[0.7, held], h)[1:]
    after = (SCALES.z_high - SCALES.z_low) / SCALES.z_rate
    lost = force[round(after / h) :] - force[round(after / h)]
    stiffness, half_time = catalogue()["viscoelastic_creep"].quantities
    assert stiffness.of(q, SCALES) == pytest.approx(lost[-1] / step, rel=0.02)
    expected = after + np.interp(0.5 * lost[-1], lost, h * np.arange(lost.size))
    assert half_time.of(q, SCALES) == pytest.approx(expected, rel=0.02)


def test_a_stretched_film_relaxes_while_it_does_not_move():
    q, stiffness, tau = creep(stretch=2.0, age=9.0)
    expected = -0.3 * np.exp(-(9.0 + T[:-1, None]) / tau) @ (2.0 * stiffness)
    assert np.allclose(forces("viscoelastic_creep", q, np.full(T.size, 0.7)), expected, rtol=1e-9)


def test_creep_that_does_not_respond_to_the_motion_relaxes_as_if_there_were_none():
    q, stiffness, tau = creep(response=0.0, stretch=2.0, age=9.0)
    expected = -0.3 * np.exp(-(9.0 + T[:-1, None]) / tau) @ (2.0 * stiffness)
    assert np.allclose(forces("viscoelastic_creep", q), expected, rtol=1e-9)


def test_stress_relaxes_with_time_and_not_with_the_way():
    q = values("stress_relaxation", relaxation=0.3, time=5.0, exponent=0.7, prestress=0.1)
    since = DT * np.arange(Z.size - 1)
    expected = (0.3 * Z[:-1] + 0.1) * (1 - np.exp(-((since / 5.0) ** 0.7)))
    assert np.allclose(forces("stress_relaxation", q), expected)
