"""When a question counts as decided."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dea.discrepancy import NamedEffect, Verdict, read_verdict
from dea.resolution import ANOTHER, Design, Outcome, Resolution, Round, State, resolution_dataset
from dea.resolution.posterior import Posterior
from dea.stages.resolve import said

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
    ("now", "kind", "outcome"),
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
def test_all_hypotheses_left_must_hold_the_verdict(now, kind, outcome):
    assert state(now, **kind).outcome(0.01) is outcome


def test_what_is_left_follows_the_level():
    found = state({"a": 0.98, "b": 0.02})
    assert found.open_hypotheses(0.01) == {"a", "b"}
    assert found.open_hypotheses(0.1) == {"a"}


def test_a_name_whose_every_hypothesis_is_rejected_is_given_nowhere(tmp_path):
    """Neither by the line that is said, nor by the dataset, nor by the verdict that is kept."""
    effect = NamedEffect("a", "input", "lag", {}, 2.0, 1.0, (0.7, 0.6, 0.8))
    named = Verdict("named", "It is a.", (effect,), {}, 0.1, {}, "mm")
    found = state({ANOTHER: 1.0})
    rmse = SimpleNamespace(seen_rmse=lambda residual: residual)
    diagnosis = SimpleNamespace(
        verdict=named, problem=rmse, units=("V", "mm"),
        nominal=SimpleNamespace(residual=2.0), extended=SimpleNamespace(residual=1.0),
    )  # fmt: skip
    first = replace(found, diagnosis=diagnosis)
    last = replace(first, withdrawn=True)
    design = Design(np.zeros(3), -1.0, ("a", "b"), 1.0, "free")
    whole = Resolution(first, (Round(1, design, {}, first, last),), Outcome.OUTSIDE)
    dataset = resolution_dataset(whole, 0.01)
    assert list(dataset["names"].values) == ["a", ""]
    assert list(dataset["status"].values) == ["named", "unknown"]
    assert list(dataset["gap_after"].values) == [1.0, 2.0]
    for words in (dataset.attrs["sentence"], said("film", whole)):
        assert "No effect of the catalogue explains" in words
        assert "It is a." not in words
    last.verdict.write(tmp_path / "verdict.json")
    assert read_verdict(tmp_path / "verdict.json").names == ()
