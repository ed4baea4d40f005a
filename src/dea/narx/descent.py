"""Search at falling prices of a term; folds of the record say at which price to stop.

At a high price only terms that explain much are kept; each lower price starts from the structure of
the one before. The lowest price that is tried follows from the noise: of m candidates
without any effect, the best explains 2 ln(m)/N of the squared error by chance (Foster and George
1994, Annals of Statistics 22:1947). Where the error left is not white noise but what no candidate
describes, a higher price predicts better: the search is repeated with each third of the record left
out, and the price whose error on the thirds left out has the least geometric mean is taken; a run
that is worse than the mean of the output, or diverges, counts as that mean.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Segment
from dea.errors import InputError
from dea.narx.candidate_models import CandidateModels, Subset
from dea.narx.exchange import Exchange, FittedStructure, JointFit, System
from dea.narx.forward import forward_and_prune
from dea.narx.orthogonal import orthogonal_order
from dea.narx.segments import squared_error
from dea.narx.trace import Trace, Tried, serr
from dea.progress import tell
from dea.terms import Term, max_lag

PRICES = tuple(float(price) for price in 1e-2 * 4.0 ** -np.arange(13))  # 1e-2 to 6e-10
_FOLDS = 3
_LONGEST_START = 25  # terms of the largest structure that FROLS proposes
_LEAST_FORWARD = 1e-5  # threshold of the forward selection that a search starts from
_AS_GOOD = 1.01  # times the least error, up to which a higher price is as good
_WORSE = 4.0  # times the least error, beyond which no lower price is tried


class Effort(NamedTuple):
    """Bounds of a search."""

    rounds: int  # accepted steps
    most: int  # terms


class Descent:
    """Searches at falling prices from the structure that FROLS proposes.

    Parameters
    ----------
    candidates
        All terms a model may have.
    systems
        For each system its normalised segments; the systems share the structure, the segments of
        a system their parameters too.
    """

    def __init__(
        self, candidates: Sequence[Term], systems: Sequence[Sequence[Segment]], trace: Trace
    ) -> None:
        self._candidates = tuple(candidates)
        self._models = [CandidateModels(candidates, segments) for segments in systems]
        self._samples = sum(models.samples for models in self._models)
        known = [
            System(segments, models.power, relative_sizes(models.triangle))
            for segments, models in zip(systems, self._models, strict=True)
        ]
        self.exchange = Exchange(candidates, known)
        self._linear = tuple(j for j, term in enumerate(candidates) if term.degree <= 1)
        self._trace = trace

    def levels(self, prices: Sequence[float], effort: Effort) -> Iterator[FittedStructure]:
        """Yield the structure found at each price, down to what a term explains by chance."""
        rounds = effort.rounds
        now = self._start(prices[0], effort.most)
        chance = 2.0 * np.log(len(self._candidates)) / self._samples
        for level, price in enumerate(prices):
            if level and price < chance * now.fit.error:
                return
            now, taken = self.exchange.search(now, price, rounds, effort.most, self._trace)
            rounds -= taken
            tell(f"search at threshold {price:.1e}: {len(now.subset)} terms")
            yield now

    def descend(self, prices: Sequence[float], effort: Effort) -> None:
        """Try the structures of every price, and of the paper's forward selection at the last.

        Both searches are greedy and end at different structures; that of least cost is taken.
        """
        for _ in self.levels(prices, effort):
            pass  # each level continues from the one before
        if len(self._models) == 1:
            models = self._models[0]
            threshold = max(prices[-1], _LEAST_FORWARD)
            subset = forward_and_prune(
                models, self._linear, threshold, threshold, effort.most, self._trace
            )
            fit = self.exchange.fit(subset, [models([subset])[0].parameters])
            self.exchange.search(FittedStructure(subset, fit), prices[-1], *effort, self._trace)

    def orthogonal(self, most: int) -> list[FittedStructure]:
        """Return what FROLS has after each step, with least-squares parameters."""
        triangles = _stacked([models.triangle for models in self._models])
        order, _ = orthogonal_order(triangles, most)
        subsets = [tuple(sorted(order[: k + 1].tolist())) for k in range(order.size)]
        found = self._estimated(subsets)
        power, before = self.exchange.power, np.inf
        for step, (j, structure) in enumerate(zip(order, found, strict=True)):
            error = structure.fit.error
            tried = Tried(str(self._candidates[j]), error * power, serr(before, error, 1.0))
            self._trace.add("orthogonal", step, [tried], 0, "added")
            before = error
        return found

    def _start(self, price: float, most: int) -> FittedStructure:
        """Return the least cost of what FROLS has after each step, and of the linear terms."""
        starts = self.orthogonal(min(most, _LONGEST_START))
        if len(self._linear) <= most:
            starts += self._estimated([self._linear])
        best = min(starts, key=lambda start: self.exchange.cost(start, price))
        return FittedStructure(best.subset, self.exchange.fit(best.subset, best.fit.parameters))

    def _estimated(self, subsets: Sequence[Subset]) -> list[FittedStructure]:
        outcomes = [models(subsets) for models in self._models]
        return [
            FittedStructure(
                subset,
                JointFit(
                    tuple(outcome.parameters for outcome in each),
                    float(
                        np.mean(
                            [
                                outcome.msse / models.power
                                for outcome, models in zip(each, self._models, strict=True)
                            ]
                        )
                    ),
                ),
            )
            for subset, *each in zip(subsets, *outcomes, strict=True)
        ]


def price_by_folds(
    candidates: Sequence[Term], systems: Sequence[Sequence[Segment]], effort: Effort
) -> float:
    """Return the price of a term at which models predict parts they were not chosen on best."""
    lag = max_lag(candidates)
    folds = [[_without(segments, fold, lag) for segments in systems] for fold in range(_FOLDS)]
    paths = [
        Descent(candidates, [kept for kept, _ in fold], Trace()).levels(PRICES, effort)
        for fold in folds
    ]
    errors: list[list[float]] = []
    for _ in PRICES:
        reached = [next(path, None) for path in paths]
        if all(structure is None for structure in reached):
            break
        last = errors[-1] if errors else [np.inf] * _FOLDS
        errors.append(
            [
                before if structure is None else _held_out(candidates, structure, fold)
                for structure, fold, before in zip(reached, folds, last, strict=True)
            ]
        )
        means = _geometric_means(errors)
        if min(means[-2:]) > _WORSE * means.min():
            break
    means = _geometric_means(errors)
    return PRICES[int(np.argmax(means <= _AS_GOOD * means.min()))]


def relative_sizes(triangle: Array) -> Array:
    """Return the root mean square of each regressor over that of the output, (terms,)."""
    norms = np.linalg.norm(triangle, axis=1)
    sizes: Array = norms[:-1] / norms[-1]
    return sizes


def _stacked(triangles: Sequence[Array]) -> Array:
    """Return the triangles of several systems as one array, (systems, terms + 1, rows).

    One of fewer equations than terms has fewer rows; zeros fill the others.
    """
    rows = max(triangle.shape[1] for triangle in triangles)
    return np.stack(
        [np.pad(triangle, ((0, 0), (0, rows - triangle.shape[1]))) for triangle in triangles]
    )


def _geometric_means(errors: Sequence[Sequence[float]]) -> Array:
    """Return the mean error of the folds at each level, each fold counting by its ratios."""
    means: Array = np.exp(np.log(np.clip(errors, 1e-300, 1.0)).mean(axis=1))
    return means


def _without(
    segments: Sequence[Segment], fold: int, lag: int
) -> tuple[list[Segment], list[Segment]]:
    """Split each segment into what a fold keeps and what it leaves out."""
    kept: list[Segment] = []
    left_out: list[Segment] = []
    for u, y in segments:
        edges = np.linspace(0, y.size, _FOLDS + 1).astype(int)
        first, last = edges[fold], edges[fold + 1]
        left_out.append((u[first:last], y[first:last]))
        kept += [
            (u[part], y[part])
            for part in (slice(0, first), slice(last, y.size))
            if y[part].size > lag
        ]
    if not kept or not any(y.size > lag for _, y in left_out):
        samples = sum(y.size for _, y in segments)
        raise InputError(
            f"a third of its {samples} samples is no longer than the largest lag, {lag}, so that"
            " no threshold can be chosen",
            field="u",
            remedy="Use a longer record or smaller lags, or search=Refined(threshold).",
        )
    return kept, left_out


def _held_out(
    candidates: Sequence[Term],
    structure: FittedStructure,
    fold: Sequence[tuple[list[Segment], list[Segment]]],
) -> float:
    """Squared error of the free runs on what the fold left out, mean of the systems."""
    terms = tuple(candidates[j] for j in structure.subset)
    shares = []
    for (_, left_out), parameters in zip(fold, structure.fit.parameters, strict=True):
        squares = sum(float(y @ y) for _, y in left_out)
        shares.append(squared_error(terms, parameters, left_out) / squares)
    return float(np.mean(shares))
