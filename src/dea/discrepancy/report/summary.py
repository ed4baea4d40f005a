"""Summarise a diagnosis as a verdict."""

from dataclasses import asdict
from itertools import pairwise

import numpy as np

from dea.discrepancy.decision import Status
from dea.discrepancy.findings import Findings
from dea.discrepancy.problem.problem import rmse
from dea.discrepancy.report.estimates import estimates, estimates_beyond_priors, quantities, quoted
from dea.discrepancy.report.remarks import remainder, remarks
from dea.discrepancy.report.sentence import (
    law_too_poor,
    rivals_told,
    verdict_sentence,
    where_sentence,
)
from dea.discrepancy.report.verdict import Bend, Change, NamedEffect, Verdict
from dea.discrepancy.rules import misfit
from dea.simulation import Family, LawCourse, Port, law_courses


def verdict_of(found: Findings) -> Verdict:
    """Return the verdict with its sentence."""
    effects = _effects(found) if found.decision.answer else ()
    block, where = found.certificate.block, found.where
    seen = found.problem.seen
    rungs = {
        "nominal" if rung.label is None else f"+ {rung.label}": rmse(rung.residual, seen)
        for rung in found.ladder.rungs
    }
    unfinished = found.decision.status is Status.UNKNOWN or found.decision.whole is False
    notes = (remainder(found), *remarks(found))
    return Verdict(
        status=str(found.decision.status),
        sentence=verdict_sentence(found, effects, notes),
        effects=effects,
        where={
            "before": where_sentence(where.before),
            "after": where_sentence(where.after),
            "along": where.before.strongest,
            "along_after": where.after.strongest,
        },
        noise_floor=found.noise_floor,
        certified={
            "rmse_before": block.before,
            "rmse_after": block.after,
            "samples": block.samples,
            "records": {name: asdict(each) for name, each in found.certificate.records.items()},
            "contradicted": {
                name: asdict(each) for name, each in found.decision.contradicted.items()
            },
        },
        unit=found.units[1],
        ladder=rungs | {"noise floor": found.noise_floor},
        equation=found.unexplained.equation if unfinished else None,
        predictable=found.unexplained.predicted,
        not_identifiable=tuple(
            label
            for candidate, visible in zip(
                found.singles.candidates, found.singles.visibility, strict=True
            )
            if candidate.finished and visible.size < found.rules.detectable
            for label in candidate.labels
        ),
        whole=found.decision.whole,
        law_too_poor=law_too_poor(found),
        beyond_priors=estimates_beyond_priors(found),
        share=asdict(found.share) if found.share else None,
        presence={"effects": found.presence.effects, "families": found.presence.families},
        model_error=asdict(found.error) | {"level": found.error.level},
        coloured_level=found.coloured_level,
        remarks=notes,
        not_offered=found.not_offered,
    )


def _effects(found: Findings) -> tuple[NamedEffect, ...]:
    extended = found.extended.extended
    rivals = tuple(rival.names for rival in rivals_told(found))
    result = []
    for index, (attached, part, part_removed) in enumerate(
        zip(extended.attached, found.ladder.contributions, _shares(found), strict=True)
    ):
        place = extended.places.force_port_of(attached) or extended.places.input_of(attached)
        parameters = estimates(found.final, index, found.uncertainty.deviation)
        result.append(
            NamedEffect(
                name=attached.effect.name,
                port=str(attached.effect.port),
                family=str(attached.effect.family),
                parameters=parameters,
                error_before=part.before,
                error_after=part.after,
                gain=(part.gain, part.low, part.high),
                presence=found.presence.effects.get(extended.places.name_of(attached), 0.0),
                rivals=rivals,
                place=place.name if place else None,
                share=part_removed,
                change=_change(found, index),
                bend=_bend(found, index),
                quoted=quoted(attached, parameters),
                quantities=quantities(found.final, index, found.uncertainty.covariance),
            )
        )
    return tuple(result)


def _change(found: Findings, index: int) -> Change | None:
    """Return what the effect ``index`` makes of a quantity in the course of a single record."""
    extended, effect = found.final.extended, found.final.extended.attached[index].effect
    if effect.port is not Port.TIME or effect.family is not Family.AGEING or extended.records > 1:
        return None
    course = _course(found, index)
    if course is None:
        return None
    start, end = (float(each) for each in course.value.values[[0, -1]])
    return Change(course.value.name, course.value.unit, start, end)


def _bend(found: Findings, index: int) -> Bend | None:
    """Return how much the effect ``index`` bends, if it is a curve of the reading."""
    effect = found.final.extended.attached[index].effect
    curve = effect.port is Port.OUTPUT and effect.family is Family.CURVE
    course = _course(found, index) if curve else None
    if course is None:
        return None
    along, value = course.along.values[found.problem.seen], course.value.values[found.problem.seen]
    line = np.polynomial.Polynomial.fit(along, value, 1)
    departure = value - line(along)
    most = int(np.argmax(np.abs(departure)))
    return Bend(
        course.value.name,
        course.value.unit,
        float(departure[most]),
        course.along.name,
        course.along.unit,
        float(along[most]),
        float(line.deriv()(0.0)),
    )


def _course(found: Findings, index: int) -> LawCourse | None:
    problem, final = found.problem, found.final
    return law_courses(final.extended, final.values, problem.u, problem.interval)[index]


def _shares(found: Findings) -> list[float | None]:
    """Return what each effect contributes to the share of all, one after the other."""
    parts, removed = found.ladder.contributions, found.share
    if removed is None or len(parts) != len(found.ladder.rungs) - 1:
        return [None] * len(parts)
    left = [misfit(error, found.floor) for error in (parts[0].before, *(p.after for p in parts))]
    if left[0] <= left[-1]:
        return [None] * len(parts)
    return [
        removed.value * (before - after) / (left[0] - left[-1]) for before, after in pairwise(left)
    ]
