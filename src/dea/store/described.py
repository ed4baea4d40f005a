"""Variables of datasets with what a contract wants of each."""

from collections.abc import Hashable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Described: TypeAlias = tuple[Hashable | Sequence[Hashable], Any, dict[str, str]]


def variable(
    dims: Hashable | Sequence[Hashable], values: Any, units: str, long_name: str
) -> Described:
    """Return a variable as xarray.Dataset takes it, with units (``"1"``: none) and meaning."""
    return dims, values, {"units": units, "long_name": long_name}


def complex_parts(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return complex values as NetCDF takes them: real and imaginary ``part``, the last axis."""
    return np.stack([values.real, values.imag], axis=-1)
