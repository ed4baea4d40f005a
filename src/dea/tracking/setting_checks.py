"""Checks of the settings of trackers, each a single finite number; others raise an InputError."""

from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import Any

from dea.errors import InputError


def check_settings(forgetting: float, leakage: float, delta: float) -> None:
    """Refuse settings of recursive least squares that are outside their range."""
    _check("forgetting", forgetting, lambda value: 0.0 < value <= 1.0, "Give one in (0, 1]")
    _check("leakage", leakage, lambda value: value >= 0.0, "Give a finite one, zero or more")
    check_delta(delta)


def check_delta(delta: float) -> None:
    """Refuse a weight of the model's own parameters that is not above zero."""
    _check("delta", delta, lambda value: value > 0.0, "Give a finite one above zero")


def check_count(name: str, count: float) -> None:
    """Refuse a number of samples or instants that is not whole, or below one."""
    _check(
        name, count, lambda value: value >= 1 and value % 1 == 0, "Give a whole number, 1 or more"
    )


def _check(name: str, value: Any, holds: Callable[[Any], bool], remedy: str) -> None:
    if not isinstance(value, Real) or not isfinite(value) or not holds(value):
        raise InputError(f"it is {value}", field=name, remedy=remedy)
