"""From fitted candidates to a name, several, none, or an honest "unknown"."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.compose import Candidate, Round
from dea.discrepancy.gain import Gains
from dea.discrepancy.problem import Problem
from dea.discrepancy.rivals import beaten
from dea.discrepancy.unknown import ResidualModel


@dataclass(frozen=True)
class Rules:
    """When a name is given. Every figure may be changed in the config.

    Parameters
    ----------
    margin
        Part of the held-out error that an effect must remove, at the lower end of its interval.
    clean
        A gap up to this many noise floors counts as explained.
    misfit
        Part of the nominal misfit (root mean square above the floor) that may remain.
    second
        A further effect must remove this part of the error that is left.
    rival_margin
        A rival of another name is beaten if its misfit is larger by this factor, and surely so.
    predictable
        A flexible model that lowers the remaining error below this part of it says that
        something else is missing.
    """

    margin: float = 0.10
    clean: float = 1.15
    misfit: float = 0.25
    second: float = 0.15
    rival_margin: float = 1.15
    predictable: float = 0.80


@dataclass(frozen=True)
class Decision:
    """The status, the chosen candidate and, where it is not alone, its rivals."""

    status: str
    chosen: Candidate | None
    rivals: tuple[Candidate, ...] = ()
    reason: str = ""


def misfit(error: float, floor: float) -> float:
    """Return what an error holds beyond the noise floor (root mean square)."""
    return float(np.sqrt(max(error**2 - floor**2, 0.0)))


def significant(gains: Gains, index: int, rules: Rules) -> bool:
    """Return whether a candidate's gain is beyond the margin and beyond chance."""
    needed = max(-np.log1p(-rules.margin), gains.null)
    return bool(gains.low[index] > needed)


def choose(
    single: Candidate | None, pair: Candidate | None, floor: float, rules: Rules, sure: float
) -> Candidate | None:
    """Return the pair if it is needed, and else the single effect.

    ``sure`` is the lower bound of the pair's gain (log ratio) over the single effect.
    """
    if pair is None or single is None:
        return single
    needed = -np.log1p(-rules.second)
    if single.error > rules.clean * floor and sure > needed:
        return pair
    return single


def decide(
    problem: Problem,
    chosen: Candidate | None,
    pool: Sequence[Candidate],
    nominal_error: float,
    floor: float,
    unexplained: ResidualModel,
    blocks: Sequence[slice],
    rules: Rules,
    rng: np.random.Generator,
) -> Decision:
    """Name the chosen candidate unless something speaks against it."""
    if chosen is None:
        if nominal_error <= rules.clean * floor and unexplained.ratio > 1.0 - rules.margin:
            return Decision("none", None, reason="the gap is at the noise floor")
        if unexplained.ratio > 1.0 - rules.margin and nominal_error <= 1.5 * floor:
            return Decision("none", None, reason="no effect and no flexible model narrows the gap")
        return Decision("unknown", None, reason="no effect of the catalogue narrows the gap")
    left = misfit(chosen.error, floor)
    whole = misfit(nominal_error, floor)
    explained = chosen.error <= rules.clean * floor or left <= rules.misfit * whole
    if not explained or (
        unexplained.ratio < rules.predictable and left > 0.5 * rules.misfit * whole
    ):
        return Decision("unknown", chosen, reason="the best effect leaves too much unexplained")
    rivals = []
    for other in pool:
        if set(other.names) == set(chosen.names) or len(other.names) != len(chosen.names):
            continue
        if not other.finished:
            continue
        _, low = beaten(chosen.fit.gap, other.fit.gap, blocks, rng)
        apart = misfit(other.error, floor) > rules.rival_margin * max(left, 0.05 * floor)
        if low <= 0 or not apart:
            rivals.append(other)
    if rivals:
        return Decision("ambiguous", chosen, tuple(rivals), "a rival explains the record as well")
    return Decision("named", chosen, reason="")


def pool_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Return all candidates of all rounds, best first."""
    return sorted((c for r in rounds for c in r.candidates), key=lambda c: c.error)
