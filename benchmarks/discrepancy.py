"""Time of a free run of the membrane compared with LSODA's, and of a diagnosis of half an hour."""

import time
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp

from benchmarks.row import Row
from benchmarks.timing import shortest
from dea.arrays import Array
from dea.discrepancy import diagnose
from dea.excitation import design
from dea.plant import Rig
from dea.plant.parameters import read_parameters
from dea.simulation import ExtendedSimulation, load_simulation

RATE = 50.0
PIECE, REPEATS = 1000, 5
TARGET_SIMULATION = 100.0
LONGEST_DIAGNOSIS = 60.0  # s, of thirty minutes
BENCH, ACTUATOR = Path("config/bench.yaml"), "dea5"


def run(peers_python: Path) -> list[Row]:
    """Return both rows, timed without compilation; ``peers_python`` is not used."""
    return [_simulation(), _diagnosis()]


def _simulation() -> Row:
    own = load_simulation("dea_membrane")
    extended = ExtendedSimulation(own)
    values = extended.layout.prior_means
    u = _volts(PIECE / RATE)
    extended.simulate(values, u, 1.0 / RATE)
    y, seconds = shortest(partial(extended.simulate, values, u, 1.0 / RATE), REPEATS)

    def slopes(t: float, x: Array, level: float) -> Array:
        own.compiled_derivative(x, level, own.nominal, dx := np.empty(x.size))
        return dx

    def by_lsoda() -> Array:
        x = np.array([state.initial for state in own.states])
        x = solve_ivp(slopes, (0.0, own.lead_in), x, "LSODA", args=(u[0],)).y[:, -1]
        outputs = np.empty(PIECE)
        for k, level in enumerate(u):
            outputs[k] = own.compiled_output(x, level, own.nominal)
            x = solve_ivp(slopes, (0.0, 1.0 / RATE), x, "LSODA", args=(level,)).y[:, -1]
        return outputs

    expected, peer = shortest(by_lsoda, REPEATS)
    np.testing.assert_allclose(y, expected, atol=2e-3 * np.ptp(expected))
    name = f"free run of the membrane, {PIECE} samples, against LSODA"
    return Row.of_times(name, seconds, peer, TARGET_SIMULATION)


def _diagnosis() -> Row:
    record = _half_an_hour()
    warm = record.isel(time=slice(0, 5000))
    diagnose(warm, "dea_membrane", workers=2)
    start = time.perf_counter()
    found = diagnose(record, "dea_membrane", workers=2)
    seconds = time.perf_counter() - start
    name = f"diagnosis of {record.time.size} samples on two threads, against a minute"
    return Row.of_times(name, seconds, LONGEST_DIAGNOSIS, 1.0, found.verdict.sentence)


def _volts(duration: float) -> Array:
    return design(
        "gaussian", duration=duration, sampling_rate=RATE, low=1.1, high=3.75, seed=2, band=1.0
    )


def _half_an_hour() -> xr.Dataset:
    parameters = read_parameters(BENCH, ACTUATOR)
    volts = _volts(1800.0)
    counts = parameters.output_converter.to_counts(volts)
    moved = Rig(parameters, seed=3).respond(counts)
    moved = moved + parameters.sensor.noise * np.random.default_rng(4).standard_normal(moved.size)
    return xr.Dataset(
        {
            "voltage": ("time", volts, {"units": "V"}),
            "displacement": ("time", 1e3 * moved, {"units": "mm"}),
        },
        {"time": ("time", np.arange(volts.size) / RATE, {"units": "s"})},
        {"sampling_rate": RATE},
    )
