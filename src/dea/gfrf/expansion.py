"""The polynomial of a NARX model, written around an operating point."""

from collections import Counter
from collections.abc import Sequence
from functools import cache
from itertools import chain, combinations
from typing import Any

from dea.arrays import Array
from dea.terms import Term, static_value

Polynomial = dict[Term, Array]


def expand(terms: Sequence[Term], theta: Any, y0: Any, u0: Array) -> dict[Term, Any]:
    """Write y_t = sum_j theta_j phi_j in the deviations Y = y - y0 and U = u - u0, exactly.

    Every factor y_{t-k} becomes y0 + Y_{t-k}, every u_{t-k} becomes u0 + U_{t-k}, and like
    monomials are collected.

    Parameters
    ----------
    theta
        Parameters, shape (..., terms).
    y0, u0
        Operating point, normalised; y0 of shape (...), u0 of shape (inputs,). ``theta`` and ``y0``
        may both be differentiable (:class:`dea.gfrf.differentiable.Differentiable`); so are the
        coefficients.

    Returns
    -------
    dict
        The coefficient, shape (...), of each monomial of the deviations that may differ from zero,
        the constant left out: it is y0 itself where y0 solves the static polynomial.
    """
    expanded: dict[Term, Any] = {}
    levels = u0.tolist()
    for j, term in enumerate(terms):
        for monomial, y_power, u_powers in _monomials(term):
            level = static_value(u_powers, levels)
            if level == 0.0:
                continue
            share = theta[..., j] * y0**y_power * level
            expanded[monomial] = expanded.get(monomial, 0.0) + share
    return expanded


# Models of many parameter sets have the same terms.
@cache
def _monomials(term: Term) -> list[tuple[Term, int, Counter[int]]]:
    """Return the monomials of a term's deviations, each with the powers of y0 and u0 beside it."""
    found = []
    for y_kept in _subsets(len(term.y_lags)):
        for u_kept in _subsets(len(term.u_lags)):
            monomial = Term(
                tuple(term.y_lags[i] for i in y_kept),
                tuple(term.u_lags[i] for i in u_kept),
                tuple(term.inputs[i] for i in u_kept if term.inputs),
            )
            if monomial != Term():
                y_power = len(term.y_lags) - len(y_kept)
                found.append((monomial, y_power, term.input_powers - monomial.input_powers))
    return found


def _subsets(count: int) -> chain[tuple[int, ...]]:
    return chain.from_iterable(combinations(range(count), size) for size in range(count + 1))
