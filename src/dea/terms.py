"""The grammar of polynomial NARX terms: parses, orders and prints products of lagged signals."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from dea.errors import InputError

_FACTOR = re.compile(r"(y|u(\d*))\(t(?:-(\d+))?\)(?:\^(\d+))?")
_NUMBER = re.compile(r"(\d+)")
_REMEDY = "Write it like 1, y(t-1) or y(t-1)u(t-3)^2, with several inputs u1(t-3), u2(t-3)."


class Term(NamedTuple):
    """A monomial: the product of y(t-k) over ``y_lags`` and of u(t-k) over ``u_lags``.

    ``inputs`` is empty where the system has one input, ``u``; of several, ``u1`` and so on, it
    holds the number of the input that each of ``u_lags`` belongs to.

    Lags are sorted, those of each input by themselves, and repeated for powers, so that a monomial
    has one representation; :meth:`of` and :meth:`parse` see to it. The constant has no lags.
    """

    y_lags: tuple[int, ...] = ()
    u_lags: tuple[int, ...] = ()
    inputs: tuple[int, ...] = ()

    @classmethod
    def of(
        cls, y_lags: Iterable[int] = (), u_lags: Iterable[int] = (), inputs: Iterable[int] = ()
    ) -> "Term":
        """Return the term with these lags in any order.

        Raises
        ------
        InputError
            For an output lag below 1 or an input lag below 0; for input numbers below 1 or not as
            many as input lags.
        """
        lags, numbers = tuple(u_lags), tuple(inputs)
        if numbers:
            if len(numbers) != len(lags) or min(numbers) < 1:
                raise InputError(
                    f"the inputs {numbers} for the input lags {lags}",
                    field="term",
                    remedy="Number the inputs from 1, one for each input lag.",
                )
            pairs = sorted(zip(numbers, lags, strict=True))
            numbers = tuple(number for number, _ in pairs)
            lags = tuple(lag for _, lag in pairs)
        else:
            lags = tuple(sorted(lags))
        term = cls(tuple(sorted(y_lags)), lags, numbers)
        if min(term.y_lags, default=1) < 1 or min(term.u_lags, default=0) < 0:
            raise InputError(
                f"the term {term} does not use the past alone",
                field="term",
                remedy="Output lags start at 1, input lags at 0.",
            )
        return term

    @classmethod
    def parse(cls, text: str) -> "Term":
        """Read a term as people write it: ``1``, ``y(t-1)``, ``y(t-1)u(t-3)^2``, ``u1(t)u2(t)``.

        Blanks and ``*`` between factors are allowed.

        Raises
        ------
        InputError
            If the text is not such a product.
        """
        compact = re.sub(r"[\s*]", "", text)
        if compact == "1":
            return cls()
        y_lags: list[int] = []
        u_lags: list[int] = []
        inputs: list[int] = []
        position = 0
        while match := _FACTOR.match(compact, position):
            signal, number, lag, power = match.groups()
            lags = [int(lag or 0)] * int(power or 1)
            if signal == "y":
                y_lags += lags
            else:
                u_lags += lags
                inputs += [int(number)] * len(lags) if number else []
            position = match.end()
        if position == 0 or position < len(compact) or len(inputs) not in (0, len(u_lags)):
            raise InputError(f"{text!r} is not a term", field="term", remedy=_REMEDY)
        return cls.of(y_lags, u_lags, inputs)

    @property
    def degree(self) -> int:
        """Number of factors; 0 for the constant."""
        return len(self.y_lags) + len(self.u_lags)

    @property
    def max_lag(self) -> int:
        """Largest lag of any factor; 0 for the constant."""
        return max(self.y_lags + self.u_lags, default=0)

    @property
    def input_columns(self) -> tuple[int, ...]:
        """The column of the input, from 0, that each of ``u_lags`` belongs to."""
        return tuple(n - 1 for n in self.inputs) or (0,) * len(self.u_lags)

    @property
    def input_powers(self) -> Counter[int]:
        """How many factors are of each input, by its column from 0."""
        return Counter(self.input_columns)

    @property
    def is_delayed_output(self) -> bool:
        """Whether it is one lagged output alone: part of the poles of the linear part."""
        return len(self.y_lags) == 1 and not self.u_lags

    @property
    def input_part(self) -> "Term":
        """The product of the input factors alone."""
        return self._replace(y_lags=())

    @property
    def reading_order(self) -> tuple[int, int, list[str | int]]:
        """Sort key for tables: the constant, then by degree, terms with more outputs first."""
        # Numbers within the text compare as numbers: u(t-2) comes before u(t-10).
        text = [int(part) if part.isdigit() else part for part in _NUMBER.split(str(self))]
        return self.degree, -len(set(self.y_lags)), text

    def mathematics(self) -> str:
        """Return the term for LaTeX and mathtext: ``y(t-1)u(t)^2`` as ``$y_{t-1}u_{t}^{2}$``."""
        factors = [
            f"{signal}_{{{f'{number},' if number else ''}{_instant(lag)}}}"
            + (f"^{{{power}}}" if power > 1 else "")
            for signal, number, lag, power in self._factors()
        ]
        return f"${''.join(factors) or 1}$"

    def html(self) -> str:
        """Return the term for HTML: signals in italics, powers raised."""
        factors = [
            f"<i>{signal}</i>{f'<sub>{number}</sub>' if number else ''}"
            f"({_instant(lag).replace('t', '<i>t</i>').replace('-', '−')})"
            + (f"<sup>{power}</sup>" if power > 1 else "")
            for signal, number, lag, power in self._factors()
        ]
        return "".join(factors) or "1"

    def __str__(self) -> str:
        factors = [
            f"{signal}{number}({_instant(lag)})" + (f"^{power}" if power > 1 else "")
            for signal, number, lag, power in self._factors()
        ]
        return "".join(factors) or "1"

    def _factors(self) -> Iterator[tuple[str, str, int, int]]:
        """Each factor once, as its signal, number, lag and power; outputs first."""
        for lag, power in Counter(self.y_lags).items():
            yield "y", "", lag, power
        numbers = self.inputs or ("",) * len(self.u_lags)
        for (number, lag), power in Counter(zip(numbers, self.u_lags, strict=True)).items():
            yield "u", str(number), lag, power


def as_terms(terms: Iterable[Term | str]) -> tuple[Term, ...]:
    """Return terms, some of which may be written as people write them.

    Raises
    ------
    InputError
        For text that is no term.
    """
    return tuple(Term.parse(term) if isinstance(term, str) else term for term in terms)


def max_lag(terms: Iterable[Term]) -> int:
    """Largest lag of any of the terms: how many samples a simulation cannot compute."""
    return max((term.max_lag for term in terms), default=0)


def input_symbol(column: int, count: int) -> str:
    """Return what terms call the input of a column, from 0, of so many: ``u``, or ``u1``."""
    return "u" if count == 1 else f"u{column + 1}"


def static_value(powers: Mapping[int, int], levels: Any) -> Any:
    """Return the product of constant inputs to their powers, as ``input_powers`` of a term tells.

    ``levels`` holds one number for each input, or one array; then so is the product, but for a
    product of no inputs, which is 1.
    """
    value: Any = 1.0
    for column, power in powers.items():
        value = value * levels[column] ** power
    return value


def numbered_inputs(terms: Iterable[Term]) -> int | None:
    """Return the largest number of an input in the terms.

    0 where they write ``u`` without a number; None where no input occurs.

    Raises
    ------
    InputError
        Where some terms number their inputs and others do not.
    """
    driven = [term for term in terms if term.u_lags]
    if not driven:
        return None
    numbers = {max(term.inputs, default=0) for term in driven}
    if 0 in numbers and len(numbers) > 1:
        plain, numbered = (
            next(term for term in driven if bool(term.inputs) is wanted) for wanted in (False, True)
        )
        raise InputError(
            f"{plain} does not say which input, {numbered} does",
            field="terms",
            remedy="Number the inputs of every term, u1, u2 and so on, or of none.",
        )
    return max(numbers)


def is_term(text: str) -> bool:
    """Whether :meth:`Term.parse` accepts ``text``."""
    try:
        Term.parse(text)
    except InputError:
        return False
    return True


def _instant(lag: int) -> str:
    return f"t-{lag}" if lag else "t"
