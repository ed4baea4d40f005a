"""Whether what a periodic disturbance leaves is its own wave, changed by the motion."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.evidence.regression import part_predicted
from dea.discrepancy.evidence.residual_model import standard
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.rules import Rules
from dea.inputs import by_input
from dea.simulation import Family

_HARMONICS = (1, 2)
_RIDGE = 1e-4


@dataclass(frozen=True)
class ModulatedWave:
    """The effects that leave a wave of a disturbance, changed by the motion; its frequency (Hz)."""

    names: tuple[str, ...]
    frequency: float


def modulated_wave(
    problem: Problem, pool: Sequence[Candidate], rules: Rules
) -> ModulatedWave | None:
    """Return the wave that follows the motion, if a disturbance leaves one.

    Of the finished candidates of a ``pool`` with a disturbance, the best of those with the fewest
    effects tells: a second effect may stand for a part of what the motion does to the wave.
    """
    waving = [c for c in pool if c.finished and _frequencies(c.fit)]
    if not waving:
        return None
    fewest = min(waving, key=lambda c: (len(c.effects), c.error))
    if not follows_motion(problem, fewest.fit, rules):
        return None
    return ModulatedWave(fewest.names, _frequencies(fewest.fit)[0])


def follows_motion(problem: Problem, fitted: Fit, rules: Rules) -> bool:
    """Return whether most of what a fit leaves is its disturbance, changed by the motion."""
    return rules.removes_energy(1.0 - part_modulated(problem, fitted), 1.0)


def part_modulated(problem: Problem, fitted: Fit) -> float:
    """Return the part of what a fit leaves, in RMS, that the motion tells at a disturbance's lines.

    A disturbance of the reading is the same whatever the device does. If its first lines predict
    the residual once they are multiplied by the motion, on samples that they were not fitted to, a
    property of the device changes periodically instead: a parametric excitation (Nayfeh and Mook
    1979, Nonlinear Oscillations). It is 0 without a disturbance.
    """
    waves = [wave for f in _frequencies(fitted) for wave in _lines(f, problem.time)]
    if not waves:
        return 0.0
    output = problem.y - fitted.residual
    rate = problem.rate_of(output)
    # A property that changes multiplies input or position, the rate, or the acceleration.
    places = [standard(signal) for signal in (*by_input(problem.u), output)]
    moving = [*places, *(place**2 for place in places), rate, problem.rate_of(rate)]
    products = [wave * signal for wave in waves for signal in map(standard, moving)]

    def left(columns: list[np.ndarray]) -> float:
        part = part_predicted(problem, fitted.residual, np.column_stack(columns), (_RIDGE,))
        return 1.0 - max(part, 0.0)

    return max(1.0 - left(waves + products) / left(waves), 0.0)


def _frequencies(fitted: Fit) -> list[float]:
    """Return the frequency (Hz) of each periodic disturbance of the reading."""
    layout = fitted.extended.layout
    return [
        float(fitted.values[part][[p.name for p in a.parameters].index(a.effect.defining)])
        for a, part in zip(fitted.extended.attached, layout.effect_slices, strict=True)
        if a.effect.family is Family.OSCILLATION and a.effect.only_reads
    ]


def _lines(frequency: float, time: np.ndarray) -> list[np.ndarray]:
    """Return cosine and sine (n,) at the first harmonics of a frequency (Hz)."""
    angles = [2.0 * np.pi * order * frequency * time for order in _HARMONICS]
    return [wave(angle) for angle in angles for wave in (np.cos, np.sin)]
