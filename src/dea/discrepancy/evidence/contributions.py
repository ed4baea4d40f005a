"""What each effect of an extension contributes, one after the other."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from dea.discrepancy.evidence.bootstrap import Gains, gains
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import rmse


@dataclass(frozen=True)
class Rung:
    """A step of the extension: the label of the effect added, and the held-out residual (n,)."""

    label: str | None
    residual: np.ndarray


@dataclass(frozen=True)
class Contribution:
    """Held-out RMS residuals without and with an effect; their log ratio with its 95 % interval."""

    before: float
    after: float
    gain: float
    low: float
    high: float


def ladder(evidence: Evidence, nominal: Fit, final: Fit, pool: Sequence[Candidate]) -> list[Rung]:
    """Return the nominal simulation, and with one effect of an extension more at a time.

    There is no rung for a part of the extension that is not among the candidates of the ``pool``.
    """
    labels = [final.extended.places.label(a) for a in final.extended.attached]
    rungs: list[tuple[str | None, Fit]] = [(None, nominal)]
    best_first = sorted(pool, key=lambda c: not c.finished)
    for count in range(1, len(labels)):
        part = set(labels[:count])
        there = (c.fit for c in best_first if set(c.labels) == part)
        rungs += [(labels[count - 1], fitted) for fitted in islice(there, 1)]
    if labels:
        rungs.append((labels[-1], final))
    return [Rung(label, evidence.held_out.residual(fit, final)) for label, fit in rungs]


def contributions(
    evidence: Evidence,
    rungs: Sequence[Rung],
    final: Fit,
    singles: Sequence[Candidate],
    gained: Gains,
) -> list[Contribution]:
    """Return what each attached effect contributes: the step to the first rung that it is part of.

    The interval of a single effect is that over the whole catalogue, ``gained``.
    """
    attached = final.extended.attached
    order = [final.extended.places.label(effect) for effect in attached]
    reached = [-1, *(order.index(rung.label) for rung in rungs if rung.label is not None)]
    result = []
    for index, effect in enumerate(attached):
        last = next(k for k, at in enumerate(reached) if at >= index)
        before, after = (rung.residual for rung in rungs[last - 1 : last + 1])
        if len(attached) == 1:
            labels = [c.labels for c in singles]
            found, at = gained, labels.index((final.extended.places.label(effect),))
        else:
            found, at = gains([before], [after], evidence.blocks, 0.0, evidence.rng), 0
        seen = evidence.problem.seen
        result.append(
            Contribution(
                rmse(before, seen),
                rmse(after, seen),
                float(found.gain[at]),
                float(found.low[at]),
                float(found.high[at]),
            )
        )
    return result
