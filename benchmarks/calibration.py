"""The virtual actuators beside the six measured ones: gain, phase, curvature and drift.

What the measured actuators do is computed from their published models (Table 1 of the paper); an
actuator of the bench without one is named, and left out. Each film is taken in the middle of its
record: after its own rest and a quarter of an hour at the middle voltage.
"""

import argparse
import csv
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.command_line import add_store, run
from benchmarks.stored import command, store
from dea.arrays import Array
from dea.configuration.bench import read_bench
from dea.errors import InputError
from dea.excitation import design
from dea.figures import style
from dea.gfrf import frequency_response
from dea.narx import NarxModel, load_published
from dea.plant import SAMPLE_PERIOD, Parameters, Rig, read_parameters
from dea.plant.film import rest
from dea.plant.small_signal import hold, responses

BENCH, PUBLISHED = Path("config/bench.yaml"), Path("config/published_models.yaml")
STUDY = Path("config/config.yaml")
TABLE, FIGURE = Path("results/calibration.csv"), Path("results/figures/calibration.png")
REFERENCE = 0.02  # Hz, where the gain is one
GAIN_AT = np.array([0.05, 0.1, 0.2, 0.5, 1.0])  # Hz
CURVATURE_AT = np.array([0.05, 0.1, 0.5, 1.0])  # Hz
LOW, HIGH = 1.1, 3.75  # V, the command that the models' input of -1 to 1 stands for
MIDDLE = 900.0  # s
GAIN_WITHIN, PHASE_WITHIN, CURVATURE_WITHIN = 0.04, 4.0, 0.25  # 1, degrees, relative
PIECES = 18  # of the record, for its mean over time
COURSE = {"dea2": -1, "dea6": 1}  # the paper: the mean displacement falls (-1), rises (1)


class Character(NamedTuple):
    """What an actuator does in the band of the study.

    ``gain`` over that at REFERENCE and ``phase`` (degrees) at GAIN_AT, each of shape (5,);
    ``curvature`` is |H2(f, f)| over |H1(REFERENCE)| at CURVATURE_AT, of shape (4,), of an input
    that goes from -1 to 1 where the command goes from LOW to HIGH.
    """

    gain: Array
    phase: Array
    curvature: Array

    def misses(self, other: "Character") -> tuple[float, float, float]:
        """Return the largest differences in gain, phase (degrees) and, relative, curvature."""
        return (
            float(np.abs(self.gain - other.gain).max()),
            float(np.abs(self.phase - other.phase).max()),
            float(np.abs(self.curvature / other.curvature - 1.0).max()),
        )


def counterparts(actuators: Sequence[str]) -> dict[str, NarxModel]:
    """Return the published model of each actuator that has one, which bears its name in capitals.

    Raises
    ------
    InputError
        If none has.
    """
    models = load_published(PUBLISHED)
    found = {name: models[name.upper()] for name in actuators if name.upper() in models}
    if not found:
        raise InputError(
            f"none of {', '.join(actuators)} has a published model",
            file=BENCH,
            field="actuators",
            remedy=f"Name one as in {PUBLISHED}, in lower case",
        )
    return found


def published(model: NarxModel, rate: float) -> Character:
    """Return the character of a published model, its one sample of delay taken off."""
    frequencies = np.concatenate([[REFERENCE], GAIN_AT])
    first = frequency_response(model, 1, frequencies, rate)
    first = first * np.exp(2j * np.pi * frequencies / rate)
    second = frequency_response(model, 2, (CURVATURE_AT, CURVATURE_AT), rate)
    return _character(first, second)


def virtual(parameters: Parameters) -> Character:
    """Return the character of a film, from the command on, without the sensor's filter."""
    film, gain = parameters.film, parameters.amplifier.gain
    state = rest(film, parameters.rest)
    supply = gain * 0.5 * (LOW + HIGH)
    if not hold(film, state, supply, MIDDLE):
        raise ValueError("the film pulls in at the middle voltage")
    swing = gain * 0.5 * (HIGH - LOW)
    frequencies = np.concatenate([[REFERENCE], GAIN_AT])
    first = responses(film, state, supply, frequencies).first * swing
    second = responses(film, state, supply, CURVATURE_AT).second * swing**2
    return _character(first, second)


def _character(first: NDArray[np.complex128], second: NDArray[np.complex128]) -> Character:
    size = np.abs(first[0])
    return Character(np.abs(first[1:]) / size, np.angle(first[1:], deg=True), np.abs(second) / size)


def study() -> dict[str, Any]:
    """Return the settings of the study."""
    found: dict[str, Any] = yaml.safe_load(STUDY.read_text())
    return found


def excitation() -> dict[str, Any]:
    """Return what the study's record is excited with, duration in s."""
    found: dict[str, Any] = study()["excitation"]["record"]
    return found


def means(actuator: str) -> Array:
    """Return the mean displacement in mm over each of PIECES of the study's record."""
    volts = design(**excitation(), sampling_rate=1.0 / SAMPLE_PERIOD, seed=1)
    rig = Rig.from_config(BENCH, actuator, seed=1)
    counts = read_parameters(BENCH, actuator).output_converter.to_counts(volts)
    reading: Array = rig.respond(counts).reshape(PIECES, -1).mean(axis=1)
    return 1e3 * reading


@style.styled
def drawn(
    measured: Mapping[str, Character],
    made: Mapping[str, Character],
    drift: Mapping[str, Array],
    duration: float,
) -> Figure:
    """Draw gain, phase, curvature and mean displacement over a record (s), a row per actuator."""
    figure = style.page_figure(style.FULL_WIDTH, 30.0 * len(made) + 12.0)
    grid = figure.subplots(len(made), 4, sharex="col", sharey="col", squeeze=False)
    panels = (
        ("gain over that at 0.02 Hz", GAIN_AT, "gain"),
        ("phase (°)", GAIN_AT, "phase"),
        ("curvature", CURVATURE_AT, "curvature"),
    )
    for row, (name, own) in zip(grid, made.items(), strict=True):
        for ax, (_, at, field) in zip(row[:3], panels, strict=True):
            target, value = getattr(measured[name], field), getattr(own, field)
            ax.fill_between(
                at, *asked_for(field, target), color=style.PALE, lw=0, label="asked for"
            )
            ax.plot(at, target, "o", color=style.BLACK, mfc="none", label="measured")
            ax.plot(at, value, "-", color=style.VERMILION, label="virtual")
            ax.set_xscale("log")
            style.plain_log_ticks(ax.xaxis)
        minutes = (np.arange(PIECES) + 0.5) * duration / 60.0 / PIECES
        row[3].plot(minutes, drift[name] / drift[name][0], color=style.VERMILION)
        row[3].axhline(1.0, color=style.GREY, lw=0.5)
        row[0].text(0.04, 0.08, name, transform=row[0].transAxes, fontweight="bold")
    titles = [title for title, *_ in panels] + ["mean displacement (1 at first)"]
    for ax, title in zip(grid[0], titles, strict=True):
        ax.set_title(title)
    _labelled(grid[-1])
    grid[0, 2].legend(loc="lower left")
    return figure


def _labelled(bottom: NDArray[np.object_]) -> None:
    axes: list[Axes] = list(bottom)
    for ax in axes[:3]:
        ax.set_xlabel("frequency (Hz)")
    axes[3].set_xlabel("time (min)")


def asked_for(field: str, target: Array) -> tuple[Array, Array]:
    """Return the lowest and the highest values of a field of Character that are no miss."""
    absolute = {"gain": GAIN_WITHIN, "phase": PHASE_WITHIN}
    margin = absolute[field] if field in absolute else CURVATURE_WITHIN * target
    return target - margin, target + margin


def _write(
    measured: Mapping[str, Character], made: Mapping[str, Character], changes: Mapping[str, float]
) -> None:
    TABLE.parent.mkdir(exist_ok=True)
    with TABLE.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            ["actuator", "quantity", "frequency_hz", "measured", "virtual", "lowest", "highest"]
        )
        for name, own in made.items():
            for field, at in zip(Character._fields, (GAIN_AT, GAIN_AT, CURVATURE_AT), strict=True):
                target = getattr(measured[name], field)
                columns = (at, target, getattr(own, field), *asked_for(field, target))
                table.writerows(
                    [name, field, f"{f:g}", *(f"{value:.3f}" for value in values)]
                    for f, *values in zip(*columns, strict=True)
                )
            course = COURSE.get(name, 0)
            bounds = ("1" if course > 0 else "", "1" if course < 0 else "")
            table.writerow([name, "drift", "", "", f"{changes[name]:.3f}", *bounds])


def main(arguments: list[str] | None = None) -> int:
    """Write the table and the figure, print the misses; return 1 where one may not be."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibration", description=__doc__)
    add_store(parser)
    options = parser.parse_args(arguments)
    rate = study()["recovery"]["sampling_rate"]
    actuators = list(read_bench(BENCH).actuators)
    measured = {name: published(model, rate) for name, model in counterparts(actuators).items()}
    made = {name: virtual(read_parameters(BENCH, name)) for name in measured}
    duration = excitation()["duration"]
    drift = {name: means(name) for name in measured}
    changes = {name: float(mean[-1] / mean[0]) for name, mean in drift.items()}
    _write(measured, made, changes)
    FIGURE.parent.mkdir(parents=True, exist_ok=True)
    style.save(drawn(measured, made, drift, duration), [FIGURE], 200)
    print("largest misses          gain   phase   curvature   mean displacement, end over start")
    unlike: list[str] = []
    rows = [
        "| | gain, 0.05 to 1 Hz | phase | curvature | mean displacement, last "
        f"{duration / PIECES:.0f} s over first |",
        "|---|---|---|---|---|",
    ]
    for name in measured:
        misses = made[name].misses(measured[name])
        gain, phase, curvature = misses
        change = changes[name]
        print(f"{name:<20}{gain:>8.3f}{phase:>7.1f}°{100 * curvature:>10.0f} %{change:>12.3f}")
        rows.append(
            f"| {name} | {gain:.3f} | {phase:.1f}° | {100 * curvature:.0f} % | {change:.2f} |"
        )
        unlike += beyond(name, misses, change)
    for name in actuators:
        if name not in measured:
            print(f"{name} has no published model: not calibrated")
    if options.store:
        values = {
            "misses": rows,
            "measured_rise": {name: float(measured[name].gain[-1] - 1.0) for name in measured},
            "virtual_rise": {name: float(made[name].gain[-1] - 1.0) for name in measured},
        }
        store("calibration", command("calibration"), values)
    if unlike:
        print("not as measured: " + "; ".join(unlike), file=sys.stderr)
    return int(bool(unlike))


def beyond(name: str, misses: Sequence[float], change: float) -> list[str]:
    """Return what is said of each miss of an actuator that is larger than it may be.

    ``change`` is the end of the mean displacement over its start, which has to lie on the side of 1
    that the paper tells of, where it tells.
    """
    limits = {"gain": GAIN_WITHIN, "phase (°)": PHASE_WITHIN, "curvature": CURVATURE_WITHIN}
    said = [
        f"{name}, {what}: {miss:.3g}, at most {limit:g}"
        for (what, limit), miss in zip(limits.items(), misses, strict=True)
        if not miss <= limit
    ]
    course = COURSE.get(name, 0)
    if course and not course * change > course:
        said.append(
            f"{name}, mean displacement, end over start: {change:.3g}, "
            f"{'above' if course > 0 else 'below'} 1 in the paper"
        )
    return said


if __name__ == "__main__":
    run(main)
