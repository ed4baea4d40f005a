"""What candidates are judged by."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.problem import Problem
from dea.discrepancy.rules import Rules


@dataclass(frozen=True)
class Evidence:
    """What candidates are judged by; errors are in the output's unit.

    Parameters
    ----------
    held_out
        Residuals on blocks that the parameters were not fitted to.
    blocks
        Blocks of the seen samples, which are resampled.
    nominal_error
        RMS residual of the simulation alone.
    noise
        Noise floor, down to which rivals are told apart.
    accuracy
        Stated accuracy of the simulation.
    rng
        Draws the blocks.
    """

    problem: Problem
    held_out: HeldOut
    blocks: Sequence[slice]
    nominal_error: float
    noise: float
    accuracy: float
    rules: Rules
    rng: np.random.Generator

    @property
    def floor(self) -> float:
        """Residual that remains of a complete simulation: noise and stated accuracy."""
        return float(np.hypot(self.noise, self.accuracy))
