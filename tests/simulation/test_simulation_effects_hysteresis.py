"""Hysteresis of a force, and backlash of an input and of a reading."""

from itertools import pairwise

import numpy as np
import pytest
from law_values import DT, SCALES, values
from made_signals import Z, forces
from scipy.integrate import solve_ivp

from dea.simulation import catalogue


def test_hysteresis_is_rate_independent_and_keeps_return_point_memory():
    q = values("rate_independent_hysteresis", stiffness=0.4, largest_radius=0.3, weight_decay=0.5)
    path = np.concatenate(
        [np.linspace(a, b, 200) for a, b in ((0.7, 1.0), (1.0, 0.4), (0.4, 0.8), (0.8, 0.4))]
    )
    slow = forces("rate_independent_hysteresis", q, path)
    fast = forces("rate_independent_hysteresis", q, path[::4])
    assert np.allclose(slow[::4][: fast.size], fast, atol=2e-3)
    # Back where the inner loop was left, the force is what it was there.
    assert slow[-1] == pytest.approx(slow[398], abs=2e-3)


def test_stops_equal_plays():
    """A stop is the motion less the play operator of the same radius."""
    q = values(
        "rate_independent_hysteresis",
        stiffness=1.0, largest_radius=0.2, weight_decay=1.5, start_position=0.7,
    )  # fmt: skip
    rank = np.arange(1, 12)
    radii, weights = 0.2 * (rank / 11) ** 2, rank * np.exp(-1.5 * rank / 11)
    play = np.full(11, 0.7)
    expected = []
    for z in Z[:-1]:
        play = np.minimum(np.maximum(play, z - radii), z + radii)
        expected.append(-weights @ (z - play) / 11)
    assert np.allclose(forces("rate_independent_hysteresis", q)[1:], expected[1:], atol=1e-12)


def test_slipping_stops_pull_harder_where_they_have_grown():
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, weight_decay=1.5,
        start_position=0.0, tilt=0.4, growth_at_ends=0.3, middle=0.5, half_range=0.5,
    )  # fmt: skip
    path = np.linspace(0.0, 1.0, 4001)
    found = forces("rate_independent_hysteresis", q, path)
    place = (path[2000:-1] - 0.5) / 0.5
    rank = np.arange(1, 12)
    slipping = np.sum(rank * np.exp(-1.5 * rank / 11) * 0.2 * (rank / 11) ** 2) / 11
    expected = -slipping * (1.0 + 0.4 * place + 0.3 * place**2)
    assert np.allclose(found[2000:], expected, rtol=1e-3)


def test_stops_that_have_shrunk_to_nothing_have_no_force():
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, tilt=-0.5, skew=0.3,
        middle=0.0, half_range=0.5,
    )  # fmt: skip
    found = forces("rate_independent_hysteresis", q, np.linspace(0.0, 2.0, 401))
    assert np.isfinite(found).all()
    assert np.allclose(found[201:], 0.0)


def test_skewed_stops_pull_harder_at_their_upper_limit():
    """Up and down, each stop that has slipped pulls by 1.3 and 0.7 of its limit."""
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.2, weight_decay=1.5,
        start_position=0.0, skew=0.3,
    )  # fmt: skip
    path = np.concatenate([np.linspace(0.0, 1.0, 1001), np.linspace(1.0, 0.0, 1001)])
    found = forces("rate_independent_hysteresis", q, path)
    rank = np.arange(1, 12)
    slipping = np.sum(rank * np.exp(-1.5 * rank / 11) * 0.2 * (rank / 11) ** 2) / 11
    assert np.allclose(found[500:1000], -1.3 * slipping)
    assert np.allclose(found[-500:], 0.7 * slipping)


def test_loops_may_be_smaller_where_the_material_saturates():
    """Small loops at the middle of the motion, and at its upper end a third as large."""
    own = {"stiffness": 0.2, "largest_radius": 0.05, "growth_at_ends": -2.0}
    q = values("rate_independent_hysteresis", **own)
    middle, half = 0.5 * (SCALES.z_low + SCALES.z_high), 0.5 * SCALES.z_span
    swing = 0.2 * half * np.sin(2 * np.pi * np.arange(2001) / 500)
    sizes = []
    for place in (middle, middle + half):
        found = forces("rate_independent_hysteresis", q, place + swing)[-501:]
        sizes.append(np.ptp(found))
    assert 0.25 < sizes[1] / sizes[0] < 0.45


@pytest.mark.parametrize("tilt", [-1.0, -0.9, 0.9, 1.0])
@pytest.mark.parametrize("duhem", [0.0, 1.0])
def test_hysteresis_beyond_the_range_of_a_record_never_drives_the_motion(tilt, duhem):
    """A designed excitation may move the device to where loops that shrink have vanished."""
    q = values(
        "rate_independent_hysteresis", stiffness=1.0, largest_radius=0.3, tilt=tilt, middle=0.0,
        half_range=1.0, start_position=-2.0, duhem_part=duhem,
    )  # fmt: skip
    swing = 0.2 * np.sin(2.0 * np.pi * np.arange(2001) / 500)
    work = []
    for place in np.linspace(-1.8, 1.8, 13):
        path = place + swing
        found = forces("rate_independent_hysteresis", q, path)[-501:]
        middle = 0.5 * (found[1:] + found[:-1])
        work.append(-np.sum(middle * np.diff(path[-501:])))
    assert min(work) >= -1e-12
    assert max(work) > 0.01


def test_loops_of_duhem_follow_the_equation_of_coleman_and_hodgdon():
    """Their equation df = k dz - f |dz| / L, integrated through reversals of uneven size."""
    q = values(
        "rate_independent_hysteresis",
        stiffness=0.4, largest_radius=0.3, start_position=0.7, duhem_part=1.0,
    )  # fmt: skip
    turns = np.array([0.7, 1.0, 0.4, 0.8, 0.55, 0.95])
    found = forces("rate_independent_hysteresis", q, path_through(turns))[::200]
    expected, f = [0.0], 0.0
    for a, b in pairwise(turns):
        sign = np.sign(b - a)
        solved = solve_ivp(
            lambda _, y, sign=sign: 0.4 * sign - y / 0.3,
            (0.0, abs(b - a)), [f], rtol=1e-9, atol=1e-12,
        )  # fmt: skip
        f = float(solved.y[0, -1])
        expected.append(-f)
    assert found == pytest.approx(expected[: found.size], abs=1e-8)


def path_through(turns):
    """A path of 200 steps from each turn to the next."""
    return np.concatenate([[turns[0]], *(np.linspace(a, b, 201)[1:] for a, b in pairwise(turns))])


@pytest.mark.parametrize("at_input", [False, True])
@pytest.mark.parametrize("swing", [0.5, 0.75])
def test_the_loop_of_backlash_has_the_area_of_its_parallelogram_at_any_rate(swing, at_input):
    """A play of gap g under a swing s holds the area g (s - g)."""
    effect, gap = catalogue()["backlash"], 0.3
    for samples in (500, 4000):
        y = 0.8 + 0.5 * swing * np.sin(2 * np.pi * np.arange(2 * samples) / samples)
        if at_input:
            read = effect.shape_input(y, values("backlash", command_gap=gap), DT)
        else:
            read = effect.shape_output(y, np.zeros(y.size), values("backlash", gap=gap), DT)
        y, read = y[samples:], read[samples:]
        area = abs(np.sum(0.5 * (read + np.roll(read, 1)) * (y - np.roll(y, 1))))
        np.testing.assert_allclose(area, gap * (swing - gap), rtol=2e-3)


def test_the_gap_of_backlash_may_change_along_the_range():
    """Half of it lies between output and reading while the output rises, or falls."""
    y = np.concatenate([np.linspace(0.8, 1.2, 400), np.linspace(1.2, 0.4, 800)])
    q = values("backlash", gap=0.1, tilt=0.4, growth_at_ends=-0.3)
    read = catalogue()["backlash"].shape_output(y, np.zeros(y.size), q, DT)
    half = 0.05 * (1.0 + 0.4 * (y - 0.8) / 0.4 - 0.3 * ((y - 0.8) / 0.4) ** 2)
    np.testing.assert_allclose(read[200:400], (y - half)[200:400], atol=1e-12)
    np.testing.assert_allclose(read[700:], (y + half)[700:], atol=1e-12)


def test_a_contact_of_backlash_that_gives_lags_behind_a_ramp_by_its_speed():
    """In its steady state the reading follows by half the gap and the time constant at speed."""
    y, drag, fine = 0.4 + 0.05 * np.arange(0.0, 15.0, 0.002), 0.3, 0.002
    q = values("backlash", gap=0.1, drag=drag)
    read = catalogue()["backlash"].shape_output(y, np.zeros(y.size), q, fine)
    np.testing.assert_allclose(y[-1] - read[-1], 0.05 + 0.05 * drag, rtol=1e-3)


def test_within_its_gap_backlash_shows_no_motion_and_beyond_it_all():
    effect = catalogue()["backlash"]
    y = np.array([1.0, 1.1, 1.25, 1.6, 1.5, 1.35, 1.2, 0.9, 1.0, 1.3])
    for place, begun in ((1.0, 0.85), (0.0, 1.0), (-1.0, 1.15)):
        at_reading = values("backlash", gap=0.3, place=place)
        read = effect.shape_output(y, np.zeros(y.size), at_reading, DT)
        at_input = values("backlash", command_gap=0.3, command_place=place)
        up = [max(begun, each) for each in (0.85, 0.95, 1.1)]
        expected = [*up, 1.45, 1.45, 1.45, 1.35, 1.05, 1.05, 1.15]
        np.testing.assert_allclose(read, expected)
        np.testing.assert_allclose(effect.shape_input(y, at_input, DT), expected)
        np.testing.assert_array_equal(effect.shape_input(y, at_reading, DT), y)
        np.testing.assert_array_equal(effect.shape_output(y, np.zeros(y.size), at_input, DT), y)
