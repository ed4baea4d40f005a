"""Prove an extension on samples, and on records, that nothing was fitted or chosen on."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.fit import Columns, Fit, fit
from dea.discrepancy.problem import Problem, rmse
from dea.simulation import ExtendedSimulation, Port

_HEAD = 0.1


@dataclass(frozen=True)
class Certified:
    """Free-run errors before and after, in the output's unit, on so many unused samples."""

    before: float
    after: float
    samples: int


@dataclass(frozen=True)
class OtherRecord:
    """A record with another excitation: input, output, and the interval in s."""

    u: np.ndarray
    y: np.ndarray
    interval: float


def certify(problem: Problem, nominal: Fit, extended: Fit) -> Certified:
    """Compare both simulations on the certified block."""
    return Certified(
        rmse(nominal.residual, problem.certify),
        rmse(extended.residual, problem.certify),
        int(problem.certify.sum()),
    )


def transferable(extended: ExtendedSimulation) -> bool:
    """Return whether all effects are properties of the device and not of one record's time."""
    return all(
        a.effect.port is not Port.TIME and a.effect.name != "periodic_disturbance"
        for a in extended.attached
    )


def certify_elsewhere(
    others: Mapping[str, OtherRecord], nominal: Fit, extended: Fit
) -> dict[str, tuple[Certified, np.ndarray, np.ndarray]]:
    """Compare both simulations on other records; return errors and both simulated outputs.

    Only the state of the device at the start is fitted, on the first tenth of the record, which
    is left out of the errors' choice but, as published errors do, counted in them.
    """
    result = {}
    for name, other in others.items():
        before, after = (_from_its_own_start(other, f) for f in (nominal, extended))
        everywhere = np.ones(other.y.size, bool)
        errors = [rmse(other.y - y, everywhere) for y in (before, after)]
        result[name] = Certified(errors[0], errors[1], other.y.size), before, after
    return result


def _from_its_own_start(other: OtherRecord, fitted: Fit) -> np.ndarray:
    extended = fitted.extended
    starting = np.array([_is_start(extended.names[i]) for i in extended.free])
    if not starting.any():
        return extended.simulate(fitted.values, other.u, other.interval)
    head = np.arange(other.u.size) < max(10, round(_HEAD * other.u.size))
    nothing = np.zeros_like(head)
    problem = Problem(
        other.u,
        other.y,
        other.interval,
        head,
        nothing,
        nothing,
        max(rmse(fitted.residual, np.isfinite(fitted.residual)), 1e-12),
    )
    own = fit(problem, extended, fitted.coordinates, iterations=10, columns=Columns(held=~starting))
    return extended.simulate(own.values, other.u, other.interval)


def _is_start(name: str) -> bool:
    owner, _, own = name.rpartition(".")
    return owner == "initial" or (owner != "" and own.startswith("start_"))
