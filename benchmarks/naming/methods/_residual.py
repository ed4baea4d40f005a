"""The residual of the simulation alone, as methods that learn from it use it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.naming.task import Task
from dea.arrays import Array
from dea.discrepancy.problem.problem import rmse

Mask = NDArray[np.bool_]
# Part of the samples used, the last ones, that choices are made on; and the part of the residual
# there that a model must remove, which is what a diagnosis asks of an effect, too.
_CHOOSING, _MARGIN = 0.25, 0.1


@dataclass(frozen=True)
class Residual:
    """What the fitted simulation leaves.

    Parameters
    ----------
    simulated : (n,)
        Its free run over the whole record; NaN from where it runs away.
    values : (m,)
        Measured minus simulated output of the seen part.
    used, train, choose : (m,) bool
        Samples to learn from, those of them that a model is first fitted to, and the others, that
        choices are made on.
    """

    simulated: Array
    values: Array
    used: Mask
    train: Mask
    choose: Mask

    @classmethod
    def of(cls, task: Task) -> "Residual":
        """Return that of a task."""
        used = task.problem.seen
        late = np.cumsum(used) > (1.0 - _CHOOSING) * used.sum()
        values = task.nominal.residual
        return cls(task.simulated(task.nominal), values, used, used & ~late, used & late)

    @property
    def held(self) -> Array:
        """The free run, with its last value from where it runs away: what terms are made of."""
        away = ~np.isfinite(self.simulated)
        first = int(np.argmax(away))
        return np.where(away, self.simulated[first - 1], self.simulated)

    def error(self, predicted: Array) -> float:
        """Return the RMS error of a prediction (n,) where choices are made; infinite if it is."""
        return rmse(self.values - predicted[: self.values.size], self.choose)


def needed(error: float, residual: Residual) -> bool:
    """Return whether a model with this error where choices are made is worth having."""
    return error <= (1.0 - _MARGIN) * rmse(residual.values, residual.choose)
