"""Checks of signals before anything is estimated from them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dea.errors import InputError

Array = NDArray[np.float64]


def as_signal(values: ArrayLike, name: str, *, missing: bool = False) -> Array:
    """Return ``values`` as a contiguous 1-D float array, in which some may be ``missing`` (NaN).

    Raises
    ------
    InputError
        If it is not one-dimensional or holds a value that is not a finite number.
    """
    try:
        signal = np.ascontiguousarray(values, dtype=float)
    except ValueError as error:
        raise InputError(
            f"it holds no numbers: {error}", field=name, remedy="Give an array of numbers."
        ) from error
    if signal.ndim != 1:
        raise InputError(
            f"it has {signal.ndim} dimensions", field=name, remedy="A signal is one-dimensional."
        )
    bad = np.flatnonzero(np.isinf(signal) if missing else ~np.isfinite(signal))
    if bad.size:
        raise InputError(
            f"{bad.size} of {signal.size} samples are not numbers, the first at sample {bad[0]}",
            field=name,
            remedy="Cut the signal before that sample.",
        )
    return signal


def as_record(
    u: ArrayLike, y: ArrayLike, lag: int = 0, terms: int = 0, *, missing: bool = False
) -> tuple[Array, Array]:
    """Return input and output as equally long signals that ``terms`` can be estimated from.

    Where outputs may be ``missing`` they are NaN.

    Raises
    ------
    InputError
        As :func:`as_signal`; also if lengths differ, if fewer than ``terms`` samples remain after
        the first ``lag``, or if either signal is constant.
    """
    inputs, outputs = as_signal(u, "u"), as_signal(y, "y", missing=missing)
    if inputs.size != outputs.size:
        raise InputError(
            f"it has {outputs.size} samples and u has {inputs.size}",
            field="y",
            remedy="Input and output are sampled together.",
        )
    if inputs.size - lag < max(terms, 1):
        raise InputError(
            f"{inputs.size} samples leave {max(inputs.size - lag, 0)} equations after a lag of "
            f"{lag}, for {terms} parameters",
            field="u",
            remedy="Use a longer record, smaller lags or fewer terms.",
        )
    for name, signal in (("u", inputs), ("y", outputs)):
        there = signal[np.isfinite(signal)]
        if not there.size:
            raise InputError("every sample is missing", field=name, remedy="Record it again.")
        if np.ptp(there) == 0.0:
            raise InputError(
                f"it is constant at {there[0]:g}",
                field=name,
                remedy="A model can only be identified from signals that vary.",
            )
    return inputs, outputs
