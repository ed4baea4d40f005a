"""Where a model rests at constant inputs, and its poles there."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array, Complex
from dea.inputs import by_input
from dea.terms import Term, static_value

_STEPS = 4  # of Newton's method; two where a root is lost altogether, and as many to settle
_REAL = 1e-6  # imaginary part, relative to 1 + |root|, up to which a root counts as real


class Rests(NamedTuple):
    """Rests of a model over constant inputs, all in the units of its equation."""

    inputs: Array  # (levels,) or (levels, inputs)
    outputs: Array  # (levels,) NaN where there is no rest within the limit
    poles: Array  # (levels,) largest modulus of the poles there; inf where there is no rest


def rests_over(
    terms: Sequence[Term],
    parameters: Array,
    inputs: Array,
    limit: float = np.inf,
    near: float = 0.0,
) -> Rests:
    """Follow the rest of a model from input zero outwards to each of ``inputs``.

    At rest y = sum_j theta_j y^p u^q. Where this has several real roots, the one nearest to the
    rest at the level before is taken; at the level nearest to zero, the one nearest to ``near``.

    Parameters
    ----------
    inputs
        Constant inputs in the units of the equation along a line, shape (levels,), or of several
        inputs (levels, inputs).
    limit
        Largest distance from ``near`` of an output that counts.
    near
        The output about which the model is used.
    """
    roots = [
        found[np.abs(found - near) <= limit] for found in real_roots(terms, parameters, inputs)
    ]
    levels = len(inputs)
    middle = int(np.argmin(np.abs(by_input(inputs)).max(axis=0)))
    outputs = np.full(levels, np.nan)
    outputs[middle] = _nearest(roots[middle], near)
    for order in (range(middle + 1, levels), range(middle - 1, -1, -1)):
        last = outputs[middle]
        for level in order:
            last = outputs[level] = _nearest(roots[level], last if np.isfinite(last) else near)
    return Rests(inputs, outputs, largest_pole(terms, parameters, inputs, outputs))


def static_polynomial(
    terms: Sequence[Term], parameters: Iterable[float], levels: Sequence[float] | Array
) -> Array:
    """Return the coefficients, by rising power of y, of sum_j theta_j y^p u^q - y.

    Its roots are where the model can rest. ``levels`` are the constant inputs, in the units of the
    equation: one number for each, or one array; shape (..., degree + 1).
    """
    degree = max(1, *(len(term.y_lags) for term in terms))
    coefficients = np.zeros((*np.shape(levels[0]), degree + 1))
    coefficients[..., 1] = -1.0
    for term, parameter in zip(terms, parameters, strict=True):
        coefficients[..., len(term.y_lags)] += parameter * static_value(term.input_powers, levels)
    return coefficients


def real_roots(terms: Sequence[Term], parameters: Array, inputs: Array) -> list[Array]:
    """Return the real roots of the static polynomial at each input, where the model can rest.

    They are the eigenvalues of its companion matrix, of all inputs at once: a search asks for the
    rests of thousands of models. Newton steps follow, since beside a leading coefficient that is
    nearly zero the eigenvalues of the smaller roots are lost.
    """
    coefficients = static_polynomial(terms, parameters.tolist(), by_input(inputs))
    degrees = np.max(np.where(coefficients != 0.0, np.arange(coefficients.shape[1]), 0), axis=1)
    real = [np.empty(0)] * len(inputs)
    for degree in np.unique(degrees[degrees > 0]).tolist():
        (levels,) = np.nonzero(degrees == degree)
        companion = np.zeros((levels.size, degree, degree))
        companion[:, range(1, degree), range(degree - 1)] = 1.0
        companion[:, :, -1] = -coefficients[levels, :degree] / coefficients[levels, degree, None]
        polynomials = coefficients[levels, : degree + 1]
        for level, roots in zip(
            levels.tolist(), _polished(np.linalg.eigvals(companion), polynomials), strict=True
        ):
            real[level] = roots.real[np.abs(roots.imag) <= _REAL * (1.0 + np.abs(roots))]
    return real


def _polished(roots: Array | Complex, coefficients: Array) -> Complex:
    """Return roots (levels, degree) of polynomials (levels, degree + 1) after Newton steps.

    A step is taken where it lowers the modulus of the polynomial.
    """
    found: Complex = roots.astype(np.complex128)
    value, slope = _value_and_slope(found, coefficients)
    for _ in range(_STEPS):
        there = slope != 0.0
        moved = found - np.where(there, value, 0.0) / np.where(there, slope, 1.0)
        moved_value, moved_slope = _value_and_slope(moved, coefficients)
        better = np.abs(moved_value) < np.abs(value)
        found = np.where(better, moved, found)
        value = np.where(better, moved_value, value)
        slope = np.where(better, moved_slope, slope)
    return found


def _value_and_slope(roots: Complex, coefficients: Array) -> tuple[Complex, Complex]:
    """Return each polynomial and its derivative at each of its roots, by Horner's scheme."""
    value, slope = np.zeros_like(roots), np.zeros_like(roots)
    for column in coefficients.T[::-1]:
        slope = slope * roots + value
        value = value * roots + column[:, None]
    return value, slope


def _nearest(roots: Array, near: float) -> float:
    return float(roots[np.argmin(np.abs(roots - near))]) if roots.size else float("nan")


def largest_pole(terms: Sequence[Term], parameters: Array, inputs: Array, outputs: Array) -> Array:
    """Return the largest modulus of the roots of z^n - sum_k (df/dy_{t-k}) z^(n-k) at each rest.

    Below 1 the rest attracts. Inputs and outputs at rest have the shapes of :class:`Rests`; where
    the output is NaN the modulus is infinite.
    """
    order = max((max(term.y_lags) for term in terms if term.y_lags), default=1)
    at_rest = np.isfinite(outputs)
    columns, y = by_input(inputs[at_rest]), outputs[at_rest]
    companion = np.zeros((y.size, order, order))
    companion[:, range(1, order), range(order - 1)] = 1.0
    for term, parameter in zip(terms, parameters.tolist(), strict=True):
        share = static_value(term.input_powers, columns)
        for lag in term.y_lags:
            slope = parameter * y ** (len(term.y_lags) - 1) * share
            companion[:, 0, lag - 1] += slope
    modulus = np.full(len(inputs), np.inf)
    if y.size:
        modulus[at_rest] = np.abs(np.linalg.eigvals(companion)).max(axis=-1)
    return modulus
