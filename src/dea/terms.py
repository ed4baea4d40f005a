"""The grammar of polynomial NARX terms: parses, orders and prints products of lagged signals."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from dea.errors import InputError

_FACTOR = re.compile(r"([yu])\(t(?:-(\d+))?\)(?:\^(\d+))?")
_NUMBER = re.compile(r"(\d+)")
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

    @property
    def reading_order(self) -> tuple[int, int, list[str | int]]:
        """Sort key for tables: the constant, then by degree, terms with more outputs first."""
        # Numbers within the text compare as numbers: u(t-2) comes before u(t-10).
        text = [int(part) if part.isdigit() else part for part in _NUMBER.split(str(self))]
        return self.degree, -len(set(self.y_lags)), text

    def mathematics(self) -> str:
        """Return the term for LaTeX and mathtext: ``y(t-1)u(t)^2`` as ``$y_{t-1}u_{t}^{2}$``."""
        factors = [
            f"{signal}_{{{_instant(lag)}}}" + (f"^{{{power}}}" if power > 1 else "")
            for signal, lag, power in self._factors()
        ]
        return f"${''.join(factors) or 1}$"

    def html(self) -> str:
        """Return the term for HTML: signals in italics, powers raised."""
        factors = [
            f"<i>{signal}</i>({_instant(lag).replace('t', '<i>t</i>').replace('-', '−')})"
            + (f"<sup>{power}</sup>" if power > 1 else "")
            for signal, lag, power in self._factors()
        ]
        return "".join(factors) or "1"

    def __str__(self) -> str:
        factors = [
            f"{signal}({_instant(lag)})" + (f"^{power}" if power > 1 else "")
            for signal, lag, power in self._factors()
        ]
        return "".join(factors) or "1"

    def _factors(self) -> Iterator[tuple[str, int, int]]:
        """Each factor once, as its signal, lag and power; outputs first."""
        for signal, lags in (("y", self.y_lags), ("u", self.u_lags)):
            for lag, power in Counter(lags).items():
                yield signal, lag, power


def max_lag(terms: Iterable[Term]) -> int:
    """Largest lag of any of the terms: how many samples a simulation cannot compute."""
    return max((term.max_lag for term in terms), default=0)


def is_term(text: str) -> bool:
    """Whether :meth:`Term.parse` accepts ``text``."""
    try:
        Term.parse(text)
    except InputError:
        return False
    return True


def _instant(lag: int) -> str:
    return f"t-{lag}" if lag else "t"
