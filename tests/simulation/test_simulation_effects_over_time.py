"""What changes or is added over time: drifts, faults, periodic disturbances."""

from dataclasses import replace

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import T, U, Y
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline

from dea.simulation import catalogue
from dea.simulation.effects._laws import DRIFT_MODES, drift_modes


def test_a_gain_never_changes_its_sign():
    falling = values("gain_drift", mode_1=-2.0)
    found = catalogue()["gain_drift"].scale_drive(T, falling)
    assert found.min() == pytest.approx(1e-3)
    assert found.max() > 2.0
    fault = values("step_fault", instant=11.0, gain_step=-3.0, rise_time=1.0)
    assert catalogue()["step_fault"].scale_drive(T, fault).min() == pytest.approx(1e-3)


def test_drifts_are_splines_of_time():
    own = {"mode_1": 0.1, "mode_2": 0.02, "mode_5": -0.03}
    gain = catalogue()["gain_drift"].scale_drive(T, values("gain_drift", **own))
    base = catalogue()["baseline_drift"].shape_output(Y, T, values("baseline_drift", **own), DT)
    weights = drift_modes()[0] @ [0.1, 0.02, 0.0, 0.0, -0.03, *[0.0] * (DRIFT_MODES - 5)]
    knots = np.arange(-3.0, 14.0)
    expected = BSpline(knots, weights, 3)(10.0 * T / 40.0)
    assert np.allclose(gain, 1 + expected)
    assert np.allclose(base, Y + expected)


def test_the_smoothest_mode_of_a_drift_is_straight_and_none_is_constant():
    for number in range(1, DRIFT_MODES + 1):
        q = values("baseline_drift", **{f"mode_{number}": 1.0})
        course = catalogue()["baseline_drift"].shape_output(np.zeros(T.size), T, q, DT)
        assert course.std() > abs(course.mean())
        if number == 1:
            assert np.corrcoef(course, T)[0, 1] > 0.9999


def test_a_drift_goes_on_straight_where_no_sample_tells_it():
    effect = catalogue()["baseline_drift"]
    prior = [p for p in effect.parameters(SCALES) if p.spread > 0]
    basis = [np.ones(T.size)]
    for p in prior:
        one = values("baseline_drift", **{p.name: p.spread})
        basis.append(effect.shape_output(np.zeros(T.size), T, one, DT))
    X = np.column_stack(basis)
    course = 0.04 * np.sqrt(T / 40.0) + 0.02 * np.sin(0.25 * T)
    known = T < 38.0
    A = X[known] / 1e-3
    weights = np.linalg.solve(A.T @ A + np.eye(A.shape[1]), A.T @ (course[known] / 1e-3))
    assert np.abs(X @ weights - course)[~known].max() < 0.003


def test_an_actuator_may_jam_within_a_part_of_its_range():
    event = {"instant": 11.01, "rise_time": 1e-6, "range_low": U.min(), "range_high": U.max()}
    q = values("step_fault", **event, highest_input=2.0, lowest_input=0.5)
    command = catalogue()["step_fault"].shape_input
    found = command(U, q, DT)
    late = T > 11.01
    np.testing.assert_array_equal(found[~late], U[~late])
    np.testing.assert_allclose(found[late], np.clip(U[late], 0.5, 2.0), atol=1e-12)
    stuck = values("step_fault", **event, highest_input=1.0, lowest_input=1.0)
    np.testing.assert_allclose(command(U, stuck, DT)[late], 1.0, atol=1e-12)
    assert np.array_equal(command(U, values("step_fault"), DT), U)
    # A constant that is added before moves the range with it.
    np.testing.assert_allclose(command(U + 0.1, values("step_fault"), DT), U + 0.1, atol=1e-12)
    np.testing.assert_allclose(command(U + 0.1, q, DT), found + 0.1, atol=1e-12)


def test_a_reading_may_be_late_from_one_instant_on():
    """The lag begins at the value that the output then has: dr/dt = (y - r) / time."""
    instant, tau = 11.0, 0.7
    q = values("step_fault", instant=instant, rise_time=1e-6, lag=tau)
    found = catalogue()["step_fault"].shape_output(Y, T, q, DT)
    late = instant <= T
    exact = solve_ivp(
        lambda t, r: (np.interp(t, T, Y) - r) / tau, (instant, T[-1]),
        [np.interp(instant, T, Y)], t_eval=T[late], rtol=1e-9, atol=1e-12, max_step=DT,
    ).y[0]  # fmt: skip
    np.testing.assert_array_equal(found[instant > T], Y[instant > T])
    np.testing.assert_allclose(found[late], exact, atol=1e-6)
    plain = catalogue()["step_fault"].shape_output(Y, T, values("step_fault"), DT)
    np.testing.assert_array_equal(plain, Y)


def test_step_fault_changes_gain_offset_and_scale_at_one_instant():
    q = values("step_fault", instant=11.01, gain_step=-0.2, offset_step=0.05, rise_time=1e-6)
    effect = catalogue()["step_fault"]
    after = T > 11.01
    assert np.allclose(effect.scale_drive(T, q), np.where(after, 0.8, 1.0))
    assert np.allclose(effect.shape_output(Y, T, q, DT), Y + 0.05 * after)
    slow = values("step_fault", instant=11.0, gain_step=0.4, offset_step=0.05, rise_time=2.0)
    t = np.array([9.9, 10.0, 10.5, 11.0, 11.5, 12.0, 12.1])
    share = np.array([0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0])
    assert np.allclose(effect.scale_drive(t, slow), 1.0 + 0.4 * share)
    assert np.allclose(effect.shape_output(np.zeros(7), t, slow, DT), 0.05 * share)
    scaled = values("step_fault", instant=11.01, offset_step=0.05, rise_time=1e-6, scale_step=-0.1)
    assert np.allclose(effect.scale_drive(T, scaled), 1.0)
    assert np.allclose(effect.shape_output(Y, T, scaled, DT), np.where(after, 0.9 * Y + 0.05, Y))


def test_a_part_of_a_step_may_be_taken_back_at_once_or_slowly():
    effect = catalogue()["step_fault"]
    step = {"instant": 11.0, "gain_step": -0.2, "offset_step": 0.05, "rise_time": 1e-6}
    t = np.array([10.9, 11.1, 13.9, 14.0, 14.5, 16.0, 30.0])
    sudden = values("step_fault", **step, held_for=3.0, return_time=1e-9, returned_part=0.75)
    assert np.allclose(effect.scale_drive(t, sudden), [1.0, *2 * [0.8], 0.8, *3 * [0.95]])
    slow = values("step_fault", **step, held_for=3.0, return_time=2.0, returned_part=1.0)
    left = np.array([0.0, 1.0, 1.0, 1.0, np.exp(-0.25), np.exp(-1.0), np.exp(-8.0)])
    assert np.allclose(effect.scale_drive(t, slow), 1.0 - 0.2 * left)
    assert np.allclose(effect.shape_output(np.zeros(7), t, slow, DT), 0.05 * left)


def test_periodic_disturbance_adds_its_lines():
    own = {"frequency": 2.0, "cosine_1": 0.01, "sine_2": 0.004}
    q = values("periodic_disturbance", **own, line_beside=0.9, sine_beside=0.003)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    phase = 2 * np.pi * 2.0 * T
    lines = 0.01 * np.cos(phase) + 0.004 * np.sin(2 * phase) + 0.003 * np.sin(0.45 * phase)
    assert np.allclose(found, lines)

    q = values("periodic_disturbance", frequency=2.0, cosine_1=0.01, phase_2=0.5)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    x = 2 * T / 40.0 - 1
    assert np.allclose(found, 0.01 * np.cos(phase + 0.5 * (1.5 * x**2 - 0.5)))
    grown = {"cosine_1": 0.01, "growth": 0.7, "middle": Y[5], "half_range": 10.0 * np.ptp(Y)}
    q = values("periodic_disturbance", frequency=2.0, **grown)
    found = catalogue()["periodic_disturbance"].shape_output(Y, T, q, DT) - Y
    assert np.allclose(found, 0.01 * np.cos(phase) * np.exp(0.07 * (Y - Y[5]) / np.ptp(Y)))


@pytest.mark.parametrize(
    ("lines", "beside"),
    [((1.3,), None), ((1.3, 2.6, 0.55), 0.55), ((1.3, 1.32), None), ((1.3, 3.2, 0.5), 3.2)],
)
def test_a_line_beside_a_periodic_disturbance_is_no_harmonic(lines, beside):
    effect = catalogue()["periodic_disturbance"]
    told = replace(SCALES, foreign_frequencies=lines)
    parameters = effect.parameters(told)
    at = [p.name for p in parameters].index("line_beside")
    free = [p.spread > 0 for p in parameters[at : at + 3]]
    assert free == [beside is not None] * 3
    for start in effect.starts(told):
        assert len(start) == len(parameters)
        assert start[at] == (beside or 0.0)


def test_sidebands_stand_on_either_side_of_the_wave_that_is_modulated():
    effect = catalogue()["periodic_disturbance"]
    told = replace(SCALES, foreign_frequencies=(1.3, 1.1))
    prior = {each.name: each.nominal for each in effect.parameters(told)}
    assert (prior["line_beside"], prior["line_opposite"]) == pytest.approx((1.1, 1.5))
    size, swing, slow = 0.01, 0.2, 2 * np.pi * 0.2
    q = values("periodic_disturbance", frequency=1.3, cosine_1=size,
               line_beside=1.1, cosine_beside=0.5 * swing * size,
               line_opposite=1.5, cosine_opposite=0.5 * swing * size)  # fmt: skip
    modulated = size * (1.0 + swing * np.cos(slow * T)) * np.cos(2 * np.pi * 1.3 * T)
    found = effect.shape_output(Y, T, q, DT) - Y
    np.testing.assert_allclose(found, modulated, atol=1e-9)


@pytest.mark.parametrize(("periods", "changes"), [(19, False), (21, True)])
def test_the_phase_of_a_disturbance_changes_slowly_over_many_periods_alone(periods, changes):
    """Whichever of several lines it is at."""
    own = {"frequency": periods / SCALES.duration, "cosine_1": 0.01}
    law = catalogue()["periodic_disturbance"].shape_output
    steady = law(Y, T, values("periodic_disturbance", **own), DT)
    for n in range(2, 7):
        wandering = law(Y, T, values("periodic_disturbance", **own, **{f"phase_{n}": 0.5}), DT)
        assert bool(np.abs(wandering - steady).max() > 1e-3) is changes
