"""How well a simulated output agrees with a measured one."""

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.errors import InputError
from dea.narx.checks import as_signal


def nmse(measured: ArrayLike, simulated: ArrayLike) -> float:
    """Normalised mean square error SSE/SST: 0 is perfect, 1 as good as the mean.

    The published Table 1 lists this; what (32) prints is :func:`fit`. Infinite where the simulation
    diverges, or the output is constant.

    Parameters
    ----------
    measured, simulated
        Shape (samples,), in one unit. What is simulated may be infinite or NaN.

    Raises
    ------
    InputError
        If the shapes differ, there is no sample, or a measured value is no finite number.
    """
    y = _measured(measured)
    error = _squared(y, simulated)
    total = float(np.sum((y - y.mean()) ** 2))
    return error / total if total > 0.0 else np.inf


def fit(measured: ArrayLike, simulated: ArrayLike) -> float:
    """Share of the output's variation that the simulation explains (32): 1 - nmse.

    Parameters and errors are those of :func:`nmse`.
    """
    return 1.0 - nmse(measured, simulated)


def fpe(measured: ArrayLike, simulated: ArrayLike, terms: int) -> float:
    """Final prediction error (33), in squared units of the output, for a model of ``terms`` terms.

    Infinite where the simulation diverges, or the model has as many terms as there are samples.
    Other parameters and errors are those of :func:`nmse`.
    """
    y = _measured(measured)
    share = terms / y.size
    return _squared(y, simulated) / y.size * (1.0 + share) / (1.0 - share) if share < 1 else np.inf


def rmse(measured: ArrayLike, simulated: ArrayLike) -> float:
    """Root mean square error, in units of the output; infinite where the simulation diverges.

    Parameters and errors are those of :func:`nmse`.
    """
    y = _measured(measured)
    return float(np.sqrt(_squared(y, simulated) / y.size))


def _measured(values: ArrayLike) -> Array:
    signal = as_signal(values, "measured")
    if not signal.size:
        raise InputError("there is no sample", field="measured", remedy="Give one at least.")
    return signal


def _squared(y: Array, simulated: ArrayLike) -> float:
    """Sum of squared errors; infinite where the simulation diverged."""
    run = np.asarray(simulated, dtype=float)
    if run.shape != y.shape:
        raise InputError(
            f"its shape is {run.shape}, that of measured {y.shape}",
            field="simulated",
            remedy="Give one value for every sample.",
        )
    return float(np.sum((y - run) ** 2)) if np.isfinite(run).all() else np.inf
