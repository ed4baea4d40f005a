"""The inverse of a model: which input brings its output to a reference."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dea.errors import InputError

Array = NDArray[np.float64]


def inverse_input(
    predict: Callable[[Array], Array],
    reference: float,
    horizon: int,
    lowest: float,
    highest: float,
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
        Output wanted ``horizon`` samples from now.
    lowest, highest
        Limits of the input. The prediction is taken to be monotone between them; where no input
        reaches the reference, it is the limit that comes nearer.

    Raises
    ------
    InputError
        If the horizon is no sample, the limits do not rise, or the prediction diverges at both.
    """
    from scipy.optimize import brentq

    if horizon < 1 or not lowest < highest:
        raise InputError(
            f"a horizon of {horizon} samples, inputs from {lowest:g} to {highest:g}",
            field="horizon, lowest, highest",
            remedy="Take a sample or more, and limits that rise.",
        )

    def error(u: float) -> float:
        return float(predict(np.full(horizon, u))[-1]) - reference

    at_low, at_high = error(lowest), error(highest)
    if not (np.isfinite(at_low) or np.isfinite(at_high)):
        raise InputError(
            "the prediction diverges at both limits of the input",
            field="predict",
            remedy="Check the model's stability, or narrow the limits.",
        )
    if np.sign(at_low) == np.sign(at_high) or not (np.isfinite(at_low) and np.isfinite(at_high)):
        return lowest if abs(at_low) <= abs(at_high) else highest
    return float(brentq(error, lowest, highest, xtol=1e-9 * (highest - lowest)))
