"""The inverse of a model: which input brings its output to a reference."""

from collections.abc import Callable

import numpy as np

from dea.arrays import Array
from dea.control.limits import are_limits
from dea.errors import InputError

_TRIED = 17  # inputs between the limits, among which a prediction is taken to be monotone


def inverse_input(
    predict: Callable[[Array], Array],
    reference: float,
    horizon: int,
    lowest: float,
    highest: float,
    near: float,
) -> float:
    """Return the constant input that brings the predicted output to ``reference``.

    The input is held through the horizon and the output compared at its end, as in predictive
    functional control with one coincidence point (J. Richalet, Automatica 29 (1993) 1251-1274). An
    inverse over a single sample would answer noise and zeros outside the unit circle with ever
    larger inputs; the longer the horizon, the calmer.

    Parameters
    ----------
    predict
        Outputs of the next samples from their inputs: :meth:`dea.OnlineTracker.predict`.
    reference
        Output wanted at the last of the ``horizon`` samples that are predicted. The first is the
        one after the last that a tracker was updated with: one that knows the samples before t is
        asked for the reference of t + horizon - 1.
    lowest, highest
        Limits of the input.
    near
        The input before. A polynomial may reach the reference at several inputs; the one nearest
        to this is returned. Where none reaches it, it is the input that comes nearest, of
        seventeen evenly spread between the limits.

    Raises
    ------
    InputError
        If the horizon is no sample, the limits are not finite or do not rise, the reference is not
        finite, or the prediction diverges throughout.
    """
    from scipy.optimize import brentq

    if horizon < 1 or not are_limits(lowest, highest):
        raise InputError(
            f"a horizon of {horizon} samples, inputs from {lowest:g} to {highest:g}",
            field="horizon, lowest, highest",
            remedy="Take a sample or more, and finite limits that rise.",
        )
    if not np.isfinite(reference):
        raise InputError(
            f"it is {reference:g}", field="reference", remedy="Give a finite output that is wanted."
        )

    def error(u: float) -> float:
        return float(predict(np.full(horizon, u))[-1]) - reference

    inputs = np.linspace(lowest, highest, _TRIED)
    errors = np.array([error(u) for u in inputs])
    finite = np.isfinite(errors)
    if not finite.any():
        raise InputError(
            "the prediction diverges at every input",
            field="predict",
            remedy="Check the model's stability, or narrow the limits.",
        )
    # The sign of an infinite error does not tell on which side of the reference it is.
    bounded = finite[:-1] & finite[1:]
    crossed = np.flatnonzero(bounded & (np.signbit(errors[:-1]) != np.signbit(errors[1:])))
    if not crossed.size:
        return float(inputs[finite][np.argmin(np.abs(errors[finite]))])
    roots = [
        brentq(error, inputs[i], inputs[i + 1], xtol=1e-9 * (highest - lowest)) for i in crossed
    ]
    return float(min(roots, key=lambda root: abs(root - near)))
