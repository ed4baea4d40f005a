"""How often the 95 % interval of a named effect's defining parameter holds the true value.

Records of a resonator whose input path hides an effect in a textbook form: x'' + 2 ζ ω x' + ω² x =
ω² K v(u), solved exactly for a voltage that is constant in each of twenty steps a sample. Nothing
of the package draws them; it gets the record alone. An interrupted campaign goes on, as long as the
code is that of the same commit.
"""

import argparse
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import cont2discrete, lfilter

import dea
from benchmarks import stored
from benchmarks.bars import progress_bars
from benchmarks.command_line import add_store, positive, run, seed_number
from benchmarks.stored import command
from dea.discrepancy import Settings
from dea.trials import wilson

OUTCOMES = Path("build/intervals.jsonl")

RATE, SAMPLES, STEPS = 1000.0, 3000, 20  # Hz
PERIOD = 8192  # samples of the periodic noise that a record is cut from
FADED_IN = 50  # samples, so that a delayed input is zero before the record
FORMS = ("sharp", "jump", "delay", "clip", "tanh")
COUNTERPARTS = {
    "sharp": ("dead_zone", "threshold"),
    "jump": ("dead_zone", "threshold"),
    "delay": ("transport_delay", "delay"),
    "clip": ("input_saturation", "limit"),
    "tanh": ("input_saturation", "limit"),
}
OFFERED = ("coulomb_friction", "dead_zone", "input_saturation", "slew_limit", "transport_delay")
# Natural frequency in Hz, damping ratio, gain: means, and spreads of their logarithms.
PRIORS = ((70.0, 0.5), (0.1, 1.0), (1.0, 1.0))


@dataclass(frozen=True)
class Drawn:
    """A record's input and output (n,), and what its device hides."""

    u: np.ndarray
    y: np.ndarray
    form: str
    true: float


def acting(form: str, u: np.ndarray, true: float) -> np.ndarray:
    """Return the voltage that acts."""
    if form == "sharp":
        beyond: np.ndarray = np.sign(u) * np.maximum(np.abs(u) - true, 0.0)
        return beyond
    if form == "jump":
        return np.where(np.abs(u) > true, u, 0.0)
    limited: np.ndarray = np.clip(u, -true, true) if form == "clip" else true * np.tanh(u / true)
    return limited


def draw(seed: int, number: int) -> Drawn:
    """Return a record, whose form follows from its number alone."""
    rng = np.random.default_rng([seed, number])
    form = FORMS[number % len(FORMS)]
    frequency, damping, gain = (
        mean * np.exp(spread * np.clip(rng.standard_normal(), -1.5, 1.5)) for mean, spread in PRIORS
    )
    band = min(frequency * rng.uniform(0.8, 1.8), 0.2 * RATE)
    size = np.exp(rng.uniform(np.log(0.5), np.log(2.0)))
    if form == "delay":
        true = (rng.integers(2, 8) + rng.uniform(0.15, 0.85)) / RATE
    else:
        low = 0.2 if COUNTERPARTS[form][0] == "dead_zone" else 0.8
        true = size * rng.uniform(low, low + 0.6)

    frequencies = np.fft.rfftfreq(PERIOD, 1 / RATE)
    edge = np.clip((frequencies - 0.9 * band) / (0.2 * band), 0.0, 1.0)
    spectrum = np.fft.rfft(rng.standard_normal(PERIOD)) * np.cos(0.5 * np.pi * edge) * (edge < 1)
    spectrum[0] = 0.0
    spectrum *= size / np.fft.irfft(spectrum).std()

    def voltage(shift: float) -> np.ndarray:
        """Return the voltage so many samples after each sample."""
        later = spectrum * np.exp(2j * np.pi * frequencies * shift / RATE)
        begun = np.clip((np.arange(SAMPLES) + shift) / FADED_IN, 0.0, 1.0)
        faded: np.ndarray = np.fft.irfft(later)[:SAMPLES] * np.sin(0.5 * np.pi * begun) ** 2
        return faded

    y = gain * resonator(frequency, damping, np.column_stack([
        voltage(middle - true * RATE) if form == "delay" else acting(form, voltage(middle), true)
        for middle in (np.arange(STEPS) + 0.5) / STEPS
    ]))  # fmt: skip
    y += rng.uniform(0.01, 0.05) * y.std() * rng.standard_normal(SAMPLES)
    return Drawn(voltage(0.0), y, form, float(true))


def resonator(frequency: float, damping: float, v: np.ndarray) -> np.ndarray:
    """Return the position at each sample, for a voltage (n, steps), constant in each step."""
    omega = 2.0 * np.pi * frequency
    continuous = [omega**2], [1.0, 2.0 * damping * omega, omega**2]
    numerator, denominator, _ = cont2discrete(continuous, 1.0 / RATE / STEPS)
    position: np.ndarray = lfilter(numerator[0], denominator, v.ravel())[::STEPS]
    return position


def judged(which: tuple[int, int]) -> dict[str, Any]:
    """Return what a diagnosis says of the record of a seed and a number.

    Where it gives the right name: whether the interval holds the true value, its half width over
    that value, and the error in half widths.
    """
    seed, number = which
    drawn = draw(seed, number)
    record = dea.Record.of(drawn.u, drawn.y, RATE, units=("V", "V"), names=("voltage", "position"))
    settings = Settings(effects=OFFERED)
    verdict = dea.diagnose(record, "mass_spring_damper", settings=settings).verdict
    name, parameter = COUNTERPARTS[drawn.form]
    named = verdict.status == "named" and verdict.names == (name,)
    found: dict[str, Any] = {"seed": seed, "number": number, "form": drawn.form, "named": named}
    found["wrong"] = verdict.status == "named" and not {name} >= set(verdict.names)
    if named:
        estimate = verdict.effects[0].parameters[parameter]
        half = 0.5 * (estimate.high - estimate.low)
        found["inside"] = bool(estimate.low <= drawn.true <= estimate.high)
        found["half"] = half / drawn.true
        found["error"] = abs(estimate.value - drawn.true) / half
    return found


def campaign(seed: int, count: int, cores: int) -> list[dict[str, Any]]:
    """Judge so many records; what the same code has judged before is taken from OUTCOMES."""
    code = stored.commit()
    known = {(row["seed"], row["number"]): row for row in stored.known(OUTCOMES, code)}
    wanted = [(seed, number) for number in range(count)]
    left = [which for which in wanted if which not in known]
    with ExitStack() as stack:
        bars = stack.enter_context(progress_bars())
        each = stack.enter_context(ProcessPoolExecutor(cores)).map if cores > 1 else map
        for row in bars.track(each(judged, left), total=len(left), description="records"):
            known[row["seed"], row["number"]] = row
            stored.add(OUTCOMES, row | {"commit": code})
    return [known[which] for which in wanted]


def summary(found: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return how many were named right or wrong, and what the intervals of the right ones hold.

    Half widths are shares of the true value, errors are in half widths: medians of both.
    """
    right = [each for each in found if each["named"]]
    counts: dict[str, Any] = {
        "records": len(found),
        "right": len(right),
        "wrong": sum(each["wrong"] for each in found),
        "inside": sum(each["inside"] for each in right),
    }
    if right:
        _, low, high, _ = wilson(counts["inside"], len(right))
        half, error = (float(np.median([each[key] for each in right])) for key in ("half", "error"))
        counts |= {"low": low, "high": high, "half": half, "error": error}
    return counts


def line(title: str, counts: Mapping[str, Any]) -> str:
    """Return a summary as it is printed."""
    text = f"{title:6} {counts['right']} of {counts['records']} named right"
    text += f", {counts['wrong']} wrong"
    if counts["right"]:
        text += f"; {counts['inside']} intervals hold the truth"
        text += f" ({counts['low']:.0%} to {counts['high']:.0%})"
        text += f"; half width {counts['half']:.1%} of it"
        text += f"; error {counts['error']:.2f} half widths (0.34 if normal)"
    return text


def main(arguments: list[str] | None = None) -> None:
    """Draw, diagnose and count."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.intervals", description=__doc__)
    parser.add_argument("--count", type=positive, default=50, help="records")
    parser.add_argument("--seed", type=seed_number, default=1, help="of the records")
    parser.add_argument("--cores", type=positive, default=2, help="records at a time")
    add_store(parser)
    asked = parser.parse_args(arguments)
    found = campaign(asked.seed, asked.count, asked.cores)
    groups = {form: [each for each in found if each["form"] == form] for form in FORMS}
    counted = {title: summary(group) for title, group in (groups | {"all": found}).items() if group}
    if asked.store:
        values = {"count": asked.count, "seed": asked.seed, **counted}
        stored.store("intervals", command("intervals", COUNT=asked.count, SEED=asked.seed), values)
    print("\n".join(line(title, counts) for title, counts in counted.items()))


if __name__ == "__main__":
    run(main)
