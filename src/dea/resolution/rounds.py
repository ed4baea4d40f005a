"""The loop: design an excitation, drive it, weigh the hypotheses, diagnose all records, stop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property, partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from dea.discrepancy import (
    Candidate,
    Certified,
    Diagnosis,
    Samples,
    Settings,
    Status,
    Verdict,
    certify_elsewhere,
    diagnose,
    memory_of,
    misfit,
    shortest_record,
    signals_of,
    transferable,
)
from dea.errors import InputError
from dea.progress import part_of, tell
from dea.resolution.design import Design, Forms, Question, designed, likeliest
from dea.resolution.error import Error
from dea.resolution.excitation import Limits, express, genes
from dea.resolution.explanation import NONE, Explanation, explained
from dea.resolution.law_error import Errors, LawError, Motion
from dea.resolution.posterior import Posterior
from dea.resolution.prediction import predicted
from dea.seeds import generator
from dea.simulation import Simulation, load_simulation

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

ANOTHER = "another"
# Part of the prior that all hypotheses share equally: the laws of a first record are never quite
# right, and its evidence may be too sure.
_EQUAL = 0.2
# Part of what another explanation has that goes to explanations found later.
_TO_NEW = 0.5
# Factor on the shortest record, since its split may rest on a slower time constant.
_SPARE = 1.2
# Excitations that are drawn for the certificate, until one keeps the outputs in range.
_DRAWS = 8
_NOWHERE = (
    "no excitation was found that keeps the outputs in range which the explanations predict."
    " Raise `resolution.output_margin`, if the device bears it."
)
CERTIFICATE = 0  # number of the record that certifies


class Outcome(StrEnum):
    """How far the question is decided."""

    DECIDED = "decided"
    PART = "decided in part"
    OUTSIDE = "outside"
    ALONE = "nothing is missing"
    OPEN = "open"
    CONTRADICTED = "contradicted"


# Status and sentence of the verdict where no hypothesis with an effect is left, or none serves.
_WITHOUT_NAME = {
    Outcome.OUTSIDE: (Status.UNKNOWN, "No effect of the catalogue explains the designed records."),
    Outcome.ALONE: (Status.NONE, "The simulation alone explains the designed records."),
    Outcome.CONTRADICTED: (
        Status.UNKNOWN,
        "What explains the designed records makes the error on a fresh record larger.",
    ),
}


@dataclass(frozen=True)
class Options:
    """How a question is resolved.

    Parameters
    ----------
    records
        Designed records at most.
    duration
        Longest duration of one in s.
    level
        Probability at which the right hypothesis may be rejected, over all rounds together.
    another
        Prior probability of an explanation that was not offered.
    forms
        Forms of excitation that compete: free ones beside fixed ones, fixed ones alone, or none,
        which plays a random one of free form.
    """

    records: int = 3
    duration: float = 120.0
    level: float = 0.01
    another: float = 0.1
    forms: Forms = Forms.FREE


@dataclass(frozen=True)
class Knowledge:
    """What is known after some records.

    ``explanations`` hold a hypothesis each by its name; ``posterior`` also holds ``another``.
    ``withdrawn`` is the outcome where it leaves no effect, so that no name is given.
    """

    records: "tuple[Record | xr.Dataset, ...]"
    diagnosis: Diagnosis
    explanations: Mapping[str, Explanation]
    posterior: Posterior
    error: LawError
    driven: float = 0.0
    withdrawn: Outcome | None = None

    @cached_property
    def verdict(self) -> Verdict:
        """The verdict on all records, without a name where no hypothesis with an effect is left."""
        found = self.diagnosis.verdict
        if self.withdrawn is None:
            return found
        status, sentence = _WITHOUT_NAME[self.withdrawn]
        return replace(found, status=status, sentence=sentence, effects=(), share=None)

    def outcome(self, level: float) -> Outcome:
        """Return whether all hypotheses that are left hold the verdict, or none has an effect.

        It is decided where one of them is the verdict, and nothing more.
        """
        left = self.posterior.left(level)
        if left <= {ANOTHER}:
            return Outcome.OUTSIDE
        if left == {NONE}:
            return Outcome.ALONE
        verdict = self.diagnosis.verdict
        if verdict.status != Status.NAMED or ANOTHER in left:
            return Outcome.OPEN
        named = set(verdict.names)
        held = [self.explanations[name].effects for name in left]
        if not all(named <= effects for effects in held):
            return Outcome.OPEN
        # Where every hypothesis that is left holds more, what is named is a part of the answer.
        return Outcome.DECIDED if verdict.whole and named in held else Outcome.PART


@dataclass(frozen=True)
class Round:
    """A designed record, what it changed, and what was known before and after."""

    number: int
    design: Design
    log_densities: Mapping[str, float]
    before: Knowledge
    after: Knowledge


@dataclass(frozen=True)
class Resolution:
    """How a question was resolved, or how far.

    ``pending`` is the number of the record that is to be made by hand next; the certificate is
    missing where nothing is named, or where it belongs to one record alone. ``halted`` says why a
    record that was still wanted could not be designed.
    """

    first: Knowledge
    rounds: tuple[Round, ...]
    outcome: Outcome
    certificate: Certified | None = None
    pending: int | None = None
    halted: str = ""

    @property
    def last(self) -> Knowledge:
        """What is known after all records."""
        return self.rounds[-1].after if self.rounds else self.first


class Desk(Protocol):
    """Where excitations are kept and records come from."""

    def design(self, number: int, make: Callable[[], Design | None]) -> Design | None:
        """Return the design of a record: the one that is kept, or else a new one."""

    def record(self, number: int, u: np.ndarray) -> "Record | xr.Dataset | None":
        """Return the record of an excitation; nothing where it is still to be made by hand."""

    def keep(self, found: Round) -> None:
        """Keep what a round has found."""


def resolve(
    records: "Sequence[Record | xr.Dataset]",
    simulation: Simulation | str,
    desk: Desk,
    limits: Limits,
    *,
    settings: Settings | None = None,
    options: Options | None = None,
    workers: int = 1,
) -> Resolution:
    """Drive designed records until one explanation is left, or the budget is spent.

    Everything but the records follows from their order, the settings and the seed, so that a loop
    that was ended goes on where it was: the ``desk`` returns the designs and records there are.
    """
    settings, options = settings or Settings(), options or Options()
    own = simulation if isinstance(simulation, Simulation) else load_simulation(simulation)
    known = first = begun(records, own, settings, options, workers)
    rounds: list[Round] = []
    halted = ""
    undecided = (Outcome.OPEN, Outcome.PART)
    while known.outcome(options.level) in undecided and len(rounds) < options.records:
        if not rounds and known.verdict.status == Status.NONE:
            break
        number = len(rounds) + 1
        design = desk.design(number, partial(next_design, known, limits, settings, options, number))
        if design is None:
            halted = f"Record {number} is not driven: {_NOWHERE}"
            break
        record = desk.record(number, design.u)
        if record is None:
            return Resolution(first, tuple(rounds), Outcome.OPEN, pending=number)
        with part_of(f"record {number}"):
            after, log_densities = learnt(known, record, own, settings, options, workers)
        rounds.append(Round(number, design, log_densities, known, after))
        desk.keep(rounds[-1])
        known = after
    outcome = known.outcome(options.level)
    found = Resolution(first, tuple(rounds), outcome, halted=halted)
    if outcome not in (Outcome.DECIDED, Outcome.PART) or not rounds:
        return found
    return _certified(found, desk, own, limits, settings, options)


def begun(
    records: "Sequence[Record | xr.Dataset]",
    simulation: Simulation,
    settings: Settings,
    options: Options,
    workers: int,
) -> Knowledge:
    """Return what is known before any designed record: the diagnosis gives hypotheses and prior.

    Raises
    ------
    InputError
        If the simulation has several inputs, as well as for what the diagnosis refuses.
    """
    if len(simulation.inputs) > 1:
        raise InputError(
            f"the design of a further record is of one input, and it has {len(simulation.inputs)}",
            file=simulation.source or f"simulation {simulation.name}",
            field="input_name",
            remedy="Diagnose its records together, under `records:` of the case",
        )
    found = diagnose(records, simulation, settings=settings, workers=workers)
    error = _law_error(found)
    explanations = _explanations(found, error.seen)
    shares = _shares(found)
    prior = {
        name: (1.0 - options.another)
        * ((1.0 - _EQUAL) * shares.get(name, 0.0) + _EQUAL / len(explanations))
        for name in explanations
    }
    return Knowledge(
        tuple(records),
        found,
        explanations,
        Posterior.of(prior | {ANOTHER: options.another}),
        error,
    )


def next_design(
    known: Knowledge, limits: Limits, settings: Settings, options: Options, number: int
) -> Design | None:
    """Return the excitation that best tells apart the hypotheses that are left."""
    tell(f"record {number}: designing it")
    left = known.posterior.left(options.level) - {ANOTHER}
    logs = known.posterior.log_now
    asked = likeliest([known.explanations[name] for name in sorted(left)], logs)
    weights = np.array([logs[each.name] for each in asked])
    if len(asked) < 2:
        # Of those that are rejected nothing is open: the one that is left is tested against each.
        asked = likeliest(list(known.explanations.values()), logs)
        weights = np.zeros(len(asked))
    question = _question(known, asked, weights, limits)
    shortest = _shortest(known, settings, options)
    durations = shortest, options.duration
    rng = _generator(settings, number)
    return designed(question, durations, options.level, rng, options.forms)


def _question(
    known: Knowledge, asked: Sequence[Explanation], weights: np.ndarray, limits: Limits
) -> Question:
    """Return the question of these explanations, with the logarithms of their weights."""
    return Question(
        asked,
        np.exp(weights - np.logaddexp.reduce(weights)).tolist(),
        known.explanations[NONE],
        known.error,
        limits,
        float(np.clip(np.mean(known.diagnosis.problem.u), limits.low, limits.high)),
    )


def _shortest(known: Knowledge, settings: Settings, options: Options) -> float:
    """Return the duration (s) of the shortest record that a diagnosis can split."""
    interval = known.diagnosis.problem.interval
    samples = shortest_record(known.diagnosis.split.spacing) * _SPARE
    needed = samples * interval + settings.warm_up
    if needed > options.duration:
        raise InputError(
            f"a designed record of {options.duration:g} s is too short for the slowest time"
            f" constant of the device: {needed:.3g} s are needed",
            field="resolution.duration",
            remedy="Raise it, or give the case a shorter `split.slowest_time`",
        )
    return needed


def learnt(
    known: Knowledge,
    record: "Record | xr.Dataset",
    simulation: Simulation,
    settings: Settings,
    options: Options,
    workers: int,
) -> tuple[Knowledge, dict[str, float]]:
    """Return what is known after a further record, and the density that each hypothesis gave it."""
    samples = signals_of(record, simulation)
    error, beyond = _errors_on(known, samples)
    told = {name: predicted(each, samples, error) for name, each in known.explanations.items()}
    log_densities = {name: each.log_density for name, each in told.items()}
    log_densities[ANOTHER] = _not_offered(known, samples, log_densities, beyond)
    posterior = known.posterior.after(log_densities)
    records = (*known.records, record)
    offered = replace(settings, effects=_offered(known, posterior, settings, options))
    found = diagnose(records, simulation, settings=offered, workers=workers)
    now = _law_error(found)
    fitted = _explanations(found, now.seen)
    shares = _shares(found)
    new = {name: share for name, share in shares.items() if name not in posterior.now}
    posterior = posterior.with_new(_parts(new), ANOTHER)
    explanations = {name: each.informed for name, each in told.items()} | {
        name: each for name, each in fitted.items() if name in posterior.now
    }
    driven = known.driven + samples.u.size * samples.interval
    after = Knowledge(records, found, explanations, posterior, now, driven)
    outcome = after.outcome(options.level)
    withdrawn = outcome if outcome in _WITHOUT_NAME else None
    return replace(after, withdrawn=withdrawn), log_densities


def _parts(shares: Mapping[str, float]) -> dict[str, float]:
    """Return the parts of what another explanation has that go to these new ones."""
    total = sum(shares.values())
    # A share may be so small that nothing can be divided by it.
    parts = {name: share / total for name, share in shares.items() if share > 0.0}
    return {name: _TO_NEW * part for name, part in parts.items() if part > 0.0}


def _not_offered(
    known: Knowledge,
    samples: Samples,
    log_densities: Mapping[str, float],
    errors: Sequence[Error],
) -> float:
    """Return the density that an explanation which is not offered gives a record, as a logarithm.

    It predicts as any of those that are offered, by their probabilities, with any of these larger
    ``errors``. Of this sum the terms of the leading one and of the one that predicted best are
    taken, which are most of it. One that diverges on the record says nothing.
    """
    before = known.posterior.log_now
    finite = [name for name, value in log_densities.items() if np.isfinite(value)]
    shown = finite or list(log_densities)
    whole = np.logaddexp.reduce([before[name] for name in shown])
    near = {max(shown, key=before.__getitem__), max(shown, key=log_densities.__getitem__)}
    terms = [
        before[name] - whole + predicted(known.explanations[name], samples, error).log_density
        for name in sorted(near)  # in the same order in every process, whose sums then agree
        for error in errors
    ]
    return float(np.logaddexp.reduce(terms) - np.log(len(errors)))


def _offered(
    known: Knowledge, posterior: Posterior, settings: Settings, options: Options
) -> tuple[str, ...]:
    """Return the effects of the hypotheses that are left; all while another one may be right.

    All, too, where none of those that are left has one, or where the verdict so far leaves more
    than a right one would.
    """
    left = posterior.left(options.level)
    verdict = known.verdict
    if ANOTHER in left or verdict.status == Status.UNKNOWN or not verdict.whole:
        return settings.effects
    effects = frozenset[str]().union(*(known.explanations[name].effects for name in left))
    return tuple(sorted(effects)) or settings.effects


def _certified(
    found: Resolution,
    desk: Desk,
    simulation: Simulation,
    limits: Limits,
    settings: Settings,
    options: Options,
) -> Resolution:
    """Certify on a fresh record, whose excitation was chosen by chance; it can withdraw a name."""
    diagnosis = found.last.diagnosis
    if not transferable(diagnosis.final.extended):
        return found
    design = desk.design(CERTIFICATE, partial(fresh_design, found.last, limits, settings, options))
    if design is None:
        return replace(found, halted=f"The name is not certified: {_NOWHERE}")
    record = desk.record(CERTIFICATE, design.u)
    if record is None:
        return replace(found, pending=CERTIFICATE)
    other = {"fresh": signals_of(record, simulation)}
    certified = certify_elsewhere(other, diagnosis.nominal, diagnosis.final)["fresh"]
    if certified.worse(diagnosis.decision.noise(diagnosis.rules, diagnosis.floor)):
        last = found.rounds[-1]
        after = replace(last.after, withdrawn=Outcome.CONTRADICTED)
        rounds = (*found.rounds[:-1], replace(last, after=after))
        found = replace(found, rounds=rounds, outcome=Outcome.CONTRADICTED)
    return replace(found, certificate=certified)


def fresh_design(
    known: Knowledge, limits: Limits, settings: Settings, options: Options
) -> Design | None:
    """Return an excitation drawn at random, of which the hypotheses that are left expect no harm.

    Nothing where none of a few draws keeps their outputs in range.
    """
    rng = _generator(settings, CERTIFICATE)
    left = sorted(known.posterior.left(options.level) - {ANOTHER})
    asked = [known.explanations[name] for name in left]
    question = _question(known, asked, np.zeros(len(asked)), limits)
    for _ in range(_DRAWS):
        u = express(rng.random(genes()), 0.5 * options.duration, limits)
        design = question.judged(u, "free")
        if design is not None:
            return design
    return None


def _explanations(found: Diagnosis, error: Error) -> dict[str, Explanation]:
    """Return the simulation alone and every candidate that may be right, by their names.

    These are the candidates that were weighed, those that the verdict speaks of, and every single
    effect that was fitted to the end.
    """
    decision = found.decision
    candidates = [
        *found.presence.candidates,
        *([decision.chosen] if decision.chosen else []),
        *decision.rivals,
        *(c for c in found.singles.candidates if c.finished),
    ]
    explanations = {NONE: explained(found.nominal, error)}
    for candidate in candidates:
        if _name(candidate) not in explanations:
            explanations[_name(candidate)] = explained(candidate.fit, error)
    return explanations


def _name(candidate: Candidate) -> str:
    return "+".join(sorted(candidate.labels))


def _shares(found: Diagnosis) -> dict[str, float]:
    """Return the weight that each explanation has by the records of a diagnosis."""
    pairs = zip(found.presence.candidates, found.presence.weights, strict=True)
    shares = {_name(candidate): float(weight) for candidate, weight in pairs}
    return shares | {NONE: max(0.0, 1.0 - sum(shares.values()))}


def _law_error(found: Diagnosis) -> LawError:
    """Return the error of a right explanation: one that left more would not be called right.

    It may be as slow as what the simulation alone leaves, and as fast as the device has moved.
    """
    simulated = found.problem.y - found.nominal.residual
    motion = Motion.of(*(simulated[samples] for samples in found.nominal.records))
    unexplained = misfit(found.problem.seen_rmse(found.nominal.residual), found.floor)
    left = min(found.error.left, found.rules.misfit * unexplained)
    fastest = max(motion.size / motion.pace, 1.0) if motion.pace else 1.0
    slowest = max(found.error.memory, memory_of(found.nominal.residual), fastest)
    seen = Error(found.error.white, left, slowest, fastest)
    return LawError(seen, motion, found.rules.law_error, unexplained, found.rules.misfit)


def _errors_on(known: Knowledge, samples: Samples) -> Errors:
    """Return the errors on a record, from its excitation and what was known before it."""
    names = list(known.explanations)
    outputs = [known.explanations[n].simulated(samples.u, samples.interval) for n in names]
    without = outputs[names.index(NONE)]
    return known.error.on(outputs, [known.posterior.now[n] for n in names], without)


def _generator(settings: Settings, number: int) -> np.random.Generator:
    return generator(settings.seed, settings.name, "resolve", str(number))
