"""The structure of least cost that is stable, with parameters that minimise the simulated error."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from dea.errors import InputError
from dea.narx.candidate_models import Segment
from dea.narx.checks import Array
from dea.narx.descent import PRICES, Descent, Effort, price_by_folds
from dea.narx.refinement import fit_free_runs
from dea.narx.search import Refined
from dea.narx.stability import StabilityTest
from dea.narx.trace import Trace, Tried
from dea.terms import Term

_CHECKED = 8  # structures of least cost whose final fits are tried before the first is returned
_UNSTABLE_DATA = 100.0  # times the squared error that stable structures may leave at most


class FoundModel(NamedTuple):
    """A model of one system in normalised units."""

    terms: tuple[Term, ...]
    parameters: Array
    covariance: Array
    withheld: str = ""  # why intervals from the covariance cannot hold
    msse: float = float("nan")  # mean squared simulated error (6)


def find(
    candidates: tuple[Term, ...],
    systems: Sequence[Sequence[Segment]],
    tests: Sequence[StabilityTest],
    search: Refined,
    trace: Trace,
) -> list[FoundModel]:
    """Return one structure with the parameters of each system.

    A structure counts as stable if it passes the tests with its final parameters. Where the least
    cost belongs to one that does not, the search goes on among those that do. If there is none, or
    if it leaves more than a hundred times the squared error, so that the record itself speaks for
    an unstable system, the structure of least cost is returned as it is.
    """
    effort = Effort(
        search.rounds, len(candidates) if search.max_terms is None else search.max_terms
    )
    price = search.threshold
    if price is None:
        price = price_by_folds(candidates, systems, effort)
    trace.threshold = price
    prices = [each for each in PRICES if each > price] + [price]
    descent = Descent(candidates, systems, trace)
    descent.descend(prices, effort)

    def polished() -> Iterator[list[FoundModel]]:
        for subset, fit in descent.exchange.by_cost(price, effort.most):
            terms = tuple(candidates[j] for j in subset)
            yield [
                _polished(terms, start, segments)
                for start, segments in zip(fit.parameters, systems, strict=True)
            ]

    def stable(found: Sequence[FoundModel]) -> bool:
        return all(
            each.passes(model.terms, model.parameters)
            for each, model in zip(tests, found, strict=True)
        )

    first = next(polished(), None)
    if first is None:
        raise every_run_diverges()
    found = first
    if not stable(first):
        descent.exchange.require(tests)
        descent.descend(prices, effort)
        found = next(filter(stable, islice(polished(), _CHECKED)), first)
        if _error(found) > _UNSTABLE_DATA * _error(first):
            found = first
    label = ", ".join(map(str, found[0].terms))
    trace.add("final", 0, [Tried(label, _error(found), 0.0)], 0, "selected")
    return found


def every_run_diverges() -> InputError:
    """Return the error for records that no model of the candidate terms stays bounded on."""
    return InputError(
        "every model of these terms diverges in free run",
        field="y_lags, u_lags, degree",
        remedy="Allow other lags or a lower degree, or use a longer record.",
    )


def _error(found: Sequence[FoundModel]) -> float:
    return sum(model.msse for model in found) / len(found)


def _polished(terms: tuple[Term, ...], start: Array, segments: Sequence[Segment]) -> FoundModel:
    fit = fit_free_runs(terms, start, segments)
    return FoundModel(terms, fit.parameters, fit.covariance, msse=fit.msse)
