"""How sure a diagnosis is of its best explanation, and what risk comes with acting on it."""

from collections.abc import Sequence
from math import inf, log, sqrt

import numpy as np

from dea.trials.outcome import Label, Said

_RESOLUTION = 0.1  # noise floors; misfits below are alike


def confidence(said: Said) -> float:
    """Return the log ratio of misfits of the first rival and the best explanation.

    The misfit is what the error holds beyond the noise floor. Sets of another size are no rivals,
    since one more effect always fits a little better. Minus infinity where there is no explanation,
    infinity where there is no rival.
    """
    if not said.ranking:
        return -inf
    best, error = said.ranking[0]
    rivals = [e for names, e in said.ranking[1:] if len(names) == len(best) and names != best]
    if not rivals:
        return inf
    return log(_misfit(min(rivals), said.noise_floor) / _misfit(error, said.noise_floor))


def acceptable(label: Label, names: frozenset[str]) -> bool:
    """Return whether giving these names would be no error: all of them are hidden."""
    return bool(names) and not label.outside and names <= label.effects


def risk_coverage(
    labels: Sequence[Label], verdicts: Sequence[Said]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return confidence, coverage and risk as one is content with less and less confidence.

    Every trial is answered with its best explanation, the surest first. Coverage is the share of
    all trials answered so far, risk the share of wrong answers among them (El-Yaniv and Wiener,
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
