"""Where the residual is concentrated, compared with what chance would make of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from dea.autocovariance import autocovariance
from dea.discrepancy.problem.problem import Problem
from dea.inputs import by_input
from dea.simulation import Input
from dea.store import variable
from dea.units import product

BINS = 12
# Draws of what chance makes, and the level of the test: ten of them may be as large.
_DRAWS, _SIGNIFICANCE = 200, 0.05
# Memories of the energy in a shuffled block, and the fewest blocks that say what chance makes. In
# blocks of a 150th of the record, chance was called a concentration in 30 % of series of 3000
# samples with a memory of 50, and in 95 % of those with one of 200, instead of 5 %.
_MEMORIES, _FEWEST = 8, 10
# Least length, in memories, of a record whose energy is shifted. A shorter record has too few
# independent shifts for a test at a level of 5 %.
_FEWEST_SHIFTS = 20
# The sum of an autocorrelation ends at the first lag of so many times its value.
_WINDOW = 5


@dataclass(frozen=True)
class Concentration:
    """The bin that the residual is concentrated in most.

    ``inside`` and ``elsewhere`` are the RMS residuals in the bin and in the other bins of the
    quantity ``along``; ``low`` and ``high`` are the bin's ends in ``unit``, ``number`` its index.
    The ``kind`` of the quantity is the same of each of several inputs; ``of`` says whose it is.
    """

    along: str
    number: int
    low: float
    high: float
    unit: str
    inside: float
    elsewhere: float
    kind: str
    of: str


@dataclass(frozen=True)
class Band:
    """The octave (Hz) that holds most of the residual's energy, and the part it holds."""

    low: float
    high: float
    part: float


@dataclass(frozen=True)
class Localisation:
    """Energy of the residual along each quantity, and where it is concentrated.

    Parameters
    ----------
    dataset
        For each quantity its bins, the RMS residual in them and the probability that chance
        concentrates the residual as much.
    concentration
        The strongest bin of the quantity along which the residual is concentrated most, or
        ``None`` where chance explains all of it, or cannot be told.
    rms
        RMS residual over all samples, in ``unit``.
    told
        Whether the memory of the residual is short enough for the record to say what chance would
        make of it along every quantity, time too.
    """

    dataset: xr.Dataset
    concentration: Concentration | None
    band: Band
    rms: float
    unit: str
    told: bool = True

    @property
    def strongest(self) -> str | None:
        """Name of the quantity along which the residual is concentrated most."""
        return self.concentration.along if self.concentration else None


class _Signal(NamedTuple):
    """An input: what datasets and people call it, its values (n,) and its unit."""

    name: str
    called: str
    u: np.ndarray
    unit: str


@dataclass(frozen=True)
class _Quantity:
    """A quantity of the record, as datasets call it; ``of`` is the input it belongs to, if any."""

    values: np.ndarray
    unit: str
    kind: str
    called: str
    of: str


@dataclass(frozen=True)
class _Binned:
    """A quantity along which the residual is binned."""

    quantity: _Quantity
    edges: np.ndarray
    label: np.ndarray

    @property
    def bins(self) -> int:
        return self.edges.size - 1


def localise(
    problem: Problem,
    residual: np.ndarray,
    inputs: Sequence[Input],
    unit: str,
    samples: np.ndarray,
    rng: np.random.Generator,
) -> Localisation:
    """Find where a ``residual`` (n,) is concentrated among ``samples`` (n, bool).

    ``unit`` is that of the output. Each of several ``inputs`` is a quantity of its own. Times are
    counted from the start of each record.

    The null distribution comes from its energy, shuffled in blocks that keep its own correlation:
    the largest standardised bin over all quantities (max statistic). Where the energy remembers so
    long that too few blocks are left, it is shifted as a whole; along time, where shifts tell
    nothing, what chance makes of it is then missing. Where it remembers for too much of the record
    for shifts as well, nothing is said.
    """
    where = np.flatnonzero(samples & np.isfinite(residual))
    energy = residual[where] ** 2
    signals = _inputs(problem, inputs)
    quantities = {}
    for name, quantity in _quantities(problem, residual, signals, unit).items():
        values = quantity.values[where]
        edges = _edges(values, name)
        label = np.clip(np.searchsorted(edges, values, "right") - 1, 0, edges.size - 2)
        quantities[name] = _Binned(quantity, edges, label)
    measured = {name: _mean(energy, q.label, q.bins) for name, q in quantities.items()}
    null = {name: np.full((_DRAWS, q.bins), np.nan) for name, q in quantities.items()}
    chance, told = _chance(energy, _memory(residual[where]), rng)
    for draw, drawn in enumerate(chance):
        for name, q in quantities.items():
            if told or name != "time":
                null[name][draw] = _mean(drawn, q.label, q.bins)
    probability = _probability(measured, null)
    rms = {name: np.sqrt(mean) for name, mean in measured.items()}
    found = [name for name in measured if probability[name] <= _SIGNIFICANCE]
    strongest = max(found, key=lambda name: float(measured[name].max())) if found else None
    variables: dict[str, Any] = {}
    for name, q in quantities.items():
        variables |= _along(name, q, rms[name], null[name], unit)
        variables[f"{name}_probability"] = variable((), probability[name], "1", f"chance, {name}")
    overall = float(np.sqrt(energy.mean()))
    variables |= _coherence(problem, residual, where, signals)
    variables["rms"] = variable((), overall, unit, "RMS residual")
    concentration = (
        _concentration(strongest, quantities[strongest], rms[strongest]) if strongest else None
    )
    band = _band(residual[where], problem.interval)
    return Localisation(xr.Dataset(variables), concentration, band, overall, unit, told)


def _probability(measured: dict[str, np.ndarray], null: dict[str, np.ndarray]) -> dict[str, float]:
    """Return the probability that chance concentrates the energy as much along each quantity."""
    scores = {}
    for name, mean in measured.items():
        # The measured one counts as a draw; otherwise it would exceed every draw by construction.
        drawn = np.vstack([mean, null[name]])
        scores[name] = np.max((drawn - drawn.mean(0)) / (drawn.std(0) + 1e-300), axis=1)
    largest = np.fmax.reduce(list(scores.values()))
    return {
        name: float(np.mean(largest >= score[0])) if np.isfinite(score[0]) else np.nan
        for name, score in scores.items()
    }


def _concentration(name: str, binned: _Binned, rms: np.ndarray) -> Concentration:
    number = int(np.argmax(rms))
    low, high = binned.edges[number : number + 2]
    counts = np.delete(np.bincount(binned.label, minlength=binned.bins), number)
    others = np.delete(rms, number)
    return Concentration(
        along=name,
        number=number,
        low=float(low),
        high=float(high),
        unit=binned.quantity.unit,
        inside=float(rms[number]),
        elsewhere=float(np.sqrt(np.square(others) @ counts / max(counts.sum(), 1))),
        kind=binned.quantity.kind,
        of=binned.quantity.of,
    )


def _along(
    name: str, binned: _Binned, rms: np.ndarray, null: np.ndarray, unit: str
) -> dict[str, Any]:
    edges, called, own = binned.edges, binned.quantity.called, binned.quantity.unit
    return {
        f"{name}_low": variable(name, edges[:-1], own, f"{called}: lower end"),
        f"{name}_high": variable(name, edges[1:], own, f"{called}: upper end"),
        f"{name}_rms": variable(name, rms, unit, f"RMS residual along {called}"),
        f"{name}_null": variable(
            name,
            np.sqrt(np.quantile(null, 0.95, axis=0)),
            unit,
            f"RMS residual along {called} that chance exceeds in 5 %",
        ),
    }


def _coherence(
    problem: Problem, residual: np.ndarray, where: np.ndarray, inputs: Sequence[_Signal]
) -> dict[str, Any]:
    from scipy.signal import coherence

    segment = min(where.size, max(64, problem.size // 16))
    variables: dict[str, Any] = {}
    for name, called, u, _ in inputs:
        # An input that rests has no coherence.
        driving = u[where] if np.ptp(u[where]) > 0.0 else np.full(where.size, np.nan)
        frequency, coherent = coherence(
            driving, residual[where], 1.0 / problem.interval, nperseg=segment
        )
        variables["frequency"] = variable("frequency", frequency, "Hz", "frequency")
        variables[name.replace("input", "coherence")] = variable(
            "frequency", coherent, "1", f"coherence of {called} and residual"
        )
    return variables


def _inputs(problem: Problem, inputs: Sequence[Input]) -> list[_Signal]:
    """Return every input with its values. A single one is called so, whatever its name."""
    signals = by_input(problem.u)
    if len(signals) == 1:
        return [_Signal("input", "input", signals[0], inputs[0].unit)]
    return [
        _Signal(f"input_{k}", each.name, u, each.unit)
        for k, (each, u) in enumerate(zip(inputs, signals, strict=True), 1)
    ]


def _quantities(
    problem: Problem,
    residual: np.ndarray,
    inputs: Sequence[_Signal],
    unit: str,
) -> dict[str, _Quantity]:
    time = problem.time.copy()
    for record in problem.records:
        time[record] -= time[record.start]
    simulated = problem.y - np.where(np.isfinite(residual), residual, 0.0)
    rate = problem.rate_of(simulated)
    still = 0.05 * np.std(rate)
    direction = np.where(rate > still, 2.0, np.where(rate < -still, 0.0, 1.0))
    turned = 1 + np.flatnonzero(np.diff(np.sign(rate)) != 0)
    last = np.union1d([own.start for own in problem.records], turned)
    since = np.arange(rate.size) - last[np.searchsorted(last, np.arange(rate.size), "right") - 1]
    found = {"time": _Quantity(time, "s", "time", "time", "")}
    several = len(inputs) > 1
    for name, called, u, own in inputs:
        found[name] = _Quantity(u, own, "input", called, called if several else "the input")
    for name, called, u, own in inputs:
        rates = problem.rate_of(u)
        said, of = (f"rate of {called}", called) if several else ("input_rate", "the input")
        found[f"{name}_rate"] = _Quantity(rates, product(own, below="s"), "input_rate", said, of)
    for name, values, own in (
        ("output", simulated, unit),
        ("output_rate", rate, product(unit, below="s")),
        ("direction", direction, "1"),
        ("reversal", since * problem.interval, "s"),
    ):
        found[name] = _Quantity(values, own, name, name, "")
    return found


def _edges(values: np.ndarray, name: str) -> np.ndarray:
    if name == "direction":
        return np.array([-0.5, 0.5, 1.5, 2.5])
    if name == "time":
        return np.linspace(values.min(), values.max() + 1e-9, 2 * BINS + 1)
    edges = np.unique(np.quantile(values, np.linspace(0, 1, BINS + 1)))
    return (
        edges if edges.size > 2 else np.array([values.min(), values.mean(), values.max() + 1e-12])
    )


def _mean(energy: np.ndarray, label: np.ndarray, bins: int) -> np.ndarray:
    count = np.maximum(np.bincount(label, minlength=bins), 1)
    return np.bincount(label, energy, bins) / count


def _memory(residual: np.ndarray) -> float:
    """Return how many samples of a residual's energy count as one; at most all of them.

    The energy of a Gaussian residual has the square of its autocorrelation (Isserlis 1918,
    Biometrika 12:134). A change of the level prolongs the memory of the energy only, a periodic
    residual that of the squared autocorrelation only: the shorter one is that of the random part.
    """
    times = _integral_time(residual**2, 1), _integral_time(residual, 2)
    return min(*times, residual.size)


def _integral_time(signal: np.ndarray, power: int) -> float:
    """Return the sum of a power of the autocorrelation; infinite where that does not end.

    It is summed over a window of several times its value (Sokal 1997, in Functional Integration,
    NATO ASI Series B 361:131): a squared autocorrelation has no zero crossing, at which
    :func:`dea.discrepancy.evidence.model_error.memory_of` ends the sum.
    """
    correlation = autocovariance(signal - signal.mean(), signal.size)
    correlation /= correlation[0] or 1.0
    times = 2.0 * np.cumsum(correlation**power) - 1.0
    ends = np.flatnonzero(np.arange(times.size) >= _WINDOW * times)
    return max(float(times[ends[0]]), 1.0) if ends.size else np.inf


def _chance(
    energy: np.ndarray, memory: float, rng: np.random.Generator
) -> tuple[Iterator[np.ndarray], bool]:
    """Return what chance makes of the energy, if that can be drawn, and whether along time too."""
    length = max(8, energy.size // 150, int(_MEMORIES * memory))
    if energy.size >= _FEWEST * length:
        return _shuffled(energy, length, rng), True
    enough = energy.size >= _FEWEST_SHIFTS * memory
    return _shifted(energy, rng) if enough else iter(()), False


def _shuffled(energy: np.ndarray, length: int, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Draw the energy in another order of its blocks, which begin anywhere."""
    for _ in range(_DRAWS):
        rolled = np.roll(energy, int(rng.integers(energy.size)))
        blocks = [rolled[i : i + length] for i in range(0, energy.size, length)]
        yield np.concatenate([blocks[i] for i in rng.permutation(len(blocks))])


def _shifted(energy: np.ndarray, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Draw the energy at other times, as if the record were a circle.

    Of an energy that is independent of a stationary quantity all shifts are as likely as none,
    however long both remember (Harris 2020, arXiv:2012.06862). That holds only if the shortest ones
    count, too, after which the energy still follows itself.
    """
    for place in (np.arange(_DRAWS) + rng.random()) / _DRAWS:
        yield np.roll(energy, int(place * energy.size))


def _band(residual: np.ndarray, interval: float) -> Band:
    power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2
    frequency = np.fft.rfftfreq(residual.size, interval)
    total = power.sum() or 1.0
    lows = frequency[1] * 2.0 ** np.arange(0, np.log2(frequency.size), 0.5)
    parts = [power[(frequency >= low) & (frequency < 2 * low)].sum() / total for low in lows]
    best = int(np.argmax(parts))
    high = min(2 * lows[best], frequency[-1])
    return Band(float(lows[best]), float(high), float(parts[best]))
