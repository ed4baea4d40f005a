"""Recursive least squares: half an hour against SysIdentPy's, one sample against padasip's."""

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.row import Row
from dea.control import OnlineTracker
from dea.narx import NarxModel, load_published, regressor_matrix
from dea.tracking import recursive_least_squares, root_mean_square

SAMPLES, TERMS, FORGETTING, REPEATS = 90_000, 10, 0.999, 5
TARGET = 20.0
ONLINE_SAMPLES, ONLINE_TARGET = 20_000, 2.0
BUDGET = 20e-6  # s for one sample, a thousandth of the sampling period
PLANT = "DEA2"  # ten terms

PEER = """
import sys, time
import numpy as np
from sysidentpy.parameter_estimation import RecursiveLeastSquares
problem = np.load(sys.argv[1])
Phi, y = problem["Phi"], problem["y"][:, None]
estimator = RecursiveLeastSquares(lam=float(sys.argv[2]))
seconds = []
for _ in range(2):
    start = time.perf_counter()
    theta = estimator.optimize(Phi, y)
    seconds.append(time.perf_counter() - start)
print(min(seconds), *theta.ravel())
"""


ONLINE_PEER = """
import sys, time
import numpy as np
import padasip
problem = np.load(sys.argv[1])
rows, y = problem["Phi"], problem["y"]
tracker = padasip.filters.FilterRLS(rows.shape[1], mu=float(sys.argv[2]), eps=1.0)
tracker.w = problem["theta"].copy()
start = time.perf_counter()
for row, output in zip(rows, y):
    tracker.adapt(output, row)
print((time.perf_counter() - start) / y.size, *tracker.w)
"""


def run(peers_python: Path) -> list[Row]:
    """Time ours and the peers on the same data: the best of several runs, without compilation.

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
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        found = recursive_least_squares(Phi, y, forgetting=FORGETTING)
        seconds.append(time.perf_counter() - start)
    peer, theta = _peer(peers_python, PEER, Phi=Phi, y=y)
    np.testing.assert_allclose(found.theta[-1], theta, rtol=1e-6)
    name = f"recursive least squares, {SAMPLES} x {TERMS}, against SysIdentPy"
    return [Row.of_times(name, min(seconds), peer, TARGET), *_online(peers_python)]


def _online(peers_python: Path) -> list[Row]:
    """Time one sample of the tracker beside a device; the peer is given the regressors."""
    published = Path(__file__).parents[1] / "config" / "published_models.yaml"
    plant: NarxModel = load_published(published)[PLANT]
    rng = np.random.default_rng(0)
    u = rng.uniform(-0.7, 0.7, ONLINE_SAMPLES)
    y = plant.simulate(u) + 1e-3 * rng.standard_normal(ONLINE_SAMPLES)
    samples = list(zip(u.tolist(), y.tolist(), strict=True))
    OnlineTracker.of_record(plant, u, y).update(*samples[0])
    seconds = []
    for _ in range(REPEATS):
        tracker = OnlineTracker.of_record(plant, u, y, forgetting=FORGETTING, leakage=0.0)
        start = time.perf_counter()
        for sample in samples:
            tracker.update(*sample)
        seconds.append((time.perf_counter() - start) / ONLINE_SAMPLES)
    Phi = regressor_matrix(plant.terms, u, y)
    scale = root_mean_square(Phi)
    peer, theta = _peer(
        peers_python,
        ONLINE_PEER,
        Phi=Phi / scale,
        y=y[plant.max_lag :],
        theta=plant.parameters * scale,
    )
    np.testing.assert_allclose(tracker.parameters * scale, theta, rtol=1e-6, atol=1e-8)
    ours, terms = min(seconds), len(plant.terms)
    detail = f"{1e6 * ours:.1f} µs for one sample of {terms} terms, padasip {1e6 * peer:.1f} µs"
    return [
        Row.of_times("one sample online, against padasip", ours, peer, ONLINE_TARGET, detail),
        Row.of_times("one sample online, against its budget", ours, BUDGET, 1.0),
    ]


def _peer(python: Path, program: str, **problem: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the time of a peer's program in s, and the parameters that it finds."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "problem.npz")
        np.savez(file, **problem)
        command = [str(python), "-c", program, str(file), str(FORGETTING)]
        output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    seconds, *theta = map(float, output.split())
    return seconds, np.array(theta)
