"""What a reader must know besides the verdict: timing, parameters at bounds, noise."""

import re
from collections.abc import Sequence

import numpy as np

from dea.discrepancy.decision import Reason, Status
from dea.discrepancy.evidence.outliers import count_outliers
from dea.discrepancy.findings import Findings
from dea.discrepancy.fitting.fit import CLOSE, at_bounds, at_prior_bounds
from dea.discrepancy.problem.split import LONG_ENOUGH, rounded_down
from dea.discrepancy.report.sentence import label_in_words, labels_in_words
from dea.simulation import TIMING_OFFSET, Family

# The values were chosen: they change what is said besides, and no verdict.
# Sampling intervals from which a timing offset is worth a remark, and its standard deviations.
_EARLY, _SURE = 0.1, 3.0
# Part of the residual from which a force that no effect has is worth a remark.
_FORCE = 0.5
# Part of the white level from which a coloured error is said, and of the gap up to which it may be
# one to live with: more of it is what is missing.
_COLOURED, _SMALL = 0.5, 0.5
# Sampling intervals of the slowest time constant below which a record shows a device only at rest:
# from one sample to the next, a transient falls below exp(-10).
_RARE = 0.1
# A law's parameter: the law's label, which may hold dots, the record that it belongs to, its name.
_PARAMETER = re.compile(r"^(.+?)\.(?:record_(\d+)\.)?([^.]+)$")


def remarks(found: Findings) -> tuple[str, ...]:
    """Return the remarks on a diagnosis, each a sentence.

    Priors that the record contradicts come last: they may be all that is wrong.
    """
    # What a force would cause is no error to live with, and neither is what priors exclude.
    rest = "" if found.decision.freed is not None else _force(found) or _noise(found)
    about_record = _rare(found), _outliers(found), _close(found)
    about_laws = _excluded(found), _laws(found), _modulated(found)
    texts = _timing(found), _dated(found), *about_laws, rest, *about_record, _bounds(found)
    return tuple(text for text in texts if text)


def remainder(found: Findings) -> str:
    """Say how much of what is left could be predicted, whatever the verdict is."""
    left = "the answer leaves" if found.decision.answer else "the simulation alone leaves"
    percent = f"{100 * found.unexplained.predicted:.0f} %"
    part = "none" if percent == "0 %" else percent
    return (
        f"A flexible model of input, motion and time removes {part} of the error that {left}, on "
        "samples that it was not fitted to."
    )


def _timing(found: Findings) -> str:
    """Say by how much the output is logged early or late, and what may pass for that."""
    fitted, problem = found.final, found.problem
    if found.decision.status not in (Status.NAMED, Status.NONE):
        # An effect that is missing may look like a time offset.
        return ""
    names = [fitted.extended.layout.names[i] for i in fitted.extended.layout.free]
    if TIMING_OFFSET not in names:
        return ""
    at = names.index(TIMING_OFFSET)
    spread = fitted.extended.timing_spread
    offset = float(fitted.coordinates[at]) * spread
    deviation = float(found.uncertainty.deviation[at]) * spread
    if abs(offset) < max(_EARLY * problem.recorded_interval, _SURE * deviation):
        return ""
    side, doubts = ("early", "") if offset < 0 else ("late", ", or the device has a lag this short")
    if offset < 0 and any(a.effect.family is Family.LAG for a in fitted.extended.attached):
        doubts = ", or the fitted lag is too long by this time"
    if _inexact(found):
        law = "the law" if found.decision.answer else "the simulation"
        doubts += f", or an error of {law} looks like such an offset"
    count = f"{abs(offset) / problem.recorded_interval:.2g}"
    samples = "1 sample" if count == "1" else f"{count} samples"
    return (
        f"The output is logged {1e3 * abs(offset):.3g} ± {2e3 * deviation:.2g} ms {side} "
        f"({samples}){doubts}."
    )


def _inexact(found: Findings) -> bool:
    """Return whether more than noise is left, or a named law is at a bound that is not its prior.

    What a law lacks then shows in other parameters, of which an offset in time is one.
    """
    fitted, most = found.final, found.rules.clean * found.stated_floor
    left = found.certificate.block.after, found.problem.seen_rmse(found.extended.residual)
    laws = [part.start for part in fitted.extended.layout.effect_slices]
    of_law = fitted.extended.layout.free >= min(laws, default=np.inf)
    bound = at_bounds(fitted.extended, fitted.coordinates) & (np.abs(fitted.coordinates) > CLOSE)
    return max(left) > most or bool((bound & of_law).any())


def _dated(found: Findings) -> str:
    """Say that the certified samples told when an event happened."""
    if not found.certificate.dated:
        return ""
    return "When it happened was found on the certified samples, which do not certify that."


def _close(found: Findings) -> str:
    """Say that the certified samples are less apart from the others than they ought to be."""
    parts, problem = found.split, found.problem
    if not parts.close:
        return ""
    which = f"Record {parts.closest}" if len(problem.lengths) > 1 else "The record"
    needed = LONG_ENOUGH * parts.slowest * problem.interval
    allowed = rounded_down(parts.largest_slowest * problem.interval)
    return (
        f"{which} is short for a device as slow as this: its certified samples are "
        f"{parts.time_constants:.2g} of the slowest time constants away from those fitted "
        "to, so that the certified error may be too small. "
        f"{LONG_ENOUGH:.0f} of them, {needed:.3g} s, would be long enough; so is this record if "
        f"the slowest is at most {allowed:.3g} s, which `slowest_time` states."
    )


def _rare(found: Findings) -> str:
    """Say that the samples are too far apart for any dynamics to be seen."""
    if found.split.slowest >= _RARE or found.split.slowest == 0.0:
        return ""
    return (
        f"The samples are {1.0 / found.split.slowest:.2g} of the simulation's slowest time "
        "constants apart, so that they show the device only at rest: check the sampling rate."
    )


def _outliers(found: Findings) -> str:
    """Say how many samples lie far from their neighbours."""
    problem = found.problem
    if problem.decimation > 1:
        return ""
    count = count_outliers(found.final.residual, problem.known, found.noise_floor)
    if not count:
        return ""
    samples = "1 sample lies" if count == 1 else f"{count} samples lie"
    return (
        f"{samples} far from both neighbours, as outliers of a sensor or a logger do: mark those "
        "that are not motion as missing, and diagnose again."
    )


def _excluded(found: Findings) -> str:
    """Name effects of the first of several explanations whose presence contradicts it."""
    if found.decision.status is not Status.AMBIGUOUS or found.decision.answer is None:
        return ""
    first, presence = found.decision.answer, found.presence
    least = 1.0 - found.rules.certain
    excluded = [name for name in first.names if presence.effects.get(name, 0.0) < least]
    likeliest = next((c for c in presence.candidates if c.effects != first.effects), None)
    if not excluded or likeliest is None:
        return ""
    several = len(excluded) > 1
    return (
        "The first explanation leads by what it predicts on blocks left out, but "
        f"{labels_in_words(excluded)} {'have' if several else 'has'} a presence below "
        f"{100 * least:.3g} %: {'their laws have' if several else 'its law has'} more freedom than "
        "this record supports. With freedom taken into account, the most probable other "
        f"explanation is {labels_in_words(likeliest.names)}."
    )


def _bounds(found: Findings) -> str:
    """Name the simulation's own parameters that the record would have beyond their priors.

    An effect may stand for them: they are then at their bounds without it alone. Where they alone
    explain the record, the finding says so.
    """
    if found.decision.freed is not None:
        return ""
    away = _at_their_bounds(at_prior_bounds(found.extended))
    if away:
        return f"{away}: the declared priors exclude what the record asks for."
    alone = _at_their_bounds(at_prior_bounds(found.nominal))
    if not alone or found.decision.answer is None:
        return ""
    effects = "the effect" if len(found.decision.answer.names) == 1 else "the effects"
    return (
        f"{alone} without {effects}: if the declared priors exclude this device, that may be all "
        "that is wrong."
    )


def _at_their_bounds(names: Sequence[str]) -> str:
    """Say which of the simulation's own parameters are at their bounds, if any is."""
    if not names:
        return ""
    told = " and ".join(name.replace("_", " ") for name in names)
    bounds = "is at its bound" if len(names) == 1 else "are at their bounds"
    return f"Of the simulation's own parameters {told} {bounds}"


def _laws(found: Findings) -> str:
    """Name the parameters of the named laws that are at their bounds."""
    answer = found.decision.answer
    away: dict[str, list[str]] = {}
    for name in answer.at_bounds if answer else ():
        [(law, record, parameter)] = _PARAMETER.findall(name)
        of_record = f" of record {record}" if record else ""
        away.setdefault(label_in_words(law), []).append(parameter.replace("_", " ") + of_record)
    if not away:
        return ""
    ends = {law: "its bound" if len(names) == 1 else "their bounds" for law, names in away.items()}
    told = [f"{law} has its {' and '.join(names)} at {ends[law]}" for law, names in away.items()]
    return f"{' and '.join(told)}, which counts against {'it' if len(told) == 1 else 'them'}."


def _modulated(found: Findings) -> str:
    """Say that what looks like a disturbance grows and falls with the motion."""
    wave = found.modulated
    if wave is None:
        return ""
    return (
        f"What {labels_in_words(wave.names)} leaves is a wave of {wave.frequency:.3g} Hz that "
        "grows and falls with input and motion: a property of the device may change at that "
        "frequency."
    )


def _force(found: Findings) -> str:
    """Say how a force looks that would explain what no effect does."""
    force = found.force
    if found.decision.status is not Status.UNKNOWN or force is None or force.part < _FORCE:
        return ""
    return (
        f"A smooth force at {force.port} that depends on {force.of} would remove "
        f"{100 * force.part:.0f} % of the residual of the simulation alone, on samples that it was "
        "not fitted to."
    )


def _noise(found: Findings) -> str:
    """Say what the best explanation leaves beyond white noise."""
    error, unit = found.error, found.units[1]
    if found.decision.reason in (Reason.NOISE, Reason.ACCURATE, Reason.UNEVEN):
        # The sentence says already that what is left is small, or white.
        return ""
    stated = found.nominal.extended.simulation.accuracy
    if error.left <= max(_COLOURED * error.white, stated):
        return ""
    if found.decision.status is Status.UNKNOWN and error.left > _SMALL * found.above_white:
        # What is missing would be counted as known.
        return ""
    white = f"the white noise of {error.white:.2g} {unit}"
    if found.coloured_level:
        level = f"{found.coloured_level:.2g} {unit} (RMS) of coloured noise"
        return f"The best explanation leaves {level} beyond {white}, which counts as noise."
    counted = "counts it as known error"
    if found.decision.status is Status.UNKNOWN:
        counted = "would count it as known error, though it may be what is missing"
    return (
        f"The best explanation leaves {error.left:.2g} {unit} (RMS) of coloured error beyond "
        f"{white}; `Simulation(…, "
        f"accuracy={error.left:.2g})` {counted}."
    )
