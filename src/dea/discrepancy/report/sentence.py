"""Put a diagnosis into words and numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from dea.discrepancy.decision import Decision
from dea.discrepancy.evidence.certificate import Certified, certify
from dea.discrepancy.evidence.experiment import Experiment
from dea.discrepancy.evidence.gain import Gains, HeldOut, gains
from dea.discrepancy.evidence.identifiability import DETECTABLE
from dea.discrepancy.evidence.localisation import Localisation
from dea.discrepancy.evidence.residual_model import ResidualModel
from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem, rmse
from dea.discrepancy.report.verdict import Estimate, NamedEffect, Verdict
from dea.discrepancy.search.rounds import Round


def estimates(problem: Problem, fit: Fit, index: int) -> dict[str, Estimate]:
    """Return the free parameters of the attached effect ``index`` with 95 % intervals.

    Those come first of which the record says most (beyond the prior), and last those that only
    shape the law.

    The residual's own correlation widens the intervals: its variance is multiplied by the sum of
    its autocorrelation.
    """
    extended = fit.extended
    where = extended.effect_slices[index]
    residual = fit.residual[problem.seen]
    spectrum = np.abs(np.fft.rfft(residual - residual.mean(), 2 * residual.size)) ** 2
    correlation = np.fft.irfft(spectrum)[: residual.size // 4]
    correlation /= correlation[0] or 1.0
    # Summed up to the first crossing of zero (Geyer 1992).
    crossing = int(np.argmax(correlation <= 0)) or correlation.size
    inflation = 1.0 + 2.0 * float(np.sum(correlation[1:crossing]))
    variance = float(np.mean(residual**2)) * inflation
    deviation = np.sqrt(np.diag(fit.covariance(problem.seen, variance)))
    values = fit.values
    own = [k for k, i in enumerate(extended.free) if where.start <= i < where.stop]
    result = {}
    for position in sorted(own, key=lambda k: (extended.shapes[k], deviation[k])):
        i = extended.free[position]
        parameter = extended.parameters[i]
        ends = [
            parameter.value(fit.coordinates[position] + side * 1.96 * deviation[position])
            for side in (-1.0, 1.0)
        ]
        name = parameter.name.split(".", 1)[1]
        result[name] = Estimate(float(values[i]), parameter.unit, min(ends), max(ends))
    return result


def verdict_of(
    *,
    problem: Problem,
    nominal: Fit,
    decision: Decision,
    first: Round,
    gained: Gains,
    held_out: HeldOut,
    before: Localisation,
    after: Localisation,
    floor: float,
    unexplained: ResidualModel,
    experiment: Experiment | None,
    signatures: Mapping[str, tuple[float, float]],
    elsewhere: Mapping[str, Certified],
    unit: str,
    blocks: Sequence[slice],
    rng: np.random.Generator,
) -> Verdict:
    """Return the verdict with its sentence; ``blocks`` hold the samples seen."""
    named = decision.status in ("named", "ambiguous") and decision.chosen is not None
    final = decision.chosen.fit if named and decision.chosen else nominal
    certified = certify(problem, nominal, final)
    rungs = _rungs(held_out, nominal, final, first)
    effects = _effects(problem, decision, rungs, first, gained, blocks, rng) if named else ()
    return Verdict(
        status=decision.status,
        sentence=_sentence(
            decision, effects, before, certified, floor, unexplained, experiment, unit
        ),
        effects=effects,
        where={
            "before": before.sentence,
            "after": after.sentence,
            "along": before.strongest,
            "along_after": after.strongest,
        },
        noise_floor=floor,
        certified={
            "rmse_before": certified.before,
            "rmse_after": certified.after,
            "samples": certified.samples,
            "records": {name: asdict(value) for name, value in elsewhere.items()},
        },
        unit=unit,
        ladder={name: rmse(residual, problem.seen) for name, residual in rungs}
        | {"noise floor": floor},
        experiment=asdict(experiment) if experiment else None,
        equation=unexplained.equation if decision.status == "unknown" else None,
        not_identifiable=tuple(name for name, (size, _) in signatures.items() if size < DETECTABLE),
    )


def _rungs(
    held_out: HeldOut, nominal: Fit, final: Fit, first: Round
) -> list[tuple[str, np.ndarray]]:
    """Return held-out gaps of the nominal simulation, of its first effect alone, and of all."""
    labels = [final.extended.label(a) for a in final.extended.attached]
    rungs = [("nominal", nominal)]
    if len(labels) > 1:
        alone = (labels[0],)
        rungs += [(f"+ {labels[0]}", c.fit) for c in first.candidates if c.labels == alone]
    if labels:
        rungs.append((f"+ {labels[-1]}", final))
    return [(name, held_out.residual(fit)) for name, fit in rungs]


def _effects(
    problem: Problem,
    decision: Decision,
    rungs: Sequence[tuple[str, np.ndarray]],
    first: Round,
    gained: Gains,
    blocks: Sequence[slice],
    rng: np.random.Generator,
) -> tuple[NamedEffect, ...]:
    assert decision.chosen is not None
    final = decision.chosen.fit
    rivals = tuple("+".join(rival.names) for rival in decision.rivals)
    singles = [c.labels for c in first.candidates]
    result = []
    for index, attached in enumerate(final.extended.attached):
        last = min(index + 1, len(rungs) - 1)
        before, after = (residual for _, residual in rungs[last - 1 : last + 1])
        if len(final.extended.attached) == 1:
            found, at = gained, singles.index((final.extended.label(attached),))
        else:
            found, at = gains(before, [after], blocks, 0.0, rng), 0
        result.append(
            NamedEffect(
                name=attached.effect.name,
                port=str(attached.effect.port),
                family=str(attached.effect.family),
                parameters=estimates(problem, final, index),
                gap_before=rmse(before, problem.seen),
                gap_after=rmse(after, problem.seen),
                gain=(float(found.gain[at]), float(found.low[at]), float(found.high[at])),
                rivals=rivals,
                balance=final.extended.force_port_of(attached),
            )
        )
    return tuple(result)


def _sentence(
    decision: Decision,
    effects: tuple[NamedEffect, ...],
    before: Localisation,
    certified: Certified,
    floor: float,
    unexplained: ResidualModel,
    experiment: Experiment | None,
    unit: str,
) -> str:
    place = before.sentence[0].upper() + before.sentence[1:]
    proof = (
        f"the error on samples kept for proof falls from {certified.before:.3g} to "
        f"{certified.after:.3g} {unit}, noise floor {floor:.3g} {unit}"
    )
    if decision.status == "none":
        return (
            f"Nothing is missing that this record could show: {decision.reason} "
            f"(error {certified.before:.3g} {unit}, noise floor {floor:.3g} {unit})."
        )
    if decision.status == "unknown":
        return (
            f"{place}. Something is missing, but {decision.reason}: error {certified.before:.3g} "
            f"{unit}, noise floor {floor:.3g} {unit}. The best equation for what is left: "
            f"{unexplained.equation} (explains {100 * unexplained.explained:.0f} %)."
        )
    laws = " and ".join(f"`{effect.name}`{_place(effect)} ({_main(effect)})" for effect in effects)
    if decision.status == "ambiguous":
        other = " or ".join(effects[0].rivals)
        advice = (
            f" To separate them, run a {experiment.kind} excitation of {experiment.duration:.3g} s "
            f"between {experiment.low:.3g} and {experiment.high:.3g}."
            if experiment
            else ""
        )
        return f"{place}. It is {laws}, or {other}: {proof}.{advice}"
    akin = effects[0].rivals
    doubt = f" (in this record {' or '.join(akin)} of its class would do as well)" if akin else ""
    return f"{place}: {laws}{doubt}; {proof}."


def _place(effect: NamedEffect) -> str:
    if effect.balance is None:
        return ""
    giver, _, taker = effect.balance.replace("_", " ").partition(">")
    return f" from {giver} to {taker}" if taker else f" at {giver}"


def _main(effect: NamedEffect) -> str:
    """Say the two parameters of which the record says most."""
    return ", ".join(
        f"{name.replace('_', ' ')} {e.value:.3g} ± {0.5 * (e.high - e.low):.2g}"
        + (f" {e.unit}" if e.unit != "1" else "")
        for name, e in list(effect.parameters.items())[:2]
    )
