"""Screen an effect: fit it by a few steps from its most promising starts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.fitting.sensitivity import unabsorbed
from dea.discrepancy.problem.problem import Problem, rmse
from dea.simulation import Effect, ExtendedSimulation, MotionRange, Scales, motion

# Starts that get cheap steps beyond the kept ones, and fits that go on after them beyond the two
# that are used: both are ranked only roughly.
_MORE = 1
_USED = 2
# Changes of the output, in noise deviations, up to which a law does nothing, and up to which no
# better place is looked for; and the distance from the prior, in spreads, at which it is looked for
# where there is no bound.
_NOTHING, _SURELY_NOTHING, _FAR = 0.3, 0.02, 6.0


@dataclass(frozen=True)
class Base:
    """A fit to start from, what its parameters cannot absorb of a change, and of its residual.

    ``output`` (n,) is its output before gain, zero and effects of the sensor. ``motions`` are the
    ranges of the position at each force port, without any effect. Two fits of one simulation,
    with other zeros of the sensor, may have no position in common.
    """

    fit: Fit
    output: np.ndarray
    remainder: Callable[[np.ndarray], np.ndarray]
    left: np.ndarray
    motions: tuple[MotionRange, ...]

    @classmethod
    def of(cls, problem: Problem, fitted: Fit) -> "Base":
        """Prepare a fit; all effects offered share it."""
        remainder = unabsorbed(fitted.jacobian[problem.seen], problem.noise)
        ports = range(len(fitted.extended.simulation.force_ports))
        motions = (motion(fitted.extended, fitted.values, problem, port) for port in ports)
        return cls(
            fit=fitted,
            output=problem.moved(fitted.extended, fitted.values),
            remainder=remainder,
            left=remainder(fitted.residual[problem.seen]),
            motions=tuple(motions),
        )

    def residual(
        self, problem: Problem, extended: ExtendedSimulation, coordinates: np.ndarray
    ) -> np.ndarray:
        """Return that of a simulation with one law more, all else being as in this fit, (n,)."""
        added = extended.attached[len(self.fit.extended.attached) :]
        output = self.output if all(a.effect.only_reads for a in added) else None
        return problem.residual(extended, extended.layout.values(coordinates), output)


@dataclass(frozen=True)
class Offer:
    """An effect, the force port or input at which it would be attached, and its scales.

    These are of the record and of one motion, which is replaced by that of the base that the effect
    is attached to.
    """

    effect: Effect
    scales: Scales
    place: int = 0
    upstream: bool = False

    def attached_to(self, base: Base) -> ExtendedSimulation:
        """Return the simulation of a base with the effect, whose scales hold the base's motion."""
        scales = self.scales
        if base.motions and not self.effect.on_input:
            moved = base.motions[self.place]
            port = base.fit.extended.simulation.force_ports[self.place]
            scales = replace(
                scales,
                z_low=moved.low,
                z_high=moved.high,
                z_rate=moved.rate,
                placed=port.position is not None,
                inertia=base.fit.extended.normalisations[self.place].inertia,
            )
        return base.fit.extended.attach(self.effect, scales, self.place, self.upstream)


class Start(NamedTuple):
    """A place to fit a law from, and what it promises.

    Parameters
    ----------
    left
        Sum of squares of a base's residual that remains after the best linear step of its
        parameters and the best multiple of the change that the law causes there.
    """

    left: float
    base: Base
    extended: ExtendedSimulation
    coordinates: np.ndarray


def promising(problem: Problem, bases: Sequence[Base], offer: Offer, kept: int) -> list[Start]:
    """Return the starts of an effect that promise most, from all ``bases``, best first.

    The bases are fits of one simulation. There is one start more than are ``kept``, from one base
    half as many at most; none where this record gives the effect no start.
    """
    found: list[Start] = []
    for base in bases:
        extended = offer.attached_to(base)
        law = extended.attached[-1]
        own = [
            _promised(problem, base, extended, law.started(start))
            for start in offer.effect.starts(law.scales)
        ]
        found += sorted(own, key=lambda start: start.left)[: max(1, kept // 2)]
    return sorted(found, key=lambda start: start.left)[: kept + min(_MORE, kept - 1)]


def _promised(problem: Problem, base: Base, extended: ExtendedSimulation, law: np.ndarray) -> Start:
    placed = extended.layout.coordinates(np.concatenate([base.fit.values, law]))
    residual = base.residual(problem, extended, placed)
    explained = -1.0
    if np.isfinite(residual).all():
        change = base.remainder((base.fit.residual - residual)[problem.seen])
        explained = max(change @ base.left, 0.0) ** 2 / max(change @ change, 1e-300)
    return Start(float(base.left @ base.left - explained), base, extended, placed)


def first_steps(
    problem: Problem, base: Base, offer: Offer, starts: Sequence[Start], steps: int
) -> list[Fit]:
    """Fit an effect from its ``starts`` by a few cheap steps; return the stable fits, best first.

    They use the start's Jacobian for all parameters that its base has. Parameters that shape a law
    are held. No fit needs to end worse than ``base``.
    """

    def fitted(start: Start) -> Fit:
        columns = Columns(held=start.extended.layout.shapes, kept=start.base.fit.jacobian)
        return fit(problem, start.extended, start.coordinates, iterations=steps, columns=columns)

    def error(candidate: Fit) -> float:
        return problem.seen_rmse(candidate.residual)

    found = [fitted(start) for start in starts]
    if min(map(error, found), default=0.0) > error(base.fit):
        # Where it does nothing, a law leaves the simulation's own fit.
        nothing = where_it_does_nothing(problem, base, offer)
        found += [] if nothing is None else [fitted(nothing)]
    return sorted((each for each in found if each.stable), key=error)


def further_steps(problem: Problem, found: Sequence[Fit], kept: int, steps: int) -> list[Fit]:
    """Continue first steps, best first, with a Jacobian of their own; return at most ``kept``.

    Those found are returned where every one runs away.
    """
    again = [
        refine(problem, each, steps, each.extended.layout.shapes)
        for each in found[: min(kept, _USED + _MORE)]
    ]
    stable = [each for each in again if each.stable]
    stable.sort(key=lambda each: problem.seen_rmse(each.residual))
    return (stable or list(found))[:kept]


def where_it_does_nothing(problem: Problem, base: Base, offer: Offer) -> Start | None:
    """Return where the law offered hardly changes anything, beside the first start that allows it.

    One parameter of a start at a time is put at its prior mean, at its bounds, or far from its
    prior: a step of nothing, a threshold at zero, a limit beyond the range.
    """
    extended = offer.attached_to(base)
    law = extended.attached[-1]
    first = base.fit.coordinates.size
    low, high = extended.layout.bounds
    seen, noise = problem.seen, problem.noise
    for start in offer.effect.starts(law.scales):
        placed = extended.layout.coordinates(np.concatenate([base.fit.values, law.started(start)]))
        own = range(first, placed.size)
        means = [(i, 0.0) for i in own if placed[i]]
        ends = [(i, end) for i in own for end in (max(low[i], -_FAR), min(high[i], _FAR))]
        least, found = _NOTHING * noise, None
        for i, place in (*means, *ends):
            moved = placed.copy()
            moved[i] = place
            change = base.residual(problem, extended, moved) - base.fit.residual
            size = rmse(change, seen)
            if size < least:
                least = size
                found = Start(float(base.left @ base.left), base, extended, moved)
                if size < _SURELY_NOTHING * noise:
                    return found
        if found is not None:
            return found
    return None


def refine(
    problem: Problem,
    screened: Fit,
    iterations: int,
    held: np.ndarray | None = None,
    tolerance: float = 1e-4,
) -> Fit:
    """Continue a screened fit with a Jacobian of all parameters, or of all that are not held."""
    own = screened.extended.layout.effect_slices[-1]
    known = int(np.sum(screened.extended.layout.free < own.start))
    return fit(
        problem,
        screened.extended,
        screened.coordinates,
        iterations=iterations,
        tolerance=tolerance,
        columns=Columns(held=held, slow=known),
    )
