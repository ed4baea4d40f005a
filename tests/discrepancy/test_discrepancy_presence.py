"""How sure an effect is: weights, shares, model error, colour and period where they are known."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.special import softmax

from dea.discrepancy.evidence.colour import is_coloured_noise
from dea.discrepancy.evidence.held_out import folds
from dea.discrepancy.evidence.model_error import ModelError, memory_of, model_error
from dea.discrepancy.evidence.occam import log_prior
from dea.discrepancy.evidence.presence import (
    Presence,
    presence,
    share_removed,
)
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.problem.noise import quantisation
from dea.discrepancy.problem.period import period_of
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules
from dea.missing import runs

MOST = Rules().may_follow()

BLOCKS = [slice(k, k + 50) for k in range(0, 5000, 50)]
WHITE = ModelError(1.0, 0.0, 0.0, 1.0)


def candidate(*names, at_bounds=(), residual=None):
    return SimpleNamespace(
        names=names, effects=frozenset(names), at_bounds=at_bounds, places=1,
        fit=SimpleNamespace(residual=residual),
    )  # fmt: skip


def weights(before, *residuals, names="abc", error=WHITE, offered=1):
    pairs = zip(names, residuals, strict=False)
    candidates = [candidate(name, residual=residual) for name, residual in pairs]
    rng = np.random.default_rng(0)
    prior = log_prior(candidates, offered, 3.0)
    found = presence(before, candidates, BLOCKS, error, prior, rng)
    return {c.names[0]: w for c, w in zip(found.candidates, found.weights, strict=True)}


def test_weights_are_those_of_the_likelihood_where_blocks_agree():
    """With the same sum of squares in every block, weights of blocks change nothing on average."""
    unit = np.ones(5000)
    errors = np.array([1.0 + 4e-4, 1.0, 1.0 + 2e-4])
    found = weights(*(error * unit for error in errors))
    expected = softmax(-0.5 * 5000 * errors**2)
    assert found["a"] == pytest.approx(expected[1], abs=0.05)
    assert found["b"] == pytest.approx(expected[2], abs=0.05)
    assert sum(found.values()) < 1.0


def test_what_helps_in_a_single_block_is_not_sure():
    rng = np.random.default_rng(1)
    before = rng.standard_normal(5000)
    everywhere, once = 0.98 * before, before.copy()
    once[:50] *= 0.1
    found = weights(10.0 * before, before, once)
    assert 0.3 < found["b"] < 0.999
    assert weights(10.0 * before, before, everywhere)["b"] > 0.99


def test_a_model_error_takes_the_sureness_from_small_differences():
    unit = np.ones(5000)
    sure = weights(9.0 * unit, 1.02 * unit, unit)
    unsure = weights(9.0 * unit, 1.02 * unit, unit, error=ModelError(1.0, 0.1, 0.5, 400.0))
    assert sure["b"] > 0.99
    # Their sums of squares differ by 202, and the density is 101.
    assert unsure["a"] == pytest.approx(1.0 / (1.0 + np.e), rel=1e-3)
    assert unsure["b"] == pytest.approx(1.0 / (1.0 + 1.0 / np.e), rel=1e-3)


def test_a_parameter_at_its_bound_counts_against_its_law():
    unit = np.ones(5000)
    candidates = [
        candidate("a", residual=unit), candidate("b", at_bounds=("b.rate",), residual=unit)
    ]  # fmt: skip
    rng = np.random.default_rng(0)
    prior = log_prior(candidates, 2, 3.0)
    found = presence(9.0 * unit, candidates, BLOCKS, WHITE, prior, rng)
    assert found.candidates[0] is candidates[0]
    assert found.weights[0] / found.weights[1] == pytest.approx(np.exp(3.0))


def test_an_effect_at_two_places_counts_twice():
    def at(*places):
        attached = [SimpleNamespace(name="end_stop", place=place) for place in places]
        named = SimpleNamespace(name_of=lambda a: a.name, label=lambda a: f"{a.name}@{a.place}")
        extended = SimpleNamespace(attached=attached, places=named)
        return Candidate(SimpleNamespace(extended=extended), 1.0, 1.0, 1.0)

    one, two = at("upper"), at("upper", "lower")
    assert one.effects == at("lower").effects < two.effects
    assert two.effects == {"end_stop", "end_stop again"}
    stub = SimpleNamespace(effects=two.effects, names=two.names, at_bounds=(), places=3 * 3)
    assert log_prior([stub], 20, 3.0)[0] == pytest.approx(-np.log(190.0 * 9.0))
    weighed = Presence((at("upper"), at("lower"), two), np.array([0.5, 0.45, 0.05]))
    assert weighed.surest(0.9) is weighed.candidates[0]
    assert weighed.surest(0.96) is None
    weighed = Presence((two, one), np.array([0.6, 0.4]))
    assert weighed.effects == {"end_stop": 1.0}
    assert weighed.least_of(two) == pytest.approx(0.6)
    assert weighed.wider_than(one) == pytest.approx(0.6)
    assert weighed.sure(0.9) == {"end_stop"}


def test_of_many_effects_offered_each_is_less_likely():
    unit = np.ones(5000)
    found = weights(unit, unit, offered=20)
    assert found["a"] == pytest.approx(1.0 / 21.0, rel=1e-6)


def test_what_an_answer_holds_beside_an_effect_is_told_by_the_wider_sets():
    alone, other = candidate("a"), candidate("b")
    sets = (candidate("a", "b"), candidate("a", "c"), alone, other)
    found = Presence(sets, np.array([0.5, 0.2, 0.2, 0.1]))
    assert found.wider_than(alone) == pytest.approx(0.7)
    assert found.least_of(sets[1]) == pytest.approx(0.2)
    assert found.among(alone, [other]) == pytest.approx(2.0 / 3.0)
    assert found.among(candidate("d"), []) == 0.0
    at_two_ports = Presence((alone, other, candidate("a")), np.array([0.6, 0.1, 0.3]))
    assert at_two_ports.among(alone, [other]) == pytest.approx(0.9)


def test_an_effect_is_as_sure_as_all_answers_that_hold_it():
    sets = (candidate("a", "b"), candidate("a", "c"), candidate("b"))
    found = Presence(sets, np.array([0.6, 0.3, 0.1])).effects
    assert found == pytest.approx({"a": 0.9, "b": 0.7, "c": 0.3})
    assert list(found) == ["a", "b", "c"]
    pair = Presence((candidate(*"sqdkmbx"),), np.array([1.0]))
    assert list(pair.effects) == list("bdkmqsx")


def test_the_share_is_that_of_the_misfit():
    before, after = np.full(5000, np.hypot(1.0, 8.0)), np.full(5000, np.hypot(1.0, 2.0))
    found = share_removed(before, after, BLOCKS, 1.0, np.random.default_rng(2))
    assert (found.value, found.low, found.high) == pytest.approx((0.75, 0.75, 0.75))
    nothing = share_removed(before, before, BLOCKS, 99.0, np.random.default_rng(2))
    assert nothing.value == 0.0


def test_the_interval_of_a_share_holds():
    held = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        course = np.repeat(rng.standard_normal(100), 50)
        before = 5.0 * course + rng.standard_normal(5000)
        after = course + rng.standard_normal(5000)
        found = share_removed(before, after, BLOCKS, 1.0, rng)
        held += found.low <= 0.8 <= found.high
    assert held >= 52


def test_memory_is_that_of_an_autoregression():
    """The sum of its autocorrelation is (1 + a) / (1 - a)."""
    noise = lfilter([1.0], [1.0, -0.9], np.random.default_rng(3).standard_normal(200_000))
    assert memory_of(noise) == pytest.approx(19.0, rel=0.12)
    assert memory_of(noise + 5.0) == pytest.approx(memory_of(noise))
    assert memory_of(noise + 5.0, 5.0) == pytest.approx(memory_of(noise, 0.0))
    assert memory_of(np.random.default_rng(4).standard_normal(100_000)) == pytest.approx(
        1.0, abs=0.1
    )


def test_a_model_error_is_what_the_best_leaves_or_what_laws_leave_anyway():
    before, best = np.full(100, 10.0), np.full(100, np.hypot(1.0, 0.8))
    assert model_error(before, best, 1.0, 0.05).coloured == pytest.approx(0.8)
    assert model_error(before, best, 1.0, 0.1).coloured == pytest.approx(0.1 * np.sqrt(99.0))
    assert model_error(before, best, 1.0, 0.05, 3.0).coloured == 3.0
    assert ModelError(3.0, 4.0, 5.0, 10.0).level == 5.0
    assert ModelError(3.0, 2.0, 4.0, 10.0).density == 169.0


def test_the_memory_of_a_law_that_leaves_less_than_expected_goes_over_to_that_of_the_gap():
    """The gap has 199 samples of memory, what the best leaves 19; they meet at a twentieth."""
    rng = np.random.default_rng(8)

    def coloured(pole):
        noise = lfilter([1.0], [1.0, -pole], rng.standard_normal(400_000))
        return noise / noise.std()

    white, gap, rest = rng.standard_normal(400_000), coloured(0.99), coloured(0.9)
    memory = [
        model_error(20.0 * gap + white, size * rest + white, 1.0, 0.05).memory
        for size in (0.0, 0.25, 0.5, 0.99, 1.01, 2.0)
    ]
    assert memory[0] == pytest.approx(199.0, rel=0.2)
    assert memory[1:3] == pytest.approx([199.0**0.75 * 19.0**0.25, (199.0 * 19.0) ** 0.5], rel=0.3)
    assert memory[3:] == pytest.approx([19.0] * 3, rel=0.25)


def test_the_memory_of_a_model_error_is_its_own_beside_white_noise():
    """What is left is white noise, and beside it a small autoregression."""
    rng = np.random.default_rng(6)
    slow = lfilter([1.0], [1.0, -0.9], rng.standard_normal(200_000))
    left = rng.standard_normal(slow.size) + 0.6 * slow / slow.std()
    found = model_error(10.0 * left, left, 1.0, 0.01)
    assert found.memory == pytest.approx(19.0, rel=0.2)
    assert found.density == pytest.approx(1.0 + 19.0 * 0.36, rel=0.2)


@pytest.mark.parametrize("step", [0.1, 3.0])
def test_rounding_has_its_deviation(step):
    y = np.round(np.random.default_rng(5).uniform(-50, 50, 2000) / step) * step
    assert quantisation(y) == pytest.approx(step / np.sqrt(12.0))
    assert quantisation(np.full(9, 2.0)) == 0.0


# Coloured noise


def record_of(residual):
    n = residual.size
    u = np.repeat(np.random.default_rng(6).uniform(-1, 1, n // 25), 25)
    halves = np.arange(n) // 250 % 2 == 0
    return Problem(u, u + residual, 0.02, halves, ~halves, np.zeros(n, bool))


def autoregressive(seed):
    return lfilter([1.0], [1.0, -0.95], np.random.default_rng(seed).standard_normal(5000))


@pytest.mark.parametrize("seed", range(4))
def test_coloured_noise_is_known_as_such(seed):
    noise = autoregressive(seed)
    assert is_coloured_noise(record_of(noise), noise, BLOCKS, MOST)


def test_what_follows_the_input_is_no_noise():
    noise = autoregressive(9)
    problem = record_of(noise)
    assert not is_coloured_noise(problem, noise + 3.0 * noise.std() * problem.u**2, BLOCKS, MOST)


@pytest.mark.parametrize("length", [12, 18, 20])
def test_blocks_too_short_to_tell_say_nothing(length):
    noise = autoregressive(9)
    short = [slice(first, first + length) for first in range(0, 40 * length, length)]
    assert not is_coloured_noise(record_of(noise), noise, short, MOST)


def test_bursts_are_no_noise():
    noise = 0.1 * autoregressive(10)
    noise[2000:2100] += 5.0 * autoregressive(11)[:100]
    assert not is_coloured_noise(record_of(noise), noise, BLOCKS, MOST)


# Periods


@pytest.mark.parametrize("period", [37, 400, 1999])
def test_a_period_is_found(period):
    rng = np.random.default_rng(12)
    once = lfilter([1.0], [1.0, -0.9], rng.standard_normal(period))
    assert period_of(np.tile(once, 6000 // period)) == period


def test_noise_and_slow_changes_have_no_period():
    rng = np.random.default_rng(13)
    assert period_of(rng.standard_normal(3000)) == 0
    assert period_of(np.linspace(0.0, 1.0, 3000)) == 0
    assert period_of(np.zeros(10)) == 0
    assert period_of(np.ones(1)) == 0


def test_a_period_is_held_out_whole():
    n = 6000
    u = np.sin(2 * np.pi * np.arange(n) / 1000)
    seen = np.arange(n) % 200 < 150
    problem = Problem(u, u, 0.02, seen, seen & False, ~seen)
    assert problem.periods == (1000,)
    masks = folds(problem)
    assert len(masks) >= 3
    assert (np.sum(masks, axis=0) == seen).all()
    for mask in masks:
        first = np.flatnonzero(mask)[0]
        later = np.flatnonzero((np.arange(n) > first) & seen & ~mask)
        last = later[0] if later.size else n
        assert last - first >= 1000 - 50


def test_a_period_of_each_record_is_held_out_whole():
    """A record whose input repeats leaves another, whose input does not, in single blocks."""
    n = 6000
    repeated = np.sin(2 * np.pi * np.arange(n) / 1000)
    once = np.random.default_rng(4).standard_normal(n)
    u = np.r_[repeated, once]
    seen = np.arange(2 * n) % 200 < 150
    problem = Problem(u, u, 0.02, seen, seen & False, ~seen, lengths=(n, n))
    assert problem.periods == (1000, 0)
    masks = folds(problem)
    assert (np.sum(masks, axis=0) == seen).all()
    repeating = [found for mask in masks if (found := runs(mask[:n]))]
    assert len(repeating) >= 3
    assert all(found[-1].stop - found[0].start >= 1000 - 50 for found in repeating)
    assert {run.stop - run.start for mask in masks for run in runs(mask[n:])} == {150}


def test_an_accuracy_that_is_stated_makes_no_evidence_stronger():
    """What is left has a memory of 95 samples, whether it is stated to be left or not."""
    rng = np.random.default_rng(12)
    slow = lfilter([1.0], [1.0, -0.979], rng.standard_normal(40_000))
    left = 0.5 * slow / slow.std() + 0.1 * rng.standard_normal(slow.size)
    silent = model_error(3.0 * left, left, 0.1, 0.05)
    stated = model_error(3.0 * left, left, 0.1, 0.05, 0.5)
    assert stated.density >= silent.density > 15.0
