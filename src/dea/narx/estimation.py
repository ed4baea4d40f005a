"""Parameters of a given structure by least squares on the one-step error."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.arrays import Array, Segment
from dea.autoregression import fit_autoregression
from dea.errors import InputError
from dea.inputs import by_input, input_count
from dea.narx.checks import as_pair, check_variation, refuse_missing
from dea.narx.labels import Signals, listed, unpacked
from dea.narx.model import NarxModel
from dea.narx.parameter_covariance import column_norms
from dea.narx.regressors import regressor_matrix
from dea.narx.scaling import Scaling, require_scaling
from dea.store import Record
from dea.terms import Term, as_terms, max_lag

NOT_WHITE = (
    "the one-step error is correlated in time, so that least squares on measured outputs is biased"
)
DEPENDENT_TERMS = (
    "the record leaves a combination of the parameters undetermined, since the terms depend on each"
    " other there"
)
FEW_EQUATIONS = (
    "fewer than ten equations are left beside the unknowns, too few to tell how large the noise is"
)
_LEFT = 10  # of a normal law; with fewer degrees of freedom a 95 % interval holds less than 92 %
_ROUNDING = 1e-12  # errors up to this share of the largest output are rounding
_DEPENDENT = 1e-12  # singular values below this share of the largest are rounding


def estimate(
    terms: Iterable[Term | str],
    u: Signals | Record | Sequence[Record],
    y: Signals | None = None,
    *,
    scaling: Scaling | None = None,
) -> NarxModel:
    """Least-squares estimate (4) of the parameters of ``terms``, with their covariance.

    Parameters
    ----------
    terms
        Monomials, or text such as ``y(t-1)u(t-3)^2``.
    u, y
        Measured input and output in physical units, shape (samples,), or equally long lists of
        such records, which share the parameters. Several inputs are the columns of ``u``, shape
        (samples, inputs). Or one or several :class:`dea.Record` alone, as for
        :func:`dea.select_terms`.
    scaling
        By default :func:`scaling_of` the records.

    Returns
    -------
    NarxModel
        Its covariance is that for a white one-step error. Noise on the output biases the
        parameters themselves, and then no interval around them holds: where the one-step error is
        not white, ``withheld`` of the model says so. :func:`dea.narx.refine` removes that bias.
        Parameters that the records leave undetermined take the smallest values that explain them,
        and ``withheld`` says so too, or that there are too few equations.

    Raises
    ------
    InputError
        If the records are not usable or are too short.
    """
    chosen = as_terms(terms)
    lag = max_lag(chosen)
    inputs, outputs, labels = unpacked(u, y, lag, len(chosen))
    records = as_segments(inputs, outputs, lag, len(chosen))
    scale = scaling_of(records) if scaling is None else scaling
    require_scaling(scale)
    found = least_squares(chosen, normalised(records, scale))
    return NarxModel(
        chosen,
        found.parameters,
        scale,
        found.covariance,
        withheld=found.withheld,
        labels=labels,
    )


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Parameters (terms,) of least squared one-step error, and their covariance (terms, terms).

    ``rank`` is the number of directions of the parameters that the equations determine,
    ``residuals`` holds the one-step error of each segment, and ``outputs`` what the equations give.
    """

    parameters: Array
    covariance: Array
    rank: int
    residuals: list[Array]
    outputs: Array

    @cached_property
    def withheld(self) -> str:
        """Why intervals of the estimate cannot hold, empty where they can.

        The estimate is consistent only if the one-step error is white; its order as an
        autoregression says whether it is.
        """
        terms, equations = self.parameters.size, sum(error.size for error in self.residuals)
        undetermined = too_little(equations, terms, terms - self.rank)
        if undetermined:
            return undetermined
        return not_white(self.residuals, self.outputs)


def not_white(errors: Sequence[Array], outputs: Array) -> str:
    """Return why one-step errors give no intervals, empty where they are white.

    Errors that are the rounding of the ``outputs`` are none. Missing samples (NaN) are left out.
    """
    largest, level = (
        np.max(np.abs(each), initial=0.0, where=np.isfinite(each))
        for each in (np.concatenate(errors), outputs)
    )
    if largest <= _ROUNDING * level:
        return ""
    return NOT_WHITE if fit_autoregression(errors).order else ""


def too_little(equations: int, unknowns: int, undetermined: int) -> str:
    """Return why equations give no intervals of parameters, empty where they do.

    ``undetermined`` is the number of directions of the parameters that they do not determine.
    """
    if equations - unknowns < _LEFT:
        return FEW_EQUATIONS
    return DEPENDENT_TERMS if undetermined else ""


def least_squares(terms: Sequence[Term], segments: Sequence[Segment]) -> LeastSquares:
    """Return the parameters (4) from normalised segments.

    Parameters that the data leave undetermined take the smallest values that explain them.
    """
    start = max_lag(terms)
    matrix = np.vstack([regressor_matrix(terms, u, y) for u, y in segments])
    targets = [y[start:] for _, y in segments]
    target = np.concatenate(targets)
    scale = column_norms(matrix)  # the rank must not depend on the columns' units
    left, singular, right = np.linalg.svd(matrix / scale, full_matrices=False)
    kept = singular > _DEPENDENT * singular[0]
    inverse = (right[kept].T / singular[kept]) / scale[:, None]
    theta = inverse @ (left[:, kept].T @ target)
    error = target - matrix @ theta
    rank = int(kept.sum())
    variance = np.sum(error**2) / max(target.size - rank, 1)
    ends = np.cumsum([each.size for each in targets])[:-1]
    covariance = variance * (inverse @ inverse.T)
    return LeastSquares(theta, covariance, rank, np.split(error, ends), target)


def scaling_of(records: Sequence[Segment], centre_input: bool = True) -> Scaling:
    """Centre each signal on its mean and scale it by its half-range over all records.

    So the input is within about -1 to 1, the interval on which the published models of such
    actuators stay bounded. Without ``centre_input`` it is only divided by its half-range, and lies
    as far outside that interval as its mean is large. Several inputs are scaled each by itself.

    Raises
    ------
    InputError
        If one of several inputs is constant over all records.
    """
    u = np.concatenate([u for u, _ in records])
    y = np.concatenate([y for _, y in records])
    columns = by_input(u)
    offsets = [float(column.mean()) if centre_input else 0.0 for column in columns]
    scales = [float(0.5 * np.ptp(column)) for column in columns]
    if u.ndim == 2 and 0.0 in scales:
        still = scales.index(0.0)
        raise InputError(
            f"its input {still + 1} is constant at {columns[still][0]:g}",
            field="u",
            remedy="Leave it out: its effect cannot be identified from a record where it rests.",
        )
    return Scaling(tuple(offsets), tuple(scales), float(y.mean()), float(0.5 * np.ptp(y)))


def normalised(records: Sequence[Segment], scaling: Scaling) -> list[Segment]:
    """Return each record in the units of the model's equation."""
    return [(scaling.normalise_input(u), scaling.normalise_output(y)) for u, y in records]


def as_segments(u: Signals, y: Signals, lag: int = 0, terms: int = 0) -> list[Segment]:
    """Return one or several records as a list of checked pairs of signals."""
    inputs, outputs = listed(u), listed(y)
    if len(inputs) != len(outputs) or not inputs:
        raise InputError(
            f"records of u: {len(inputs)}, of y: {len(outputs)}",
            field="u",
            remedy="Give as many of the one as of the other; the columns of an array are inputs.",
        )
    for each in outputs:
        refuse_missing(each, "Give dea.Record.of(u, y, sampling_rate), of which they are left out")
    records = [as_pair(one, other, lag, terms) for one, other in zip(inputs, outputs, strict=True)]
    counts = sorted({input_count(u) for u, _ in records})
    if len(counts) > 1:
        raise InputError(
            f"records with {' and '.join(map(str, counts))} inputs",
            field="u",
            remedy="Give records of the same inputs.",
        )
    check_variation(*zip(*records, strict=True))
    return records
