"""The terms that a selection may choose from: every monomial of the lagged signals."""

from collections.abc import Sequence
from itertools import combinations_with_replacement

from dea.errors import InputError
from dea.terms import Term


def candidate_terms(
    y_lags: int | Sequence[int], u_lags: int | Sequence[int], degree: int
) -> tuple[Term, ...]:
    """Every monomial up to ``degree`` of the lagged signals, by degree; the constant first.

    Parameters
    ----------
    y_lags, u_lags
        The largest lag (1 to it are used), or the lags themselves, for instance to start after
        a dead time.
    degree
        Largest number of factors, at least 1.

    Returns
    -------
    tuple of Term
        (n + degree choose degree) terms for n lagged signals: 84 for 3, 3, 3.
    """
    if degree < 1:
        raise InputError(f"a degree of {degree}", field="degree", remedy="It is at least 1.")
    variables = [("y", lag) for lag in lag_list(y_lags, "y_lags")]
    variables += [("u", lag) for lag in lag_list(u_lags, "u_lags")]
    return tuple(
        Term.of(
            (lag for variable, lag in factors if variable == "y"),
            (lag for variable, lag in factors if variable == "u"),
        )
        for factor_count in range(degree + 1)
        for factors in combinations_with_replacement(variables, factor_count)
    )


def linear_terms(y_lags: int | Sequence[int], u_lags: int | Sequence[int]) -> tuple[Term, ...]:
    """Return the linear basis: the constant and every lagged signal by itself."""
    return candidate_terms(y_lags, u_lags, 1)


def lag_list(lags: int | Sequence[int], field: str) -> list[int]:
    """Return the lags themselves where a largest lag may stand for 1 to it."""
    listed = list(range(1, lags + 1)) if isinstance(lags, int) else sorted(set(lags))
    if isinstance(lags, int) and lags < 0:
        raise InputError(f"a lag of {lags}", field=field, remedy="Lags are 0 or more.")
    return listed
