"""A record to be explained: its signals, which samples are for what, and its noise."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.discrepancy.effects import Scales
from dea.discrepancy.extended import ExtendedSimulation, Frame
from dea.discrepancy.simulation import Balance, Simulation
from dea.errors import InputError

# Part of the drive's force below which an elastic force is none to measure others by.
_SLACK = 1e-3
# Part of the motion at the prior below which a fitted simulation counts as standing still.
_STILL = 0.3
# Steps of integration per sample that are tried, coarsest first.
_SUBSTEPS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 256)


@dataclass(frozen=True)
class Problem:
    """Input and output of a record at a uniform interval (s), and who may see which samples.

    Parameters
    ----------
    u, y : (n,)
        Input and output in the simulation's units.
    fit, select, certify : (n,) bool
        Samples that a fit sees, in two halves of alternating blocks, and those to certify on.
    noise : float
        Standard deviation of the noise, in the output's unit.
    tolerance : float
        Error of integration that is small enough (root mean square, in the output's unit).
    most_steps : int
        Steps of integration that a sample may have.
    """

    u: np.ndarray
    y: np.ndarray
    interval: float
    fit: np.ndarray
    select: np.ndarray
    certify: np.ndarray
    noise: float = 1.0
    tolerance: float = np.inf
    most_steps: int = 1

    @property
    def time(self) -> np.ndarray:
        """Time since the start in s."""
        return np.arange(self.u.size) * self.interval

    @cached_property
    def seen(self) -> np.ndarray:
        """Samples that a fit sees, shape (n,)."""
        return self.fit | self.select

    def seen_rmse(self, gap: np.ndarray) -> float:
        """Return the RMSE over all samples that may choose; infinite if ``gap`` is anywhere.

        Candidates are ranked on all of them: some blocks a wrong simulation can be fitted to.
        """
        return rmse(gap, self.seen)

    def moved(self, extended: ExtendedSimulation, values: np.ndarray) -> np.ndarray:
        """Return the output before any sensor, shape (n,)."""
        return extended.run(values, self.u, self.interval)[0]

    def gap(
        self, extended: ExtendedSimulation, values: np.ndarray, output: np.ndarray | None = None
    ) -> np.ndarray:
        """Return measured minus simulated output, shape (n,); infinite where unstable.

        ``output`` is that before any sensor, where it is known already.
        """
        if output is None:
            output = self.moved(extended, values)
        y = extended.read(output, values, self.interval)
        return np.where(np.isfinite(y), self.y - y, np.inf)

    def seeing(self, samples: np.ndarray) -> "Problem":
        """Return the same record of which a fit sees only some of the samples (n, bool)."""
        return replace(self, fit=self.fit & samples, select=self.select & samples)

    def with_noise(self, noise: float) -> "Problem":
        """Return the same record with another noise level."""
        return replace(self, noise=noise)


def rmse(gap: np.ndarray, samples: np.ndarray) -> float:
    """Return the root mean square of ``gap`` over ``samples``; infinite if it is anywhere."""
    chosen = gap[samples]
    if not np.isfinite(chosen).all():
        return np.inf
    return float(np.sqrt(np.mean(chosen**2)))


def base(
    simulation: Simulation, u: np.ndarray, interval: float, tolerance: float
) -> ExtendedSimulation:
    """Return the simulation without effects, with its motion normalised and its step chosen.

    The step is refined until the output at the nominal parameters changes by less than
    ``tolerance`` (in the output's unit, root mean square).

    Raises
    ------
    InputError
        If the simulation runs away at its nominal parameters on this input.
    """
    extended = ExtendedSimulation(simulation)
    values = extended.values(np.zeros(extended.free.size))
    extended = with_fine_steps(extended, values, u, interval, tolerance)
    y = extended.simulate(values, u, interval)
    if not np.isfinite(y).all():
        raise InputError(
            f"it runs away at its nominal parameters after "
            f"{interval * np.argmin(np.isfinite(y)):g} s of this input",
            file=simulation.source or f"simulation {simulation.name}",
            field="parameters",
            remedy="Correct the nominal values, or the units of the record's input",
        )
    frames = tuple(
        _frame(extended, balance, values, u, interval) for balance in simulation.balances
    )
    return replace(extended, frames=frames)


def with_fine_steps(
    extended: ExtendedSimulation,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
    tolerance: float,
    most: int = _SUBSTEPS[-1],
) -> ExtendedSimulation:
    """Return the simulation with so many steps that a few more change less than ``tolerance``.

    The change is the root mean square of the output's, at these parameter ``values``. A sample
    has at ``most`` so many steps, enough or not.
    """
    coarse = extended.simulate(values, u, interval)
    for substeps in (s for s in _SUBSTEPS if extended.substeps < s <= most):
        finer = replace(extended, substeps=substeps)
        fine = finer.simulate(values, u, interval)
        if rmse(fine - coarse, np.ones(u.size, bool)) < tolerance:
            break
        extended, coarse = finer, fine
    return extended


def deflection(
    extended: ExtendedSimulation,
    balance: Balance,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
) -> np.ndarray:
    """Return what moves at a balance, from rest and in its own unit, without any effect."""
    own = extended.simulation
    alone = replace(
        own,
        balances=(balance,),
        derivative=own.compiled_derivative,
        output=own.compiled_output,
    )
    bare = ExtendedSimulation(alone, (), (Frame(balance.rest),), extended.substeps)
    values = values[: len(bare.parameters)]
    output, position = bare.run(values, u, interval)
    return bare.read(output, values, interval) if balance.position is None else position


def _frame(
    extended: ExtendedSimulation,
    balance: Balance,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
) -> Frame:
    own = extended.simulation
    moving = own.state_names.index(balance.position or balance.velocity or "")
    equation = own.state_names.index(balance.equation)
    p, x = values[: len(own.parameters)], np.array([s.initial for s in own.states])
    excursion = float(np.max(np.abs(deflection(extended, balance, values, u, interval)))) or 1.0
    low, high = np.empty(x.size), np.empty(x.size)
    for sign, slope in ((0.6, low), (0.8, high)):
        x[moving] = balance.rest + sign * excursion
        own.compiled_derivative(x, float(np.mean(u)), p, slope)
    elastic = abs(high[equation] - low[equation]) / 0.2
    # A device that nothing pulls back is measured by what the range of its input does to it.
    x[moving] = balance.rest
    for level, slope in ((float(u.min()), low), (float(u.max()), high)):
        own.compiled_derivative(x, level, p, slope)
    driven = abs(high[equation] - low[equation])
    return Frame(balance.rest, excursion, elastic if elastic > _SLACK * driven else driven)


def scales(
    problem: Problem,
    extended: ExtendedSimulation,
    values: np.ndarray,
    units: tuple[str, str],
    balance: int = 0,
    frequencies: tuple[float, ...] = (),
    jumps: tuple[float, ...] = (),
) -> Scales:
    """Return how large things are in this record and in its simulation."""
    z = np.zeros(2)
    if extended.simulation.balances:
        port = extended.simulation.balances[balance]
        prior = extended.values(np.zeros(extended.free.size))
        z, z_prior = (
            deflection(extended, port, v, problem.u, problem.interval)
            / extended.frames[balance].scale
            for v in (values, prior)
        )
        # Fitted to a device that is stuck, a simulation stands still and tells no scale; without
        # the effect that holds it, it may run away.
        if not np.ptp(z) >= _STILL * np.ptp(z_prior):
            z = z_prior
    rate = np.abs(np.diff(problem.u)) / problem.interval
    return Scales(
        u_unit=units[0],
        y_unit=units[1],
        u_low=float(problem.u.min()),
        u_high=float(problem.u.max()),
        u_rate=float(np.quantile(rate[rate > 0], 0.98)),
        y_low=float(problem.y.min()),
        y_high=float(problem.y.max()),
        z_low=float(z.min()),
        z_high=float(z.max()) if np.ptp(z) > 0 else float(z.min()) + 1.0,
        interval=problem.interval,
        duration=float(problem.u.size * problem.interval),
        frequencies=frequencies,
        jumps=jumps,
    )
