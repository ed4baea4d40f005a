"""Term selection and free-run simulation against other packages.

The records are those of the six published models under the study's excitation, with one per cent
of noise on the output. All packages choose from the same 84 candidate terms on the same 5,000
samples and are scored by the free run on the same independent record without noise. A search of
ours has at most as many terms as the peer it is compared with. Times are processor seconds of one
core, without compilation and import; ours is the best of several repetitions.

The peers: MetaMSS and FROLS of SysIdentPy (the number of terms by its information criterion), and
the NARX models of fastcan with as many terms as FROLS took.
"""

import json
import subprocess
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.row import Row
from dea.excitation import design
from dea.narx import (
    Forward,
    NarxModel,
    Orthogonal,
    Refined,
    UnstableModel,
    load_published,
    nmse,
    select_terms,
)

Array = NDArray[np.float64]
Search = Forward | Orthogonal | Refined

SAMPLES, NOISE, REPEATS = 5_000, 0.01, 3
LONG_RUN = 200_000  # samples; 5,000 are simulated too quickly to be timed
THRESHOLD = 3e-6
SIMULATION_TARGET = 100.0
MODELS = Path(__file__).parents[1] / "config" / "published_models.yaml"
PEERS = Path(__file__).parent / "peers"


class Comparison(NamedTuple):
    """A search of ours, the peer it is set against, and how many times faster it has to be."""

    label: str
    search: Callable[[int], Search]  # with at most so many terms
    peer: str
    target: float


COMPARISONS = (
    Comparison(
        "forward selection", lambda most: Forward(THRESHOLD, THRESHOLD, most), "MetaMSS", 30.0
    ),
    Comparison("forward selection", lambda most: Forward(THRESHOLD, THRESHOLD, most), "FROLS", 0.2),
    Comparison("orthogonal search", Orthogonal, "FROLS", 1.0),
    Comparison("orthogonal search", Orthogonal, "fastcan", 0.2),
    Comparison("refined search", lambda most: Refined(THRESHOLD, 200, most), "MetaMSS", 5.0),
    Comparison("refined search by its defaults", lambda _: Refined(), "MetaMSS", 1.0),
)


class Case(NamedTuple):
    """A record to identify from and one to test on; shape (SAMPLES,) each."""

    u: Array
    y: Array
    u_test: Array
    y_test: Array


def run(peers_python: Path) -> list[Row]:
    """Return a row for each comparison and one for simulation; compilation is not timed."""
    warnings.simplefilter("ignore", UnstableModel)  # their errors are in the table
    plants = load_published(MODELS)
    cases = {name: _record(plant, number) for number, (name, plant) in enumerate(plants.items())}
    first = next(iter(cases.values()))
    for search in (Forward(), Orthogonal(), Refined(THRESHOLD)):
        select_terms(first.u[:500], first.y[:500], search=search)
    peers = {name: _peers(peers_python, case) for name, case in cases.items()}
    rows = [_compared(comparison, cases, peers) for comparison in COMPARISONS]
    return [*rows, _simulation(plants["DEA2"], cases["DEA2"], peers["DEA2"])]


def _compared(
    comparison: Comparison, cases: dict[str, Case], peers: dict[str, dict[str, Any]]
) -> Row:
    label, search, peer, target = comparison
    seconds, theirs, details, lost = 0.0, 0.0, [], []
    for name, (u, y, u_test, y_test) in cases.items():
        result = peers[name][peer]
        theirs += result["seconds"]
        times = []
        for _ in range(REPEATS):
            start = time.process_time()
            found = select_terms(u, y, search=search(result["terms"]))
            times.append(time.process_time() - start)
        seconds += min(times)
        error = nmse(y_test[3:], found.simulate(u_test, y_test)[3:])
        other = _error(y_test[3:], np.array(result["run"], dtype=float)[3:])
        if not error < other:
            lost.append(name)
        details.append(f"{name} {error:.1e}/{other:.1e} {len(found.terms)}/{result['terms']}")
    return Row.of_times(
        f"{label}, {len(cases)} x {SAMPLES}, against {peer}",
        seconds,
        theirs,
        target,
        "free-run nmse and terms, ours/peer: " + ", ".join(details),
        tuple(lost),
    )


def _simulation(plant: NarxModel, case: Case, peer: dict[str, Any]) -> Row:
    """Compare the simulation speeds; the times in the row are seconds per million samples."""
    u = np.resize(case.u_test, LONG_RUN)
    plant.simulate(u)
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        plant.simulate(u)
        times.append(time.process_time() - start)
    ours = min(times) / LONG_RUN * 1e6
    theirs = peer["simulation"] / case.u_test.size * 1e6
    name = "free-run simulation of a million samples, against predict"
    return Row.of_times(name, ours, theirs, SIMULATION_TARGET)


def _record(plant: NarxModel, number: int) -> Case:
    rng = np.random.default_rng(number)
    u, u_test = (
        design("gaussian", duration=SAMPLES / 50, sampling_rate=50, low=-1, high=1, seed=seed)
        for seed in (2 * number, 2 * number + 1)
    )
    y, y_test = plant.simulate(u), plant.simulate(u_test)
    offset = y.mean()  # the peers do not centre their signals
    noisy = y + NOISE * y.std() * rng.standard_normal(SAMPLES)
    return Case(u, noisy - offset, u_test, y_test - offset)


def _peers(python: Path, case: Case) -> dict[str, Any]:
    """Return seconds, terms and run of each peer on one record."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "record.npz"
        np.savez(file, u=case.u, y=case.y, u_test=case.u_test, y_test=case.y_test)
        command = [str(python), str(PEERS / "identification.py"), str(file)]
        done = subprocess.run(command, capture_output=True, check=True)
    result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return result


def _error(measured: Array, run: Array) -> float:
    """Return the nmse of a peer's run; a diverged run is NaN and its error infinite."""
    return nmse(measured, run) if np.isfinite(run).all() else np.inf
