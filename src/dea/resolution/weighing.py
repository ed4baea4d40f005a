"""How probable each explanation is: by the first diagnosis, and by every further record."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dea.discrepancy import (
    Candidate,
    Diagnosis,
    Samples,
    Settings,
    Status,
    diagnose,
    memory_of,
    misfit,
    signals_of,
)
from dea.effect_label import joined
from dea.errors import InputError
from dea.resolution.error import Error
from dea.resolution.explanation import NONE, Explanation, explanation_of
from dea.resolution.knowledge import ANOTHER, WITHOUT_NAME, Inquiry, Knowledge, Options
from dea.resolution.law_error import Errors, LawError, Motion
from dea.resolution.posterior import Posterior
from dea.resolution.prediction import predicted

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

# Part of the prior that all hypotheses share equally: the laws of a first record are never quite
# right, and its evidence may be too sure.
_EQUAL = 0.2
# Part of what another explanation has that goes to explanations found later.
_TO_NEW = 0.5


def begun(records: "Sequence[Record | xr.Dataset]", inquiry: Inquiry) -> Knowledge:
    """Return what is known before any designed record: the diagnosis gives hypotheses and prior.

    Raises
    ------
    InputError
        If the simulation has several inputs, as well as for what the diagnosis refuses.
    """
    simulation = inquiry.simulation
    if len(simulation.inputs) > 1:
        raise InputError(
            "further records can be designed for one input only, and it has"
            f" {len(simulation.inputs)}",
            file=simulation.source or f"simulation {simulation.name}",
            field="input_name",
            remedy="Diagnose its records together, under `records:` of the case",
        )
    found = diagnose(records, simulation, settings=inquiry.settings, workers=inquiry.workers)
    explanations = _explanations(found)
    prior = _prior(_shares(found), list(explanations), inquiry.options.another)
    return Knowledge(tuple(records), found, explanations, Posterior.of(prior), _law_error(found))


def learnt(
    known: Knowledge, record: "Record | xr.Dataset", inquiry: Inquiry
) -> tuple[Knowledge, dict[str, float]]:
    """Return what is known after a further record, and the density that each hypothesis gave it."""
    settings, options = inquiry.settings, inquiry.options
    samples = signals_of(record, inquiry.simulation)
    error, beyond = _errors_on(known, samples)
    told = {name: predicted(each, samples, error) for name, each in known.explanations.items()}
    log_densities = {name: each.log_density for name, each in told.items()}
    log_densities[ANOTHER] = _not_offered(known, samples, log_densities, beyond)
    posterior = known.posterior.after(log_densities)
    records = (*known.records, record)
    offered = replace(settings, effects=_offered(known, posterior, settings, options))
    found = diagnose(records, inquiry.simulation, settings=offered, workers=inquiry.workers)
    fitted = _explanations(found)
    shares = _shares(found)
    again = _found_anew(known, posterior, found, options) & set(fitted)
    new = {name: shares.get(name, 0.0) for name in fitted if name not in posterior.now}
    new |= dict.fromkeys(again, 1.0)
    posterior = posterior.with_new(_parts(new), ANOTHER)
    explanations = {name: each.informed for name, each in told.items()} | {
        name: each for name, each in fitted.items() if name in posterior.now
    }
    driven = known.driven + samples.u.size * samples.interval
    anew = known.anew | again
    after = Knowledge(records, found, explanations, posterior, _law_error(found), driven, anew=anew)
    outcome = after.outcome(options.level)
    withdrawn = outcome if outcome in WITHOUT_NAME else None
    return replace(after, withdrawn=withdrawn), log_densities


def _found_anew(
    known: Knowledge, posterior: Posterior, found: Diagnosis, options: Options
) -> set[str]:
    """Return the verdict's explanation if only another one is left, and it had been rejected once.

    A fit to the first records may have ended in a minimum that does not predict others. Where all
    records together have the same effects at another one, that is another explanation, which the
    next record judges. One that is rejected again is not offered a third time.
    """
    verdict = found.verdict
    if posterior.left(options.level) != {ANOTHER} or verdict.status != Status.NAMED:
        return set()
    if not verdict.whole or found.decision.chosen is None:
        return set()
    return {_name(found.decision.chosen)} & set(posterior.now) - known.anew


def _prior(shares: Mapping[str, float], names: Sequence[str], another: float) -> dict[str, float]:
    """Return the prior of explanations, those that were dropped left out, and of another one."""
    total = sum(shares.get(name, 0.0) for name in names)
    equal = _EQUAL if total > 0.0 else 1.0
    weights = {name: shares.get(name, 0.0) / (total or 1.0) for name in names}
    prior = {
        name: (1.0 - another) * ((1.0 - equal) * weight + equal / len(names))
        for name, weight in weights.items()
    }
    return prior | {ANOTHER: another}


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

    It predicts as one of those that are offered, weighted by their probabilities, with one of these
    larger ``errors``. Of this sum only the terms of the likeliest one and of the one that predicted
    best are taken, which are most of it. One that diverges on the record does not count.
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
    if ANOTHER in left or verdict.status == Status.UNKNOWN or verdict.whole is False:
        return settings.effects
    effects = {effect for name in left for effect in known.explanations[name].effects}
    return tuple(sorted(effects)) or settings.effects


def _explanations(found: Diagnosis) -> dict[str, Explanation]:
    """Return the simulation alone and every candidate that may be right, by their names.

    These are those that the verdict speaks of, the candidates that were weighed, and every single
    effect that was fitted to the end. Where one leaves no more than a right one may, those that
    leave more are dropped: a drift that is free in every record can fit any short record alone.
    """
    decision = found.decision
    spoken = [*([decision.chosen] if decision.chosen else []), *decision.rivals]
    others = [*found.presence.candidates, *(c for c in found.singles.candidates if c.finished)]
    most = found.rules.misfit * _unexplained(found)
    right = [c for c in (*spoken, *others) if misfit(c.rmse, found.floor) <= most]
    candidates = [*spoken, *right] if right else [*spoken, *others]
    problem, error = found.problem, _error(found)
    explanations = {NONE: explanation_of(found.nominal, problem, error)}
    for candidate in candidates:
        if _name(candidate) not in explanations:
            explanations[_name(candidate)] = explanation_of(candidate.fit, problem, error)
    return explanations


def _name(candidate: Candidate) -> str:
    return joined(sorted(candidate.labels))


def _shares(found: Diagnosis) -> dict[str, float]:
    """Return the weight that each explanation has by the records of a diagnosis."""
    pairs = zip(found.presence.candidates, found.presence.weights, strict=True)
    shares = {_name(candidate): float(weight) for candidate, weight in pairs}
    return shares | {NONE: max(0.0, 1.0 - sum(shares.values()))}


def _motion(found: Diagnosis) -> Motion:
    simulated = found.problem.y - found.nominal.residual
    return Motion.of(*(simulated[samples] for samples in found.nominal.records))


def _error(found: Diagnosis) -> Error:
    """Return the error of a right explanation: one that left more would not be called right.

    It may be as slow as what the simulation alone leaves, and as fast as the device has moved, in
    samples of the diagnosis.
    """
    motion = _motion(found)
    left = min(found.error.left, found.rules.misfit * _unexplained(found))
    left = max(left, found.nominal.extended.simulation.accuracy, found.coloured_level)
    fastest = max(motion.size / motion.pace, 1.0) if motion.pace else 1.0
    slowest = max(found.error.memory, memory_of(found.nominal.residual), fastest)
    return Error(found.error.white, left, slowest, fastest)


def _law_error(found: Diagnosis) -> LawError:
    """Return that error in further records, which are not decimated."""
    factor = found.problem.decimation
    return LawError(
        _error(found).at_rate(factor),
        _motion(found),
        found.rules.law_error,
        _unexplained(found),
        found.rules.misfit,
        factor,
    )


def _unexplained(found: Diagnosis) -> float:
    """Return the misfit of the simulation alone."""
    return misfit(found.problem.seen_rmse(found.nominal.residual), found.floor)


def _errors_on(known: Knowledge, samples: Samples) -> Errors:
    """Return the errors on a record, from its excitation and what was known before it."""
    names = list(known.explanations)
    outputs = [known.explanations[n].simulated(samples.u, samples.interval) for n in names]
    without = outputs[names.index(NONE)]
    return known.error.on(outputs, [known.posterior.now[n] for n in names], without)
