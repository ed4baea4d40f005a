"""A diagnosis in words."""

from collections.abc import Iterable, Mapping, Sequence

from dea.discrepancy.decision import Reason, Status
from dea.discrepancy.evidence.certificate import Certified
from dea.discrepancy.evidence.localisation import Localisation
from dea.discrepancy.evidence.residual_model import ResidualModel
from dea.discrepancy.findings import Findings
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import rmse
from dea.discrepancy.report.estimates import estimates_beyond_priors
from dea.discrepancy.report.lags import common_lag
from dea.discrepancy.report.verdict import Estimate, NamedEffect
from dea.discrepancy.rules import misfit
from dea.effect_label import joined, name_and_place, place_in_words
from dea.number_format import estimate, quantity, share, written_out

# The bin of each quantity that the residual is concentrated in.
_PHRASES: Mapping[str, str] = {
    "time": "between {low:.3g} and {high:.3g} s",
    "input": "where {input} is between {low:.3g} and {high:.3g} {unit}",
    "input_rate": "where {input} changes by {low:.3g} to {high:.3g} {unit}",
    "output": "where the simulated output is between {low:.3g} and {high:.3g} {unit}",
    "output_rate": "where the output moves at {low:.3g} to {high:.3g} {unit}",
    "direction": "while the output is {direction}",
    "reversal": "{low:.3g} to {high:.3g} s after a reversal of the motion",
}
# Percentage of the residual from which an equation for it is worth a sentence.
_LEAST_SHARE = 1.0
# Part of the gap that the best explanation may leave for its effect to be spoken of: one that
# removes little is no hint. The value was chosen.
_LEFT = 0.8
# Presence from which every likely explanation holds an effect.
_SURE = 0.99
# Parameters of an effect that a sentence has room for.
_QUOTED = 2
_DIRECTIONS = ("falling", "still", "rising")


def where_sentence(found: Localisation) -> str:
    """Say where a residual is concentrated."""
    band = found.band
    spectrum = (
        f"{100 * band.part:.0f} % of its energy lies between {band.low:.2g} and {band.high:.2g} Hz"
    )
    bin_ = found.concentration
    if bin_ is None:
        size = f"{found.rms:.3g} {found.unit}"
        nowhere = "is concentrated nowhere"
        if not found.told:
            nowhere = "changes too slowly for the record to say where it is concentrated"
        return f"the residual of {size} (RMS) {nowhere}; {spectrum}"
    place = _PHRASES[bin_.kind].format(
        input=bin_.of,
        low=bin_.low,
        high=bin_.high,
        unit=bin_.unit,
        direction=_DIRECTIONS[bin_.number] if bin_.along == "direction" else "",
    )
    return (
        f"the residual is {bin_.inside:.3g} {found.unit} (RMS) {place}, "
        f"{bin_.elsewhere:.3g} {found.unit} elsewhere; {spectrum}"
    )


def verdict_sentence(
    found: Findings, effects: Sequence[NamedEffect], notes: Sequence[str] = ()
) -> str:
    """Say what a diagnosis found, the finding first; ``effects`` are those that are named."""
    return written_out(" ".join([_finding(found, effects), *notes]))


def _finding(found: Findings, effects: Sequence[NamedEffect]) -> str:
    unit, noise_floor = found.units[1], found.noise_floor
    decision, block, unexplained = found.decision, found.certificate.block, found.unexplained
    place = f"near the simulation's priors {where_sentence(found.where.before)}"
    noise = f"noise floor {noise_floor:.3g} {unit}"
    if decision.status is Status.NONE:
        most = found.rules.noise_like * found.stated_floor
        if decision.reason is Reason.COLOURED and block.before > most:
            return (
                f"Nothing is named, but {block.before / noise_floor:.2g} noise floors remain: "
                f"{decision.reason}, nor anything else that was tested "
                f"(error {block.before:.3g} {unit}, {noise})."
            )
        return (
            f"Nothing is missing that this record could show: {decision.reason} "
            f"(error {block.before:.3g} {unit}, {noise})."
        )
    if decision.freed is not None:
        return f"{_excluding_priors(found, decision.freed)} {place[0].upper()}{place[1:]}."
    if decision.status is Status.UNKNOWN:
        hints = "", ""
        if decision.reason is Reason.ONLY_CERTIFIED:
            elsewhere = found.problem.seen_rmse(found.nominal.residual)
            if elsewhere > found.rules.clean * found.floor:
                return (
                    "Something is missing: on the certified samples the simulation alone has an "
                    f"error of {block.before:.3g} {unit}, {noise}. On the others its error of "
                    f"{elsewhere:.3g} {unit}, {elsewhere / noise_floor:.2g} noise floors, was "
                    f"taken for noise. {place[0].upper()}{place[1:]}."
                )
        else:
            # Both come from the other samples, which do not show what is missing.
            hints = _nearest(found), equation_sentence(unexplained)
        return (
            f"Something is missing, but {decision.reason}{_against(found)}: "
            f"the simulation alone has an error of {block.before:.3g} {unit}, "
            f"{noise}.{hints[0]} {place[0].upper()}{place[1:]}.{hints[1]}"
        )
    extended = found.extended.extended
    laws = " and ".join(
        f"{label_in_words(extended.places.label(attached))} ({_main(effect)})"
        for effect, attached in zip(effects, extended.attached, strict=True)
    )
    rivals = " or ".join(rivals_in_words(found))
    lag = common_lag(decision.answer, effects, rivals_told(found)) if decision.answer else ""
    alone = len(effects) == 1
    place = f"Without {'it' if alone else 'them'}, {place}"
    proof = f"the error on the certified samples {_change(block, unit)}, {noise}"
    if decision.status is Status.AMBIGUOUS:
        advice = (
            "`make resolve` designs the record that decides"
            if len(found.inputs) == 1
            else "A further record that moves each input by itself may decide"
        )
        removed = f"The first explanation removes {_removed(found)}"
        alike = f" Each holds {lag}." if lag else ""
        return f"It is {laws}, or {rivals}.{alike} {removed}: {proof}. {place}. {advice}."
    removed = f"{laws} {'removes' if alone else 'remove'} {_removed(found)}"
    if not decision.whole:
        return f"Certain part of the answer: {removed}; {proof}. {_further(found)} {place}."
    alike = f": {lag}" if lag else ""
    doubt = f" In this record {rivals} of its class would do as well{alike}." if rivals else ""
    probably = "Probably " if law_too_poor(found) else ""
    return f"{probably}{removed}: {proof}.{doubt}{_form(found)} {place}."


def _excluding_priors(found: Findings, freed: Fit) -> str:
    """Say at which values, beyond their priors, the simulation's parameters need no effect."""
    unit, beyond = found.units[1], estimates_beyond_priors(found)
    told = [
        f"{name.replace('_', ' ')} "
        f"{estimate(each.value, each.low, each.high, each.unit, at_bound=each.at_bound)} "
        f"(declared {quantity(each.prior, each.unit)})"
        for name, each in beyond.items()
    ]
    left = rmse(freed.residual, found.problem.certify)
    names = " and ".join(name.replace("_", " ") for name in beyond)
    return (
        "Nothing is named, because the declared priors exclude this device: "
        f"with {' and '.join(told)} the simulation alone has an error of {left:.3g} {unit} on the "
        f"certified samples, within its priors one of {found.certificate.block.before:.3g} {unit}, "
        f"noise floor {found.noise_floor:.3g} {unit}. Correct the nominal value or the spread of "
        f"{names}, and diagnose again."
    )


def _against(found: Findings) -> str:
    """Say with what, and on which records, the error grew, or fell less than on other samples."""
    chosen, records = found.decision.chosen, found.decision.contradicted
    if chosen is None or not records:
        return ""
    laws, unit = labels_in_words(chosen.labels), found.units[1]
    changes = ", ".join(f"on {name} {_change(each, unit)}" for name, each in records.items())
    if all(each.after < each.before for each in records.values()):
        before, after = (
            found.problem.seen_rmse(each.residual) for each in (found.nominal, chosen.fit)
        )
        changes += f", but from {before:.3g} to {after:.3g} {unit} where it was fitted"
    return f" (with {laws} the error {changes})"


def _change(block: Certified, unit: str) -> str:
    """Say how an error changes, and that it falls only where the numbers shown do."""
    before, after = f"{block.before:.3g}", f"{block.after:.3g}"
    if float(after) < float(before):
        return f"falls from {before} to {after} {unit}"
    return f"is {before} {unit} before and {after} {unit} after"


def _removed(found: Findings) -> str:
    """Say how much of the gap is removed; a course in time may not show on blocks left out."""
    removed = found.share
    if removed is None:
        return "part of the gap"
    if removed.value <= 0.0:
        return "none of the gap on blocks left out"
    return f"{share(removed.value, removed.low, removed.high)} of the gap"


def _further(found: Findings) -> str:
    """Say what else is likely."""
    named = {str(a.effect.family) for a in found.extended.extended.attached}
    likely = [
        family
        for family, value in found.presence.families.items()
        if value >= found.rules.likely and family not in named
    ]
    hint = f" ({likely[0]} is likely)" if likely else ""
    return f"What remains is not named{hint}: {where_sentence(found.where.after)}."


def equation_sentence(unexplained: ResidualModel) -> str:
    """Return the equation for the simulation's residual as a sentence, if it explains anything."""
    explained = 100 * unexplained.explained
    if explained < _LEAST_SHARE:
        return ""
    return (
        " The best equation for the residual of the simulation alone "
        f"(explains {explained:.0f} %): {unexplained.equation}."
    )


def _nearest(found: Findings) -> str:
    """Name the effect that most of the explanations hold, where it explains anything."""
    likely = [name for name, value in found.presence.effects.items() if value >= found.rules.likely]
    if not likely:
        return ""
    best = next((c for c in found.pool if c.finished and likely[0] in c.names), None)
    if best is None or misfit(best.rmse, found.error.white) > _LEFT * found.above_white:
        return ""
    sure = found.presence.effects[likely[0]] >= _SURE
    holders = "All likely explanations" if sure else "Most explanations"
    return (
        f" {holders} hold {label_in_words(likely[0])}; the best leaves {best.rmse:.3g} "
        f"{found.units[1]}."
    )


def law_too_poor(found: Findings) -> bool:
    """Return whether the certified error shows that the laws named as all of the answer are poor.

    What looks like coloured noise is not held against them.
    """
    decision = found.decision
    if decision.status is not Status.NAMED or not decision.whole or _leaves_coloured_noise(found):
        return False
    return found.certificate.block.after > found.rules.poor * found.floor


def _leaves_coloured_noise(found: Findings) -> bool:
    coloured = found.decision.reason is Reason.COLOURED
    return coloured and found.certificate.block.after > found.rules.poor * found.stated_floor


def _form(found: Findings) -> str:
    """Say what an answer leaves beyond what a complete simulation would."""
    left = f"{found.certificate.block.after / found.noise_floor:.2g} noise floors"
    if _leaves_coloured_noise(found):
        return f" What remains, {left}, looks like coloured noise."
    if not law_too_poor(found):
        return ""
    one = len(found.extended.extended.attached) == 1
    laws = "Its law is" if one else "Their laws are"
    return f" {laws} too poor here: {left} remain."


def label_in_words(label: str) -> str:
    """Return the name of an effect as code, with the input or force port of its label."""
    name, place = name_and_place(label)
    return " ".join(filter(None, (f"`{name}`", place_in_words(place))))


def labels_in_words(labels: Iterable[str]) -> str:
    """Return the names of several effects, joined."""
    return " and ".join(label_in_words(label) for label in labels)


def rivals_told(found: Findings) -> list[Candidate]:
    """Return the rivals to report; beside a name those that the evidence excludes are left out.

    Such a rival predicts held-out blocks as well, but these may be too few to exclude it.
    """
    decision, present = found.decision, found.presence.effects
    if decision.status is not Status.NAMED:
        return list(decision.rivals)
    least = 1.0 - found.rules.certain
    return [c for c in decision.rivals if min(present.get(name, 0.0) for name in c.names) >= least]


def rivals_in_words(found: Findings) -> list[str]:
    """Return each rival's effects, joined."""
    return [joined(map(_at_its_input, rival.names)) for rival in rivals_told(found)]


def _at_its_input(label: str) -> str:
    return " at ".join(part for part in name_and_place(label) if part)


def _main(effect: NamedEffect) -> str:
    """Say the parameters that tell most of an effect.

    Of a drift say where it begins and ends, and of a curve of the reading how far it
    bends: their parameters are pieces of a course.
    """
    if (bend := effect.bend) is not None:
        turned = f"{bend.name} of the opposite sign, " if bend.slope < 0.0 else f"{bend.name} "
        return (
            f"{turned}bent by up to {_sized(bend.largest, bend.unit)}, at "
            f"{bend.along} {_sized(bend.at, bend.unit_along)}"
        )
    if (change := effect.change) is not None:
        start, end = (_sized(each, change.unit) for each in (change.start, change.end))
        return f"{change.name} {start} at the start and {end} at the end"
    told: Iterable[tuple[str, Estimate]] = effect.quantities.items()
    if not effect.quantities:
        told = ((name, effect.parameters[name]) for name in effect.quoted[:_QUOTED])
    return ", ".join(
        f"{name.replace('_', ' ')} "
        + estimate(each.value, each.low, each.high, each.unit, at_bound=each.at_bound)
        for name, each in told
    )


def _sized(value: float, unit: str) -> str:
    return f"{value:.3g}" if unit == "1" else f"{value:.3g} {unit}"
