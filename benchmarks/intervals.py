"""How often the 95 % interval of a named effect's defining parameter holds the true value.

Records of a resonator whose input path hides an effect in a textbook form: x'' + 2 ζ ω x' + ω² x =
ω² K v(u), solved exactly for a voltage that is constant in each of twenty steps a sample. Nothing
of the package draws them; it gets the record alone.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from scipy.signal import cont2discrete, lfilter

import dea
from dea.discrepancy import Settings
from dea.trials.proportion import wilson

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
        return np.sign(u) * np.maximum(np.abs(u) - true, 0.0)
    if form == "jump":
        return np.where(np.abs(u) > true, u, 0.0)
    return np.clip(u, -true, true) if form == "clip" else true * np.tanh(u / true)


def draw(number: int) -> Drawn:
    """Return a record: number, seed and form are one."""
    rng = np.random.default_rng(number)
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
        return np.fft.irfft(later)[:SAMPLES] * np.sin(0.5 * np.pi * begun) ** 2

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


def judged(number: int) -> dict[str, object]:
    """Return what a diagnosis says of a record, and whether its interval holds the true value."""
    drawn = draw(number)
    record = dea.Record.of(drawn.u, drawn.y, RATE, units=("V", "V"), names=("voltage", "position"))
    settings = Settings(effects=OFFERED)
    verdict = dea.diagnose(record, "mass_spring_damper", settings=settings).verdict
    name, parameter = COUNTERPARTS[drawn.form]
    named = verdict.status == "named" and verdict.names == (name,)
    found: dict[str, object] = {"form": drawn.form, "named": named}
    found["wrong"] = verdict.status == "named" and not {name} >= set(verdict.names)
    if named:
        estimate = verdict.effects[0].parameters[parameter]
        half = 0.5 * (estimate.high - estimate.low)
        found["inside"] = estimate.low <= drawn.true <= estimate.high
        found["half"] = half / drawn.true
        found["error"] = abs(estimate.value - drawn.true) / half
    return found


def main() -> None:
    """Draw, diagnose and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1, help="number of the first record")
    parser.add_argument("--cores", type=int, default=2)
    asked = parser.parse_args()
    numbers = range(asked.seed, asked.seed + asked.count)
    with ProcessPoolExecutor(asked.cores) as pool:
        found = list(pool.map(judged, numbers))
    for form in FORMS:
        report(form, [each for each in found if each["form"] == form])
    report("all", found)


def report(title: str, found: list[dict[str, object]]) -> None:
    """Print a line: how many were named right, and of these how many intervals hold the truth."""
    right = [each for each in found if each["named"]]
    inside = sum(bool(each["inside"]) for each in right)
    line = f"{title:6} {len(right)} of {len(found)} named right"
    line += f", {sum(bool(each['wrong']) for each in found)} wrong"
    if right:
        _, low, high, _ = wilson(inside, len(right))
        half, error = (np.median([each[key] for each in right]) for key in ("half", "error"))
        line += f"; {inside} intervals hold the truth ({low:.0%} to {high:.0%})"
        line += f"; half width {half:.1%} of it; error {error:.2f} half widths (0.34 if normal)"
    print(line, flush=True)


if __name__ == "__main__":
    main()
