"""Term selection and free-run simulation against other packages.

The records are those of the six published models under the study's excitation, with one per cent
of noise on the output. All packages choose from the same 84 candidate terms on the same 5,000
samples and are scored by the free run on the same independent record without noise. A search of
ours has at most as many terms as the peer it is compared with, save the one by its defaults, which
decides on their number itself, as MetaMSS does. Times are processor seconds of one core, without
compilation and import, each the shortest of several.

The peers: MetaMSS of SysIdentPy; its FROLS, with as many terms as its information criterion takes,
at most 15; and the NARX models of fastcan with as many terms as FROLS took, and a constant.
"""

import json
import tempfile
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.command_line import peer as said_by
from benchmarks.row import Row
from benchmarks.timing import shortest
from dea.arrays import Array
from dea.excitation import design
from dea.narx import (
    Forward,
    NarxModel,
    Orthogonal,
    Refined,
    Scaling,
    UnstableModel,
    load_published,
    nmse,
    select_terms,
)
from dea.terms import Term

Search = Forward | Orthogonal | Refined

SAMPLES, NOISE, REPEATS = 5_000, 0.01, 3
CANDIDATES = 84  # products of at most three of three past outputs and three past inputs
THRESHOLD = 3e-6
SIMULATION_TARGET, SIMULATED = 100.0, "DEA2"
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
    return [*rows, _simulation(cases[SIMULATED], peers[SIMULATED])]


def _compared(
    comparison: Comparison, cases: dict[str, Case], peers: dict[str, dict[str, Any]]
) -> Row:
    label, search, peer, target = comparison
    seconds, theirs, found_of, lost = 0.0, 0.0, {}, []
    for name, (u, y, u_test, y_test) in cases.items():
        result = peers[name][peer]
        theirs += result["seconds"]
        limited = search(result["terms"])
        found, needed = shortest(partial(select_terms, u, y, search=limited), REPEATS)
        seconds += needed
        error = nmse(y_test[3:], found.simulate(u_test, y_test)[3:])
        other = _error(y_test[3:], np.array(result["run"], dtype=float)[3:])
        if not error < other:
            lost.append(name)
        found_of[name] = f"{error:.1e}/{other:.1e} {len(found.terms)}/{result['terms']}"
    return Row.of_times(
        f"{label}, {len(cases)} x {SAMPLES}, against {peer}",
        seconds,
        theirs,
        target,
        "free-run nmse and terms, ours/peer:",
        tuple(lost),
        found_of,
    )


def _simulation(case: Case, peers: dict[str, Any]) -> Row:
    """Compare the free runs of one model, the one that MetaMSS found.

    Raises
    ------
    AssertionError
        If both do not give the same output.
    """
    found = peers["simulation"]
    model = model_of(found["equation"], found["parameters"])
    model.simulate(case.u_test, case.y_test)
    run, seconds = shortest(partial(model.simulate, case.u_test, case.y_test), REPEATS)
    np.testing.assert_allclose(run, peers["MetaMSS"]["run"], rtol=1e-6, atol=1e-9)
    name = f"free run of {len(model.terms)} terms, {run.size} samples, against SysIdentPy's predict"
    return Row.of_times(name, seconds, found["seconds"], SIMULATION_TARGET)


def model_of(equation: Sequence[Sequence[int]], parameters: Sequence[float]) -> NarxModel:
    """Return the model of SysIdentPy's codes: lags of y above 1000, those of u above 2000."""
    texts = ("".join(f"{'yu'[code // 1000 - 1]}(t-{code % 1000})" for code in t) for t in equation)
    terms = tuple(Term.parse(text or "1") for text in texts)
    return NarxModel(terms, np.array(parameters), Scaling())


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
    """Return seconds, terms and run of each peer on one record.

    Raises
    ------
    PeerError
        If the program fails.
    AssertionError
        If a peer chooses from other candidates than ours.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "record.npz"
        np.savez(file, u=case.u, y=case.y, u_test=case.u_test, y_test=case.y_test)
        program = PEERS / "identification.py"
        output = said_by(program.name, [str(python), str(program), str(file), str(REPEATS)])
    result: dict[str, Any] = json.loads(output.splitlines()[-1])
    for name in {comparison.peer for comparison in COMPARISONS}:
        offered = result[name]["candidates"]
        assert offered == CANDIDATES, f"{name} chooses from {offered} candidates"
    return result


def _error(measured: Array, run: Array) -> float:
    """Return the nmse of a peer's run; a diverged run is NaN and its error infinite."""
    return nmse(measured, run) if np.isfinite(run).all() else np.inf
