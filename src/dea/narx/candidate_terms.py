"""The terms that a selection may choose from: every monomial of the lagged signals."""

from collections.abc import Sequence
from itertools import combinations_with_replacement
from math import comb
from numbers import Integral
from typing import Any, cast

import numpy as np

from dea.errors import InputError
from dea.given_numbers import is_count
from dea.terms import Term

Lags = int | Sequence[int]
InputLags = Lags | Sequence[Sequence[int]]
_WHOLE = int, np.integer
MOST = 20_000  # terms: their cross products take 3 GB


def candidate_terms(
    y_lags: Lags, u_lags: InputLags, degree: int, inputs: int = 1
) -> tuple[Term, ...]:
    """Every monomial up to ``degree`` of the lagged signals, by degree; the constant first.

    Parameters
    ----------
    y_lags, u_lags
        The largest lag (1 to it are used), or the lags themselves, for instance to start after
        a dead time. Of several inputs a list of such lists, one for each, may give each its own.
    degree
        Largest number of factors, at least 1.
    inputs
        How many inputs there are.

    Returns
    -------
    tuple of Term
        (n + degree choose degree) terms for n lagged signals: 84 for 3, 3, 3.

    Raises
    ------
    InputError
        If lags or degree are not whole numbers in their range, or there are too many terms.
    """
    if not is_count(degree):
        raise InputError(
            f"a degree of {degree!r}", field="degree", remedy="Give a whole number, at least 1"
        )
    variables = [Term((lag,)) for lag in lag_list(y_lags, "y_lags")]
    for column, lags in enumerate(input_lag_lists(u_lags, inputs)):
        numbers = (column + 1,) if inputs > 1 else ()
        variables += [Term((), (lag,), numbers) for lag in lags]
    count = comb(len(variables) + int(degree), int(degree))
    if count > MOST:
        raise InputError(
            f"{len(variables)} lagged signals to the degree {degree} make {count} terms",
            field="degree",
            remedy=f"Lower it, or give fewer lags: at most {MOST} terms can be chosen from.",
        )
    return tuple(
        Term.of(
            (lag for factor in factors for lag in factor.y_lags),
            (lag for factor in factors for lag in factor.u_lags),
            (number for factor in factors for number in factor.inputs),
        )
        for factor_count in range(degree + 1)
        for factors in combinations_with_replacement(variables, factor_count)
    )


def linear_terms(y_lags: Lags, u_lags: InputLags, inputs: int = 1) -> tuple[Term, ...]:
    """Return the linear basis: the constant and every lagged signal by itself."""
    return candidate_terms(y_lags, u_lags, 1, inputs)


def input_lag_lists(u_lags: InputLags, inputs: int) -> list[list[int]]:
    """Return the lags of each input.

    Raises
    ------
    InputError
        Where lags are listed for another number of inputs.
    """
    listed = isinstance(u_lags, Sequence)
    if not listed or not any(isinstance(each, Sequence) for each in cast(Sequence[Any], u_lags)):
        return [lag_list(cast(Lags, u_lags), "u_lags")] * inputs
    u_lags = cast(Sequence[Any], u_lags)
    if len(u_lags) != inputs or not all(isinstance(each, Sequence) for each in u_lags):
        raise InputError(
            f"{u_lags} for {inputs} input{'s' if inputs > 1 else ''}",
            field="u_lags",
            remedy="Give one list of lags for every input, or one number for all.",
        )
    return [lag_list(cast(Sequence[int], each), "u_lags") for each in u_lags]


def lag_list(lags: Lags, field: str) -> list[int]:
    """Return the lags themselves where a largest lag may stand for 1 to it."""
    if isinstance(lags, _WHOLE):
        if lags < 0:
            raise InputError(f"a lag of {lags}", field=field, remedy="Lags are 0 or more.")
        return list(range(1, int(lags) + 1))
    if not np.iterable(lags) or not all(isinstance(lag, Integral) for lag in lags):
        raise InputError(
            f"{lags!r}", field=field, remedy="Give the largest lag, or a list of whole numbers."
        )
    return sorted({int(lag) for lag in lags})
