"""How a selection searches: three ways, each with its settings."""

from dataclasses import dataclass
from numbers import Real

from dea.errors import InputError
from dea.given_numbers import is_count


@dataclass(frozen=True)
class Refined:
    """Add, drop and exchange terms while their parameters minimise the simulated error.

    Parameters
    ----------
    threshold
        The share of the output's mean square that a term must explain. By default the record
        decides: as low as its noise allows, and only as low as parts left out confirm.
    rounds
        Largest number of accepted steps.
    max_terms
        Largest number of terms.
    """

    threshold: float | None = None
    rounds: int = 200
    max_terms: int | None = None

    def __post_init__(self) -> None:
        _whole("rounds", self.rounds, 0)
        _one_or_any(self.max_terms)
        if self.threshold is not None:
            _not_negative("threshold", self.threshold)


@dataclass(frozen=True)
class Forward:
    """The paper's forward selection and pruning (5)-(9), with least-squares parameters (4).

    Parameters
    ----------
    add_threshold, prune_threshold
        SERR below which no term is added; rise of the error, as SERR, up to which one is removed.
    max_terms
        Largest number of terms; pruning goes on until the model has no more.
    """

    add_threshold: float = 1e-5
    prune_threshold: float = 1e-5
    max_terms: int | None = None

    def __post_init__(self) -> None:
        _one_or_any(self.max_terms)
        _not_negative("add_threshold", self.add_threshold)
        _not_negative("prune_threshold", self.prune_threshold)


@dataclass(frozen=True)
class Orthogonal:
    """Forward regression with orthogonal least squares (FROLS): a first model in milliseconds.

    Terms are taken in the order of their error reduction ratios; of the models after each step the
    one with the least simulated error is returned, with least-squares parameters.

    Parameters
    ----------
    max_terms
        Largest number of terms.
    """

    max_terms: int | None = 25

    def __post_init__(self) -> None:
        _one_or_any(self.max_terms)


Search = Refined | Forward | Orthogonal
SEARCHES: dict[str, type[Search]] = {
    "refined": Refined,
    "forward": Forward,
    "orthogonal": Orthogonal,
}


def _one_or_any(max_terms: int | None) -> None:
    if max_terms is not None:
        _whole("max_terms", max_terms, 1)


def _whole(name: str, count: int, least: int) -> None:
    if not is_count(count, least):
        raise InputError(
            f"it is {count!r}", field=name, remedy=f"Give a whole number, {least} or more."
        )


def _not_negative(name: str, threshold: float) -> None:
    if not isinstance(threshold, Real) or not threshold >= 0.0:
        raise InputError(f"it is {threshold!r}", field=name, remedy="A share is 0 or more.")
