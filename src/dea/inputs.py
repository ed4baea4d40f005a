"""How one input or several are laid out: samples in rows, inputs in columns."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray


def input_count(u: ArrayLike) -> int:
    """Return how many inputs ``u`` holds: its columns, or one."""
    shape = np.shape(u)
    return int(shape[1]) if len(shape) == 2 else 1


def by_input(u: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return one input or several as contiguous rows, shape (inputs, samples)."""
    return np.ascontiguousarray(u.reshape(1, -1) if u.ndim == 1 else u.T)


def joined(inputs: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return inputs, each (samples,), as they were before :func:`by_input`."""
    return inputs[0] if len(inputs) == 1 else np.column_stack(inputs)
