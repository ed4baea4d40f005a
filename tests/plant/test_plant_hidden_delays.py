"""Hidden delays of the command against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import built, through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.signal import lfilter
from scipy.stats import levy, nbinom

from dea.plant.film import SUBSTEP

TIME = UNEVEN.time
U = command()
U[0] += 0.01
COUNT = np.arange(U.size)
T = COUNT * SUBSTEP


def came(late):
    """Return the command a whole number of sub-steps late; its first value came before."""
    return U[np.maximum(COUNT - late, 0)]


def mean_lag(form, size, share, period):
    """Return the mean lag behind a ramp over many whole periods."""
    late = T - through(drawn(form, size, share)[0], T)
    last = 1500 + period * (2000 // period)
    return late[1500:last].mean()


@pytest.mark.parametrize("size", [0.001, 0.1, 0.6])
def test_a_pure_delay_is_a_whole_number_of_sub_steps(size):
    made, defining, _ = drawn("pure_delay", size, 0.3)
    steps = max(round(size * TIME / SUBSTEP), 1)
    assert not made.output
    assert defining == {"delay": pytest.approx(steps * SUBSTEP)}
    np.testing.assert_array_equal(through(made, U), came(steps))


@pytest.mark.parametrize("size", [0.001, 0.1, 0.61])
def test_a_sample_leaves_one_period_after_it_was_taken(size):
    made, defining, _ = drawn("sampled_and_held", size, 0.3)
    period = max(round(size * TIME / (1.5 * SUBSTEP)), 1)
    assert not made.output
    taken = (COUNT // period - 1) * period
    np.testing.assert_array_equal(through(made, U), U[np.maximum(taken, 0)])
    mean = mean_lag("sampled_and_held", size, 0.3, period)
    assert defining == {"delay": pytest.approx(mean, rel=1e-9)}
    assert mean == pytest.approx(size * TIME, abs=1.5 * SUBSTEP)


def test_a_stream_of_a_laminar_flow_arrives_with_its_share_of_it():
    made, defining, _ = drawn("laminar_tube", 0.4, 0.3)
    assert not made.output
    assert not defining
    # By t a share 1 - (T/2t)² has arrived; the middles of 24 equal shares, of one mean.
    times = 1.0 / (2.0 * np.sqrt(1.0 - (2 * np.arange(24) + 1) / 48.0))
    steps = np.rint(0.4 * TIME / SUBSTEP * times / np.mean(times)).astype(int)
    expected = np.mean([came(late) for late in steps], axis=0)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    assert steps.mean() == pytest.approx(0.4 * TIME / SUBSTEP, abs=0.5)


@pytest.mark.parametrize("share", SHARES)
def test_an_edge_leaves_a_coaxial_cable_as_its_skin_effect_lets_it(share):
    made, defining, draws = drawn("coaxial_cable", 0.5, share)
    assert not made.output
    assert not defining
    half, late = 0.5 * TIME, draws.at(0.002, 0.015)
    risen = through(made, np.repeat([0.0, 1.0], [1, 8000]))[1:]
    # Levy's distribution is the error function of the root, and its median is known.
    scale = late * half / levy.median()
    whole = levy.cdf(np.arange(8002) * SUBSTEP, (1.0 - late) * half, scale)
    # To half a part, and a sub-step.
    assert (risen > whole[:-2] - 0.51 / 24.0).all()
    assert (risen < whole[2:] + 0.51 / 24.0).all()
    assert int(np.argmax(risen >= 0.5)) == pytest.approx(half / SUBSTEP, abs=2)
    assert (risen[: int(0.98 * half / SUBSTEP)] == 0.0).all()


def test_no_stream_arrives_in_the_sub_step_in_which_it_left():
    made = drawn("laminar_tube", 0.001, 0.3)[0]
    np.testing.assert_allclose(through(made, U), came(1), atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_each_two_reflections_come_two_passages_later_and_weaker(share):
    made, defining, draws = drawn("reflecting_line", 0.2, share)
    assert not made.output
    once = round(0.2 * TIME / SUBSTEP)
    kept = draws.at(0.03, 0.1) * draws.side()
    shares = kept ** np.arange(5)
    mean = once * SUBSTEP * (shares * [1, 3, 5, 7, 9]).sum() / shares.sum()
    assert defining == {"delay": pytest.approx(mean)}
    # Each wave is the one before, reflected at both ends; together they pass a held command.
    waves = [kept**n * came((2 * n + 1) * once) for n in range(5)]
    expected = sum(waves) * (1.0 - kept) / (1.0 - kept**5)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("size", [0.001, 0.004])
def test_a_short_brigade_has_one_bucket_at_least(size):
    made, defining, draws = drawn("bucket_brigade", size, 1.0)
    buckets, left = max(round(size * TIME / SUBSTEP), 1), draws.at(0.002, 0.015)
    assert not made.output
    charge = lfilter([1.0 - left], [1.0, -left], U - U[0])
    assert buckets == 1
    np.testing.assert_allclose(through(made, U), charge + U[0], atol=1e-9)
    # A bucket that is full at once is not late, but for what it leaves behind.
    mean = mean_lag("bucket_brigade", size, 1.0, 1)
    assert defining == {"delay": pytest.approx(mean, rel=1e-6)}


@pytest.mark.parametrize("size", [0.001, 0.2])
def test_samples_are_joined_at_every_sub_step_at_most(size):
    made, defining, _ = drawn("joined_samples", size, 0.3)
    period = max(round(size * TIME / SUBSTEP), 1)
    assert not made.output
    expected = np.interp(T - period * SUBSTEP, T[::period], U[::period])
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    mean = mean_lag("joined_samples", size, 0.3, period)
    assert defining == {"delay": pytest.approx(mean, rel=1e-9)}


@pytest.mark.parametrize("seed", range(3))
def test_a_jittered_delay_is_a_mean_of_sines_renewed_every_hundredth_of_a_second(seed):
    made, defining = built("transport_delay", "jittered_delay", 0.5, seed, UNEVEN)
    mean, rng = 0.5 * TIME, np.random.default_rng(seed)
    assert not made.output
    assert defining == {"delay": pytest.approx(mean)}
    depth = mean * rng.uniform(0.05, 0.2)
    frequencies = 0.05 * 60.0 ** rng.uniform(0.0, 1.0, 6) / TIME
    angles = 2.0 * np.pi * np.outer(T[::10], frequencies) + rng.uniform(0.0, 2.0 * np.pi, 6)
    late = np.repeat(mean + depth * np.sin(angles).mean(axis=1), 10)
    np.testing.assert_allclose(through(made, U), np.interp(T - late, T, U), atol=1e-9)
    assert np.ptp(late) > 0.3 * depth


@pytest.mark.parametrize("share", SHARES)
def test_tanks_in_series_answer_a_step_as_a_sum_of_waiting_times(share):
    made, defining, draws = drawn("dispersed_plug_flow", 0.6, share)
    mean, tanks = 0.6 * TIME, draws.integers(25, 61)
    assert not made.output
    assert defining == {"delay": pytest.approx(mean)}
    risen = through(made, np.repeat([2.0, 3.0], [1, 1000]))[1:] - 2.0
    t = np.arange(1, 1001) * SUBSTEP
    # Of so many failures before each success that the mean is the tank's time.
    expected = nbinom.cdf(np.arange(1000), tanks, 1.0 / (1.0 + mean / tanks / SUBSTEP))
    np.testing.assert_allclose(risen, expected, atol=1e-9)
    # The mean delay of a sum is the sum of the delays.
    assert (1.0 - risen).sum() * SUBSTEP == pytest.approx(mean, rel=1e-6)
    spread = np.diff(risen, prepend=0.0) @ (t - SUBSTEP - mean) ** 2
    assert spread == pytest.approx(mean**2 / tanks + SUBSTEP * mean, rel=1e-4)
