"""The loop from end to end, on devices that hide an effect."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from made_devices import INTERVAL, LIMITS, NOISE, InMemory, as_record, hidden

from dea.discrepancy import Budget, Certified, Fit, Rules, Settings
from dea.errors import InputError
from dea.resolution import (
    ANOTHER,
    CERTIFICATE,
    Knowledge,
    Options,
    Resolution,
    ResolutionOutcome,
    experiment_page,
    resolution_dataset,
    resolve,
    said,
)
from dea.resolution.design import Question
from dea.resolution.error import Error
from dea.resolution.knowledge import Inquiry
from dea.resolution.law_error import LawError, Motion
from dea.resolution.posterior import Posterior
from dea.resolution.question import fresh_design, next_design
from made_carriage import CARRIAGE

pytestmark = pytest.mark.usefixtures("few_excitations")

SETTINGS = Settings(
    effects=("sensor_lag", "transport_delay", "electrode_lag"),
    warm_up=0.0,
    budget=Budget(starts=2, shakes=0, restarted=0, effects=1),
)
OPTIONS = Options(duration=20.0)
INQUIRY = Inquiry(CARRIAGE, LIMITS, SETTINGS, OPTIONS)


def first(device):
    """Two slow sines, on which a delay and a lag are nearly the same."""
    t = np.arange(1500) * INTERVAL
    u = 0.3 * np.sin(2 * np.pi * 0.5 * t) + 0.1 * np.sin(2 * np.pi * 0.8 * t)
    return device(u, 0)


def solved(device, options=OPTIONS, source=None):
    source = source or InMemory(device)
    records = [first(device)]
    return resolve(records, CARRIAGE, source, LIMITS, settings=SETTINGS, options=options), source


DEVICES = {
    "sensor_lag": hidden("sensor_lag", [0.15, 0.9, 0.0]),
    "transport_delay": hidden("transport_delay", [0.15]),
}


@cache
def solved_once(effect):
    return solved(DEVICES[effect])


@pytest.mark.slow
@pytest.mark.parametrize("effect", DEVICES)
def test_designed_records_leave_the_effect_that_is_hidden(effect):
    found, source = solved_once(effect)
    assert found.first.outcome(OPTIONS.level) is ResolutionOutcome.OPEN
    assert {"sensor_lag", "transport_delay"} <= found.first.posterior.left(OPTIONS.level)
    assert found.outcome is ResolutionOutcome.DECIDED
    assert found.last.diagnosis.verdict.names == (effect,)
    assert [each.number for each in source.kept] == list(range(1, len(found.rounds) + 1))
    assert found.certificate.after < 1.3 * NOISE < found.certificate.before
    for design in source.designs.values():
        assert design.u.min() >= LIMITS.low
        assert design.u.max() <= LIMITS.high
        assert np.abs(np.diff(design.u)).max() / INTERVAL <= LIMITS.rate * (1 + 1e-9)
        assert design.u.size * INTERVAL <= OPTIONS.duration
    dataset = resolution_dataset(found, OPTIONS.level)
    np.testing.assert_allclose(np.nansum(dataset["probability"], axis=1), 1.0)
    assert dataset["names"].values[-1] == effect
    seconds = sum(source.designs[each.number].u.size for each in found.rounds) * INTERVAL
    assert dataset["driven"].values[-1] == pytest.approx(seconds)
    assert CERTIFICATE in source.designs


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "law", "imitated"),
    [("dead_zone", [0.2], True), ("end_stop", [0.5, -0.5, 20.0], False)],
)
def test_an_effect_that_is_not_offered_ends_without_a_name(effect, law, imitated):
    """An electrode whose current is a power of the voltage imitates a dead zone, and no stop."""
    found, source = solved(hidden(effect, law), Options(records=1, duration=10.0))
    assert found.outcome is not ResolutionOutcome.DECIDED
    assert found.certificate is None
    assert CERTIFICATE not in source.designs
    assert found.last.verdict.status != "named"
    assert imitated or found.last.posterior.now["another"] > 0.99


@pytest.mark.slow
def test_a_loop_that_was_ended_goes_on_with_what_it_has():
    whole, source = solved_once("transport_delay")

    def driven_again(u, seed):
        raise AssertionError("a record that there is was driven again")

    again = InMemory(driven_again, designs=dict(source.designs), records=dict(source.records))
    resumed, _ = solved(DEVICES["transport_delay"], source=again)
    assert resumed.last.posterior == whole.last.posterior


def test_records_too_short_to_be_diagnosed_are_refused():
    with pytest.raises(InputError, match=r"resolution\.duration.*Raise it"):
        solved(hidden("transport_delay", [0.15]), Options(duration=4.0))


def test_the_motion_in_several_records_does_not_count_the_jump_from_one_to_the_next():
    """Two records of one wave, the second of which is displaced by ten times its size."""
    from dea.resolution.weighing import _law_error

    wave = np.sin(np.arange(400) / 20)
    y = np.concatenate([wave, wave + 10.0])
    extended = SimpleNamespace(lengths=(400, 400), simulation=SimpleNamespace(accuracy=0.0))
    nominal = Fit(extended, np.zeros(0), np.zeros(800), np.zeros((800, 0)), 0.0)
    diagnosis = SimpleNamespace(
        problem=SimpleNamespace(y=y, seen_rmse=lambda residual: 0.2, decimation=3),
        nominal=nominal, noise_floor=0.1, floor=0.1, coloured_level=0.0,
        error=SimpleNamespace(white=0.1, left=0.05, memory=4.0), rules=Rules(),
    )  # fmt: skip
    error = _law_error(diagnosis)
    diagnosis.coloured_level = 0.15
    assert _law_error(diagnosis).seen.coloured == 0.15 > error.seen.coloured
    motion = error.motion
    assert error.apart == 3
    assert error.seen.memory >= 3 * 4.0
    assert motion.size == pytest.approx(np.std(y))
    assert motion.pace == pytest.approx(np.std(np.diff(wave)))


def known(left=("a",)):
    """Return what is known where some of three explanations are left, of which one runs away."""

    def level(value):
        return lambda u, interval: np.full(u.size, value)

    names = {"none": 0.0, "a": 0.1, "away": 99.0}
    explanations = {
        name: SimpleNamespace(
            name=name,
            labels=() if name == "none" else (name,),
            mean=np.zeros(1),
            root=np.eye(1),
            simulated=level(value),
            linearised=lambda u, interval, y=value: (np.full(u.size, y), np.zeros((u.size, 1))),
        )
        for name, value in names.items()
    }
    prior = Posterior.of(dict.fromkeys([*names, ANOTHER], 1.0))
    posterior = prior.after({name: 0.0 if name in left else -1e3 for name in prior.now})
    error = LawError(Error(0.1, 0.0, 1.0), Motion(np.inf, np.inf), 0.0)
    diagnosis = SimpleNamespace(problem=SimpleNamespace(u=np.zeros(9), interval=INTERVAL))
    return Knowledge((), diagnosis, explanations, posterior, error)


def test_a_certificate_asks_the_explanations_that_are_left():
    design = fresh_design(known(), INQUIRY)
    assert LIMITS.allows(design.u)
    assert design.closest == ()
    assert fresh_design(known(left=("away",)), INQUIRY) is None
    page = experiment_page(
        "carriage", "resolve_fresh", design, LIMITS, {"a": 1.0}, ("V", "V"), others=True
    )
    assert "the one that is left" in page


def test_explanations_that_a_certificate_asks_are_equally_probable():
    design = fresh_design(known(left=("none", "a")), INQUIRY)
    assert design.closest == ("a", "none")
    assert design.log_bound == pytest.approx(np.log(0.5) - design.distance**2 / 8.0)


def test_a_judged_excitation_keeps_its_range_to_the_last_digit():
    """It is drawn to the middle, and 0.3 + (0.9 - 0.3) is above 0.9."""
    knowledge, limits = known(), replace(LIMITS, low=0.0, high=0.9)
    question = Question(
        [knowledge.explanations["a"]],
        [1.0],
        knowledge.explanations["none"],
        knowledge.error,
        limits,
        0.3,
    )
    assert limits.allows(question.judged(np.linspace(0.3, 0.9, 5), "free").u)


def test_why_no_record_was_designed_is_said(monkeypatch):
    from dea.resolution import rounds

    knowledge = known()
    verdict = SimpleNamespace(status="ambiguous", names=(), sentence="It is open.", whole=True)
    monkeypatch.setattr(knowledge.diagnosis, "verdict", verdict, raising=False)
    monkeypatch.setattr(rounds, "begun", lambda *arguments: knowledge)
    monkeypatch.setattr(rounds, "next_design", lambda *arguments: None)
    found, _ = solved(lambda u, seed: as_record(u, u))
    assert (found.outcome, found.rounds, found.pending) == (ResolutionOutcome.OPEN, (), None)
    assert "Raise `resolution.output_margin`" in said("carriage", found)
    monkeypatch.setattr(verdict, "status", "none")
    found, _ = solved(lambda u, seed: as_record(u, u))
    assert "Nothing is missing by the first records" in said("carriage", found)
    monkeypatch.setattr(knowledge.diagnosis, "final", SimpleNamespace(extended=None), raising=False)
    monkeypatch.setattr(rounds, "transferable", lambda extended: True)
    nowhere = SimpleNamespace(design=lambda number, records, make: None)
    decided = Resolution(knowledge, (), ResolutionOutcome.DECIDED)
    found = rounds._certified(decided, nowhere, INQUIRY)
    assert (found.certificate, found.pending) == (None, None)
    assert "not certified: no excitation was found" in said("carriage", found)


def test_a_record_that_is_still_to_be_made_leaves_what_was_decided(monkeypatch):
    from dea.resolution import rounds

    part = SimpleNamespace(
        outcome=lambda level: ResolutionOutcome.PART, verdict=SimpleNamespace(status="named"),
        records=(),
    )  # fmt: skip
    by_hand = SimpleNamespace(
        design=lambda number, records, make: SimpleNamespace(u=np.zeros(3)),
        record=lambda number, u: None,
    )
    monkeypatch.setattr(rounds, "begun", lambda *arguments: part)
    found = rounds.resolve((), CARRIAGE, by_hand, None)
    assert (found.outcome, found.pending) == (ResolutionOutcome.PART, 1)


@pytest.mark.parametrize(
    ("logs", "asked"),
    [
        ({"none": -4.7, "a": -4.7, "away": -1e4, ANOTHER: 0.0}, {"none": 0.5, "a": 0.5}),
        (
            {"none": -1e3, "a": 0.0, "away": -1e4, ANOTHER: -1e3},
            dict.fromkeys(["a", "none", "away"], 1 / 3),
        ),
    ],
)
def test_what_is_asked_counts_by_itself(monkeypatch, logs, asked):
    """What another explanation or a rejection has taken is not what rivals may be mistaken for."""
    from dea.resolution import question

    questions = []
    monkeypatch.setattr(question, "_shortest", lambda *arguments: 1.0)
    monkeypatch.setattr(question, "designed", lambda asked, *rest: questions.append(asked))
    knowledge = known()
    prior = dict.fromkeys(logs, 0.25)
    knowledge = replace(knowledge, posterior=Posterior.of(prior).after(logs))
    next_design(knowledge, INQUIRY, 1)
    (asking,) = questions
    found = dict(zip([e.name for e in asking.explanations], asking.probabilities, strict=True))
    assert found == pytest.approx(asked)


def test_another_explanation_may_be_near_any_of_those_that_are_offered(monkeypatch):
    """Not near the leading one alone, which the record may have shown to be far off."""
    from dea.resolution import weighing

    told = {("none", 1.0): -900.0, ("a", 1.0): -50.0, ("none", 2.0): -800.0, ("a", 2.0): -40.0}

    def predicted(explanation, samples, error):
        return SimpleNamespace(log_density=told[explanation.name, error.coloured])

    monkeypatch.setattr(weighing, "predicted", predicted)
    now = {"none": 0.6, "a": 0.1, "away": 0.2, ANOTHER: 0.1}
    knowledge = replace(known(), posterior=Posterior.of(now))
    densities = {"none": -1000.0, "a": -100.0, "away": -np.inf}
    errors = [Error(0.1, 1.0, 9.0), Error(0.1, 2.0, 9.0)]
    found = weighing._not_offered(knowledge, None, densities, errors)
    exact = np.log(0.1 / 0.7) + np.logaddexp(-50.0, -40.0) - np.log(2.0)
    assert found == pytest.approx(exact)


@pytest.mark.parametrize(
    ("after", "outcome", "status"),
    [(0.9, ResolutionOutcome.DECIDED, "named"), (1.1, ResolutionOutcome.CONTRADICTED, "unknown")],
)
def test_a_fresh_record_can_withdraw_a_name(monkeypatch, after, outcome, status):
    from dea.resolution import rounds

    found, _ = solved_once("sensor_lag")
    certified = Certified(1.0, after, 100)
    monkeypatch.setattr(rounds, "certify_elsewhere", lambda *arguments: {"fresh": certified})
    source = InMemory(DEVICES["sensor_lag"])
    source.keep(found.rounds[-1])
    again = rounds._certified(found, source, INQUIRY)
    assert source.kept[-1].after.verdict.status == status
    assert (again.outcome, again.certificate) == (outcome, certified)
    assert again.last.verdict.status == status
    assert resolution_dataset(again, OPTIONS.level)["status"].values[-1] == status
