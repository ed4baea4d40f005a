"""What candidates are judged by."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.fitting.fit import Fit, fit, without
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules


@dataclass(frozen=True)
class Evidence:
    """What candidates are judged by; errors are in the output's unit.

    Parameters
    ----------
    nominal
        The simulation alone, refitted.
    held_out
        Residuals on blocks that the parameters were not fitted to.
    blocks
        Blocks of the seen samples, which are resampled.
    noise_floor
        Level of the white noise, down to which rivals are told apart.
    accuracy
        Stated accuracy of the simulation.
    coloured_level
        Level of the coloured noise beyond the white one, 0 where the best candidate leaves none.
    rng
        Draws what is random, such as the blocks.
    """

    problem: Problem
    nominal: Fit
    held_out: HeldOut
    blocks: Sequence[slice]
    noise_floor: float
    accuracy: float
    rules: Rules
    rng: np.random.Generator
    coloured_level: float = 0.0

    @cached_property
    def nominal_error(self) -> float:
        """RMS residual of the simulation alone."""
        return self.problem.seen_rmse(self.nominal.residual)

    @cached_property
    def _refitted(self) -> dict[tuple[Fit, int], Fit]:
        return {}

    def refitted_without(self, fitted: Fit, index: int) -> Fit:
        """Return a fit without one of its effects, the others fitted again; found once."""
        key = fitted, index
        if key not in self._refitted:
            start = without(self.problem, fitted, index)
            self._refitted[key] = fit(self.problem, start.extended, start.coordinates)
        return self._refitted[key]

    @cached_property
    def _seed(self) -> int:
        return int(self.rng.integers(2**32))

    @property
    def resampling(self) -> np.random.Generator:
        """A generator that draws the same blocks whenever candidates are compared.

        So a bound is the same whatever was compared before.
        """
        return np.random.default_rng(self._seed)

    @property
    def floor(self) -> float:
        """Residual that a complete simulation leaves: white noise, and what goes beyond it.

        That is coloured noise, or the stated accuracy, whichever is larger.
        """
        return float(np.hypot(self.noise_floor, max(self.accuracy, self.coloured_level)))

    @property
    def stated_floor(self) -> float:
        """White noise and stated accuracy, without coloured noise."""
        return float(np.hypot(self.noise_floor, self.accuracy))
