"""The probabilities of hypotheses, and how often the right one is rejected."""

import numpy as np
import pytest

from dea.errors import InputError
from dea.resolution.posterior import Posterior

LEVEL = 0.05


def log_normal(left, S):
    _, spread = np.linalg.slogdet(2.0 * np.pi * S)
    return -0.5 * (left @ np.linalg.solve(S, left) + spread)


def test_probabilities_are_those_of_bayes():
    prior = {"a": 2.0, "b": 1.0, "c": 1.0}
    after = Posterior.of(prior).after({"a": np.log(0.1), "b": np.log(0.8), "c": -np.inf})
    assert after.now == pytest.approx({"a": 0.2, "b": 0.8, "c": 0.0})
    assert after.prior == {"a": 0.5, "b": 0.25, "c": 0.25}
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
    assert found.prior == pytest.approx({"a": 0.5, "another": 0.3, "b": 0.2})
    assert found.now == pytest.approx({"a": 0.25, "another": 0.45, "b": 0.3})


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
    mean = 0.6 * rng.standard_normal((3, 2))
    prior = {"a": 0.2, "b": 0.5, "c": 0.3}
    rejected = 0
    for _ in range(runs):
        truth = mean[0] + 0.5 * rng.standard_normal(2)
        beliefs = [(m, 0.25 * np.eye(2)) for m in mean]
        posterior = Posterior.of(prior)
        ever = False
        for _ in range(records):
            gain = 1.0 if posterior.now["a"] > prior["a"] else 0.5
            y = gain * J[0] @ truth + noise * rng.standard_normal(size)
            logs = {}
            for number, name in enumerate(prior):
                slope, (m, P) = gain * J[number], beliefs[number]
                S = np.eye(size) + slope @ P @ slope.T
                logs[name] = log_normal(y - slope @ m, S)
                K = P @ slope.T @ np.linalg.inv(S)
                beliefs[number] = (m + K @ (y - slope @ m), P - K @ slope @ P)
            posterior = posterior.after(logs)
            ever |= "a" in posterior.rejected(LEVEL)
        rejected += ever
    assert rejected / runs <= LEVEL + 2.0 * np.sqrt(LEVEL * (1.0 - LEVEL) / runs)
