"""Lags as settings give them."""

from collections.abc import Sequence
from typing import Any


def largest_lag(*lags: int | Sequence[Any]) -> int:
    """Return the largest lag of settings, each the largest, a list, or a list for each input.

    A list may be empty, as that of a model without lags of its output.
    """
    return max((each if isinstance(each, int) else largest_lag(*each) for each in lags), default=0)
