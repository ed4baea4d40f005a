"""Term selection and free-run simulation against SysIdentPy's MetaMSS and ``predict``.

The records are those of the six published models under the study's excitation, with one per cent
of noise on the output. Both packages choose from the same 84 candidate terms on the same 5,000
samples and are scored by the free run on the same independent record without noise. Our model may
have no more terms than the peer's. Times are processor seconds of one core; ours is the best of
several repetitions.
"""

import json
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.row import Row
from dea.excitation import design
from dea.narx import NarxModel, load_published, nmse, select_terms

Array = NDArray[np.float64]

SAMPLES, NOISE, REPEATS = 5_000, 0.01, 5
LONG_RUN = 200_000  # samples; 5,000 are simulated too quickly to be timed
THRESHOLD = 3e-6
SELECTION_TARGET, SIMULATION_TARGET = 30.0, 100.0
SEARCHES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("forward selection and pruning", {"refine": False}),
    ("with six refining rounds", {"refine": True, "rounds": 6}),
)
MODELS = Path(__file__).parents[1] / "config" / "published_models.yaml"

PEER = """
import json, sys, time, warnings
import numpy as np
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import MetaMSS
from sysidentpy.parameter_estimation import LeastSquares
warnings.simplefilter("ignore")
data = np.load(sys.argv[1])
u, y, u_test, y_test = (data[name][:, None] for name in ("u", "y", "u_test", "y_test"))
model = MetaMSS(norm=-2, xlag=[1, 2, 3], ylag=[1, 2, 3], estimator=LeastSquares(),
                basis_function=Polynomial(degree=3), maxiter=30, n_agents=10, random_state=1)
start = time.process_time()
model.fit(X=u, y=y)
selection = time.process_time() - start
seconds = []
for _ in range(3):
    start = time.process_time()
    run = model.predict(X=u_test, y=y_test[:3])
    seconds.append(time.process_time() - start)
print(json.dumps({"selection": selection, "simulation": min(seconds), "run": run.ravel().tolist(),
                  "terms": len(model.final_model)}))
"""


class Case(NamedTuple):
    """A record to identify from and one to test on; shape (SAMPLES,) each."""

    u: Array
    y: Array
    u_test: Array
    y_test: Array


def run(peers_python: Path) -> list[Row]:
    """Return a row for each search and one for simulation; compilation is not timed."""
    plants = load_published(MODELS)
    cases = {name: _record(plant, number) for number, (name, plant) in enumerate(plants.items())}
    for _, search in SEARCHES:
        select_terms(cases["DEA1"].u, cases["DEA1"].y, **search)
    peers = {name: _peer(peers_python, case) for name, case in cases.items()}
    peer = sum(each["selection"] for each in peers.values())
    rows = []
    for label, search in SEARCHES:
        seconds, details, better = 0.0, [], 0
        for name, (u, y, u_test, y_test) in cases.items():
            settings = {
                **search,
                "max_terms": peers[name]["terms"],
                "add_threshold": THRESHOLD,
                "prune_threshold": THRESHOLD,
            }
            times = []
            for _ in range(REPEATS):
                start = time.process_time()
                found = select_terms(u, y, **settings)
                times.append(time.process_time() - start)
            seconds += min(times)
            error = nmse(y_test[3:], found.simulate(u_test, y_test)[3:])
            theirs = _error(y_test[3:], np.array(peers[name]["run"])[3:])
            better += error < theirs
            terms = f"{len(found.terms)}/{peers[name]['terms']}"
            details.append(f"{name} {error:.1e}/{theirs:.1e} {terms}")
        rows.append(
            Row.of_times(
                f"{label}, {len(cases)} x {SAMPLES}, against MetaMSS",
                seconds,
                peer,
                SELECTION_TARGET,
                f"free-run nmse lower on {better} of {len(cases)}; nmse and terms, ours/peer: "
                + ", ".join(details),
            )
        )
    return [*rows, _simulation(plants["DEA2"], cases["DEA2"], peers["DEA2"])]


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
    offset = y.mean()  # the peer does not centre its signals
    noisy = y + NOISE * y.std() * rng.standard_normal(SAMPLES)
    return Case(u, noisy - offset, u_test, y_test - offset)


def _peer(python: Path, case: Case) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "record.npz"
        np.savez(file, u=case.u, y=case.y, u_test=case.u_test, y_test=case.y_test)
        command = [str(python), "-c", PEER, str(file)]
        done = subprocess.run(command, capture_output=True, check=True)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def _error(measured: Array, run: Array) -> float:
    """Return the nmse of a peer's run; a diverged run is NaN and its error infinite."""
    return nmse(measured, run) if np.isfinite(run).all() else np.inf
