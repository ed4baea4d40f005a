"""When a question counts as decided."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_outcomes import DRIFTING, knowledge, resolution_of

from dea import store
from dea.discrepancy import Reason, Rules, Settings, read_verdict
from dea.resolution import ANOTHER, Options, ResolutionOutcome, resolution_dataset, said
from dea.resolution.knowledge import Inquiry
from dea.resolution.posterior import Posterior
from dea.resolution.weighing import _explanations, _offered, _parts, _prior, learnt


@pytest.mark.parametrize(
    ("now", "kind", "outcome"),
    [
        ({"a": 0.9, "a+b": 0.1}, {}, ResolutionOutcome.DECIDED),
        ({"a": 0.9, "a+b": 0.1}, {"whole": False}, ResolutionOutcome.PART),
        ({"a+b": 1.0}, {}, ResolutionOutcome.PART),
        ({"a+b": 1.0}, {"reason": Reason.COLOURED}, ResolutionOutcome.PART),
        ({DRIFTING: 1.0}, {}, ResolutionOutcome.PART),
        # What the verdict takes for coloured noise is no further effect.
        ({DRIFTING: 1.0}, {"reason": Reason.COLOURED}, ResolutionOutcome.DECIDED),
        ({"a": 0.9, "a+b": 0.1}, {"status": "ambiguous"}, ResolutionOutcome.OPEN),
        ({"a": 0.9, "a+b": 0.1}, {"names": ("a", "b")}, ResolutionOutcome.OPEN),
        # A stop at two places is another explanation than one at a single place.
        ({"a": 1.0}, {"names": ("a", "a")}, ResolutionOutcome.OPEN),
        ({"a+a": 1.0}, {"names": ("a", "a")}, ResolutionOutcome.DECIDED),
        ({"a+a": 1.0}, {}, ResolutionOutcome.PART),
        ({"a": 0.9, "b": 0.1}, {}, ResolutionOutcome.OPEN),
        ({"a": 0.9, "none": 0.1}, {}, ResolutionOutcome.OPEN),
        ({"a": 0.9, ANOTHER: 0.1}, {}, ResolutionOutcome.OPEN),
        ({"none": 1.0}, {"status": "none", "names": ()}, ResolutionOutcome.ALONE),
        ({"none": 1.0}, {}, ResolutionOutcome.ALONE),
        ({"none": 0.9, "a": 0.1}, {"status": "none", "names": ()}, ResolutionOutcome.OPEN),
        ({ANOTHER: 1.0}, {}, ResolutionOutcome.OUTSIDE),
        ({ANOTHER: 1.0}, {"status": "unknown", "names": ()}, ResolutionOutcome.OUTSIDE),
    ],
)
def test_all_hypotheses_left_must_hold_the_verdict(now, kind, outcome):
    assert knowledge(now, **kind).outcome(0.01) is outcome


def test_what_is_left_follows_the_level():
    found = knowledge({"a": 0.98, "b": 0.02})
    assert found.posterior.left(0.01) == {"a", "b"}
    assert found.posterior.left(0.1) == {"a"}


@pytest.mark.parametrize(
    ("outcome", "status", "sentence"),
    [
        (ResolutionOutcome.DECIDED, "named", "It is a."),
        (ResolutionOutcome.PART, "named", "It is a."),
        (ResolutionOutcome.OPEN, "named", "It is a."),
        (ResolutionOutcome.OUTSIDE, "unknown", "No effect of the catalogue explains"),
        (ResolutionOutcome.ALONE, "none", "The simulation alone explains"),
        (ResolutionOutcome.CONTRADICTED, "unknown", "makes the error on a fresh record larger"),
    ],
)
def test_what_is_written_of_an_outcome_holds_a_name_only_where_it_stands(
    tmp_path, outcome, status, sentence
):
    """So do the line that is said, the dataset, and the verdict that is kept."""
    found = resolution_of(outcome)
    store.write(resolution_dataset(found, 0.01), tmp_path / "resolution.nc", title="a film")
    dataset = store.read(tmp_path / "resolution.nc")
    named = status == "named"
    assert dataset.attrs["outcome"] == outcome
    assert list(dataset["names"].values) == ["a", "a" if named else ""]
    assert list(dataset["status"].values) == ["named", status]
    assert list(dataset["error_after"].values) == [1.0, 1.0 if named else 2.0]
    for words in (dataset.attrs["sentence"], said("film", found)):
        assert sentence in words
        assert ("It is a." in words) is named
    found.last.verdict.write(tmp_path / "verdict.json")
    kept = read_verdict(tmp_path / "verdict.json")
    assert (kept.names, kept.whole) == ((("a",), True) if named else ((), None))


def test_where_only_the_simulation_alone_is_left_all_effects_asked_for_are_offered():
    settings = Settings(effects=("a", "b", "c"))
    left = knowledge({"none": 1.0})
    assert _offered(left, left.posterior, settings, Options()) == ("a", "b", "c")
    left = knowledge({"none": 0.5, "a": 0.5}, status="none", names=(), whole=None)
    assert _offered(left, left.posterior, settings, Options()) == ("a",)


@pytest.mark.parametrize("kind", [{"status": "unknown", "names": ()}, {"whole": False}])
def test_all_effects_are_offered_where_the_verdict_leaves_too_much(kind):
    """Those that are left may all hold a part of the answer alone."""
    settings = Settings(effects=("a", "b", "c"))
    left = knowledge({"a": 1.0}, **kind)
    assert _offered(left, left.posterior, settings, Options()) == ("a", "b", "c")


@pytest.mark.parametrize("size", [0.3, 1e-300, 1e-320])
def test_new_explanations_share_a_half_however_unlikely_all_of_them_are(size):
    parts = _parts({"a": 3.0 * size, "b": size, "c": 0.0})
    assert parts == pytest.approx({"a": 0.375, "b": 0.125}, rel=1e-3)
    posterior = Posterior.of({"none": 0.5, ANOTHER: 0.5}).with_new(parts, ANOTHER)
    assert sum(posterior.now.values()) == pytest.approx(1.0)
    assert all(np.isfinite(value) for value in posterior.log_now.values())


def test_where_nothing_new_was_found_the_probabilities_stay():
    posterior = Posterior.of({"none": 0.5, ANOTHER: 0.5})
    assert posterior.with_new(_parts({"c": 0.0}), ANOTHER) == posterior


@pytest.mark.parametrize(
    ("creep", "drift", "kept"),
    [
        (1.1, 2.2, {"none", "creep", "drift", "hum"}),
        (4.0, 2.2, {"none", "creep", "drift", "hum"}),
        (4.0, 3.6, {"none", "creep", "drift", "hum", "fault"}),
    ],
)
def test_what_leaves_more_than_a_right_explanation_is_no_hypothesis(
    creep, drift, kept, monkeypatch
):
    """The gap is 9.95 floors; the verdict speaks of creep, which may leave too much itself."""

    def left(name, rmse):
        return SimpleNamespace(labels=(name,), rmse=rmse, finished=True, fit=name)

    # Where none is right, all are kept.
    hum, fault = left("hum", 2.6 if drift < 3.0 else 3.3), left("fault", 3.5)
    found = SimpleNamespace(
        nominal=SimpleNamespace(residual=10.0), noise_floor=1.0, floor=1.0,
        rules=Rules(misfit=0.25),
        problem=SimpleNamespace(seen_rmse=abs),
        decision=SimpleNamespace(chosen=left("creep", creep), rivals=()),
        presence=SimpleNamespace(candidates=(left("drift", drift), fault)),
        singles=SimpleNamespace(candidates=(hum, fault)),
    )  # fmt: skip
    monkeypatch.setattr("dea.resolution.weighing.explanation_of", lambda fitted, *_: fitted)
    monkeypatch.setattr("dea.resolution.weighing._error", lambda found: None)
    assert set(_explanations(found)) == kept


def test_what_is_dropped_leaves_the_probability_of_another_explanation_as_it_is():
    prior = _prior({"none": 0.0, "a": 0.1, "dropped": 0.9}, ["none", "a"], 0.1)
    assert prior == pytest.approx({"none": 0.09, "a": 0.81, ANOTHER: 0.1})
    # All that was weighed is dropped.
    assert _prior({"none": 0.0}, ["none", "a"], 0.1) == pytest.approx(
        {"none": 0.45, "a": 0.45, ANOTHER: 0.1}
    )


def stubbed(monkeypatch, known, densities, shares):
    """Let a record be predicted with these logarithmic densities; each diagnosis fits anew."""
    stubs = {
        "signals_of": lambda record, simulation: SimpleNamespace(u=np.zeros(10), interval=0.1),
        "_errors_on": lambda known, samples: (None, ()),
        "predicted": lambda explanation, samples, error: SimpleNamespace(
            informed="told", log_density=densities.pop(0)
        ),
        "_not_offered": lambda *arguments: 0.0,
        "_offered": lambda *arguments: (),
        "diagnose": lambda records, simulation, **options: known.diagnosis,
        "_law_error": lambda found: None,
        "_explanations": lambda found: {"none": "fitted", "a": "fitted", "new": "fitted"},
        "_shares": lambda found: shares,
    }
    for name, stub in stubs.items():
        monkeypatch.setattr(f"dea.resolution.weighing.{name}", stub)


INQUIRY = Inquiry(None, None, Settings(), Options())


def test_what_a_later_diagnosis_drops_is_no_new_hypothesis(monkeypatch):
    """It has a weight, and no explanation that could predict the next record."""
    known = knowledge({"none": 0.1, "a": 0.4, ANOTHER: 0.5})
    stubbed(monkeypatch, known, [0.0] * 7, {"a": 0.9, "new": 0.05, "dropped": 0.05})
    after, _ = learnt(known, None, INQUIRY)
    assert set(after.posterior.now) - {ANOTHER} == set(after.explanations)
    assert "new" in after.explanations
    assert "dropped" not in after.posterior.now


@pytest.mark.parametrize(
    ("kind", "again"),
    [({}, True), ({"whole": False}, False), ({"status": "unknown", "names": ()}, False)],
)
def test_what_all_records_have_at_another_minimum_is_judged_once_more(monkeypatch, kind, again):
    """It was rejected as the first record had it; the next record tells whether it is right."""
    known = knowledge({"a": 0.5, ANOTHER: 0.5}, **kind)
    known.diagnosis.decision.chosen = SimpleNamespace(labels=("a",)) if kind == {} else None
    stubbed(monkeypatch, known, [-100.0] * 6, {"a": 1.0})
    once, _ = learnt(known, None, INQUIRY)
    assert once.outcome(0.01) is (ResolutionOutcome.OPEN if again else ResolutionOutcome.OUTSIDE)
    assert (once.withdrawn is None) == again
    if not again:
        return
    assert once.posterior.now["a"] == pytest.approx(0.5)
    assert once.explanations["a"] == "fitted"
    stubbed(monkeypatch, known, [-100.0] * 7, {"a": 1.0})
    twice, _ = learnt(once, None, INQUIRY)
    assert twice.outcome(0.01) is ResolutionOutcome.OUTSIDE
