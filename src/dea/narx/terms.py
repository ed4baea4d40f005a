"""Terms of a polynomial NARX model: monomials of lagged outputs and inputs, and their text."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import combinations_with_replacement
from typing import NamedTuple

from dea.errors import InputError

_FACTOR = re.compile(r"([yu])\(t(?:-(\d+))?\)(?:\^(\d+))?")
_REMEDY = "Write it like 1, y(t-1) or y(t-1)u(t-3)^2."


class Term(NamedTuple):
    """A monomial: the product of y(t-k) over ``y_lags`` and of u(t-k) over ``u_lags``.

    Lags are sorted and repeated for powers, so that a monomial has one representation;
    :meth:`of` and :meth:`parse` see to it. The constant has no lags.
    """

    y_lags: tuple[int, ...] = ()
    u_lags: tuple[int, ...] = ()

    @classmethod
    def of(cls, y_lags: Iterable[int] = (), u_lags: Iterable[int] = ()) -> "Term":
        """Return the term with these lags in any order.

        Raises
        ------
        InputError
            For an output lag below 1 or an input lag below 0.
        """
        term = cls(tuple(sorted(y_lags)), tuple(sorted(u_lags)))
        if min(term.y_lags, default=1) < 1 or min(term.u_lags, default=0) < 0:
            raise InputError(
                f"the term {term} does not use the past alone",
                field="term",
                remedy="Output lags start at 1, input lags at 0.",
            )
        return term

    @classmethod
    def parse(cls, text: str) -> "Term":
        """Read a term as people write it: ``1``, ``y(t-1)``, ``y(t-1)u(t-3)^2``.

        Blanks and ``*`` between factors are allowed.

        Raises
        ------
        InputError
            If the text is not such a product.
        """
        compact = re.sub(r"[\s*]", "", text)
        if compact == "1":
            return cls()
        lags: dict[str, list[int]] = {"y": [], "u": []}
        position = 0
        while match := _FACTOR.match(compact, position):
            variable, lag, power = match.groups()
            lags[variable] += [int(lag or 0)] * int(power or 1)
            position = match.end()
        if position == 0 or position < len(compact):
            raise InputError(f"{text!r} is not a term", field="term", remedy=_REMEDY)
        return cls.of(lags["y"], lags["u"])

    @property
    def degree(self) -> int:
        """Number of factors; 0 for the constant."""
        return len(self.y_lags) + len(self.u_lags)

    @property
    def max_lag(self) -> int:
        """Largest lag of any factor; 0 for the constant."""
        return max(self.y_lags + self.u_lags, default=0)

    def __str__(self) -> str:
        factors = [
            f"{variable}(t{f'-{lag}' if lag else ''}){f'^{power}' if power > 1 else ''}"
            for variable, lags in (("y", self.y_lags), ("u", self.u_lags))
            for lag, power in Counter(lags).items()
        ]
        return "".join(factors) or "1"


def max_lag(terms: Iterable[Term]) -> int:
    """Largest lag of any of the terms: how many samples a simulation cannot compute."""
    return max((term.max_lag for term in terms), default=0)


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
