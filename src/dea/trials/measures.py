"""The rates of a campaign with their intervals and targets."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.trials.confidence import acceptable
from dea.trials.opened import Opened
from dea.trials.proportion import Proportion, wilson

# Names of rates that campaigns count as well; of nothing there is one for each kind of noise.
BOTH = "both of two"
ON_NOTHING = "name given on nothing"
ON_FOREIGN = "name given on a foreign effect"
CLOSE = 0.4  # noise RMS; the largest error to the noise-free truth after a right name
# Kinds of noise that are counted together, also where no trial has them; others by themselves.
_NOISE = {
    "white noise": ("white",),
    "coloured noise": ("coloured", "flicker"),
    **{f"{kind} readings": (kind,) for kind in ("drifting", "quantised", "shifted")},
}


class Measure(NamedTuple):
    """A rate, and the share it should reach, or that it should stay below (``at_most``)."""

    share: Proportion
    target: float
    at_most: bool = False


def measures(trials: Sequence[Opened]) -> dict[str, Measure]:
    """Return every rate by name; those without trials are NaN."""
    single, pair, outside, null = (
        [t for t in trials if t.kind == kind] for kind in ("single", "pair", "outside", "null")
    )
    right = [t for t in trials if t.outcome == "right name"]
    named = [t for t in trials if t.said.status == "named"]
    covered = [inside for t in right for inside in t.covered]
    return {
        "right name": Measure(_share(single, {"right name"}), 0.88),
        "right name, and nothing further missing": Measure(
            wilson(sum(t.outcome == "right name" and t.said.whole for t in single), len(single)),
            np.nan,
        ),
        "right class": Measure(_share(single, {"right name", "right class"}), 0.95),
        "wrong name": Measure(_share(single, {"wrong name"}), 0.02, at_most=True),
        BOTH: Measure(_share(pair, {"right name"}), 0.75),
        "one or both of two, nothing wrong": Measure(
            _share(pair, {"right name", "one of two"}), 0.9
        ),
        **{
            f"{ON_NOTHING}, {noise}": Measure(
                _named(drawn), 0.02 if noise == "white noise" else 0.05, at_most=True
            )
            for noise, drawn in _by_noise(null).items()
        },
        ON_FOREIGN: Measure(_named(outside), 0.03, at_most=True),
        "names given that are right": Measure(
            wilson(sum(acceptable(t.label, t.said.effects) for t in named), len(named)), np.nan
        ),
        "close to the truth after a right name": Measure(
            wilson(sum(t.said.truth_error <= CLOSE for t in right), len(right)), 0.85
        ),
        "defining parameter within its interval": Measure(wilson(sum(covered), len(covered)), 0.85),
    }


def _by_noise(trials: Sequence[Opened]) -> dict[str, list[Opened]]:
    """Return each trial in the group of its kind of noise."""
    shared = {kind for kinds in _NOISE.values() for kind in kinds}
    alone = sorted({t.label.noise for t in trials} - shared)
    groups = _NOISE | {f"{kind} readings": (kind,) for kind in alone}
    return {name: [t for t in trials if t.label.noise in groups[name]] for name in groups}


def _share(trials: Sequence[Opened], outcomes: set[str]) -> Proportion:
    return wilson(sum(t.outcome in outcomes for t in trials), len(trials))


def _named(trials: Sequence[Opened]) -> Proportion:
    return wilson(sum(t.said.status == "named" for t in trials), len(trials))
