"""What a method is given, and what it answers."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from benchmarks.naming.shared import Shared
from dea.arrays import Array
from dea.discrepancy import Settings
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Problem, Samples, rmse
from dea.discrepancy.problem.records import prepare
from dea.discrepancy.search.starts import fit_nominal
from dea.seeds import generator
from dea.simulation import ExtendedSimulation, Simulation
from dea.store import Record


@dataclass(frozen=True)
class Task:
    """A record whose last part is kept from the method, and a simulation of the device.

    Parameters
    ----------
    u : (n,)
        Input, of the part that is kept back too.
    y : (m,), m < n
        Output before that part; NaN where it is missing.
    settings
        What is known of the record besides (slowest time, warm-up), and how far fits go.
    shared
        What several methods need of it.
    """

    name: str
    u: Array
    y: Array
    interval: float
    simulation: Simulation
    settings: Settings
    shared: Shared = field(default_factory=Shared, compare=False, repr=False)

    @property
    def seen(self) -> Samples:
        """The part of the record that a method may use."""
        return Samples(self.u[: self.y.size], self.y, self.interval)

    @property
    def problem(self) -> Problem:
        """The seen part, all of which fits use."""
        return self._prepared[0]

    @property
    def nominal(self) -> Fit:
        """The simulation alone, fitted to the seen part as a diagnosis does it."""

        def fitted() -> Fit:
            problem, bare = self._prepared
            budget = self.settings.budget.of(problem.recorded_samples, problem.oversampled)
            return fit_nominal(problem, bare, budget.starts, self.rng, workers=1)

        found: Fit = self.shared.once("nominal", fitted)
        return found

    @property
    def rng(self) -> np.random.Generator:
        """A generator that follows from the task alone."""
        return generator(self.settings.seed, self.name, "diagnose")

    def simulated(self, fitted: Fit) -> Array:
        """Return the free run of a fitted simulation over the whole record, shape (n,)."""
        run: Array = fitted.extended.as_recorded.simulate(fitted.values, self.u, self.interval)
        return run

    def ahead(self, fitted: Fit) -> Array:
        """Return the part of its free run that is kept back, shape (n - m,)."""
        return self.simulated(fitted)[self.y.size :]

    @property
    def _prepared(self) -> tuple[Problem, ExtendedSimulation]:
        def made() -> tuple[Problem, ExtendedSimulation]:
            # Undecimated, since other methods take the record as it is.
            whole = replace(self.settings.budget, decimated=self.seen.size)
            settings = replace(self.settings, budget=whole)
            problem, _, bare = prepare([self.seen], self.simulation, settings)
            return problem.whole(), bare

        found: tuple[Problem, ExtendedSimulation] = self.shared.once("problem", made)
        return found


class Posed(NamedTuple):
    """A task, and the output that is kept back, shape (n - m,)."""

    task: Task
    kept: Array

    @classmethod
    def of(
        cls, name: str, record: Record, kept_back: float, simulation: Simulation, settings: Settings
    ) -> "Posed":
        """Keep the last part of a record back, a share ``kept_back`` of it."""
        seen = round((1.0 - kept_back) * record.u.size)
        interval = 1.0 / record.sampling_rate
        # A view of the record would lead a method to the rest of it.
        task = Task(name, record.u, record.y[:seen].copy(), interval, simulation, settings)
        return cls(task, record.y[seen:])

    def error(self, ahead: Array) -> float:
        """Return the RMS error of a prediction of what is kept back."""
        return rmse(self.kept - ahead, np.isfinite(self.kept))


@dataclass(frozen=True)
class Answer:
    """What a method says.

    Parameters
    ----------
    status
        ``named``, ``none``, ``ambiguous`` or ``unknown``.
    ahead : (n - m,)
        Its prediction of the output that was kept back.
    effects
        The names given, where it is ``named`` or ``ambiguous``.
    rivals
        Sets of names that an ambiguous answer offers instead.
    """

    status: str
    ahead: Array
    effects: frozenset[str] = frozenset()
    rivals: tuple[frozenset[str], ...] = ()


@dataclass(frozen=True)
class Method:
    """A method: its title, where it is from, and what it makes of a task."""

    title: str
    source: str
    answer: Callable[[Task], Answer]
