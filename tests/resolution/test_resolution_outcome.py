"""When a question counts as decided."""

from types import SimpleNamespace

import numpy as np
import pytest

from dea.resolution import ANOTHER, Outcome, State
from dea.resolution.posterior import Posterior

PRIOR = {"none": 0.1, "a": 0.4, "b": 0.3, "a+b": 0.1, ANOTHER: 0.1}


def state(now, status="named", names=("a",), whole=True):
    verdict = SimpleNamespace(status=status, names=names, whole=whole)
    explanations = {
        name: SimpleNamespace(effects=frozenset(name.split("+")) - {"none"})
        for name in PRIOR
        if name != ANOTHER
    }
    logs = dict.fromkeys(PRIOR, -np.inf) | {name: np.log(value) for name, value in now.items()}
    posterior = Posterior(PRIOR, logs)
    return State((), SimpleNamespace(verdict=verdict), explanations, posterior, None)


@pytest.mark.parametrize(
    ("now", "said", "outcome"),
    [
        ({"a": 0.9, "a+b": 0.1}, {}, Outcome.DECIDED),
        ({"a": 0.9, "a+b": 0.1}, {"whole": False}, Outcome.PART),
        ({"a": 0.9, "a+b": 0.1}, {"status": "ambiguous"}, Outcome.OPEN),
        ({"a": 0.9, "a+b": 0.1}, {"names": ("a", "b")}, Outcome.OPEN),
        ({"a": 0.9, "b": 0.1}, {}, Outcome.OPEN),
        ({"a": 0.9, "none": 0.1}, {}, Outcome.OPEN),
        ({"a": 0.9, ANOTHER: 0.1}, {}, Outcome.OPEN),
        ({ANOTHER: 1.0}, {}, Outcome.OUTSIDE),
        ({ANOTHER: 1.0}, {"status": "unknown", "names": ()}, Outcome.OUTSIDE),
    ],
)
def test_all_hypotheses_left_must_hold_the_verdict(now, said, outcome):
    assert state(now, **said).outcome(0.01) is outcome


def test_what_is_left_follows_the_level():
    found = state({"a": 0.98, "b": 0.02})
    assert found.open_hypotheses(0.01) == {"a", "b"}
    assert found.open_hypotheses(0.1) == {"a"}
