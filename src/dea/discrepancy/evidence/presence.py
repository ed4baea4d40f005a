"""How sure it is that an effect is part of the answer, whatever the answer's other effects.

Every candidate gets a weight by its evidence, averaged over resampled blocks, since its law is
never quite right (bagged posteriors: Huggins and Miller 2023, Bayesian Analysis 18:79). An effect's
presence is the weight of all candidates that contain it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.evidence.bootstrap import energies
from dea.discrepancy.evidence.model_error import ModelError
from dea.discrepancy.fitting.candidates import Candidate, EffectSet
from dea.discrepancy.rules import misfit

_DRAWS = 1000


@dataclass(frozen=True)
class Share:
    """Part of the misfit that an extension removes, with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Presence:
    """The candidates that were weighed, best first, and their weights (k,).

    One minus their sum is the weight of the simulation alone.
    """

    candidates: tuple[Candidate, ...]
    weights: np.ndarray

    @property
    def effects(self) -> dict[str, float]:
        """Probability that each effect is part of the answer, the surest first."""
        return self._of(lambda c: set(c.names))

    @property
    def families(self) -> dict[str, float]:
        """The same for each family of effects."""
        return self._of(families_of)

    @property
    def _counted(self) -> dict[str, float]:
        return self._of(lambda c: set(c.effects))

    def sure(self, certain: float) -> set[str]:
        """Return the effects that are ``certain``, as candidates count them."""
        return {name for name, value in self._counted.items() if value >= certain}

    def least_of(self, candidate: Candidate) -> float:
        """Return the probability of the effect of a candidate that is least sure."""
        found = self._counted
        return min(found.get(name, 0.0) for name in candidate.effects)

    def surest(self, certain: float) -> Candidate | None:
        """Return the candidate whose own weight, at any force ports, makes it ``certain``."""
        return next((c for c in self.candidates if self._weight_of(c) >= certain), None)

    def wider_than(self, candidate: Candidate) -> float:
        """Return the probability that the answer holds more than the effects of a candidate."""
        return self._weight_where(lambda effects: effects > candidate.effects)

    def among(self, candidate: Candidate, others: Sequence[Candidate]) -> float:
        """Return the probability of a candidate if it is right or one of the ``others`` is.

        Its effects count at whatever force port they act.
        """
        sets = {candidate.effects, *(other.effects for other in others)}
        whole = self._weight_where(lambda effects: effects in sets)
        return self._weight_of(candidate) / (whole or 1.0)

    def _weight_of(self, candidate: Candidate) -> float:
        return self._weight_where(lambda effects: effects == candidate.effects)

    def _weight_where(self, holds: Callable[[EffectSet], bool]) -> float:
        pairs = zip(self.candidates, self.weights, strict=True)
        return sum(float(weight) for c, weight in pairs if holds(c.effects))

    def _of(self, parts: Callable[[Candidate], set[str]]) -> dict[str, float]:
        found: dict[str, float] = {}
        for candidate, weight in zip(self.candidates, self.weights, strict=True):
            for part in parts(candidate):
                found[part] = found.get(part, 0.0) + float(weight)
        # Ties are sorted by name.
        return dict(sorted(found.items(), key=lambda item: (-item[1], item[0])))


def families_of(candidate: Candidate) -> set[str]:
    """Return the families of a candidate's effects."""
    return {str(a.effect.family) for a in candidate.fit.extended.attached}


def presence(
    before: np.ndarray,
    candidates: Sequence[Candidate],
    blocks: Sequence[slice],
    error: ModelError,
    log_odds: np.ndarray,
    rng: np.random.Generator,
) -> Presence:
    """Weigh candidates by their residuals against the one ``before`` (n,).

    ``log_odds`` (k,) is what else counts against the simulation alone: that of
    :mod:`dea.discrepancy.evidence.occam`. Blocks get weights of a flat Dirichlet distribution (the
    Bayesian bootstrap).
    """
    residuals = (before, *(c.fit.residual for c in candidates))
    sums = np.array([energies(residual, blocks) for residual in residuals])
    shares = rng.dirichlet(np.ones(len(blocks)), _DRAWS) * len(blocks)
    odds = np.append(0.0, log_odds) - 0.5 * (shares @ sums.T) / max(error.density, 1e-300)
    odds -= odds.max(axis=1, keepdims=True)
    weights = np.exp(odds)
    weights /= weights.sum(axis=1, keepdims=True)
    mean = weights.mean(axis=0)[1:]
    order = np.argsort(-mean, kind="stable")
    return Presence(tuple(candidates[i] for i in order), mean[order])


def share_removed(
    before: np.ndarray,
    after: np.ndarray,
    blocks: Sequence[slice],
    floor: float,
    rng: np.random.Generator,
) -> Share:
    """Return the part of the misfit above the ``floor`` that an extension removes.

    ``before`` and ``after`` (n,) are held-out residuals, resampled with the same blocks.
    """
    samples = np.array([block.stop - block.start for block in blocks])
    a, b = energies(before, blocks), energies(after, blocks)
    picks = rng.integers(0, len(blocks), (_DRAWS, len(blocks)))
    count = samples[picks].sum(1)

    def removed(first: float, second: float) -> float:
        whole = misfit(float(np.sqrt(first)), floor)
        return 1.0 - misfit(float(np.sqrt(second)), floor) / whole if whole > 0 else 0.0

    drawn = [
        removed(x, y) for x, y in zip(a[picks].sum(1) / count, b[picks].sum(1) / count, strict=True)
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    value = removed(a.sum() / samples.sum(), b.sum() / samples.sum())
    return Share(value, float(low), float(high))
