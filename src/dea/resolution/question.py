"""Which record to drive next, and which to certify on."""

from collections.abc import Sequence

import numpy as np

from dea.discrepancy import Settings, shortest_record
from dea.errors import InputError
from dea.progress import tell
from dea.resolution.design import Design, Question, designed, likeliest
from dea.resolution.excitation import Limits, express, genes
from dea.resolution.explanation import NONE, Explanation
from dea.resolution.knowledge import ANOTHER, Inquiry, Knowledge
from dea.seeds import generator

# Factor on the shortest record, since its split may rest on a slower time constant.
_SPARE = 1.2
# Excitations that are drawn for the certificate, until one keeps the outputs in range.
_DRAWS = 8
CERTIFICATE = 0  # number of the record that certifies


def next_design(known: Knowledge, inquiry: Inquiry, number: int) -> Design | None:
    """Return the excitation that best tells apart the hypotheses that are left."""
    options = inquiry.options
    tell(f"record {number}: designing it")
    left = known.posterior.left(options.level) - {ANOTHER}
    logs = known.posterior.log_now
    asked = likeliest([known.explanations[name] for name in sorted(left)], logs)
    weights = np.array([logs[each.name] for each in asked])
    tested = ""
    if len(asked) < 2:
        tested = asked[0].name if asked else ""
        asked = likeliest(list(known.explanations.values()), logs)
        weights = np.zeros(len(asked))
    question = _question(known, asked, weights, inquiry.limits, tested)
    durations = _shortest(known, inquiry), options.duration
    rng = _generator(inquiry.settings, number)
    return designed(question, durations, options.level, rng, options.forms)


def fresh_design(known: Knowledge, inquiry: Inquiry) -> Design | None:
    """Return an excitation drawn at random whose predicted outputs stay in range.

    None where no draw of a few keeps those of all hypotheses that are left in range.
    """
    limits, options = inquiry.limits, inquiry.options
    rng = _generator(inquiry.settings, CERTIFICATE)
    left = sorted(known.posterior.left(options.level) - {ANOTHER})
    asked = [known.explanations[name] for name in left]
    question = _question(known, asked, np.zeros(len(asked)), limits)
    for _ in range(_DRAWS):
        u = express(rng.random(genes()), 0.5 * options.duration, limits)
        design = question.judged(u, "free")
        if design is not None:
            return design
    return None


def _question(
    known: Knowledge,
    asked: Sequence[Explanation],
    weights: np.ndarray,
    limits: Limits,
    tested: str = "",
) -> Question:
    """Return the question of these explanations, with the logarithms of their weights."""
    return Question(
        asked,
        np.exp(weights - np.logaddexp.reduce(weights)).tolist(),
        known.explanations[NONE],
        known.error,
        limits,
        float(np.clip(np.mean(known.diagnosis.problem.u), limits.low, limits.high)),
        tested,
    )


def _shortest(known: Knowledge, inquiry: Inquiry) -> float:
    """Return the duration (s) of the shortest record that a diagnosis can split."""
    interval = known.diagnosis.problem.interval
    samples = shortest_record(known.diagnosis.split.spacing) * _SPARE
    needed = samples * interval + inquiry.settings.warm_up
    duration = inquiry.options.duration
    if needed > duration:
        raise InputError(
            f"a designed record of {duration:g} s is too short for the slowest time"
            f" constant of the device: {needed:.3g} s are needed",
            field="resolution.duration",
            remedy="Raise it, or give the case a shorter `split.slowest_time`",
        )
    return needed


def _generator(settings: Settings, number: int) -> np.random.Generator:
    return generator(settings.seed, settings.name, "resolve", str(number))
