"""Prepare a simulation for a record: choose its integration step, normalise its motion."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from dea.inputs import by_input
from dea.simulation.extended import ExtendedSimulation
from dea.simulation.force_port import ForcePort
from dea.simulation.interpolation import InputInterpolation
from dea.simulation.normalisation import Normalisation
from dea.simulation.scales import Scales
from dea.simulation.simulation import Simulation

# Part of the drive's force below which the elastic force is too small to be the unit of force.
_SLACK = 1e-3
# Part of the range of motion at the prior below which a fitted simulation counts as not moving.
_STILL = 0.3
# Prior spread of the time by which the output is logged late, in sampling intervals: with the three
# spreads that a parameter may move, a good sample either way.
_TIMING = 0.4
# Decay rate, relative to the largest eigenvalue, up to which it is a rounding error of the finite
# differences, and the mode an integrator.
_ROUNDING = 1e-9
# Numbers of integration steps per sample that are tried, coarsest first.
_SUBSTEPS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 256)
# The last of them that are twice those before: a method of first order errs by half at each.
_DOUBLINGS = 3


class Sampled(Protocol):
    """A record: input and output, each (n,), at a uniform interval (s).

    Several inputs are columns.
    """

    @property
    def u(self) -> np.ndarray:
        """Input."""

    @property
    def y(self) -> np.ndarray:
        """Output."""

    @property
    def interval(self) -> float:
        """Sampling interval in s."""


def prepared(
    simulation: Simulation,
    u: np.ndarray,
    interval: float,
    tolerance: float,
    lengths: tuple[int, ...] = (),
    interpolation: InputInterpolation | None = None,
) -> ExtendedSimulation:
    """Return the simulation without effects, with its motion normalised and its step chosen.

    ``lengths`` are the samples of each of several records in ``u`` (n,), one after the other.
    ``interpolation`` is given where these are not the samples that were recorded. The instant at
    which the output is logged becomes free within about a sample.

    The step is refined until the output at the nominal parameters changes by less than
    ``tolerance`` (RMS, in the output's unit). Where no step settles the whole motion, that is asked
    of the part that is settled.

    Raises
    ------
    InputError
        If the simulation diverges at its nominal parameters on this input.
    """
    extended = ExtendedSimulation(
        simulation, lengths=lengths if len(lengths) > 1 else (), interpolation=interpolation
    )
    values = extended.layout.prior_means
    extended = with_fine_steps(extended, values, u, interval, tolerance)
    if extended.substeps == _SUBSTEPS[-1]:
        extended = _while_settled(extended, values, u, interval, tolerance)
    _require_a_run(extended, values, u, interval)
    normalisations = tuple(
        _normalisation(extended, port, values, u, interval) for port in simulation.force_ports
    )
    return replace(extended, normalisations=normalisations, timing_spread=_TIMING * interval)


def _require_a_run(
    extended: ExtendedSimulation, values: np.ndarray, u: np.ndarray, interval: float
) -> None:
    """Refuse a simulation that diverges at its nominal parameters, or whose output is no number."""
    own = extended.simulation
    y, position = extended.run(values, u, interval)
    if not np.isfinite(y).all():
        first = int(np.argmin(np.isfinite(y)))
        after = f"at its nominal parameters after {interval * first:g} s of this input"
        if np.isfinite(position[first]):
            raise own.error(
                f"it is not a number {after}",
                "output",
                "Give a function that is defined wherever the states go",
            )
        raise own.error(
            f"it runs away {after}",
            "parameters",
            "Correct the nominal values, or the units of the record's input",
        )


def with_fine_steps(
    extended: ExtendedSimulation,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
    tolerance: float,
    most: int = _SUBSTEPS[-1],
) -> ExtendedSimulation:
    """Return the simulation with steps so short that shorter ones change less than ``tolerance``.

    The change is the RMS change of the output at the parameter ``values``. A sample is integrated
    in at ``most`` so many steps, even if the tolerance is not reached.

    Parameters
    ----------
    values
        Of all parameters, shape (parameters,).
    u
        Input (n,), of several inputs (n, inputs).
    interval
        Between samples, in s.
    tolerance
        In units of the output.
    """
    coarse = extended.simulate(values, u, interval)
    for substeps in (s for s in _SUBSTEPS if extended.substeps < s <= most):
        finer = replace(extended, substeps=substeps)
        fine = finer.simulate(values, u, interval)
        change = fine - coarse
        if np.isfinite(change).all() and float(np.sqrt(np.mean(change**2))) < tolerance:
            break
        extended, coarse = finer, fine
    return extended


def _while_settled(
    extended: ExtendedSimulation,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
    tolerance: float,
) -> ExtendedSimulation:
    """Return the simulation with steps fine enough for the samples at which the runs converge.

    When a pendulum swings over the top depends on every step, however short: the finest steps would
    only slow down all fits, in most of which it does not swing over. If finer steps still reduce
    the error, the finest are kept.
    """
    tried = (1, *_SUBSTEPS)
    runs = [replace(extended, substeps=s).simulate(values, u, interval) for s in tried]
    changes = np.abs(np.diff(runs, axis=0))
    sizes = np.sqrt(np.mean(changes**2, axis=1))
    settled = changes[-_DOUBLINGS:].max(0) < tolerance
    if not sizes[-1] > sizes[-1 - _DOUBLINGS] / 2.0 ** (_DOUBLINGS - 1) or not settled.any():
        return extended
    fits = np.sqrt(np.mean(changes[:, settled] ** 2, axis=1)) < tolerance
    return replace(extended, substeps=tried[int(np.argmax(fits))])


def measured_scales(
    extended: ExtendedSimulation,
    values: np.ndarray,
    record: Sampled,
    force_port: int = 0,
    at_input: int = 0,
) -> Scales:
    """Return the scales of a record and of the motion of its simulation at ``values``.

    Those of the input are of number ``at_input``, those of the motion at one ``force_port``; both
    count from 0. ``values`` (parameters,) are those of all parameters.
    """
    own = extended.simulation
    moved = motion(extended, values, record, force_port) if own.force_ports else MotionRange()
    placed = not own.force_ports or own.force_ports[force_port].position is not None
    normalisations = extended.normalisations
    u = by_input(record.u)[at_input]
    return Scales(
        u_unit=own.inputs[at_input].unit,
        y_unit=own.output_unit,
        u_low=float(u.min()),
        u_high=float(u.max()),
        u_rate=_fast(u, record.interval),
        y_low=float(record.y.min()),
        y_high=float(record.y.max()),
        z_low=moved.low,
        z_high=moved.high,
        interval=record.interval,
        duration=float(max(extended.lengths or (u.size,)) * record.interval),
        smooth=extended.input_interpolation == "smooth",
        placed=placed,
        inertia=normalisations[force_port].inertia if normalisations else 0.0,
        z_rate=moved.rate,
    )


def _fast(signal: np.ndarray, interval: float) -> float:
    """Return the rate per second that a signal (n,) which changes hardly ever exceeds."""
    rate = np.abs(np.diff(signal)) / interval
    return float(np.quantile(rate[rate > 0], 0.98)) if rate.any() else 0.0


class MotionRange(NamedTuple):
    """Lowest and highest normalised position, and the rate (1/s) that it hardly ever exceeds."""

    low: float = 0.0
    high: float = 1.0
    rate: float = 0.0


def motion(
    extended: ExtendedSimulation, values: np.ndarray, record: Sampled, force_port: int
) -> MotionRange:
    """Return the range of the normalised position at a force port, without any effect.

    It is simulated at ``values`` (parameters,); where it hardly moves there, at the prior means.
    ``force_port`` counts from 0.
    """
    port = extended.simulation.force_ports[force_port]
    prior = extended.layout.prior_means
    z, z_prior = (
        _deflection(extended, port, v, record.u, record.interval)
        / extended.normalisations[force_port].scale
        for v in (values, prior)
    )
    # A simulation fitted to a device that sticks does not move and gives no scale; without the
    # effect that holds the device it may diverge.
    if not np.ptp(z) >= _STILL * np.ptp(z_prior):
        z = z_prior
    low, high = float(z.min()), float(z.max())
    return MotionRange(low, high if high > low else low + 1.0, _fast(z, record.interval))


def slowest_time(extended: ExtendedSimulation, u: np.ndarray) -> float:
    """Return the slowest time constant (s) of the simulation at its start under the mean input.

    0 where no mode decays, as of an integrator. ``u`` is the input (n,), of several inputs
    (n, inputs).
    """
    own = extended.simulation
    x = np.array([state.initial for state in own.states])
    f0, f1 = np.empty(x.size), np.empty(x.size)
    A = np.empty((x.size, x.size))
    level = np.mean(u, axis=0)
    own.compiled_derivative(x, level, own.nominal, f0)
    for j in range(x.size):
        step = 1e-4 * max(abs(x[j]), 1e-3)
        moved = x.copy()
        moved[j] += step
        own.compiled_derivative(moved, level, own.nominal, f1)
        A[:, j] = (f1 - f0) / step
    modes = np.linalg.eigvals(A)
    decay = -modes.real
    decaying = decay > _ROUNDING * np.abs(modes).max(initial=0.0)
    return float(1.0 / decay[decaying].min()) if decaying.any() else 0.0


def _deflection(
    extended: ExtendedSimulation,
    port: ForcePort,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
) -> np.ndarray:
    """Return the motion at a force port without any effect, relative to rest, in its own unit.

    Of a port without a position it is the reading.
    """
    own = extended.simulation
    alone = replace(
        own,
        force_ports=(port,),
        derivative=own.compiled_derivative,
        output=own.compiled_output,
    )
    bare = replace(
        extended, simulation=alone, attached=(), normalisations=(Normalisation(port.rest),),
        timing_spread=0.0,
    )  # fmt: skip
    values = values[: len(bare.layout.parameters)]
    output, position = bare.run(values, u, interval)
    return bare.read(output, values, interval) if port.position is None else position


def _normalisation(
    extended: ExtendedSimulation,
    port: ForcePort,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
) -> Normalisation:
    own = extended.simulation
    moving = own.state_names.index(port.position or port.velocity or "")
    equation = own.state_names.index(port.equation)
    p, x = values[: len(own.parameters)], np.array([s.initial for s in own.states])
    excursion = float(np.max(np.abs(_deflection(extended, port, values, u, interval)))) or 1.0
    low, high = np.empty(x.size), np.empty(x.size)
    for sign, slope in ((0.6, low), (0.8, high)):
        x[moving] = port.rest + sign * excursion
        own.compiled_derivative(x, np.mean(u, axis=0), p, slope)
    elastic = abs(high[equation] - low[equation]) / 0.2
    # Where no elastic force acts, the ranges of the inputs give the unit of force: of each by
    # itself, since two that act against each other would cancel.
    x[moving] = port.rest
    driven = 0.0
    for least, most in _each_over_its_range(u):
        own.compiled_derivative(x, least, p, low)
        own.compiled_derivative(x, most, p, high)
        driven += abs(high[equation] - low[equation])
    opposed = elastic > _SLACK * driven
    unit_force = elastic if opposed else driven
    # Where a velocity alone is known, what opposes it is no spring.
    held = opposed and port.position is not None
    inertia = 0.0 if held or unit_force == 0.0 else excursion / unit_force
    if port.equation == port.position:
        inertia *= inertia  # without a mass a force gives a speed
    if port.divisor is not None:
        unit_force *= p[own.parameter_names.index(port.divisor)]
    return Normalisation(port.rest, excursion, unit_force, inertia)


def _each_over_its_range(u: np.ndarray) -> Iterator[tuple[Any, Any]]:
    """Yield the least and the largest level of each input, the others at their means."""
    if u.ndim == 1:
        yield u.min(), u.max()
        return
    for column in range(u.shape[1]):
        low, high = u.mean(axis=0), u.mean(axis=0)
        low[column], high[column] = u[:, column].min(), u[:, column].max()
        yield low, high
