"""Improve a structure by adding, removing and exchanging terms under refined parameters.

Forward selection judges each term by least-squares parameters, which noise biases, and does not
reconsider pairs of terms. Here the parameters of every candidate structure minimise the simulated
error, so that the right structure reaches the noise floor. To limit the number of fits, the
derivative of the run by the parameter of *every* candidate term, projected orthogonally to those
of the present terms, predicts the gain of each; only the best few are fitted. A step is taken if

    MSSE / mean(y^2) + price * sum_j (1 + log2(max(1, size_j / 4)))

falls, where size_j is the root mean square of the term's contribution over that of the output:
each term has its price, and one that others cancel costs more. Since this falls with every step,
no structure is taken twice and the search ends. A model that is stable only on these records
counts as unstable. Several systems share the structure, and each has its own parameters; the error
is then their mean.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Segment
from dea.narx.candidate_models import Subset
from dea.narx.parameter_covariance import column_norms
from dea.narx.refinement import minimise
from dea.narx.segments import LinearisedRuns, linearise
from dea.narx.stability import StabilityTest, stays_in_range_reversed
from dea.narx.trace import Trace, Tried, serr
from dea.terms import Term

_FITTED = 4  # additions, and removals, of best predicted gain that are fitted in a round
_EFFORT = (8, 1e-4)  # iterations and relative tolerance of a candidate's fit
_LEAST_FALL = 0.01  # share of the price by which the cost falls in an accepted step
_AMPLE = 4.0  # contribution of a term, relative to the output, above which it costs more
_DOUBT = 3.0  # prices by which a fit may turn out better than its prediction
_DEPENDENT = 1e-10  # share of a slope's energy below which it is rounding


class System(NamedTuple):
    """What a search knows of one system."""

    segments: Sequence[Segment]
    power: float  # mean square of the normalised output
    sizes: Array  # (candidates,) root mean square of each regressor over that of the output


class JointFit(NamedTuple):
    """Refined parameters of one structure, of each system its own, and their error."""

    parameters: tuple[Array, ...]  # of each system (terms,)
    error: float  # mean over the systems of MSSE / mean(y^2); inf where one is not stable


class FittedStructure(NamedTuple):
    """A subset of the candidate terms, and its fit."""

    subset: Subset
    fit: JointFit


class Move(NamedTuple):
    """A structure that a round tries, with the parameters to start its fit from."""

    label: str
    status: str
    subset: Subset
    start: tuple[Array, ...]
    predicted: float  # error of the fit


class Exchange:
    """Searches structures among ``candidates`` for one system or several."""

    def __init__(self, candidates: Sequence[Term], systems: Sequence[System]) -> None:
        self._candidates = tuple(candidates)
        self._systems = tuple(systems)
        self.power = float(np.mean([system.power for system in systems]))
        self._fits: dict[Subset, JointFit] = {}
        self._unsteady: dict[Subset, JointFit] = {}  # with the errors on the records alone
        self._tests: Sequence[StabilityTest] = ()
        self._untested: set[Subset] = set()  # fitted before the tests were required

    def search(
        self, start: FittedStructure, price: float, rounds: int, most: int, trace: Trace
    ) -> tuple[FittedStructure, int]:
        """Improve a structure for at most ``rounds`` accepted steps and ``most`` terms.

        Returns the structure found, or the one given if none is better, and the steps taken.
        """
        now = start
        for step in range(1, rounds + 1):
            for moves in self._rounds(now, price, most):
                found = [
                    FittedStructure(move.subset, self.fit(move.subset, move.start))
                    for move in moves
                ]
                costs = [self.cost(each, price) for each in found]
                best = int(np.argmin(costs)) if costs else 0
                fallen = self.cost(now, price) - min(costs, default=np.inf)
                accepted = fallen > _LEAST_FALL * price
                trace.add(
                    "exchange",
                    step,
                    [
                        Tried(
                            move.label,
                            each.fit.error * self.power,
                            serr(now.fit.error, each.fit.error, 1.0),
                        )
                        for move, each in zip(moves, found, strict=True)
                    ],
                    best if accepted else None,
                    moves[best].status if moves else "",
                )
                if accepted:
                    now = found[best]
                    break
            else:
                return now, step - 1
        return now, rounds

    def cost(self, structure: FittedStructure, price: float) -> float:
        """Return the error and the price of the terms."""
        subset, fit = structure
        columns = list(subset)
        sizes = np.mean(
            [
                system.sizes[columns] * np.abs(parameters)
                for system, parameters in zip(self._systems, fit.parameters, strict=True)
            ],
            axis=0,
        )
        extra = np.log2(np.maximum(1.0, sizes / _AMPLE)).sum()
        return float(fit.error + price * (len(subset) + extra))

    def fit(self, subset: Subset, start: Sequence[Array]) -> JointFit:
        """Refine the parameters of each system, once for each structure."""
        if subset not in self._fits:
            terms = self._terms(subset)
            fits = [
                minimise(terms, first, system.segments, *_EFFORT)
                for system, first in zip(self._systems, start, strict=True)
            ]
            shares = [fit.msse / each.power for fit, each in zip(fits, self._systems, strict=True)]
            fit = JointFit(tuple(each.parameters for each in fits), float(np.mean(shares)))
            self._fits[subset] = self._checked(subset, fit) if np.isfinite(fit.error) else fit
        return self._tested(subset)

    def require(self, tests: Sequence[StabilityTest]) -> None:
        """From now on, count what does not pass the ``tests`` of its system as unstable.

        Structures that were fitted before are tested when they are asked for again: most are not.
        """
        self._tests = tuple(tests)
        self._untested = {subset for subset, fit in self._fits.items() if np.isfinite(fit.error)}

    def by_cost(self, price: float, most: int) -> Iterator[FittedStructure]:
        """Yield the structures tried, the least cost first, those that are not stable last."""
        for fits in (self._fits, self._unsteady):
            tried = [
                FittedStructure(subset, fit)
                for subset, fit in fits.items()
                if np.isfinite(fit.error) and len(subset) <= most
            ]
            for each in sorted(tried, key=lambda each: self.cost(each, price)):
                if fits is self._unsteady or np.isfinite(self._tested(each.subset).error):
                    yield each

    def _tested(self, subset: Subset) -> JointFit:
        """Return the fit of a structure, tested as is required by now."""
        if subset in self._untested:
            self._untested.remove(subset)
            self._fits[subset] = self._checked(subset, self._fits[subset])
        return self._fits[subset]

    def _checked(self, subset: Subset, fit: JointFit) -> JointFit:
        """Return the fit, its error infinite where it is not stable."""
        terms = self._terms(subset)
        stable = all(
            stays_in_range_reversed(terms, parameters, system.segments)
            for system, parameters in zip(self._systems, fit.parameters, strict=True)
        ) and all(
            test.passes(terms, parameters)
            for test, parameters in zip(self._tests, fit.parameters, strict=False)
        )
        if stable:
            return fit
        self._unsteady[subset] = fit
        return fit._replace(error=np.inf)

    def _rounds(self, now: FittedStructure, price: float, most: int) -> Iterator[list[Move]]:
        """Removals, then additions, then exchanges: in order of computing time."""

        def promising(moves: Sequence[Move]) -> list[Move]:
            """The best few of those whose prediction is not too far above the present error."""
            near = [each for each in moves if each.predicted <= now.fit.error + _DOUBT * price]
            return sorted(near, key=lambda each: each.predicted)[:_FITTED]

        # An unstable structure has an infinite error; with one more or less term it may be stable.
        yield promising(self._removals(now, ""))
        additions = self._additions(now)
        if len(now.subset) < most:
            yield additions
        exchanges = []
        for move in additions:
            tried = self.fit(move.subset, move.start)
            if np.isfinite(tried.error):
                kept = set(move.subset) & set(now.subset)
                exchanges += [
                    swap
                    for swap in self._removals(
                        FittedStructure(move.subset, tried), f"{move.label} for "
                    )
                    if not kept <= set(swap.subset)
                ]
        yield promising(exchanges)

    def _removals(self, now: FittedStructure, prefix: str) -> list[Move]:
        """The terms whose removal raises the error least, by the quadratic model at the minimum."""
        subset, fit = now
        if len(subset) == 1:
            return []
        rise = np.zeros(len(subset))
        moved = []
        for system, point, parameters in self._linearised(subset, fit.parameters):
            if not np.isfinite(point.error):
                return []
            norms = column_norms(point.slope)
            inverse = np.linalg.pinv(
                (point.slope / norms).T @ (point.slope / norms), hermitian=True
            )
            scaled = parameters * norms
            diagonal = np.maximum(np.diag(inverse), np.finfo(float).tiny)
            rise += self._share(system, point, scaled**2 / diagonal)
            # Column i: the parameters at the minimum of the quadratic model without term i.
            moved.append((scaled[:, None] - inverse * (scaled / diagonal)) / norms[:, None])
        moves = []
        for i in np.argsort(rise, kind="stable")[:_FITTED]:
            label = prefix + str(self._candidates[subset[i]])
            status = "exchanged" if prefix else "pruned"
            rest = tuple(j for j in subset if j != subset[i])
            start = tuple(np.delete(each[:, i], i) for each in moved)
            moves.append(Move(label, status, rest, start, fit.error + float(rise[i])))
        return moves

    def _additions(self, now: FittedStructure) -> list[Move]:
        """The terms of largest predicted fall, by their slope orthogonal to the present slopes."""
        present = list(now.subset)
        everything = tuple(range(len(self._candidates)))
        full = [np.zeros(len(everything)) for _ in self._systems]
        for each, parameters in zip(full, now.fit.parameters, strict=True):
            each[present] = parameters
        fall = np.zeros(len(everything))
        for system, point, _ in self._linearised(everything, full):
            if not np.isfinite(point.error):
                return []
            slope = point.slope
            basis, _ = np.linalg.qr(slope[:, present] / column_norms(slope[:, present]))
            off = slope - basis @ (basis.T @ slope)
            energy = np.einsum("ij,ij->j", off, off)
            usable = energy > _DEPENDENT * np.einsum("ij,ij->j", slope, slope)
            explained = np.where(usable, (off.T @ point.residual) ** 2, 0.0)
            explained /= np.where(usable, energy, 1.0)
            fall += self._share(system, point, explained)
        fall[present] = 0.0
        moves = []
        for j in np.argsort(-fall, kind="stable")[:_FITTED]:
            if fall[j] > 0.0:
                grown = tuple(sorted((*now.subset, int(j))))
                start = tuple(each[list(grown)] for each in full)
                predicted = now.fit.error - float(fall[j])
                moves.append(Move(str(self._candidates[j]), "added", grown, start, predicted))
        return moves

    def _share(self, system: System, point: LinearisedRuns, squares: Array) -> Array:
        """Return by how much sums of squares of a system change the mean error of all."""
        return squares / (len(self._systems) * system.power * point.residual.size)

    def _linearised(
        self, subset: Subset, parameters: Sequence[Array]
    ) -> Iterator[tuple[System, LinearisedRuns, Array]]:
        terms = self._terms(subset)
        for system, theta in zip(self._systems, parameters, strict=True):
            yield system, linearise(terms, theta, system.segments), theta

    def _terms(self, subset: Subset) -> tuple[Term, ...]:
        return tuple(self._candidates[j] for j in subset)
