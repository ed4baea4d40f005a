"""Where a model rests at constant inputs, and its poles there."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial

from dea.narx.checks import Array
from dea.terms import Term

_REAL = 1e-6  # imaginary part, relative to 1 + |root|, up to which a root counts as real


class Rests(NamedTuple):
    """Rests of a model over constant inputs, all in the units of its equation."""

    inputs: Array  # (levels,)
    outputs: Array  # (levels,) NaN where there is no rest within the limit
    poles: Array  # (levels,) largest modulus of the poles there; inf where there is no rest


def rests_over(
    terms: Sequence[Term], parameters: Array, inputs: Array, limit: float = np.inf
) -> Rests:
    """Follow the rest of a model from input zero outwards to each of ``inputs``.

    At rest y = sum_j theta_j y^p u^q. Of several real roots the one nearest to the rest of the
    level before is taken, for the level nearest to zero the one nearest to zero.

    Parameters
    ----------
    inputs
        Constant inputs in the units of the equation, rising, shape (levels,).
    limit
        Largest modulus of an output that counts.
    """
    middle = int(np.argmin(np.abs(inputs)))
    outputs = np.full(inputs.size, np.nan)
    outputs[middle] = _nearest_root(terms, parameters, inputs[middle], 0.0, limit)
    for order in (range(middle + 1, inputs.size), range(middle - 1, -1, -1)):
        last = outputs[middle]
        for level in order:
            near = last if np.isfinite(last) else 0.0
            last = outputs[level] = _nearest_root(terms, parameters, inputs[level], near, limit)
    return Rests(inputs, outputs, _largest_pole(terms, parameters, inputs, outputs))


def _nearest_root(
    terms: Sequence[Term], parameters: Array, u: float, near: float, limit: float
) -> float:
    coefficients = np.zeros(1 + max(1, *(len(term.y_lags) for term in terms)))
    coefficients[1] = -1.0
    for term, parameter in zip(terms, parameters.tolist(), strict=True):
        coefficients[len(term.y_lags)] += parameter * u ** len(term.u_lags)
    trimmed = np.trim_zeros(coefficients, "b")
    if trimmed.size < 2:
        return float("nan")
    roots = polynomial.polyroots(trimmed)
    real = roots.real[np.abs(roots.imag) <= _REAL * (1.0 + np.abs(roots))]
    real = real[np.abs(real) <= limit]
    return float(real[np.argmin(np.abs(real - near))]) if real.size else float("nan")


def _largest_pole(terms: Sequence[Term], parameters: Array, inputs: Array, outputs: Array) -> Array:
    """Largest modulus of the roots of z^n - sum_k (df/dy_{t-k}) z^(n-k) at each rest."""
    order = max((max(term.y_lags) for term in terms if term.y_lags), default=1)
    at_rest = np.isfinite(outputs)
    u, y = inputs[at_rest], outputs[at_rest]
    companion = np.zeros((u.size, order, order))
    companion[:, range(1, order), range(order - 1)] = 1.0
    for term, parameter in zip(terms, parameters.tolist(), strict=True):
        for lag in term.y_lags:
            slope = parameter * y ** (len(term.y_lags) - 1) * u ** len(term.u_lags)
            companion[:, 0, lag - 1] += slope
    modulus = np.full(inputs.size, np.inf)
    if u.size:
        modulus[at_rest] = np.abs(np.linalg.eigvals(companion)).max(axis=-1)
    return modulus
