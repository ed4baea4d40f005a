"""The excitation that best separates two rivals, among those the acquisition offers."""

from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Fit
from dea.discrepancy.problem import Problem
from dea.discrepancy.sensitivity import sensitivities, unabsorbed
from dea.excitation import design

# Candidate designs of each kind of excitation, which differ in rests, rates and bands.
_DESIGNS: tuple[tuple[str, dict[str, float]], ...] = (
    ("gaussian", {"band": 1.0}),
    ("gaussian", {"band": 0.2}),
    ("bursts", {"band": 1.0, "active": 15.0, "rest": 15.0}),
    ("multisine", {"band": 1.0, "period": 30.0}),
    ("staircase", {"levels": 6, "hold": 8.0, "rest": 8.0}),
    ("binary", {"band": 1.0}),
    ("triangle", {"slowest": 20.0, "fastest": 4.0}),
)
# Length of every design: enough for its periods and rests.
_SAMPLES = 6000


@dataclass(frozen=True)
class Experiment:
    """An excitation, and by how many noise deviations in all it separates the rivals."""

    kind: str
    duration: float
    low: float
    high: float
    settings: dict[str, float]
    separation: float
    present: float


def separating_experiment(problem: Problem, first: Fit, second: Fit, seed: int) -> Experiment:
    """Choose the design on which the rivals, each refitted to the other, differ most.

    The discrimination criterion of Atkinson and Fedorov (1975), Biometrika 62:57, over the
    designs the acquisition offers, within the range of the record's input.
    """
    low, high = float(problem.u.min()), float(problem.u.max())
    rate = 1.0 / problem.interval
    best: Experiment | None = None
    present = _apart(problem, problem.u[:_SAMPLES], first, second)
    for kind, settings in _DESIGNS:
        # Times and bands are given for 50 Hz and scale with the sampling rate.
        pace = rate / 50.0
        scaled = {
            key: value * pace if key == "band" else value if key == "levels" else value / pace
            for key, value in settings.items()
        }
        duration = _SAMPLES / rate
        u = design(
            kind, duration=duration, sampling_rate=rate, low=low, high=high, seed=seed, **scaled
        )
        distance = _apart(problem, u, first, second)
        if best is None or distance > best.separation:
            best = Experiment(kind, duration, low, high, scaled, distance, present)
    assert best is not None
    return best


def _apart(problem: Problem, u: np.ndarray, first: Fit, second: Fit) -> float:
    """Return the distance of the rivals on ``u`` in noise deviations, the closer way round."""
    return min(_one_way(problem, u, first, second), _one_way(problem, u, second, first))


def _one_way(problem: Problem, u: np.ndarray, truth: Fit, rival: Fit) -> float:
    y = truth.extended.simulate(truth.values, u, problem.interval)
    if not np.isfinite(y).all():
        return 0.0
    everywhere = np.ones(u.size, bool)
    imagined = Problem(u, y, problem.interval, everywhere, everywhere, everywhere, problem.noise)
    residual = imagined.residual(rival.extended, rival.values)
    if not np.isfinite(residual).all():
        return 0.0
    J = sensitivities(
        imagined, rival.extended, rival.coordinates, residual, np.arange(rival.coordinates.size)
    )
    return float(np.linalg.norm(unabsorbed(J, problem.noise)(residual)) / problem.noise)
