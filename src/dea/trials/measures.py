"""The rates of a campaign with their intervals and targets."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.trials.confidence import acceptable
from dea.trials.opened import Opened
from dea.trials.proportion import Proportion, wilson

CLOSE = 0.4  # noise RMS; the largest error to the noise-free truth after a right name
COLOURED = ("coloured", "flicker")


class Measure(NamedTuple):
    """A rate, and the share it should reach, or for wrong and undue names stay below."""

    share: Proportion
    target: float


def measures(trials: Sequence[Opened]) -> dict[str, Measure]:
    """Return every rate by name; those without trials are NaN."""
    single, pair, outside, null = (
        [t for t in trials if t.kind == kind] for kind in ("single", "pair", "outside", "null")
    )
    right = [t for t in trials if t.outcome == "right name"]
    named = [t for t in trials if t.said.status == "named"]
    covered = [inside for t in right for inside in t.covered]
    nothing = {
        "white noise": [t for t in null if t.label.noise == "white"],
        "coloured noise": [t for t in null if t.label.noise in COLOURED],
        **{
            f"{kind} readings": [t for t in null if t.label.noise == kind]
            for kind in ("drifting", "quantised", "shifted")
        },
    }
    return {
        "right name": Measure(_share(single, {"right name"}), 0.88),
        "right name, and nothing further missing": Measure(
            wilson(sum(t.outcome == "right name" and t.said.whole for t in single), len(single)),
            np.nan,
        ),
        "right class": Measure(_share(single, {"right name", "right class"}), 0.95),
        "wrong name": Measure(_share(single, {"wrong name"}), 0.02),
        "both of two": Measure(_share(pair, {"right name"}), 0.75),
        "one or both of two, nothing wrong": Measure(
            _share(pair, {"right name", "one of two"}), 0.9
        ),
        **{
            f"name given on nothing, {noise}": Measure(
                _named(drawn), 0.02 if noise == "white noise" else 0.05
            )
            for noise, drawn in nothing.items()
        },
        "name given on a foreign effect": Measure(_named(outside), 0.03),
        "names given that are right": Measure(
            wilson(sum(acceptable(t.label, t.said.effects) for t in named), len(named)), np.nan
        ),
        "close to the truth after a right name": Measure(
            wilson(sum(t.said.truth_error <= CLOSE for t in right), len(right)), 0.85
        ),
        "defining parameter within its interval": Measure(wilson(sum(covered), len(covered)), 0.85),
    }


def _share(trials: Sequence[Opened], outcomes: set[str]) -> Proportion:
    return wilson(sum(t.outcome in outcomes for t in trials), len(trials))


def _named(trials: Sequence[Opened]) -> Proportion:
    return wilson(sum(t.said.status == "named" for t in trials), len(trials))
