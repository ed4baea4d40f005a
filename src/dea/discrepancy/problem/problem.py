"""A record to be explained: its signals, the roles of its samples, and its noise."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dea.discrepancy.problem.noise import at_a_limit, quantisation, white_level
from dea.discrepancy.problem.period import period_of
from dea.discrepancy.problem.split import cut
from dea.missing import filled, runs
from dea.simulation import ExtendedSimulation, ShapedInput, samples_of_each

_BRIDGED = 8  # samples of a missing stretch across which a residual is interpolated
_FOR_NOISE = 8, 64  # blocks of the noise level in a record, and their least number of samples


@dataclass(frozen=True)
class Samples:
    """Input and output of a record, each (n,), at a uniform interval (s).

    Several inputs are the columns of ``u``. An output that is missing is NaN.
    """

    u: np.ndarray
    y: np.ndarray
    interval: float

    @property
    def size(self) -> int:
        """Number of samples."""
        return self.y.size


@dataclass(frozen=True)
class Problem(Samples):
    """A record with the roles of its samples.

    Parameters
    ----------
    u, y : (n,)
        Input and output in the simulation's units; several inputs are columns (n, inputs).
    fit, select, certify : (n,) bool
        Samples that a fit sees, in two halves of alternating blocks, and those to certify on.
    noise : float
        Standard deviation of the noise, in the output's unit.
    tolerance : float
        Error of integration that is small enough (root mean square, in the output's unit).
    most_steps : int
        Steps of integration that a sample may have.
    measured : (n,) bool, or None where all were
        Samples whose output is not missing; it is interpolated in the others.
    decimation : int
        Samples of the record as it was given to each of these.
    oversampled : bool
        Whether the record is sampled so much faster than it moves that it may be decimated.
    lengths : tuple of int
        Samples of each of several records that are joined; empty for one.
    threads : int
        Threads that the derivatives by several parameters are computed on.
    """

    fit: np.ndarray
    select: np.ndarray
    certify: np.ndarray
    noise: float = 1.0
    tolerance: float = np.inf
    most_steps: int = 1
    measured: np.ndarray | None = None
    decimation: int = 1
    oversampled: bool = False
    lengths: tuple[int, ...] = ()
    threads: int = 1

    @property
    def recorded_samples(self) -> int:
        """Number of samples of the record as it was given."""
        return self.size * self.decimation

    @property
    def recorded_interval(self) -> float:
        """Sampling interval (s) of the record as it was given."""
        return self.interval / self.decimation

    @property
    def time(self) -> np.ndarray:
        """Time since the start in s."""
        return np.arange(self.size) * self.interval

    @cached_property
    def periods(self) -> tuple[int, ...]:
        """Period of the input of each record in samples; zero where it does not repeat."""
        return tuple(period_of(self.u[own]) for own in self.records)

    @cached_property
    def seen(self) -> np.ndarray:
        """Samples that a fit sees, shape (n,)."""
        result: np.ndarray = self.fit | self.select
        return result

    @property
    def records(self) -> list[slice]:
        """The samples of each record."""
        return samples_of_each(self.lengths or (self.size,))

    def of_each_record(
        self, change: Callable[[np.ndarray], np.ndarray], signal: np.ndarray
    ) -> np.ndarray:
        """Return a signal (n,) after a change of each record by itself, as if it came alone."""
        return np.concatenate([change(signal[own]) for own in self.records])

    def rate_of(self, signal: np.ndarray) -> np.ndarray:
        """Return the change per second of a signal (n,)."""
        return self.of_each_record(lambda own: np.gradient(own, self.interval), signal)

    def across_certified(self, signal: np.ndarray) -> np.ndarray:
        """Return a signal (n,) interpolated over the certified samples, which choose nothing."""
        return filled(np.where(self.certify, np.nan, signal))[0]

    @cached_property
    def uncertified(self) -> "Problem":
        """The record with outputs as if the certified samples were missing."""
        return replace(self, y=self.across_certified(self.y))

    @cached_property
    def bridged(self) -> np.ndarray:
        """Samples seen, and short stretches of missing outputs between them, shape (n,).

        Its runs are the blocks: else scattered ones would cut the record into pieces of a few
        samples, neighbours of which are not independent.
        """
        result = self.seen.copy()
        for missing in runs(~self.known):
            inside = missing.start > 0 and missing.stop < self.size
            if inside and missing.stop - missing.start <= _BRIDGED:
                result[missing] = self.seen[missing.start - 1] and self.seen[missing.stop]
        return result

    def blocks(self, length: float, own: slice | None = None) -> list[slice]:
        """Cut what is :attr:`bridged` into blocks of about ``length`` samples.

        None reaches from one record into another. Those of one record, ``own``, can be had alone.
        """
        parts = (
            slice(each.start + run.start, each.start + run.stop)
            for each in (self.records if own is None else [own])
            for run in runs(self.bridged[each])
        )
        return cut(parts, length)

    @cached_property
    def noise_blocks(self) -> list[slice]:
        """Blocks that are long enough to show the level of white noise."""
        parts, shortest = _FOR_NOISE
        return self.blocks(max(self.size / parts, shortest))

    @cached_property
    def _showing(self) -> np.ndarray:
        """Samples whose noise shows, shape (n,): they are measured, and no limit holds them."""
        result: np.ndarray = self.known & ~at_a_limit(self.uncertified.y)
        return result

    @cached_property
    def _rounding(self) -> float:
        return quantisation(self.y[self.seen])

    def white_level(self, *residuals: np.ndarray) -> float:
        """Return the lowest level of white noise in residuals (n,), or that of rounding."""
        found = (white_level(each, self.noise_blocks, self._showing) for each in residuals)
        return max(min(found), self._rounding)

    def seen_rmse(self, residual: np.ndarray) -> float:
        """Return the RMSE over all samples seen; infinite if ``residual`` is at any of them.

        Candidates are ranked on all of them, since a wrong simulation can fit some blocks well.
        """
        return rmse(residual, self.seen)

    def moved(
        self,
        extended: ExtendedSimulation,
        values: np.ndarray,
        shaped: Sequence[ShapedInput] | None = None,
    ) -> np.ndarray:
        """Return the output before gain, zero and effects of the sensor, shape (n,).

        Inputs ``shaped`` for other values are used where these shape them alike.
        """
        result: np.ndarray = extended.run(values, self.u, self.interval, shaped)[0]
        return result

    def residual(
        self, extended: ExtendedSimulation, values: np.ndarray, output: np.ndarray | None = None
    ) -> np.ndarray:
        """Return measured minus simulated output, shape (n,); infinite where unstable.

        ``output`` is that of :meth:`moved`, if it is known already. Where the measured output is
        missing, the residual is interpolated: it bends less than the output, and spectra of it need
        a whole signal.
        """
        if output is None:
            output = self.moved(extended, values)
        y = extended.read(output, values, self.interval)
        residual = np.where(np.isfinite(y), self.y - y, np.inf)
        if self.measured is None or not np.isfinite(residual).all():
            return residual
        return filled(np.where(self.measured, residual, np.nan))[0]

    def seeing(self, samples: np.ndarray) -> "Problem":
        """Return the same record with only some ``samples`` (n, bool) for fits to see."""
        return replace(self, fit=self.fit & samples, select=self.select & samples)

    @property
    def known(self) -> np.ndarray:
        """Samples whose output was measured, shape (n,)."""
        return np.ones(self.size, bool) if self.measured is None else self.measured

    def whole(self) -> "Problem":
        """Return it with all samples for fits to see, but those before the first of each record."""
        used = self.seen | self.certify
        everything = self.known.copy()
        for own in self.records:
            everything[own.start : own.start + int(np.argmax(used[own]))] = False
        return replace(self, fit=everything, select=everything & False)

    def with_noise(self, noise: float) -> "Problem":
        """Return the same record with another noise level."""
        return replace(self, noise=noise)


def rmse(residual: np.ndarray, samples: np.ndarray) -> float:
    """Return the root mean square of ``residual`` over ``samples``; infinite if any is."""
    chosen = residual[samples]
    if not np.isfinite(chosen).all():
        return np.inf
    return float(np.sqrt(np.mean(chosen**2)))
