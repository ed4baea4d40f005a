"""How much of a residual some smooth force on the motion would cause.

Forces that no law of the catalogue has, such as a drag that grows with the square of the speed,
show in the output as the device filters them. A regression on what was simulated misses that.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from dea.discrepancy.evidence.regression import part_predicted
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem
from dea.simulation import (
    FORCE,
    Effect,
    Family,
    Parameter,
    Port,
    Scales,
    measured_scales,
)

# What the force depends on, and the places of those terms among the weights.
_GROUPS = {"the place": (0, 1), "the speed": (2, 3, 6, 7)}
_TERMS = 8
# Part of what all terms predict that those of one group must, for the force to depend on it alone.
_ALONE = 0.8
# Part of the unit of force by which each term pushes, and weights of the ridge, the best of which
# counts: what is nearly collinear would be fitted by noise.
_PUSH, _RIDGES = 1e-3, (1e-6, 1e-4, 1e-2)


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Return powers and products of place and speed, each in its range, with weights ``q``."""
    place = (z - q[_TERMS]) / q[_TERMS + 1]
    speed = w / q[_TERMS + 2]
    smooth = q[0] * place * place + q[1] * place * place * place
    smooth += speed * speed * (q[2] + q[3] * speed) + speed * place * (q[4] + q[5] * place)
    return float(smooth + q[6] * speed * abs(speed) + q[7] * np.tanh(3.0 * speed))


class UnknownForce(NamedTuple):
    """A force that would cause a residual: the part of it that is predicted, and how it looks.

    ``of`` is what it depends on, ``port`` where it pushes.
    """

    part: float
    of: str
    port: str


def unknown_force(problem: Problem, fitted: Fit) -> UnknownForce | None:
    """Return the smooth force that predicts most of a fit's residual on samples not fitted to.

    The force is a sum of powers and products of place and speed at one of the force ports, small
    enough for its effects to add up; the parameters of the fit adapt to it. There is none without a
    port, or where three forces are attached already. The best of a few sums is taken by the samples
    that judge it, so that noise of a short record may give a small part.
    """
    if not (fitted.stable and fitted.extended.takes_force):
        return None
    found = [
        _at_port(problem, fitted, place, port.name)
        for place, port in enumerate(fitted.extended.simulation.force_ports)
    ]
    return max(found, key=lambda force: force.part, default=None)


def _at_port(problem: Problem, fitted: Fit, place: int, name: str) -> UnknownForce:
    changes = _changes(problem, fitted, place)
    placed = fitted.extended.simulation.force_ports[place].position is not None
    groups = _GROUPS if placed else {"the speed": _GROUPS["the speed"]}
    parts = {
        group: _predicted(problem, fitted, [changes[k] for k in terms])
        for group, terms in groups.items()
    }
    whole = max(_predicted(problem, fitted, changes) if placed else 0.0, *parts.values(), 0.0)
    group = max(parts, key=lambda each: parts[each])
    of = group if parts[group] >= _ALONE * whole else "place and speed"
    return UnknownForce(whole, of, name)


def _predicted(problem: Problem, fitted: Fit, changes: Sequence[np.ndarray]) -> float:
    """Return the part of the residual that changes of it, and of the parameters, predict."""
    X = np.column_stack([fitted.jacobian, *changes])
    return part_predicted(problem, fitted.residual, X, _RIDGES)


def _changes(problem: Problem, fitted: Fit, port: int) -> list[np.ndarray]:
    """Return the change of the residual (n,) by each term of the force.

    It is taken from a run with a zero force, so that both runs use the same secants.
    """
    scales = measured_scales(fitted.extended, fitted.values, problem.uncertified, port)
    pushed = fitted.extended.attach(_effect(_speed(problem, fitted)), scales, port)
    law = np.array([p.nominal for p in pushed.attached[-1].parameters])

    def residual(weights: np.ndarray) -> np.ndarray:
        own = pushed.attached[-1].started((law + weights).tolist())
        return problem.residual(pushed, np.concatenate([fitted.values, own]))

    idle = residual(np.zeros(law.size))
    with np.errstate(invalid="ignore"):  # infinite where the simulation runs away
        return [residual(_PUSH * unit) - idle for unit in np.eye(law.size)[:_TERMS]]


def _speed(problem: Problem, fitted: Fit) -> float:
    """Return how fast the simulated output moves, in ranges per second (RMS)."""
    output = problem.y - fitted.residual
    return float(np.sqrt(np.mean(problem.rate_of(output) ** 2)) / (np.ptp(output) or 1.0))


def _effect(speed: float) -> Effect:
    def parameters(scales: Scales) -> tuple[Parameter, ...]:
        half = 0.5 * scales.z_span
        # Where a speed alone is known, the scales are those of the output, which goes with it.
        fast = speed * scales.z_span if scales.placed else half
        return (
            *(Parameter(f"term_{k}", "1", 0.0, 0.0) for k in range(_TERMS)),
            Parameter("middle", "1", 0.5 * (scales.z_low + scales.z_high), 0.0),
            Parameter("half_range", "1", half, 0.0),
            Parameter("speed", "1/s", max(fast, 1e-9), 0.0),
        )

    return Effect(
        name="unknown_force",
        port=Port.FORCE,
        family=Family.CURVE,
        symptom="the device moves as no effect of the catalogue makes it move",
        citation="",
        parameters=parameters,
        starts=lambda scales: (),
        force=force,
    )
