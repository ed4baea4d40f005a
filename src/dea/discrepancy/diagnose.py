"""Name what a simulation is missing, from a record of the device it describes."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dea.discrepancy.decision import (
    Decision,
    Status,
    best_extension,
    confirmed,
    decide,
    proven_alone,
    share_of,
    sure_alone,
    with_priors_checked,
    without_small_drift,
)
from dea.discrepancy.diagnosis import Diagnosis
from dea.discrepancy.evidence.bootstrap import Gains, gains
from dea.discrepancy.evidence.certificate import (
    Certificate,
    certify,
    certify_elsewhere,
)
from dea.discrepancy.evidence.colour import coloured_level
from dea.discrepancy.evidence.confusion import confusion
from dea.discrepancy.evidence.contributions import contributions, ladder
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.evidence.identifiability import most_visible
from dea.discrepancy.evidence.localisation import localise
from dea.discrepancy.evidence.model_error import ModelError, model_error
from dea.discrepancy.evidence.modulation import modulated_wave
from dea.discrepancy.evidence.null import null_gain
from dea.discrepancy.evidence.occam import log_prior, log_volume
from dea.discrepancy.evidence.presence import (
    Presence,
    presence,
)
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.evidence.transfer import leave_one_out, record_names
from dea.discrepancy.evidence.unknown_force import unknown_force
from dea.discrepancy.findings import Ladder, Singles, Where
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.estimation import at_its_error, on_whole_record, with_its_error
from dea.discrepancy.fitting.events import with_events_dated
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.fitting.parallel import in_parallel
from dea.discrepancy.problem.problem import Problem, Samples
from dea.discrepancy.problem.records import prepare, signals_of
from dea.discrepancy.search.degenerate import unfinish_degenerate
from dea.discrepancy.search.not_offered import NotOffered, never_tried, places
from dea.discrepancy.search.rounds import Round
from dea.discrepancy.search.search import Search, noise_floor, pool_of
from dea.discrepancy.search.starts import bases, fit_near_prior, fit_nominal
from dea.discrepancy.settings import Settings
from dea.errors import InputError
from dea.progress import tell
from dea.seeds import generator
from dea.simulation import (
    Effect,
    ExtendedSimulation,
    Simulation,
    catalogue,
    load_simulation,
)

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

# Leading candidates that are weighed against each other, and rivals whose confusion is shown. Both
# were chosen, not measured.
_WEIGHED, _SHOWN = 14, 8
# Samples whose simulation takes much longer than a thread needs to start: those that candidates are
# fitted on are too few at the end of a list.
_LONG = 10_000


def diagnose(
    record: "Record | xr.Dataset | Sequence[Record | xr.Dataset]",
    simulation: Simulation | str,
    *,
    test_records: "Mapping[str, Record | xr.Dataset] | None" = None,
    settings: Settings | None = None,
    workers: int = 1,
) -> Diagnosis:
    """Compare a record with a simulation and name the effect, or effects, that are missing.

    Parameters
    ----------
    record
        A :class:`dea.Record`, or a dataset with time (s), voltage and displacement, or input and
        output; in the simulation's units. Of several records of one device each has its own start
        and its own drift; all else is shared.
    simulation
        A simulation, the name of one that comes with the study, or a Python file.
    test_records
        Records of the same device under other excitations, by name, to certify on: they can
        withdraw an answer, but choose none.
    settings
        :class:`dea.discrepancy.Settings`: which effects are offered, the slowest time constant of
        the device, how far the search goes.
    workers
        Threads that candidates are fitted on; the result does not depend on it.

    Returns
    -------
    Diagnosis
        ``verdict`` says what is missing, ``final`` is the simulation fitted to the whole record,
        with the effects that are named.

    Raises
    ------
    InputError
        If units do not match, no output of a record is known, the record is too short for the
        split, the simulation diverges, or an argument is of another kind.
    """
    if workers < 1:
        raise InputError(f"it is {workers}", field="workers", remedy="Give at least one")
    settings = Settings() if settings is None else settings
    if not isinstance(settings, Settings):
        raise InputError(
            f"it is {type(settings).__name__}",
            field="settings",
            remedy="Give dea.discrepancy.Settings(effects=…), or none",
        )
    rules = settings.rules
    own = simulation if isinstance(simulation, Simulation) else load_simulation(simulation)
    rng = generator(settings.seed, settings.name, "diagnose")
    records = _signals(_listed(record), own)
    others = _tested_all({} if test_records is None else test_records, own, len(records))
    offered = _offered(settings.effects)

    # Split the record, and fit the simulation alone.
    tell("the simulation alone")
    problem, parts, bare = prepare(records, own, settings)
    if problem.size >= _LONG:
        problem = replace(problem, threads=workers)
    budget = settings.budget.of(problem.recorded_samples, problem.oversampled)
    nominal = fit_nominal(problem, bare, budget.starts, rng, workers)
    near = fit_near_prior(problem, nominal)

    # Fit candidates, which also show the noise floor.
    starts = bases(problem, nominal, near, rng)
    blocks = problem.blocks(max(problem.size / settings.blocks, parts.spacing))
    rounds = Search(problem, starts, offered, budget, rules, workers, blocks).rounds()
    if not rounds[0].candidates:
        raise InputError(
            "none of the effects offered can attach to this simulation and stay stable",
            file=own.source or f"simulation {own.name}",
            field="force_ports",
            remedy="Declare its force ports, or offer effects of other ports",
        )
    white = noise_floor(problem, rounds)
    rounds = unfinish_degenerate(problem, rounds, rules, white, workers)
    singles, pool = rounds[0].candidates, pool_of(rounds)

    # Collect evidence.
    evidence = Evidence(problem, nominal, HeldOut(problem), blocks, white, own.accuracy, rules, rng)
    evidence = replace(evidence, coloured_level=coloured_level(evidence, pool))
    gained = _gains(evidence, nominal, singles, workers)
    weighed, error = _weighed(evidence, pool, _count(problem, bare, offered))
    proven = proven_alone(rounds, gained, rules) or sure_alone(evidence, rounds, weighed)
    chosen = best_extension(evidence, rounds, proven)

    # Decide, and withdraw what samples not used so far contradict.
    decided = decide(evidence, chosen, pool, proven, weighed)
    decided = without_small_drift(decided, evidence, pool)
    decided = with_priors_checked(decided, evidence, others, workers)
    tell("the answer on samples not used so far")
    decision, final, certificate = _certified(evidence, decided, others, workers)

    # Describe.
    where = Where(
        *(
            localise(problem, each.residual, own.inputs, own.output_unit, problem.seen, rng)
            for each in (near, final)
        )
    )
    noisy = problem.with_noise(evidence.floor)
    rungs = ladder(evidence, nominal, final, pool)
    nameless = decision.status is Status.UNKNOWN
    visible = (most_visible(noisy, nominal, c.fit, rules.detectable) for c in singles)
    return Diagnosis(
        problem=noisy,
        split=parts,
        nominal=nominal,
        extended=final,
        final=on_whole_record(problem, final, rules.clean) if decision.answer else final,
        spread=evidence.held_out.spread(final),
        singles=Singles(singles, gained, tuple(visible)),
        pool=tuple(pool),
        decision=decision,
        ladder=Ladder(tuple(rungs), tuple(contributions(evidence, rungs, final, singles, gained))),
        where=where,
        unexplained=residual_model(problem, final.residual),
        force=unknown_force(problem, nominal) if nameless else None,
        modulated=modulated_wave(problem, pool, rules) if nameless else None,
        confusion=confusion(noisy, _rivals_to_show(decision, pool)),
        certificate=certificate,
        noise_floor=white,
        coloured_level=evidence.coloured_level,
        floor=evidence.floor,
        stated_floor=evidence.stated_floor,
        presence=weighed,
        error=error,
        share=share_of(evidence, final) if decision.answer else None,
        rules=rules,
        not_offered=not_offered(rounds, offered),
    )


def _certified(
    evidence: Evidence, decided: Decision, others: Mapping[str, Samples], workers: int
) -> tuple[Decision, Fit, Certificate]:
    """Return the decision that samples not used so far leave, its fit, and the errors on them.

    Where they contradict it, that is the fit of the simulation alone.
    """
    problem, nominal, clean = evidence.problem, evidence.nominal, evidence.rules.clean

    def alone() -> Certificate:
        elsewhere = certify_elsewhere(others, nominal, nominal)
        return Certificate(certify(problem, nominal, nominal), elsewhere)

    if decided.answer is None:
        certificate = alone()
        return confirmed(decided, evidence, nominal, {}, certificate.records), nominal, certificate
    dated = with_events_dated(problem, decided.answer.fit)
    by_date = dated is not decided.answer.fit
    final = at_its_error(problem, dated, clean, workers)
    left_out = {}
    if len(problem.records) > 1:
        left_out = leave_one_out(with_its_error(problem, final, clean), nominal, final)
    tested = certify_elsewhere(others, nominal, final)
    decision = confirmed(decided, evidence, final, left_out, tested, by_date)
    if decision.answer is not decided.answer:
        return decision, nominal, alone()
    block = certify(problem, nominal, final)
    return decision, final, Certificate(block, left_out | tested, by_date)


def _tested_all(
    records: "Mapping[str, Record | xr.Dataset]", simulation: Simulation, diagnosed: int
) -> dict[str, Samples]:
    if not isinstance(records, Mapping):
        raise InputError(
            f"it is {type(records).__name__}",
            field="test_records",
            remedy='Give them by name, as {"second": record}',
        )
    taken = [name for name in records if diagnosed > 1 and name in record_names(diagnosed)]
    if taken:
        raise InputError(
            "that is the name of a record which is diagnosed",
            field=f"test_records.{taken[0]}",
            remedy="Give it another name",
        )
    return {name: _tested(name, record, simulation) for name, record in records.items()}


def _tested(name: str, record: "Record | xr.Dataset", simulation: Simulation) -> Samples:
    """Return the signals of a test record, which an error names."""
    field = f"test_records.{name}"
    if not _is_record(record):
        raise InputError(
            f"it is {type(record).__name__}",
            field=field,
            remedy="Give a dea.Record, or a dataset; dea.Record.of makes one",
        )
    return _signals_at(field, record, simulation)


def _listed(
    record: "Record | xr.Dataset | Sequence[Record | xr.Dataset]",
) -> "list[Record | xr.Dataset]":
    single = _is_record(record) or not isinstance(record, list | tuple)
    given: list[Any] = [record] if single else list(record)
    for number, each in enumerate(given, start=1):
        if not _is_record(each):
            of_list = "" if single else f"{type(record).__name__}, of which record {number} is "
            raise InputError(
                f"it is {of_list}{type(each).__name__}",
                field="record",
                remedy="Give a dea.Record, a dataset, or a list of them; dea.Record.of makes one",
            )
    return given


def _signals(given: "Sequence[Record | xr.Dataset]", simulation: Simulation) -> list[Samples]:
    """Return the signals of the records; of several, an error tells the number of its own."""
    if len(given) == 1:
        return [signals_of(given[0], simulation)]
    numbered = enumerate(given, start=1)
    return [_signals_at(f"record {number}", each, simulation) for number, each in numbered]


def _signals_at(field: str, record: "Record | xr.Dataset", simulation: Simulation) -> Samples:
    """Return the signals of a record, which an error tells by its ``field``."""
    try:
        return signals_of(record, simulation)
    except InputError as error:
        within = ".".join(filter(None, (field, error.field)))
        raise error.at(field=within) from None


def _is_record(given: object) -> bool:
    import xarray as xr

    from dea.store import Record

    return isinstance(given, Record | xr.Dataset)


def _offered(names: Sequence[str]) -> list[Effect]:
    unknown = sorted(set(names) - set(catalogue()))
    if unknown:
        raise InputError(
            f"there is no effect {unknown[0]!r}",
            field="effects",
            remedy=f"Known are {', '.join(catalogue())}",
        )
    return [effect for name, effect in catalogue().items() if not names or name in names]


def not_offered(rounds: Sequence[Round], offered: Sequence[Effect]) -> tuple[NotOffered, ...]:
    """Return what was never tried, alone or beside another effect; what settings leave out last."""
    left_out = [
        NotOffered.by_settings(effect) for effect in catalogue().values() if effect not in offered
    ]
    candidates = [c for each in rounds for c in each.candidates]
    return (*never_tried(rounds[0].skipped, candidates), *left_out)


def _count(problem: Problem, extended: ExtendedSimulation, offered: Sequence[Effect]) -> int:
    """Return how many effects are offered, where one is another at another input."""
    return sum(len(places(problem, extended, each)[0]) if each.on_input else 1 for each in offered)


def _gains(evidence: Evidence, nominal: Fit, singles: Sequence[Candidate], workers: int) -> Gains:
    """Return the gains of the single effects on held-out blocks, and that of chance."""
    problem, held_out, blocks = evidence.problem, evidence.held_out, evidence.blocks
    fits = [c.fit for c in singles]
    null = null_gain(problem, nominal, fits, singles[0].fit.residual, blocks, evidence.rng)
    after = in_parallel(
        lambda c: held_out.residual(c.fit) if c.finished else c.fit.residual,
        singles,
        workers,
        "single effects on blocks left out",
    )
    # Nothing is held out of a candidate that is not finished, and may not be named: both residuals
    # are then of fits to the same blocks.
    before = [
        held_out.residual(nominal, c.fit) if c.finished else nominal.residual for c in singles
    ]
    return gains(before, after, blocks, null, evidence.rng)


def _weighed(
    evidence: Evidence, pool: Sequence[Candidate], offered: int
) -> tuple[Presence, ModelError]:
    """Return the weights of the leading candidates, and the error that the best of them leaves."""
    leading = [c for c in pool if c.finished][:_WEIGHED]
    nominal, seen, rules = evidence.nominal, evidence.problem.seen, evidence.rules
    best = min(
        (nominal, *(c.fit for c in leading)), key=lambda f: evidence.problem.seen_rmse(f.residual)
    )
    error = model_error(
        nominal.residual[seen],
        best.residual[seen],
        evidence.noise_floor,
        rules.law_error,
        evidence.accuracy,
    )
    alone, *volumes = (
        log_volume(each, seen, error.density, rules.shaped)
        for each in (nominal, *(c.fit for c in leading))
    )
    odds = log_prior(leading, offered, rules.at_bound) + np.array(volumes) - alone
    weighed = presence(nominal.residual, leading, evidence.blocks, error, odds, evidence.rng)
    return weighed, error


def _rivals_to_show(decision: Decision, pool: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the best finished candidates of as many effects as the chosen one, best first."""
    count = len(decision.chosen.names) if decision.chosen else 1
    shown: dict[frozenset[str], Candidate] = {}
    for c in pool:
        if c.finished and len(c.names) == count:
            shown.setdefault(c.effects, c)
    return tuple(shown.values())[:_SHOWN]
