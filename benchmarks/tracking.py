"""Recursive least squares: half an hour against SysIdentPy's, one sample against padasip's."""

import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.command_line import peer as said_by
from benchmarks.row import Row
from benchmarks.timing import shortest
from dea.control import OnlineTracker
from dea.narx import NarxModel, load_published, regressor_matrix
from dea.tracking import recursive_least_squares, root_mean_square

SAMPLES, TERMS, FORGETTING, REPEATS = 90_000, 10, 0.999, 5
TARGET = 20.0
ONLINE_SAMPLES, ONLINE_TARGET = 20_000, 2.0
BUDGET = 20e-6  # s for one sample, a thousandth of the sampling period
PLANT = "DEA2"  # ten terms

# Both take the file of a problem, the forgetting factor and how often they are timed, and print the
# shortest time of the processor in s and the parameters.
PEER = """
import sys, time
import numpy as np
from sysidentpy.parameter_estimation import RecursiveLeastSquares
problem = np.load(sys.argv[1])
Phi, y = problem["Phi"], problem["y"][:, None]
estimator = RecursiveLeastSquares(lam=float(sys.argv[2]))
seconds = []
for _ in range(int(sys.argv[3])):
    start = time.process_time()
    theta = estimator.optimize(Phi, y)
    seconds.append(time.process_time() - start)
print(min(seconds), *theta.ravel())
"""


ONLINE_PEER = """
import sys, time
import numpy as np
import padasip
problem = np.load(sys.argv[1])
rows, y = problem["Phi"], problem["y"]
seconds = []
for _ in range(int(sys.argv[3])):
    tracker = padasip.filters.FilterRLS(rows.shape[1], mu=float(sys.argv[2]), eps=1.0)
    tracker.w = problem["theta"].copy()
    start = time.process_time()
    for row, output in zip(rows, y):
        tracker.adapt(output, row)
    seconds.append(time.process_time() - start)
print(min(seconds) / y.size, *tracker.w)
"""


def run(peers_python: Path) -> list[Row]:
    """Time ours and the peers on the same data, without compilation: the shortest of as many runs.

    ``peers_python`` is the interpreter of an environment that holds SysIdentPy and padasip.

    Raises
    ------
    AssertionError
        If two do not find the same parameters.
    """
    rng = np.random.default_rng(0)
    Phi = rng.standard_normal((SAMPLES, TERMS))
    y = Phi @ rng.standard_normal(TERMS) + 0.1 * rng.standard_normal(SAMPLES)
    recursive_least_squares(Phi[:10], y[:10], forgetting=FORGETTING)
    task = partial(recursive_least_squares, Phi, y, forgetting=FORGETTING)
    found, seconds = shortest(task, REPEATS)
    peer, theta = _peer("SysIdentPy", peers_python, PEER, Phi=Phi, y=y)
    np.testing.assert_allclose(found.theta[-1], theta, rtol=1e-6)
    name = f"recursive least squares, {SAMPLES} x {TERMS}, against SysIdentPy"
    return [Row.of_times(name, seconds, peer, TARGET), *_online(peers_python)]


def _online(peers_python: Path) -> list[Row]:
    """Time one sample of the tracker beside a device; the peer is given the regressors."""
    published = Path(__file__).parents[1] / "config" / "published_models.yaml"
    plant: NarxModel = load_published(published)[PLANT]
    rng = np.random.default_rng(0)
    u = rng.uniform(-0.7, 0.7, ONLINE_SAMPLES)
    y = plant.simulate(u) + 1e-3 * rng.standard_normal(ONLINE_SAMPLES)
    samples = list(zip(u.tolist(), y.tolist(), strict=True))
    OnlineTracker.of_record(plant, u, y).update(*samples[0])
    made = partial(OnlineTracker.of_record, plant, u, y, forgetting=FORGETTING, leakage=0.0)
    trackers = iter([made() for _ in range(REPEATS)])

    def followed() -> OnlineTracker:
        tracker = next(trackers)
        for sample in samples:
            tracker.update(*sample)
        return tracker

    tracker, seconds = shortest(followed, REPEATS)
    Phi = regressor_matrix(plant.terms, u, y)
    scale = root_mean_square(Phi)
    peer, theta = _peer(
        "padasip",
        peers_python,
        ONLINE_PEER,
        Phi=Phi / scale,
        y=y[plant.max_lag :],
        theta=plant.parameters * scale,
    )
    np.testing.assert_allclose(tracker.parameters * scale, theta, rtol=1e-6, atol=1e-8)
    ours, what = seconds / ONLINE_SAMPLES, f"one sample online, {len(plant.terms)} terms"
    return [
        Row.of_times(f"{what}, against padasip", ours, peer, ONLINE_TARGET),
        Row.of_times(f"{what}, against its budget", ours, BUDGET, 1.0),
    ]


def _peer(name: str, python: Path, program: str, **problem: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the time of a peer's program in s, and the parameters that it finds.

    Raises
    ------
    PeerError
        If it fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "problem.npz")
        np.savez(file, allow_pickle=False, **problem)
        given = [str(file), str(FORGETTING), str(REPEATS)]
        output = said_by(name, [str(python), "-c", program, *given])
    seconds, *theta = map(float, output.split())
    return seconds, np.array(theta)
