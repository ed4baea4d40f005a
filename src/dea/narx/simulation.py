"""Free-run simulation of polynomial NARX models, compiled.

The contributions of the inputs do not depend on the output: the terms are grouped by their monomial
of outputs, and each group's coefficient C_g[t], a polynomial of inputs alone, is computed for all
t at once. What remains of the recursion (7) is y_t = sum_g C_g[t] * prod_k y_{t-k}.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Array, Indices
from dea.errors import InputError
from dea.inputs import by_input
from dea.narx import kernels
from dea.narx.checks import check_inputs, check_shape
from dea.narx.kernels import NONE, Structure
from dea.terms import Term, max_lag, numbered_inputs

# Beyond this a run counts as diverged. Far above any signal, far below where products of outputs
# overflow.
BOUND = 1e10


def structure(terms: tuple[Term, ...]) -> Structure:
    """Return the integer arrays that describe ``terms``."""
    return _described(terms)[0]


@lru_cache(maxsize=4096)
def _described(terms: tuple[Term, ...]) -> tuple[Structure, int | None]:
    """Return the integer arrays that describe ``terms``, and the largest number of an input."""
    monomials = sorted({term.y_lags for term in terms}, key=lambda lags: (len(lags), lags))
    arrays = Structure(
        group=np.array([monomials.index(term.y_lags) for term in terms], dtype=np.int64),
        y_lags=padded_lags(monomials),
        u_lags=padded_lags([term.u_lags for term in terms]),
        u_rows=padded_lags([term.input_columns for term in terms]),
        start=max_lag(terms),
    )
    return arrays, numbered_inputs(terms)


def simulate(
    terms: tuple[Term, ...], parameters: Array, u: Array, y_initial: Array, bound: float = BOUND
) -> Array:
    """Free run (7), (8): the model is fed its own outputs.

    Parameters
    ----------
    terms, parameters
        The model, for signals as they are given here (no scaling takes place).
    u
        Input, shape (samples,), or several, shape (samples, inputs).
    y_initial
        The first outputs, at least as many as the largest lag; they are returned unchanged.
    bound
        Once an output exceeds this the run has diverged: it and all later samples are ``inf``.

    Returns
    -------
    ndarray
        Outputs, shape (samples,).

    Raises
    ------
    InputError
        If there is not one parameter for each term, or inputs or initial outputs are too few.
    """
    shape, numbered = _described(terms)
    check_inputs(numbered, u)
    check_shape(parameters, (len(terms),), "parameters")
    y = _begun(y_initial, shape.start, u.shape[0])
    kernels.run(shape, parameters, by_input(u), y, bound)
    return y


def bounded(
    terms: tuple[Term, ...],
    parameters: Array,
    u: Array,
    bound: float,
    every: bool = False,
    *,
    start: float = 0.0,
    samples: int | None = None,
) -> NDArray[np.bool_]:
    """Say of each of several runs whether it keeps within ``bound`` about ``start``, (runs,).

    Parameters
    ----------
    u
        Inputs, shape (inputs, period, runs).
    every
        Whether all have to: the first that does not then ends all, and none counts.
    start
        The output before all runs.
    samples
        Of a run, over which inputs are repeated; by default one period.

    Other parameters are those of :func:`simulate`.
    """
    shape, numbered = _described(terms)
    check_inputs(numbered, u[:, :, 0].T)
    length = u.shape[1] if samples is None else samples
    return kernels.bounded(shape, parameters, u, length, start, bound, every)


def simulate_varying(
    terms: tuple[Term, ...], theta: Array, u: Array, y_initial: Array, bound: float = BOUND
) -> Array:
    """Free run with parameters that change with time: sample t is computed with ``theta[t]``.

    Parameters
    ----------
    theta
        Parameters, shape (samples, terms).

    Other parameters and the result are those of :func:`simulate`.

    Raises
    ------
    InputError
        If ``theta`` is of another shape.
    """
    check_shape(theta, (u.shape[0], len(terms)), "theta")
    shape = structure(terms)
    y = _begun(y_initial, shape.start, u.shape[0])
    kernels.run_varying(shape, np.ascontiguousarray(theta), input_rows(terms, u), y, bound)
    return y


def input_rows(terms: tuple[Term, ...], u: Array) -> Array:
    """Return the inputs of ``terms`` as the kernels take them, checked to be all that they name."""
    check_inputs(_described(terms)[1], u)
    return by_input(u)


def _begun(y_initial: Array, start: int, samples: int) -> Array:
    """Return the outputs of a run, of which the first are given and the others not computed yet."""
    if y_initial.size < start and y_initial.size < samples:
        raise InputError(
            f"{y_initial.size} initial outputs for a largest lag of {start}",
            field="y_initial",
            remedy=f"Give the first {start} outputs.",
        )
    y = np.empty(samples)
    given = min(start, samples)
    y[:given] = y_initial[:given]
    return y


def padded_lags(lags: Sequence[tuple[int, ...]]) -> Indices:
    """Return the lags of each term as the rows of an array, padded with ``NONE``."""
    width = max(map(len, lags), default=0)
    return np.array([[*row, *[NONE] * (width - len(row))] for row in lags], dtype=np.int64)
