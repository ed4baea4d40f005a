"""The confidence of a diagnosis in its best explanation, and the risk at each coverage."""

from collections.abc import Sequence
from math import inf, log, sqrt

import numpy as np

from dea.trials.outcome import Label, Said

_RESOLUTION = 0.1  # noise floors; smaller misfits are equal


def confidence(said: Said) -> float:
    """Return the log ratio of misfits of the first rival and the best explanation.

    The misfit is the error beyond the noise floor, in the root-sum-square sense. Effect sets of
    another size are no rivals, since one more effect always lowers the error a little. Minus
    infinity without an explanation, infinity without a rival.
    """
    if not said.ranking:
        return -inf
    best, error = said.ranking[0]
    rivals = [e for names, e in said.ranking[1:] if len(names) == len(best) and names != best]
    if not rivals:
        return inf
    return log(_misfit(min(rivals), said.noise_floor) / _misfit(error, said.noise_floor))


def acceptable(label: Label, names: frozenset[str]) -> bool:
    """Return whether all these names are hidden, so that giving them is no error."""
    return bool(names) and not label.outside and names <= label.effects


def risk_coverage(
    labels: Sequence[Label], verdicts: Sequence[Said]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return confidence, coverage and risk for a falling threshold of the confidence.

    Every trial is answered with its best explanation, in order of confidence. Coverage is the share
    of all trials answered so far, risk the share of wrong answers among them (El-Yaniv and Wiener,
    J. Mach. Learn. Res. 11 (2010) 1605). Shape of each: (trials with an explanation,).
    """
    answered = [
        (confidence(said), acceptable(label, said.ranking[0][0]))
        for label, said in zip(labels, verdicts, strict=True)
        if said.ranking
    ]
    answered.sort(key=lambda pair: -pair[0])
    sureness = np.array([pair[0] for pair in answered], dtype=float)
    wrong = np.cumsum([not right for _, right in answered], dtype=float)
    ranks = np.arange(1.0, len(answered) + 1.0)
    return sureness, ranks / len(labels), wrong / ranks


def _misfit(error: float, floor: float) -> float:
    return sqrt(max(error**2 - floor**2, (_RESOLUTION * floor) ** 2))
