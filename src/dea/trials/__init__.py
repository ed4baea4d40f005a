"""Scores of blind trials: verdicts against the labels that were sealed."""

from dea.trials.measures import BOTH, ON_FOREIGN, ON_NOTHING
from dea.trials.outcome import KINDS, OUTCOMES, Label, Said, effect_set, kind_of, outcome
from dea.trials.proportion import Proportion, wilson
from dea.trials.scores import scores
from dea.trials.seals import open_seal

__all__ = [
    "BOTH",
    "KINDS",
    "ON_FOREIGN",
    "ON_NOTHING",
    "OUTCOMES",
    "Label",
    "Proportion",
    "Said",
    "effect_set",
    "kind_of",
    "open_seal",
    "outcome",
    "scores",
    "wilson",
]
