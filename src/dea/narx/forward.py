"""The paper's forward selection and pruning, by simulated error reduction (5)-(9)."""

from collections.abc import Callable

import numpy as np

from dea.narx.candidate_models import CandidateModels, Subset
from dea.narx.trace import Trace, Tried, serr


def forward_and_prune(
    models: CandidateModels,
    basis: Subset,
    add_threshold: float,
    prune_threshold: float,
    most: int,
    trace: Trace,
) -> Subset:
    """Add the terms of largest SERR, then remove those of least, by the two thresholds."""
    names = [str(term) for term in models.candidates]
    error = models([basis])[0].msse
    # SERR of the basis (9) is its error itself, not a reduction.
    trace.add("basis", 0, [Tried("linear basis", error, error / models.power)], 0, "added")

    def grow(subset: Subset) -> dict[str, Subset]:
        free = [j for j in range(len(names)) if j not in subset] if len(subset) < most else []
        return {names[j]: tuple(sorted((*subset, j))) for j in free}

    def shrink(subset: Subset) -> dict[str, Subset]:
        removable = subset if len(subset) > 1 else ()
        return {names[j]: tuple(i for i in subset if i != j) for j in removable}

    grown = _descend(models, basis, grow, lambda _: add_threshold, trace, ("forward", "added"))

    def least_ratio(subset: Subset) -> float:
        return -prune_threshold if len(subset) <= most else -np.inf

    return _descend(models, grown, shrink, least_ratio, trace, ("pruning", "pruned"))


def _descend(
    models: CandidateModels,
    subset: Subset,
    moves: Callable[[Subset], dict[str, Subset]],
    least_ratio: Callable[[Subset], float],
    trace: Trace,
    labels: tuple[str, str],
) -> Subset:
    """Take the move of least simulated error while its SERR (5) is at least ``least_ratio``."""
    phase, status = labels
    error, step = models([subset])[0].msse, 0
    while options := moves(subset):
        step += 1
        errors = [outcome.msse for outcome in models(options.values())]
        ratios = [serr(error, after, models.power) for after in errors]
        best = int(np.argmin(errors))
        accepted = ratios[best] >= least_ratio(subset)
        tried = [Tried(*each) for each in zip(options, errors, ratios, strict=True)]
        trace.add(phase, step, tried, best if accepted else None, status)
        if not accepted:
            break
        subset, error = list(options.values())[best], errors[best]
    return subset
