"""Checks of signals before anything is estimated from them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.errors import InputError
from dea.inputs import input_count
from dea.store import real_numbers


def as_signal(values: ArrayLike, name: str, *, missing: bool = False) -> Array:
    """Return ``values`` as a contiguous 1-D float array, in which some may be ``missing`` (NaN).

    Raises
    ------
    InputError
        If it is not one-dimensional or holds a value that is not a finite number.
    """
    signal = np.ascontiguousarray(real_numbers(values, name))
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


def check_shape(values: Array, wanted: tuple[int, ...], field: str) -> None:
    """Refuse an array of another shape, beyond whose end compiled code would read."""
    if np.shape(values) != wanted:
        raise InputError(f"its shape is {np.shape(values)}", field=field, remedy=f"Use {wanted}.")


def _samples(count: int) -> str:
    return "1 sample" if count == 1 else f"{count} samples"


def refuse_missing(y: ArrayLike, remedy: str) -> None:
    """Refuse outputs of which samples are missing, where nothing can leave them out."""
    missing = np.flatnonzero(np.isnan(real_numbers(y, "y")))
    if missing.size:
        raise InputError(
            f"{_samples(missing.size)} {'is' if missing.size == 1 else 'are'} missing, the first is"
            f" sample {missing[0]}",
            field="y",
            remedy=remedy,
        )


def as_input(values: ArrayLike) -> Array:
    """Return one input, shape (samples,), or several, shape (samples, inputs), as floats.

    A single column is one input. Columns are contiguous.

    Raises
    ------
    InputError
        As :func:`as_signal`.
    """
    numbers = real_numbers(values, "u")
    if numbers.ndim == 2 and numbers.shape[1] == 1:
        numbers = numbers[:, 0]
    if numbers.ndim != 2:
        return as_signal(numbers, "u")
    bad = np.argwhere(~np.isfinite(numbers))
    if bad.size:
        raise InputError(
            f"{len(bad)} of {numbers.size} samples are not numbers, the first at sample"
            f" {bad[0][0]} of input {bad[0][1] + 1}",
            field="u",
            remedy="Cut the signals before that sample.",
        )
    return np.asfortranarray(numbers)


def check_inputs(numbered: int | None, u: Array) -> None:
    """Check that terms are of these inputs, ``numbered`` as :func:`dea.terms.numbered_inputs` says.

    Raises
    ------
    InputError
        If there are several inputs and the terms do not number theirs, or if there are fewer than
        the terms name.
    """
    count = input_count(u)
    if numbered is None or (numbered <= count if numbered else count == 1):
        return
    given = "one input" if count == 1 else f"{count} inputs"
    wanted = f"inputs up to u{numbered}" if numbered else "a single input, u"
    raise InputError(
        f"{given} for a model whose terms name {wanted}",
        field="u",
        remedy="Give the inputs of the model in its order, as the columns of u.",
    )


def as_record(
    u: ArrayLike, y: ArrayLike, lag: int = 0, terms: int = 0, *, missing: bool = False
) -> tuple[Array, Array]:
    """Return input and output as equally long signals that ``terms`` can be estimated from.

    Where outputs may be ``missing`` they are NaN. Several inputs are the columns of ``u``.

    Raises
    ------
    InputError
        As :func:`as_pair`; also if the output is constant, or if every input is.
    """
    inputs, outputs = as_pair(u, y, lag, terms, missing=missing)
    check_variation([inputs], [outputs])
    return inputs, outputs


def as_pair(
    u: ArrayLike, y: ArrayLike, lag: int = 0, terms: int = 0, *, missing: bool = False
) -> tuple[Array, Array]:
    """Return input and output as equally long signals, which may be constant.

    Raises
    ------
    InputError
        As :func:`as_signal`; also if lengths differ, or if fewer than ``terms`` samples remain
        after the first ``lag``.
    """
    inputs, outputs = as_input(u), as_signal(y, "y", missing=missing)
    samples = inputs.shape[0]
    if samples != outputs.size:
        raise InputError(
            f"it has {_samples(outputs.size)} and u has {samples}",
            field="y",
            remedy="Input and output are sampled together.",
        )
    if samples - lag < max(terms, 1):
        left = (
            f"{_samples(samples)} {'leaves' if samples == 1 else 'leave'} {max(samples - lag, 0)}"
        )
        raise InputError(
            f"{left} equations after a lag of {lag}"
            + (f", for {terms} parameters" if terms else ""),
            field="u",
            remedy="Use a longer record, smaller lags or fewer terms.",
        )
    return inputs, outputs


def check_variation(inputs: Sequence[Array], outputs: Sequence[Array]) -> None:
    """Check that the output and an input of one or several records vary, all taken together.

    Raises
    ------
    InputError
        If they do not, or if no output is known.
    """
    for name, signals in (("u", inputs), ("y", outputs)):
        signal = np.concatenate(signals)
        there = signal[np.isfinite(signal)] if signal.ndim == 1 else signal
        if not there.size:
            raise InputError("every sample is missing", field=name, remedy="Record it again.")
        if not np.ptp(there, axis=0).any():
            raise InputError(
                f"it is constant at {', '.join(f'{level:g}' for level in np.ravel(there[0]))}",
                field=name,
                remedy="A model can only be identified from signals that vary.",
            )
