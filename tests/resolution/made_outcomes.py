"""What a resolution may have found, without a diagnosis behind it."""

from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from dea.discrepancy import NamedEffect, Verdict
from dea.resolution import ANOTHER, Design, Knowledge, Resolution, ResolutionRound
from dea.resolution.knowledge import WITHOUT_NAME
from dea.resolution.posterior import Posterior

DRIFTING = "a+baseline_drift"
PRIOR = {"none": 0.1, "a": 0.4, "b": 0.2, "a+a": 0.05, "a+b": 0.05, DRIFTING: 0.1, ANOTHER: 0.1}


def knowledge(now, status="named", names=("a",), whole=True, reason=None):
    verdict = SimpleNamespace(status=status, names=names, whole=whole)
    diagnosis = SimpleNamespace(verdict=verdict, decision=SimpleNamespace(reason=reason))
    explanations = {
        name: SimpleNamespace(effects=Counter(name.split("+") if name != "none" else ()))
        for name in PRIOR
        if name != ANOTHER
    }
    logs = dict.fromkeys(PRIOR, -np.inf) | {name: np.log(value) for name, value in now.items()}
    posterior = Posterior({name: np.log(value) for name, value in PRIOR.items()}, logs)
    return Knowledge((), diagnosis, explanations, posterior, None)


def resolution_of(outcome):
    """Return a resolution that names an effect at first, and has this outcome after a round."""
    effect = NamedEffect("a", "input", "lag", {}, 2.0, 1.0, (0.7, 0.6, 0.8))
    diagnosis = SimpleNamespace(
        verdict=Verdict("named", "It is a.", (effect,), {}, 0.1, {}, "mm"),
        problem=SimpleNamespace(seen_rmse=lambda residual: residual), units=("V", "mm"),
        nominal=SimpleNamespace(residual=2.0), extended=SimpleNamespace(residual=1.0),
    )  # fmt: skip
    first = replace(knowledge({ANOTHER: 1.0}), diagnosis=diagnosis)
    last = replace(first, withdrawn=outcome if outcome in WITHOUT_NAME else None)
    design = Design(np.zeros(3), -1.0, ("a", "b"), 1.0, "free")
    return Resolution(first, (ResolutionRound(1, design, {}, first, last),), outcome)
