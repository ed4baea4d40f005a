"""Count how often the 95 % bands of a tracked model contain the responses of a virtual actuator.

The virtual actuators are no NARX models: their films creep, and so do their responses. A record is
driven, identified and tracked with the numbers of the study; at three instants responses and rest
are set against those of the film in the state that it has then, which goes on at a constant voltage
of the excitation's mean pressure, without tones, with small ones and with their negative. The free
run is set against the displacement without noise of the whole record. A film has no parameters of
a NARX model that theirs could be set against. Writes
``results/coverage_film.csv`` and ``.md``; ``--store`` keeps the latter as
``docs/measured/coverage_film.json``.
"""

import argparse
import copy
import itertools
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

import dea
from benchmarks import command_line
from benchmarks.command_line import add_store, positive, seed_number
from benchmarks.coverage.campaign import Cell, counted, each_done
from benchmarks.coverage.judged import FROM, INSTANTS, Judged, contains, phase_contains
from benchmarks.coverage.report import rows, written
from benchmarks.stored import command, store
from dea.arrays import Array, Complex
from dea.excitation import design
from dea.gfrf.bands import ResponseBand, frequency_response_band, zero_input_interval
from dea.gfrf.instants import Instants
from dea.gfrf.model_error import model_error
from dea.narx import Interval, NarxModel
from dea.plant import SAMPLE_PERIOD, Rig, read_parameters
from dea.plant.converter import Converter
from dea.seeds import generator
from dea.stages.identification import selection_arguments
from dea.tracking import with_constant

ROOT = Path(__file__).parents[2]
BENCH, STUDY = ROOT / "config" / "bench.yaml", ROOT / "config" / "config.yaml"
RATE = 1.0 / SAMPLE_PERIOD
# A record in s: it is tracked from where the study begins to identify.
DURATION = 1400.0
SHARES = np.array([0.3, 0.5, 0.7])  # of the part that is tracked, where it is judged
# The period of the tones in s, how often each plays, and their amplitude in V. The first period
# settles; from the two others follows what the film would answer in the state that it had.
PERIOD, PERIODS, AMPLITUDE = 20.0, 3, 0.02
LINES = np.array([1, 2, 4, 8, 16])  # of the tones: 0.05 to 0.8 Hz of the band of 1 Hz
PAIRS = ((1, 4), (2, 8), (4, 16))  # of lines, for H2


class Truth(NamedTuple):
    """H1 at LINES in mm/V, H2 at PAIRS in mm/V², and the rest in mm."""

    first: Complex
    second: Complex
    rest: float


def study() -> dict[str, Any]:
    """Return the settings of the study."""
    found: dict[str, Any] = yaml.safe_load(STUDY.read_text())
    return found


def truth(rig: Rig, converter: Converter, bias: float) -> Truth:
    """Return responses and rest of a rig in the state that it has, about a constant voltage (V).

    The ``converter`` is that of its output.

    At a constant voltage the film creeps away from that state: what the last two periods show,
    whose middles are 1.5 and 2.5 periods later, is extended back to it in a straight line.
    """
    period = round(PERIOD * RATE)
    time = np.arange(PERIODS * period) / RATE

    def played(volts: Array) -> tuple[Array, Array]:
        counts = converter.to_counts(volts)
        return converter.to_values(counts), 1e3 * copy.deepcopy(rig).respond(counts)

    def lines(signal: Array) -> Complex:
        each = np.fft.rfft(signal.reshape(PERIODS, period))[1:, : 2 * LINES[-1] + 1] * 2.0 / period
        found: Complex = _extended_back(each)
        return found

    def both(tones: Array) -> tuple[Complex, Complex, Complex]:
        """Return the lines of the tones, and of what is odd and what is even in the answer."""
        (u_plus, plus), (u_minus, minus) = played(bias + tones), played(bias - tones)
        if not np.allclose(u_plus + u_minus, 2.0 * bias, rtol=0.0, atol=1e-9):
            raise ValueError(
                f"{bias} V is no count of the converter: the tones are not rounded alike"
            )
        return lines((u_plus - u_minus) / 2), lines((plus - minus) / 2), lines((plus + minus) / 2)

    def tone(line: int) -> Array:
        made: Array = AMPLITUDE * np.cos(2.0 * np.pi * line / PERIOD * time)
        return made

    u, odd, _ = both(np.sum([tone(line) for line in LINES], axis=0))
    _, creeping = played(np.full(time.size, bias))
    still = lines(creeping)
    second = []
    for low, high in PAIRS:
        pair, _, even = both(tone(low) + tone(high))
        second.append((even - still)[low + high] / (pair[low] * pair[high]))
    at_rest = _extended_back(creeping.reshape(PERIODS, period)[1:].mean(axis=1))
    return Truth(odd[LINES] / u[LINES], np.array(second), float(at_rest))


def _extended_back(periods: Any) -> Any:
    """Return what the second and the third period tell of the instant at which the first begins."""
    return periods[0] + 1.5 * (periods[0] - periods[1])


def judge(actuator: str, number: int, seed: int) -> Judged:
    """Drive, identify and track a record of an actuator, and judge the bands of its responses."""
    chosen = study()
    parameters = read_parameters(BENCH, actuator)
    drawn = int(generator(seed, actuator, str(number)).integers(2**31))
    rig = Rig(parameters, drawn)
    volts = design(
        **chosen["excitation"]["record"] | {"duration": DURATION}, sampling_rate=RATE, seed=drawn
    )
    output, reading = parameters.output_converter, parameters.displacement_converter
    counts = output.to_counts(volts)
    clean = 1e3 * copy.deepcopy(rig).respond(counts)
    identification = chosen["identification"]
    first = round(identification["start"] * RATE)
    at = first + np.round(SHARES * (counts.size - first)).astype(int)
    # The rig goes through the record in pieces, to be copied in the state that it has between them.
    pieces, states = [], []
    for begin, end in itertools.pairwise([0, *at, counts.size]):
        pieces.append(rig.advance(counts[begin:end]))
        states.append(copy.deepcopy(rig))
    u, y = (np.concatenate([piece[k] for piece in pieces]) for k in (0, 1))
    u, y = output.to_values(u)[first:], reading.to_values(y)[first:]
    part = slice(0, round(identification["length"] * RATE))
    model = dea.select_terms(u[part], y[part], **selection_arguments(identification))
    # Held there, the film creeps on as under the excitation: its mean pressure stays as it was.
    # Of a voltage on a count of the converter, tones and their negatives are rounded alike.
    pressure = np.array([np.sqrt(np.mean(volts**2))])
    [bias] = output.to_values(output.to_counts(pressure))
    claimed = tracked_bands(model, u, y, at - first, float(bias), chosen)
    judged: dict[str, list[Array]] = {}
    for state, *both, (_, low, high) in zip(
        states[:-1], claimed.first, claimed.second, claimed.rest, strict=True
    ):
        true = truth(state, output, float(bias))
        judged.setdefault("rest", []).append(contains(np.array([true.rest]), low, high))
        for label, response, band in zip(("H1", "H2"), true[:2], both, strict=True):
            gain, phase = np.abs(response), np.degrees(np.angle(response))
            judged.setdefault(f"{label} gain", []).append(
                contains(gain, band.gain_low, band.gain_high)
            )
            judged.setdefault(f"{label} phase", []).append(
                phase_contains(phase, band.phase_low, band.phase_high)
            )
    along = np.linspace(FROM, y.size - 1, INSTANTS).astype(int)
    ends = (end[along] for end in claimed.run)
    judged["free run"] = [contains(clean[first:][along], *ends)]
    inside = {name: np.concatenate(each) for name, each in judged.items()}
    return Judged(inside, claimed.withheld)


class Claimed(NamedTuple):
    """Intervals as the study makes them.

    Parameters
    ----------
    first, second, rest
        Those of H1, of H2 and of the rest at each of the instants.
    run
        Low and high ends of that of the free run, (samples,).
    withheld
        Why there are none, if there are not.
    """

    first: list[ResponseBand]
    second: list[ResponseBand]
    rest: list[Interval]
    run: tuple[Array, Array]
    withheld: str


def tracked_bands(
    model: NarxModel, u: Array, y: Array, samples: Array, bias: float, chosen: dict[str, Any]
) -> Claimed:
    """Track the parameters of a model, and return its intervals at these samples about ``bias``."""
    tracker = chosen["gfrf"]["tracker"]
    track = dea.track_parameters(
        model, u, y, method=tracker, sampling_rate=RATE, **chosen["tracking"]["trackers"][tracker]
    )
    followed, f = with_constant(model), LINES / PERIOD
    course = track["parameter"].transpose("time", "term").values
    excited_above = chosen["gfrf"]["excited_above"]
    lacking = model_error(followed, course, u, y, RATE, excited_above, operating_point=bias)
    instants = Instants.of(track, followed)
    pairs = np.array(PAIRS).T / PERIOD
    first, second, rests = [], [], []
    for at in instants.nearest(samples / RATE):
        about: dict[str, Any] = {
            "parameters": instants.theta[at],
            "covariance": instants.covariance[at],
            "operating_point": bias,
            "allow_missing": True,
        }
        H1 = frequency_response_band(followed, 1, f, RATE, **about)
        H2 = frequency_response_band(followed, 2, tuple(pairs), RATE, **about)
        if lacking is not None:
            H1 = H1.widened(*lacking.first(f))
            H2 = H2.widened(*lacking.second(*pairs))
        first.append(H1)
        second.append(H2)
        rests.append(zero_input_interval(followed, **about))
    runs = dea.tracking.compare_free_runs(model, {tracker: track}, u, y, window=len(u))
    run = runs.sel(simulation=tracker)
    ends = run["simulated_low"].values, run["simulated_high"].values
    return Claimed(first, second, rests, ends, str(track.attrs["withheld"]))


def _judge(arguments: tuple[str, int, int]) -> Judged:
    return judge(*arguments)


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage.film", description=__doc__)
    parser.add_argument("--count", type=positive, default=17, help="records of each actuator")
    parser.add_argument("--seed", type=seed_number, default=1, help="of the records")
    parser.add_argument("--cores", type=positive, default=os.cpu_count(), help="jobs at a time")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "coverage_film")
    add_store(parser)
    given = parser.parse_args(arguments)
    actuators = [each["bench"] for each in study()["actuators"]]
    jobs = [(name, k, given.seed) for name in actuators for k in range(given.count)]
    done = each_done(_judge, jobs, given.cores, "records of actuators")
    kind = f"{study()['excitation']['record']['band']:g} Hz"
    cells = {
        name: Cell(name, kind, "of the sensor", study()["gfrf"]["tracker"], "film")
        for name in actuators
    }
    table = rows(
        [
            counted(
                cells[name], [one for (of, *_), one in zip(jobs, done, strict=True) if of == name]
            )
            for name in actuators
        ]
    )
    lines, text = written(table, given.output)
    if given.store:
        asked = {"COUNT": given.count, "SEED": given.seed}
        values = {name.lower(): value for name, value in asked.items()}
        store("coverage_film", command("coverage-film", **asked), {**values, "table": lines})
    print(text)


if __name__ == "__main__":
    command_line.run(main)
