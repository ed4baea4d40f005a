"""Where a simulation and a record disagree, against what chance would make of the same gap."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from dea.discrepancy.problem import Problem

BINS = 12
_DRAWS = 200
_LEVEL = 0.05
# Unit of a quantity along which the residual is looked at, and how a sentence speaks of it.
_PHRASES: Mapping[str, str] = {
    "time": "between {low:.3g} and {high:.3g} s",
    "input": "where the input is between {low:.3g} and {high:.3g} {unit}",
    "input_rate": "where the input changes by {low:.3g} to {high:.3g} {unit}",
    "output": "where the simulated output is between {low:.3g} and {high:.3g} {unit}",
    "output_rate": "where the output moves at {low:.3g} to {high:.3g} {unit}",
    "direction": "while the output is {name}",
    "reversal": "{low:.3g} to {high:.3g} s after a reversal of the motion",
}
_DIRECTIONS = ("falling", "still", "rising")


@dataclass(frozen=True)
class Localisation:
    """Energy of the gap along each quantity, and in words where it is.

    ``dataset`` holds, for each quantity, its bins, the RMS residual in them and the probability
    that chance concentrates the residual as much; ``strongest`` names the quantity along which the
    residual is concentrated most, or ``None`` where chance explains all of it.
    """

    dataset: xr.Dataset
    sentence: str
    strongest: str | None


def localise(
    problem: Problem,
    residual: np.ndarray,
    units: tuple[str, str],
    samples: np.ndarray,
    rng: np.random.Generator,
) -> Localisation:
    """Find where ``gap`` (n,) lives among ``samples`` (n, bool).

    The energy is shuffled in blocks that keep its own correlation; the largest standardised bin
    over all quantities (max statistic) gives the null.
    """
    from scipy.signal import coherence

    where = np.flatnonzero(samples & np.isfinite(residual))
    energy = residual[where] ** 2
    quantities = _quantities(problem, residual, units)
    labels, edges = {}, {}
    for name, (values, _) in quantities.items():
        edges[name] = _edges(values[where], name)
        labels[name] = np.clip(
            np.searchsorted(edges[name], values[where], "right") - 1, 0, edges[name].size - 2
        )
    measured = {name: _mean(energy, label, edges[name].size - 1) for name, label in labels.items()}
    null = {name: np.empty((_DRAWS, m.size)) for name, m in measured.items()}
    length = max(8, where.size // 150)
    for draw in range(_DRAWS):
        shuffled = _shuffle(energy, length, rng)
        for name, label in labels.items():
            null[name][draw] = _mean(shuffled, label, measured[name].size)
    scores, thresholds = {}, []
    for name, mean in measured.items():
        centre, width = null[name].mean(0), null[name].std(0) + 1e-300
        scores[name] = (mean - centre) / width
        thresholds.append(np.max((null[name] - centre) / width, axis=1))
    largest = np.max(thresholds, axis=0)
    probability = {
        name: float((1 + np.sum(largest >= score.max())) / (1 + _DRAWS))
        for name, score in scores.items()
    }
    rms = {name: np.sqrt(mean) for name, mean in measured.items()}
    overall = float(np.sqrt(energy.mean()))
    found = [name for name in scores if probability[name] <= _LEVEL]
    strongest = max(found, key=lambda name: measured[name].max()) if found else None
    segment = min(where.size, max(64, problem.u.size // 16))
    u, e = problem.u[where], residual[where]
    frequency, coherent = coherence(u, e, 1.0 / problem.interval, nperseg=segment)
    band, part = _band(e, problem.interval)
    sentence = _sentence(strongest, rms, edges, quantities, overall, units[1], band, part)
    variables: dict[str, tuple] = {}
    for name, (_, unit) in quantities.items():
        variables[f"{name}_low"] = (name, edges[name][:-1], _label(unit, f"{name}: lower end"))
        variables[f"{name}_high"] = (name, edges[name][1:], _label(unit, f"{name}: upper end"))
        variables[f"{name}_gap"] = (name, rms[name], _label(units[1], f"RMS gap along {name}"))
        variables[f"{name}_null"] = (
            name, np.sqrt(np.quantile(null[name], 0.95, axis=0)),
            _label(units[1], f"RMS gap along {name} that chance exceeds in 5 %"),
        )  # fmt: skip
        variables[f"{name}_probability"] = ((), probability[name], _label("1", f"chance, {name}"))
    variables["frequency"] = ("frequency", frequency, _label("Hz", "frequency"))
    variables["coherence"] = ("frequency", coherent, _label("1", "coherence of input and gap"))
    variables["gap_rms"] = ((), overall, _label(units[1], "RMS gap"))
    return Localisation(xr.Dataset(variables), sentence, strongest)


def _label(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}


def _quantities(
    problem: Problem, residual: np.ndarray, units: tuple[str, str]
) -> dict[str, tuple[np.ndarray, str]]:
    simulated = problem.y - np.where(np.isfinite(residual), residual, 0.0)
    rate = np.gradient(simulated, problem.interval)
    still = 0.05 * np.std(rate)
    direction = np.where(rate > still, 2.0, np.where(rate < -still, 0.0, 1.0))
    turned = np.flatnonzero(np.diff(np.sign(rate)) != 0)
    last = np.concatenate([[0], turned + 1])
    since = np.arange(rate.size) - last[np.searchsorted(last, np.arange(rate.size), "right") - 1]
    return {
        "time": (problem.time, "s"),
        "input": (problem.u, units[0]),
        "input_rate": (np.gradient(problem.u, problem.interval), f"{units[0]}/s"),
        "output": (simulated, units[1]),
        "output_rate": (rate, f"{units[1]}/s"),
        "direction": (direction, "1"),
        "reversal": (since * problem.interval, "s"),
    }


def _edges(values: np.ndarray, name: str) -> np.ndarray:
    if name == "direction":
        return np.array([-0.5, 0.5, 1.5, 2.5])
    if name == "time":
        return np.linspace(values[0], values[-1] + 1e-9, 2 * BINS + 1)
    edges = np.unique(np.quantile(values, np.linspace(0, 1, BINS + 1)))
    return (
        edges if edges.size > 2 else np.array([values.min(), values.mean(), values.max() + 1e-12])
    )


def _mean(energy: np.ndarray, label: np.ndarray, bins: int) -> np.ndarray:
    count = np.maximum(np.bincount(label, minlength=bins), 1)
    return np.bincount(label, energy, bins) / count


def _shuffle(energy: np.ndarray, length: int, rng: np.random.Generator) -> np.ndarray:
    rolled = np.roll(energy, int(rng.integers(energy.size)))
    blocks = [rolled[i : i + length] for i in range(0, energy.size, length)]
    return np.concatenate([blocks[i] for i in rng.permutation(len(blocks))])


def _band(residual: np.ndarray, interval: float) -> tuple[tuple[float, float], float]:
    """Return the octave-wide band (Hz) that holds most of the gap, and the part it holds."""
    power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2
    frequency = np.fft.rfftfreq(residual.size, interval)
    total = power.sum() or 1.0
    lows = frequency[1] * 2.0 ** np.arange(0, np.log2(frequency.size), 0.5)
    parts = [power[(frequency >= low) & (frequency < 2 * low)].sum() / total for low in lows]
    best = int(np.argmax(parts))
    return (float(lows[best]), float(min(2 * lows[best], frequency[-1]))), float(parts[best])


def _sentence(
    strongest: str | None,
    rms: Mapping[str, np.ndarray],
    edges: Mapping[str, np.ndarray],
    quantities: Mapping[str, tuple[np.ndarray, str]],
    overall: float,
    unit: str,
    band: tuple[float, float],
    part: float,
) -> str:
    spectrum = f"{100 * part:.0f} % of its energy lies between {band[0]:.2g} and {band[1]:.2g} Hz"
    if strongest is None:
        return (
            f"the gap of {overall:.3g} {unit} (RMS) is spread as chance would spread it; {spectrum}"
        )
    bin_ = int(np.argmax(rms[strongest]))
    place = _PHRASES[strongest].format(
        low=edges[strongest][bin_],
        high=edges[strongest][bin_ + 1],
        unit=quantities[strongest][1],
        name=_DIRECTIONS[bin_] if strongest == "direction" else "",
    )
    others = np.delete(rms[strongest], bin_)
    return (
        f"the gap is {rms[strongest][bin_]:.3g} {unit} (RMS) {place}, "
        f"{np.sqrt(np.mean(np.square(others))):.3g} {unit} elsewhere; {spectrum}"
    )
