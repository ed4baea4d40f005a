"""Candidate models: subsets of the candidate terms, estimated and simulated freely, fast.

The candidates' regressors are compressed once to a triangle by QR, so that least squares (4) on a
subset costs nothing that grows with the record and, unlike normal equations, does not square the
condition number: neighbouring lags of a smooth signal are almost collinear. Products of inputs
are computed once as well; only the recursion (7) is left for each candidate model.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Segment
from dea.narx.candidate_kernels import Candidates, EstimationData, estimate_and_simulate
from dea.narx.kernels import NONE
from dea.narx.limits import bound_of
from dea.narx.regressors import regressor_matrix
from dea.narx.simulation import structure
from dea.terms import Term, max_lag

Subset = tuple[int, ...]


class CandidateModel(NamedTuple):
    """A candidate model, estimated and simulated."""

    msse: float  # mean squared simulated error (6); inf where the run diverged
    parameters: Array  # (terms of the subset,)


class CandidateModels:
    """Estimates and simulates models made of any of the candidate terms.

    Parameters
    ----------
    candidates
        All terms a model may have.
    segments
        Normalised inputs and outputs, as for :func:`dea.narx.regressor_matrix`. Each is simulated
        from its own first outputs; they share their parameters.

    Attributes
    ----------
    triangle
        The regressors and, in the last row, the output, compressed by QR; (terms + 1, rows).
    power
        Mean square of the normalised output.
    """

    def __init__(self, candidates: Sequence[Term], segments: Sequence[Segment]) -> None:
        self.candidates = tuple(candidates)
        self.start = max_lag(candidates)
        u = np.concatenate([u for u, _ in segments])
        y = np.concatenate([y for _, y in segments])
        ends = np.cumsum([y.size for _, y in segments]).astype(np.int64)
        self.samples = int(ends[-1] - self.start * len(segments))
        rows = [
            np.column_stack([regressor_matrix(candidates, u, y, self.start), y[self.start :]])
            for u, y in segments
        ]
        triangle: Array = np.linalg.qr(np.vstack(rows), mode="r")  # type: ignore[assignment]
        self.power = float(np.mean(np.concatenate([row[:, -1] for row in rows]) ** 2))
        shape = structure(self.candidates)
        terms = sorted({term.input_part for term in candidates})
        product = [terms.index(term.input_part) for term in candidates]
        self._terms = Candidates(
            shape.group, shape.y_lags, np.array(product, dtype=np.int64), self.start
        )
        products = np.ones((len(terms), y.size))
        first = max((term.max_lag for term in terms), default=0)
        products[:, first:] = regressor_matrix(terms, u, y, first).T
        self.triangle: Array = np.ascontiguousarray(triangle.T)
        self._data = EstimationData(self.triangle, products, y, ends)
        self._bound = bound_of(segments)
        self._known: dict[Subset, CandidateModel] = {}

    def __call__(self, subsets: Iterable[Subset]) -> list[CandidateModel]:
        """Return the model of each subset (sorted candidate indices); each is computed once."""
        asked = list(subsets)
        fresh = [subset for subset in dict.fromkeys(asked) if subset not in self._known]
        if fresh:
            width = max(map(len, fresh))
            columns = np.full((len(fresh), width), NONE, dtype=np.int64)
            for row, subset in zip(columns, fresh, strict=True):
                row[: len(subset)] = subset
            errors, theta = estimate_and_simulate(columns, self._terms, self._data, self._bound)
            for subset, error, parameters in zip(fresh, errors / self.samples, theta, strict=True):
                self._known[subset] = CandidateModel(float(error), parameters[: len(subset)])
        return [self._known[subset] for subset in asked]
