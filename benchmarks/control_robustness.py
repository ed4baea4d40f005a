"""The adaptive inverse on drawn actuators under disturbances: followed, stopped, or off.

Each actuator is one of the study's with other moduli, permittivity and rest. Its controller has the
model that was identified from the study's actuator, so that no model is quite right. The bench is
driven in this process, sample by sample, without the link; limits and rate are checked here.
"""

import argparse
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from benchmarks.command_line import add_store, positive, run, seed_number
from benchmarks.stored import command
from benchmarks.stored import store as keep
from dea import store
from dea.arrays import Array
from dea.configuration.bench import BENCH
from dea.configuration.files import read_yaml
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.control import AdaptiveInverse, ControllerDesign, LostError
from dea.narx import NarxModel
from dea.plant import Parameters, Rig, read_parameters
from dea.seeds import generator

RESULTS, TABLE = Path("results"), Path("results/tables/control_robustness.csv")
TURN = 7.0  # s: each kind of reference once
FOLLOWED = 0.05  # of the stroke, up to which an RMS error counts as following
SPREAD = 0.05  # standard deviation of the logarithm of a drawn parameter
LOAD = 0.1  # of the stroke, of step disturbances
DROPPED = (500, 550)  # samples without a reading: a second
EVENT = 600  # the sample that comes late, and the first of the step disturbance
LATE = 5  # periods by which it is late
AGED = 1800.0  # s: as long as the record that the model is of
AGEING = ("stiffness_ageing", "leakage_ageing", "electrode_ageing")


class Scenario(NamedTuple):
    """What is done to an actuator: to its parameters, its output, its sensor, its time, its model.

    ``load`` moves the output by a share of the stroke, as a push would. ``sensor`` says what the
    controller gets to see of it, and moves nothing.
    """

    parameters: Callable[[Parameters], Parameters] = lambda parameters: parameters
    load: Callable[[int], float] = lambda sample: 0.0
    sensor: Callable[[int, float], float] = lambda sample, measured: measured
    late: int | None = None
    foreign: bool = False


def aged(parameters: Parameters) -> Parameters:
    """Return an actuator that ages twice as fast, and has done so for AGED before it is driven."""
    film = parameters.film
    stiffness, leakage, electrode = (2.0 * getattr(film, name) for name in AGEING)
    hours = AGED / 3600.0
    stiffer, leakier, drier = (1.0 + rate * hours for rate in (stiffness, leakage, electrode))
    moduli = {f"yeoh_{k}": stiffer * getattr(film, f"yeoh_{k}") for k in (1, 2, 3)}
    film = film._replace(
        **moduli,
        branch_modulus=stiffer * film.branch_modulus,
        leak_resistance=film.leak_resistance / leakier,
        electrode_resistance=film.electrode_resistance * drier,
        stiffness_ageing=stiffness / stiffer,
        leakage_ageing=leakage / leakier,
        electrode_ageing=electrode / drier,
    )
    return replace(parameters, film=film)


def _loaded(sample: int) -> float:
    return LOAD * (EVENT <= sample < EVENT + 250)


def _dropped(sample: int, measured: float) -> float:
    return np.nan if DROPPED[0] <= sample < DROPPED[1] else measured


SCENARIOS = {
    "undisturbed": Scenario(),
    "step disturbances": Scenario(load=_loaded),
    "sensor dropped for a second": Scenario(sensor=_dropped),
    "late sample": Scenario(late=EVENT),
    "aged, and ages twice as fast": Scenario(parameters=aged),
    "model of another actuator": Scenario(foreign=True),
}


class Outcome(NamedTuple):
    """RMS error over the stroke (NaN if stopped), whether a limit was violated, what stopped it."""

    error: float
    violated: bool
    stopped: str


def drawn(actuator: str, number: int, seed: int) -> Parameters:
    """Return an actuator of the study with moduli, permittivity and rest of its own."""
    parameters = read_parameters(Path(BENCH), actuator)
    rng = generator(seed, "control robustness", str(number))
    stiffer, permittivity, rest = np.exp(SPREAD * rng.standard_normal(3)).tolist()
    film = parameters.film
    moduli = {f"yeoh_{k}": stiffer * getattr(film, f"yeoh_{k}") for k in (1, 2, 3)}
    film = film._replace(
        **moduli,
        branch_modulus=stiffer * film.branch_modulus,
        permittivity=permittivity * film.permittivity,
    )
    return replace(parameters, film=film, rest=rest * parameters.rest)


def tried(parameters: Parameters, design: ControllerDesign, controller: AdaptiveInverse,
          scenario: Scenario, seed: int) -> Outcome:  # fmt: skip
    """Follow the reference once; the error is of every sample, seen or not."""
    task, rig = design.task, Rig(scenario.parameters(parameters), seed)
    output, sensor = parameters.output_converter, parameters.displacement_converter

    def advance(volts: Array) -> float:
        _, measured = rig.advance(output.to_counts(volts))
        return float(sensor.to_values(measured)[-1])

    ramp = np.linspace(0.0, task.start, round(task.start * design.sampling_rate))
    measured, volts, outputs = advance(ramp), [task.start], []
    for sample in range(task.reference.size):
        try:
            volts.append(controller(scenario.sensor(sample, measured)))
        except LostError as lost:
            return Outcome(np.nan, violated(volts, design), str(lost))
        periods = 1 + LATE * (sample == scenario.late)
        measured = advance(np.full(periods, volts[-1])) + scenario.load(sample) * task.stroke
        outputs.append(measured)
    lead = sum(task.run_in)
    error = (np.array(outputs) - controller.reference)[lead:] / task.stroke
    return Outcome(float(np.sqrt(np.mean(error**2))), violated(volts, design), "")


def violated(volts: list[float], design: ControllerDesign) -> bool:
    """Return whether a voltage is outside the limits, changes too fast, or is no number."""
    (low, high), small = design.task.limits, 1e-9
    step = design.settings["rate"] / design.sampling_rate
    given = np.array(volts)
    within = (low - small <= given) & (given <= high + small)
    return not (within.all() and np.all(np.abs(np.diff(given)) <= step + small))


def designs(
    settings: Mapping[str, Any], actuators: list[str], seed: int
) -> dict[str, ControllerDesign]:
    """Return the design for each actuator that has a model, with a short reference."""
    short = dict(settings) | {
        "duration": 3 * TURN,
        "reference": dict(settings["reference"]) | {"turn": TURN},
    }
    found = {}
    for name in actuators:
        folder = RESULTS / name
        signals = store.signals(store.read_record(folder / "record.nc"))
        rate = float(f"{signals.sampling_rate:.9g}")
        model = NarxModel.load(folder / "model.nc")
        found[name] = ControllerDesign.of_record(model, signals.u, signals.y, rate, short, seed)
    return found


def campaign(count: int, seed: int) -> Iterator[tuple[str, Outcome]]:
    """Yield the outcome of every scenario on each of ``count`` drawn actuators."""
    study = check_study(read_yaml(FILE, what="the configuration", example=FILE))
    names = [actuator.name for actuator in study.actuators if actuator.bench]
    benches = {actuator.name: str(actuator.bench) for actuator in study.actuators}
    designed = designs(written(study)["control"], names, seed)
    gains = {name: design.gains() for name, design in designed.items()}
    for number in range(count):
        name = names[number % len(names)]
        other = names[(number + 1) % len(names)]
        parameters = drawn(benches[name], number, seed)
        for label, scenario in SCENARIOS.items():
            own = designed[name]
            source = designed[other] if scenario.foreign else own
            # A foreign model follows what the actuator itself can reach.
            design = replace(source, task=own.task)
            controller = design.adaptive(gains[other if scenario.foreign else name])
            yield label, tried(parameters, design, controller, scenario, seed + number)


def table(outcomes: list[tuple[str, Outcome]]) -> pd.DataFrame:
    """Return a row for each scenario."""
    rows = []
    for label in SCENARIOS:
        found = [outcome for name, outcome in outcomes if name == label]
        errors = np.array([each.error for each in found if not each.stopped])
        rows.append(
            {
                "scenario": label,
                "actuators": len(found),
                "followed": int((errors <= FOLLOWED).sum()),
                "off": int((~(errors <= FOLLOWED)).sum()),  # or no number
                "stopped": sum(bool(each.stopped) for each in found),
                "limit violated": sum(each.violated for each in found),
                "median error (%)": 100.0 * float(np.median(errors)) if errors.size else np.nan,
                "95 % below (%)": (
                    100.0 * float(np.quantile(errors, 0.95)) if errors.size else np.nan
                ),
            }
        )
    return pd.DataFrame(rows)


def main(arguments: list[str] | None = None) -> None:
    """Run the campaign, write its table, and print it."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.control_robustness", description=__doc__
    )
    parser.add_argument("--count", type=positive, default=100, help="actuators drawn")
    parser.add_argument("--seed", type=seed_number, default=1)
    add_store(parser)
    options = parser.parse_args(arguments)
    found = table(list(campaign(options.count, options.seed)))
    TABLE.parent.mkdir(parents=True, exist_ok=True)
    with store.atomic(TABLE) as partial:
        found.to_csv(partial, index=False)
    lines = found.round(2).to_markdown(index=False)
    if options.store:
        values = {
            "count": options.count,
            "seed": options.seed,
            "table": lines.splitlines(),
            "followed": dict(zip(found["scenario"], found["followed"].tolist(), strict=True)),
            "stopped": int(found["stopped"].sum()),
            "violated": int(found["limit violated"].sum()),
            "trials": int(found["actuators"].sum()),
        }
        made_by = command("control-robustness", COUNT=options.count, SEED=options.seed)
        keep("control_robustness", made_by, values)
    print(lines)


if __name__ == "__main__":
    run(main)
