"""Where the bands of tracked parameters are taken, and when they are withheld."""

import numpy as np

from dea.arrays import Array
from dea.narx import not_white

NOT_MOVED = (
    "no step of the free-run smoother lowered the error of the free run, so that this is the "
    "estimate of the {} instead"
)
NOT_SETTLED = (
    "the iteration over free runs did not settle: the parameters change too fast for its "
    "linearisation, or the record tells too little of them"
)
WINDOWS_FAILED = (
    "{} windows of the record have no estimate: the free run diverges, or outputs are missing"
)
WINDOWS_FEW = (
    "the record has {:g} windows that do not overlap: fewer than {} do not tell how far the "
    "parameters move within one; {}"
)
UNDETERMINED = (
    "windows of the record tell too little of single parameters: within their intervals the free "
    "run is far from linear in them"
)
TARGET_UNKNOWN = "leakage pulls towards parameters whose own covariance is not known"
LARGEST_CURVATURE = 0.5  # departure of a run at the ends of an interval from its linearisation
# Samples of a window within which parameters hardly move: long enough for its own estimate.
_WINDOW, _SAMPLES_PER_TERM = 500, 50


def reason_to_withhold(innovation: Array, Phi: Array, target: Array) -> str:
    """Return why intervals of an estimate by one-step errors do not hold, empty where they do.

    Parameters that change also follow coloured noise, and then the innovation is white although the
    noise is not. Therefore the errors of least squares in short windows, within which the
    parameters hardly move, are tested as well.

    Parameters
    ----------
    innovation
        One-step errors of the tracker, shape (n,).
    Phi, target
        Regressors (n, p) and outputs (n,) of the equations; an output that is missing is NaN.
    """
    # The first tenth holds the start from the prior.
    settled = innovation[innovation.size // 10 :]
    errors = [[settled], _in_windows(Phi, target)]
    return next(filter(None, (not_white(each, target) for each in errors if each)), "")


def _in_windows(Phi: Array, target: Array) -> list[Array]:
    """Return the errors of least squares in windows, with a constant, of what is there."""
    samples, terms = Phi.shape
    count = max(1, samples // max(_WINDOW, _SAMPLES_PER_TERM * terms))
    errors = []
    for part in np.array_split(np.arange(samples), count):
        there = part[np.isfinite(target[part])]
        if there.size > terms + 1:
            matrix = np.column_stack([np.ones(there.size), Phi[there]])
            found = np.full(part.size, np.nan)
            theta = np.linalg.lstsq(matrix, target[there], rcond=None)[0]
            found[there - part[0]] = target[there] - matrix @ theta
            errors.append(found)
    return errors
