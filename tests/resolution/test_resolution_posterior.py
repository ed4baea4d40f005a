"""The probabilities of hypotheses, and how often the right one is rejected."""

import numpy as np
import pytest

from dea.errors import InputError
from dea.resolution.posterior import Posterior

LEVEL = 0.05


def log_normal(left, S):
    _, spread = np.linalg.slogdet(2.0 * np.pi * S)
    return -0.5 * (np.sum(left * np.linalg.solve(S, left), axis=(-2, -1)) + spread)


def test_probabilities_are_those_of_bayes():
    prior = {"a": 2.0, "b": 1.0, "c": 1.0}
    after = Posterior.of(prior).after({"a": np.log(0.1), "b": np.log(0.8), "c": -np.inf})
    assert after.now == pytest.approx({"a": 0.2, "b": 0.8, "c": 0.0})
    assert after.log_offered == pytest.approx(
        {"a": np.log(0.5), "b": np.log(0.25), "c": np.log(0.25)}
    )
    assert after.rejected(LEVEL) == {"c"}


def test_evidence_is_not_forgotten_however_strong():
    """A hypothesis that has lost e^5000 against another is not right after winning e^4000 back."""
    found = Posterior.of({"a": 1.0, "b": 1.0}).after({"a": -5000.0, "b": 0.0})
    assert found.rejected(LEVEL) == {"a"}
    again = found.after({"a": 4000.0, "b": 0.0})
    assert again.rejected(LEVEL) == {"a"}
    assert again.log_now["a"] == pytest.approx(-1000.0)
    assert again.after({"a": 2000.0, "b": 0.0}).now == pytest.approx({"a": 1.0, "b": 0.0})


def test_a_record_that_every_hypothesis_rules_out_is_refused():
    with pytest.raises(InputError, match="no explanation gives the designed record"):
        Posterior.of({"a": 1.0, "b": 1.0}).after({"a": -np.inf, "b": -np.inf})


def test_new_hypotheses_take_their_share_from_another():
    before = Posterior.of({"a": 1.0, "another": 1.0}).after({"a": 0.0, "another": np.log(3.0)})
    found = before.with_new({"b": 0.4}, "another")
    assert found.now == pytest.approx({"a": 0.25, "another": 0.45, "b": 0.3})
    offered = {name: np.exp(value) for name, value in found.log_offered.items()}
    assert offered == pytest.approx({"a": 0.5, "another": 0.3, "b": 0.3})


def test_a_new_hypothesis_is_judged_by_later_records_alone():
    """It takes its share of one that is nearly rejected, and e^-5 of a record later it is not."""
    before = Posterior.of({"a": 0.6, "b": 0.3, "another": 0.1}).after(
        {"a": 0.0, "b": -2.0, "another": -6.0}
    )
    found = before.with_new({"a+b": 0.5}, "another")
    assert found.rejected(0.01) == {"another"}
    assert found.after({"a": 0.0, "b": 0.0, "another": 0.0, "a+b": -4.0}).left(0.01) >= {"a+b"}
    assert "a+b" in found.after({"a": 0.0, "b": 0.0, "another": 0.0, "a+b": -5.0}).rejected(0.01)


@pytest.mark.parametrize("noise", [1.0, 0.7])
def test_the_right_hypothesis_is_rejected_no_more_often_than_the_level_at_any_time(noise):
    """Whoever chooses each experiment from what came before, and looks after each one.

    Three hypotheses predict y = J x with their own slopes, beliefs and means. The one that holds is
    driven for twenty records by an adversary, who picks the input on which it looks worst so far.
    The noise may be less than the hypotheses take it for.
    """
    rng = np.random.default_rng(7)
    runs, records, size = 1500, 20, 4
    J = rng.standard_normal((3, size, 2))
    mean = 0.6 * rng.standard_normal((3, 2, 1))
    prior = {"a": 0.2, "b": 0.5, "c": 0.3}
    truth = mean[0] + 0.5 * rng.standard_normal((runs, 2, 1))
    # Belief of each hypothesis in each run.
    m, P = np.tile(mean, (runs, 1, 1, 1)), np.tile(0.25 * np.eye(2), (runs, 3, 1, 1))
    posteriors = [Posterior.of(prior)] * runs
    ever = np.zeros(runs, dtype=bool)
    for _ in range(records):
        gain = np.where([each.now["a"] > prior["a"] for each in posteriors], 1.0, 0.5)
        slope = gain[:, None, None, None] * J
        y = slope[:, 0] @ truth + noise * rng.standard_normal((runs, size, 1))
        left = y[:, None] - slope @ m
        S = np.eye(size) + slope @ P @ slope.swapaxes(-2, -1)
        logs = log_normal(left, S)
        K = P @ slope.swapaxes(-2, -1) @ np.linalg.inv(S)
        m, P = m + K @ left, P - K @ slope @ P
        posteriors = [
            each.after(dict(zip(prior, own, strict=True)))
            for each, own in zip(posteriors, logs, strict=True)
        ]
        ever |= ["a" in each.rejected(LEVEL) for each in posteriors]
    assert ever.mean() <= LEVEL + 2.0 * np.sqrt(LEVEL * (1.0 - LEVEL) / runs)
