"""Whether what is named in some records of a device serves on the one that was left out."""

import numpy as np

from dea.discrepancy.evidence.certificate import Certified
from dea.discrepancy.fitting.fit import Columns, Fit, fit
from dea.discrepancy.problem.problem import Problem, rmse
from dea.simulation import samples_of_each

_ITERATIONS = 10


def record_names(count: int) -> list[str]:
    """Return the names by which the records of a joint diagnosis are told."""
    return [f"record_{number}" for number in range(1, count + 1)]


def leave_one_out(problem: Problem, nominal: Fit, extended: Fit) -> dict[str, Certified]:
    """Compare both simulations on each of several records, fitted to the others alone.

    On the record that is left out only what is its own is fitted: its state at the start and the
    course of what happens in one record alone. A single record leaves nothing to compare.
    """
    found = {}
    lengths = nominal.extended.lengths
    for name, samples in zip(record_names(len(lengths)), samples_of_each(lengths), strict=True):
        record = np.zeros(problem.size, bool)
        record[samples] = True
        before, after = (_on(problem, record, each) for each in (nominal, extended))
        found[name] = Certified(before, after, int((record & problem.seen).sum()))
    return found


def _on(problem: Problem, record: np.ndarray, fitted: Fit) -> float:
    extended = fitted.extended
    elsewhere = fit(problem.seeing(~record), extended, fitted.coordinates, iterations=_ITERATIONS)
    own = fit(
        problem.seeing(record),
        extended,
        elsewhere.coordinates,
        iterations=_ITERATIONS,
        columns=Columns(held=~extended.layout.own_of_records),
    )
    return rmse(own.residual, record & problem.seen)
