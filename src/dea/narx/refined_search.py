"""The structure of least cost that is stable, with parameters that minimise the simulated error."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from dea.arrays import Segment
from dea.errors import InputError
from dea.narx.descent import PRICES, Descent, Effort, price_by_folds
from dea.narx.free_run_fit import FreeRunFit, fit_free_runs
from dea.narx.search import Refined
from dea.narx.stability import StabilityTest
from dea.narx.trace import Trace, Tried
from dea.terms import Term

_CHECKED = 8  # structures of least cost whose final fits are tried before the first is returned
_UNSTABLE_DATA = 100.0  # times the squared error that stable structures may leave at most


class Found(NamedTuple):
    """One structure, and the fit to each system in normalised units."""

    terms: tuple[Term, ...]
    fits: Sequence[FreeRunFit]

    @property
    def error(self) -> float:
        """The mean squared simulated error (6), mean of the systems."""
        return sum(fit.msse for fit in self.fits) / len(self.fits)


def find(
    candidates: tuple[Term, ...],
    systems: Sequence[Sequence[Segment]],
    tests: Sequence[StabilityTest],
    search: Refined,
    trace: Trace,
) -> Found:
    """Return one structure with the parameters of each system.

    A structure counts as stable if it passes the tests with its final parameters. Where the least
    cost belongs to one that does not, the search goes on among those that do. If there is none, or
    if it leaves more than a hundred times the squared error, which suggests that
    the system itself is unstable, the structure of least cost is returned as it is.
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

    def polished() -> Iterator[Found]:
        for subset, fit in descent.exchange.by_cost(price, effort.most):
            terms = tuple(candidates[j] for j in subset)
            starts = zip(fit.parameters, systems, strict=True)
            yield Found(terms, [fit_free_runs(terms, *each) for each in starts])

    def stable(found: Found) -> bool:
        return all(
            each.passes(found.terms, fit.parameters)
            for each, fit in zip(tests, found.fits, strict=True)
        )

    first = next(polished(), None)
    if first is None:
        raise every_run_diverges()
    found = first
    if not stable(first):
        descent.exchange.require(tests)
        descent.descend(prices, effort)
        found = next(filter(stable, islice(polished(), _CHECKED)), first)
        if found.error > _UNSTABLE_DATA * first.error:
            found = first
    label = ", ".join(map(str, found.terms))
    trace.add("final", 0, [Tried(label, found.error, 0.0)], 0, "selected")
    return found


def every_run_diverges() -> InputError:
    """Return the error for records that no model of the candidate terms stays bounded on."""
    return InputError(
        "every model of these terms diverges in free run",
        field="y_lags, u_lags, degree",
        remedy="Allow other lags or a lower degree, or use a longer record.",
    )
