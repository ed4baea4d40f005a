"""A ridge regression of the residual: predicts what the simulation lacks, and cannot name it.

The residual is regressed on the dictionary by which a diagnosis asks whether anything predictable
is left. Its ridge, and whether it may use terms in time, are chosen on the last quarter of what is
seen; then all of it is regressed on.
"""

import numpy as np
from sklearn.linear_model import Ridge

from benchmarks.naming.methods._residual import Mask, Residual, needed
from benchmarks.naming.task import Answer, Method, Task
from dea.arrays import Array
from dea.discrepancy.evidence.residual_model import dictionary
from dea.discrepancy.problem.problem import Problem

_RIDGES = np.logspace(-2, 6, 17)


def answer(task: Task) -> Answer:
    """Say ``unknown`` where the regression predicts some of the residual, else ``none``."""
    residual = Residual.of(task)
    choices = [
        (ridge, columns)
        for columns in _columns(task, residual.held)
        for ridge in _RIDGES
    ]  # fmt: skip

    def predicted(choice: tuple[float, Array], train: Mask) -> Array:
        ridge, X = choice
        seen = X[: train.size][train]
        mean, scale = seen.mean(0), seen.std(0) + 1e-12
        fitted = Ridge(alpha=ridge).fit((seen - mean) / scale, residual.values[train])
        found: Array = fitted.predict((X - mean) / scale)
        return found

    errors = [residual.error(predicted(choice, residual.train)) for choice in choices]
    best = int(np.argmin(errors))
    if not needed(errors[best], residual):
        return Answer("none", task.ahead(task.nominal))
    correction = predicted(choices[best], residual.used)
    return Answer("unknown", (residual.simulated + correction)[task.y.size :])


def _columns(task: Task, simulated: Array) -> list[Array]:
    """Return the dictionary over the whole record, with and without its terms in time."""
    nothing = np.zeros(task.u.size, bool)
    whole = Problem(task.u, simulated, task.interval, nothing, nothing, nothing)
    names, X = dictionary(whole, simulated)
    lasting = np.array([not name.startswith("time") for name in names])
    return [X, X[:, lasting]]


METHOD = Method(
    "ridge regression of the residual", "Hoerl and Kennedy, Technometrics 12 (1970) 55", answer
)
