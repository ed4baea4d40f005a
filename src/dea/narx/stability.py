"""Whether a model stays bounded on inputs like those it was identified from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea.arrays import Array
from dea.inputs import by_input
from dea.narx.limits import DIVERGED, LEEWAY, MeasuredRange, stays_in_range
from dea.narx.rest import Rests, rests_over
from dea.narx.scaling import Scaling
from dea.narx.simulation import bounded
from dea.narx.surrogates import phase_randomised, same_class
from dea.store import variable
from dea.terms import Term

Bools: TypeAlias = NDArray[np.bool_]
SLOWEST = 0.2  # share of the record that a pole's time constant may last
_LEVELS, _HOLDS, _RUNS, _SURROGATES = 41, 20, 100, 20
_DIAGONALS = 8  # along which several inputs are varied together, at most
_LONGEST = 20_000  # samples of a stretch that a random input is like
_SHORTEST = 5_000  # samples of a long run


class UnstableModel(UserWarning):
    """No stable model was found; the one returned is not to be trusted away from its record."""


@dataclass(frozen=True, eq=False)
class Stability:
    """What was tried on a model, and what became of it.

    Parameters
    ----------
    inputs, outputs, poles
        Constant inputs over the record's range and the rests there in physical units, and the
        largest modulus of the poles; shape (levels,). Of several rests it is that which is nearest
        to the one at the level before, from the input nearest to its offset on and there nearest to
        the mean output; frequency responses are around the one that a run settles to. Several
        inputs, shape (levels, inputs), are varied one by one, the others at their offsets or where
        their range comes nearest to them, and together from corner to corner, along eight diagonals
        at most. Where there is no rest the output is NaN and the modulus infinite.
    holds, runs, surrogates
        Bounded runs and runs in all: holds at levels over the range; random inputs with the values
        and the spectrum of the record's; phase-randomised inputs with its spectrum. Of a record of
        more than 20,000 samples each random input is like a stretch of that length, taken in turn
        from its beginning to its end. Runs on such inputs may depart from the mean output of the
        record three times as far as it does itself, holds a hundred times.
    samples
        Of the record.
    """

    inputs: Array
    outputs: Array
    poles: Array
    holds: tuple[int, int]
    runs: tuple[int, int]
    surrogates: tuple[int, int]
    samples: int

    @property
    def largest_pole(self) -> float:
        """The largest modulus of a pole at rest over the input range."""
        return float(self.poles.max())

    @property
    def slowest(self) -> float:
        """The longest time constant of a pole at rest, in samples; infinite where unstable."""
        return time_constant(self.largest_pole)

    @property
    def bounded(self) -> bool:
        """Whether every hold and every random run stayed within the limit."""
        return all(kept == tried for kept, tried in (self.holds, self.runs, self.surrogates))

    @property
    def status(self) -> str:
        """``stable``; ``slow`` with a pole slower than a fifth of the record; ``unstable``."""
        if not self.bounded or self.largest_pole >= 1.0:
            return "unstable"
        return "slow" if self.slowest > SLOWEST * self.samples else "stable"

    @property
    def stable(self) -> bool:
        """Whether the status is ``stable``."""
        return self.status == "stable"

    def to_dataset(self, u_units: str, y_units: str) -> xr.Dataset:
        """Return the report as ``model.nc`` holds it, the status as attribute ``stability``."""
        of_inputs = ("level", "input")[: self.inputs.ndim]
        counts = {
            "holds": (self.holds, "holds: bounded runs, and all"),
            "runs": (self.runs, "random inputs: bounded runs, and all"),
            "surrogates": (self.surrogates, "phase-randomised inputs: bounded runs, and all"),
        }
        return xr.Dataset(
            {
                "rest_input": variable(of_inputs, self.inputs, u_units, "constant input"),
                "rest_output": variable("level", self.outputs, y_units, "output at rest there"),
                "rest_pole": variable(
                    "level", self.poles, "1", "largest modulus of the poles there"
                ),
                **{
                    name: variable("count", np.asarray(runs), "1", label)
                    for name, (runs, label) in counts.items()
                },
                "record_samples": variable((), self.samples, "1", "samples of the record"),
            },
            attrs={"stability": self.status},
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> "Stability":
        """Return the report that :meth:`to_dataset` described."""

        def count(name: str) -> tuple[int, int]:
            bounded, tried = dataset[name].values.tolist()
            return bounded, tried

        return Stability(
            dataset["rest_input"].values,
            dataset["rest_output"].values,
            dataset["rest_pole"].values,
            count("holds"),
            count("runs"),
            count("surrogates"),
            int(dataset["record_samples"]),
        )

    def __str__(self) -> str:
        """Return the report in one line."""
        at_rest = np.isfinite(self.poles)
        told = []
        if not at_rest.all():
            without = np.count_nonzero(~at_rest)
            told.append(f"no rest at {without} of {at_rest.size} constant inputs")
        if at_rest.any():
            at = int(np.argmax(np.where(at_rest, self.poles, -1.0)))
            pole, level = float(self.poles[at]), np.ravel(self.inputs[at])
            told.append(
                f"largest pole {pole:.5f} (at an input of "
                f"{', '.join(f'{each:.4g}' for each in level)}, "
                f"time constant {time_constant(pole):.4g} samples)"
            )
        counts = (
            f"{kept} of {tried} {name} bounded"
            for name, (kept, tried) in (
                ("holds", self.holds),
                ("random inputs", self.runs),
                ("phase-randomised inputs", self.surrogates),
            )
        )
        return f"{self.status}: {', '.join(told)}; {', '.join(counts)}"


def time_constant(modulus: float) -> float:
    """Return the samples in which a pole of this modulus decays to 1/e."""
    if modulus >= 1.0:
        return float("inf")
    return float(-1.0 / np.log(modulus)) if modulus > 0.0 else 0.0


class StabilityTest:
    """The inputs that models of one record have to stay bounded on, in the units of the equation.

    Parameters
    ----------
    segments
        Normalised inputs and outputs. Every run begins at the mean output.
    """

    def __init__(self, segments: Sequence[tuple[Array, Array]]) -> None:
        u = np.concatenate([u for u, _ in segments])
        self.samples = len(u)
        self.lines = _lines(u, _LEVELS)
        self.holds = _side_by_side(level[None] for line in _lines(u, _HOLDS) for level in line)
        self.random = _random_inputs(u.tobytes("F"), u.shape)
        self._held = max(len(u), _SHORTEST)
        period = self.random.shape[1]
        self._ran = period * -(-_SHORTEST // period)
        # The level of the record is zero only where the scaling is its own.
        self._start, largest = MeasuredRange.of(segments)
        self._within, self._bound = LEEWAY * largest, DIVERGED * largest

    def rests(self, terms: tuple[Term, ...], parameters: Array) -> Rests:
        """Return the model's rests over the input range."""
        found = [
            rests_over(terms, parameters, line, self._bound, self._start) for line in self.lines
        ]
        return Rests(*(np.concatenate(each) for each in zip(*found, strict=True)))

    def held(self, terms: tuple[Term, ...], parameters: Array, every: bool = False) -> Bools:
        """Say of each hold whether it stays bounded. Gains at rest may exceed those recorded.

        With ``every``, the first that does not ends the test, and all count as unbounded.
        """
        return bounded(
            terms, parameters, self.holds, self._bound, every, start=self._start, samples=self._held
        )

    def ran(self, terms: tuple[Term, ...], parameters: Array, every: bool = False) -> Bools:
        """Say likewise of each random input whether the run stays in the range of the outputs.

        First come those with the values of the record, then the phase-randomised ones.
        """
        return bounded(
            terms,
            parameters,
            self.random,
            self._within,
            every,
            start=self._start,
            samples=self._ran,
        )

    def passes(self, terms: tuple[Term, ...], parameters: Array) -> bool:
        """Whether the model is stable on all of them; ends at the first failure."""
        slowest = time_constant(float(self.rests(terms, parameters).poles.max()))
        return (
            slowest <= SLOWEST * self.samples
            and bool(self.held(terms, parameters, every=True).all())
            and bool(self.ran(terms, parameters, every=True).all())
        )


def stays_in_range_reversed(
    terms: tuple[Term, ...], parameters: Array, segments: Sequence[tuple[Array, Array]]
) -> bool:
    """Whether the model stays in range on the time-reversed inputs of the records.

    These have the same amplitudes and spectrum, so that a model that leaves the range by far on
    them is bounded on these records only.
    """
    measured = MeasuredRange.of(segments)
    return all(stays_in_range(terms, parameters, u[::-1], y[::-1], measured) for u, y in segments)


def _lines(u: Array, count: int) -> list[Array]:
    """Return constant inputs along lines through the range of ``u``.

    Each input is varied by itself, the others at zero or at the end of their range nearest to it;
    several also together, along diagonals of their range.
    """
    low, high = u.min(axis=0), u.max(axis=0)
    if u.ndim == 1:
        return [np.linspace(low, high, count)]
    lines = []
    for column in range(low.size):
        line = np.tile(np.clip(0.0, low, high), (count, 1))
        line[:, column] = np.linspace(low[column], high[column], count)
        lines.append(line)
    return lines + [
        np.linspace(np.where(falls, high, low), np.where(falls, low, high), count)
        for falls in _diagonals(low.size)
    ]


def _diagonals(inputs: int) -> Bools:
    """Return which inputs fall along each diagonal of their range, on which the first one rises.

    There are 2^(inputs - 1); of more than eight, eight are drawn, the same each time.
    """
    if 2 ** (inputs - 1) <= _DIAGONALS:
        return np.array([(False, *signs) for signs in product((False, True), repeat=inputs - 1)])
    rng = np.random.default_rng(0)
    drawn: dict[bytes, NDArray[np.bool_]] = {}
    while len(drawn) < _DIAGONALS:
        falls = rng.random(inputs) < 0.5
        falls[0] = False
        drawn[falls.tobytes()] = falls
    return np.array(list(drawn.values()))


# A choice of orders selects from one record again and again.
@lru_cache(maxsize=1)
def _random_inputs(content: bytes, shape: tuple[int, ...]) -> Array:
    """Return inputs like the one with this content, of the record's values and phase-randomised."""
    u = np.frombuffer(content).reshape(shape, order="F")
    rng = np.random.default_rng(0)  # every model of a record meets the same inputs
    runs = [same_class(u[part], rng) for part in _stretches(len(u), _RUNS)]
    surrogates = [phase_randomised(u[part], rng) for part in _stretches(len(u), _SURROGATES)]
    return _side_by_side([*runs, *surrogates])


def _stretches(samples: int, count: int) -> list[slice]:
    """Return equally long stretches from the beginning of a record to its end, or the whole."""
    length = min(samples, _LONGEST)
    begins = np.linspace(0, samples - length, count).astype(int)
    return [slice(begin, begin + length) for begin in begins.tolist()]


def _side_by_side(inputs: Iterable[Array]) -> Array:
    """Return inputs of one length as :func:`dea.narx.simulation.bounded` takes them, read-only.

    The kernel is compiled for arrays that may be written to apart from those that may not.
    """
    found = np.stack([by_input(u) for u in inputs], axis=-1)
    found.flags.writeable = False
    return found


def assess(
    terms: tuple[Term, ...], parameters: Array, scaling: Scaling, test: StabilityTest
) -> Stability:
    """Return what becomes of a model in all runs of ``test``."""
    rests, held = test.rests(terms, parameters), test.held(terms, parameters)
    ran, randomised = np.split(test.ran(terms, parameters), [_RUNS])
    return Stability(
        scaling.restore_input(rests.inputs),
        scaling.restore_output(rests.outputs),
        rests.poles,
        (int(held.sum()), held.size),
        (int(ran.sum()), ran.size),
        (int(randomised.sum()), randomised.size),
        test.samples,
    )
