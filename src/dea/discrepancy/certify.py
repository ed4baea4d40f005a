"""Prove an extension on samples, and on records, that nothing was fitted or chosen on."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dea.discrepancy.effects import Port
from dea.discrepancy.extended import ExtendedSimulation
from dea.discrepancy.fit import Fit, fit
from dea.discrepancy.problem import Problem, rmse

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
        rmse(nominal.gap, problem.certify),
        rmse(extended.gap, problem.certify),
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
    extended, values = fitted.extended, fitted.values
    starting = [i for i in extended.free if _is_start(extended.names[i])]
    if not starting:
        return extended.simulate(values, other.u, other.interval)
    head = np.arange(other.u.size) < max(10, round(_HEAD * other.u.size))
    nothing = np.zeros_like(head)
    problem = Problem(
        other.u,
        other.y,
        other.interval,
        head,
        nothing,
        nothing,
        max(rmse(fitted.gap, np.isfinite(fitted.gap)), 1e-12),
    )
    held = _Held(extended, values, np.array(starting))
    own = fit(problem, held, held.coordinates(values), iterations=10)  # type: ignore[arg-type]
    return extended.simulate(held.values(own.coordinates), other.u, other.interval)


def _is_start(name: str) -> bool:
    owner, _, own = name.rpartition(".")
    return owner == "initial" or (owner != "" and own.startswith("start_"))


@dataclass(frozen=True)
class _Held:
    """An extended simulation of which only some parameters are free."""

    extended: ExtendedSimulation
    fixed: np.ndarray
    free: np.ndarray

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        pairs = [self.extended.parameters[i].coordinate_bounds() for i in self.free]
        return np.array([low for low, _ in pairs]), np.array([high for _, high in pairs])

    def values(self, coordinates: np.ndarray) -> np.ndarray:
        result = self.fixed.copy()
        for i, coordinate in zip(self.free, coordinates, strict=True):
            result[i] = self.extended.parameters[i].value(coordinate)
        return result

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        return np.array([self.extended.parameters[i].coordinate(values[i]) for i in self.free])

    def simulate(self, values: np.ndarray, u: np.ndarray, interval: float) -> np.ndarray:
        return self.extended.simulate(values, u, interval)
