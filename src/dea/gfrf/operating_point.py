"""The zero-input response: where a model comes to rest at a constant input."""

from collections.abc import Sequence

import numpy as np

from dea.arrays import Array
from dea.narx import BOUND, largest_pole, real_roots, simulate
from dea.terms import Term, max_lag, static_value

_FIRST_RUN = 256  # samples; each further run is twice as long
_RUNS = 11  # half a million samples in all: poles up to 0.99997 come to rest within them
_NEAR = 1e-6  # distance from an attracting root, relative to 1 + |root|, that counts as at rest


def rest(terms: Sequence[Term], theta: Array, u0: Array, start: float = 0.0) -> float | None:
    """Return the root of the static polynomial that a free run at constant input settles to.

    Parameters
    ----------
    theta
        Parameters, shape (terms,).
    u0, start
        Constant inputs, shape (inputs,), and the output at which the run starts, normalised.

    Returns
    -------
    float or None
        The normalised output, exact to rounding; None where the run diverges, oscillates or
        does not settle.
    """
    terms = tuple(terms)
    roots = _attracting_roots(terms, theta, u0)
    bound = BOUND * (1.0 + max(map(abs, roots), default=0.0))
    lag = max(max_lag(terms), 1)
    outputs = np.full(lag, start)
    reached = _reached(outputs, roots)
    for run in range(_RUNS):
        if reached is not None or not roots or not np.all(np.isfinite(outputs)):
            break
        inputs = np.tile(u0, (lag + _FIRST_RUN * 2**run, 1))
        outputs = simulate(terms, theta, inputs, outputs, bound)[-lag:]
        reached = _reached(outputs, roots)
    return reached


def _reached(outputs: Array, roots: Sequence[float]) -> float | None:
    """Return the root that all of these outputs are at, None where they are at none."""
    for root in roots:
        if np.all(np.abs(outputs - root) <= _NEAR * (1.0 + abs(root))):
            return root
    return None


def rest_along(terms: Sequence[Term], theta: Array, u0: Array) -> Array:
    """Follow the rest of a model whose parameters change.

    Parameters
    ----------
    theta
        Parameters, shape (times, terms).

    Returns
    -------
    ndarray
        Normalised outputs, shape (times,): each is where the free run settles that starts at the
        rest of the instant before, so that among several roots the branch is followed, and left
        where it ends. NaN where the model does not settle.
    """
    y0 = np.full(theta.shape[0], np.nan)
    last = 0.0
    for t, parameters in enumerate(theta):
        found = rest(terms, parameters, u0, last)
        if found is not None:
            y0[t] = last = found
    return y0


def rest_slope(terms: Sequence[Term], theta: Array, y0: Array, u0: Array) -> Array:
    """Return the derivative of the rest by each parameter, shape (terms, sets).

    Differentiating y0 = sum_j theta_j y0^q u0^r: dy0/dtheta_j = y0^q u0^r / (1 - df/dy0).

    Parameters
    ----------
    theta, y0
        Parameters (sets, terms) and their rests (sets,), normalised.
    """
    levels = u0.tolist()
    powers = [(len(term.y_lags), static_value(term.input_powers, levels)) for term in terms]
    values = np.stack([y0**q * share for q, share in powers])
    feedback = sum(
        theta[:, j] * q * y0 ** (q - 1) * share for j, (q, share) in enumerate(powers) if q
    )
    slope: Array = values / (1.0 - feedback)
    return slope


def _attracting_roots(terms: tuple[Term, ...], theta: Array, u0: Array) -> list[float]:
    [roots] = real_roots(terms, theta, u0[None])
    poles = largest_pole(terms, theta, np.tile(u0, (roots.size, 1)), roots)
    # A double root attracts from one side only; its pole is 1 but for rounding.
    attracting: list[float] = roots[poles < 1.0 - _NEAR].tolist()
    return attracting
