"""Improve a structure by adding, removing and exchanging terms under refined parameters.

Forward selection judges each term by least-squares parameters, which noise biases, and does not
reconsider pairs of terms. Here the parameters of every candidate structure minimise the simulated
error, so that the right structure reaches the noise floor. To limit the number of fits, the
derivative of the run by the parameter of *every* candidate term, projected orthogonally to those
of the present terms, predicts the gain of each; only the best few are fitted. A step is taken if

    MSSE / mean(y^2) + price * (number of terms)

falls; since this cost falls with every step, no structure is taken twice and the search ends. A
model that stays bounded only on these records counts as unstable.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dea.narx.candidate_models import Segment, Subset
from dea.narx.checks import Array
from dea.narx.parameter_covariance import column_norms
from dea.narx.refinement import Refined, linearise, minimise
from dea.narx.simulation import simulate
from dea.narx.trace import Trace, Tried, gain
from dea.terms import Term

_FITTED = 4  # additions, and removals, of best predicted gain that are fitted in a round
_EFFORT = (8, 1e-4)  # iterations and relative tolerance of a candidate's fit
_LEAST_FALL = 0.01  # share of the price by which the cost falls in an accepted step
_LEEWAY = 3.0  # times the largest measured output that a run may reach on reversed inputs
_DEPENDENT = 1e-10  # share of a slope's energy below which it is rounding


class Move(NamedTuple):
    """A structure that a round tries, with the parameters to start its fit from."""

    label: str
    status: str
    subset: Subset
    start: Array


class Exchange:
    """Searches structures among ``candidates`` on normalised segments."""

    def __init__(
        self, candidates: Sequence[Term], segments: Sequence[Segment], power: float, price: float
    ) -> None:
        self._candidates = tuple(candidates)
        self._segments = segments
        self._power = power
        self._price = price
        self._fits: dict[Subset, Refined] = {}

    def search(
        self, subset: Subset, start: Array, rounds: int, most: int, trace: Trace
    ) -> tuple[Subset, Array]:
        """Improve ``subset`` for at most ``rounds`` accepted steps and ``most`` terms.

        Returns the structure and parameters found; those given, refined, if none is better.
        """
        fit = self._fit(subset, start)
        for step in range(1, rounds + 1):
            for moves in self._rounds(subset, fit, most):
                fits = [self._fit(move.subset, move.start) for move in moves]
                costs = [
                    self._cost(move.subset, tried) for move, tried in zip(moves, fits, strict=True)
                ]
                best = int(np.argmin(costs)) if costs else 0
                fallen = self._cost(subset, fit) - min(costs, default=np.inf)
                accepted = fallen > _LEAST_FALL * self._price
                trace.add(
                    "exchange",
                    step,
                    [
                        Tried(move.label, tried.msse, gain(fit.msse, tried.msse, self._power))
                        for move, tried in zip(moves, fits, strict=True)
                    ],
                    best if accepted else None,
                    moves[best].status if moves else "",
                )
                if accepted:
                    subset, fit = moves[best].subset, fits[best]
                    break
            else:
                break
        return subset, fit.parameters

    def _rounds(self, subset: Subset, fit: Refined, most: int) -> Iterator[list[Move]]:
        """Removals, then additions, then exchanges: in order of computing time."""
        yield self._removals(subset, fit, "")
        additions = self._additions(subset, fit)
        if len(subset) < most:
            yield additions
        exchanges = []
        for move in additions:
            tried = self._fit(move.subset, move.start)
            if np.isfinite(tried.msse):
                kept = set(move.subset) & set(subset)
                exchanges += [
                    swap
                    for swap in self._removals(move.subset, tried, f"{move.label} for ")
                    if not kept <= set(swap.subset)
                ]
        yield exchanges

    def _removals(self, subset: Subset, fit: Refined, prefix: str) -> list[Move]:
        """The terms whose removal raises the error least, by the quadratic model at the minimum."""
        if len(subset) == 1:
            return []
        error, _, slope = linearise(self._terms(subset), fit.parameters, self._segments)
        if not np.isfinite(error):
            return []
        norms = column_norms(slope)
        inverse = np.linalg.pinv((slope / norms).T @ (slope / norms), hermitian=True)
        scaled = fit.parameters * norms
        rise = scaled**2 / np.maximum(np.diag(inverse), np.finfo(float).tiny)
        moves = []
        for i in np.argsort(rise, kind="stable")[:_FITTED]:
            moved = (scaled - inverse[:, i] * scaled[i] / inverse[i, i]) / norms
            label = prefix + str(self._candidates[subset[i]])
            status = "exchanged" if prefix else "pruned"
            rest = tuple(j for j in subset if j != subset[i])
            moves.append(Move(label, status, rest, np.delete(moved, i)))
        return moves

    def _additions(self, subset: Subset, fit: Refined) -> list[Move]:
        """The terms of largest predicted fall, by their slope orthogonal to the present slopes."""
        full = np.zeros(len(self._candidates))
        full[list(subset)] = fit.parameters
        point = linearise(self._candidates, full, self._segments)
        if not np.isfinite(point.error):
            return []
        present = point.slope[:, list(subset)]
        basis, _ = np.linalg.qr(present / column_norms(present))
        off = point.slope - basis @ (basis.T @ point.slope)
        energy = np.sum(off**2, axis=0)
        usable = energy > _DEPENDENT * np.sum(point.slope**2, axis=0)
        usable[list(subset)] = False
        fall = np.where(usable, (off.T @ point.residual) ** 2, 0.0)
        fall /= np.where(usable, energy, 1.0)
        moves = []
        for j in np.argsort(-fall, kind="stable")[:_FITTED]:
            if fall[j] > 0.0:
                grown = tuple(sorted((*subset, int(j))))
                label = str(self._candidates[j])
                moves.append(Move(label, "added", grown, full[list(grown)]))
        return moves

    def _fit(self, subset: Subset, start: Array) -> Refined:
        if subset not in self._fits:
            terms = self._terms(subset)
            fit = minimise(terms, start, self._segments, *_EFFORT)
            if not self._is_steady(terms, fit.parameters):
                fit = Refined(fit.parameters, np.inf)
            self._fits[subset] = fit
        return self._fits[subset]

    def _is_steady(self, terms: tuple[Term, ...], theta: Array) -> bool:
        """Whether the model stays in range on the time-reversed inputs of the records.

        These have the same amplitudes and spectrum, so that a model that leaves the measured range
        by far on them is bounded on these records only.
        """
        for u, y in self._segments:
            limit = _LEEWAY * float(np.abs(y).max())
            run = simulate(terms, theta, np.ascontiguousarray(u[::-1]), y[::-1], bound=limit)
            if not np.isfinite(run[-1]):
                return False
        return True

    def _cost(self, subset: Subset, fit: Refined) -> float:
        return fit.msse / self._power + self._price * len(subset)

    def _terms(self, subset: Subset) -> tuple[Term, ...]:
        return tuple(self._candidates[j] for j in subset)
