"""What a number is that a caller gives to the library; each refuses others in its own words."""

from numbers import Real
from typing import Any

import numpy as np


def is_count(value: Any, least: int = 1) -> bool:
    """Return whether a value is of a whole type, of Python or numpy, and at least ``least``."""
    return isinstance(value, int | np.integer) and bool(value >= least)


def is_positive(value: Any) -> bool:
    """Return whether a value is a real number above zero, and finite."""
    return isinstance(value, Real) and 0.0 < float(value) < np.inf
