"""Recursive least squares against SysIdentPy's, over half an hour of ten regressors."""

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.row import Row
from dea.tracking import recursive_least_squares

SAMPLES, TERMS, FORGETTING, REPEATS = 90_000, 10, 0.999, 5
TARGET = 20.0

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


def run(peers_python: Path) -> list[Row]:
    """Time both on the same data: the best of several runs, without compilation.

    ``peers_python`` is the interpreter of an environment that holds SysIdentPy.

    Raises
    ------
    AssertionError
        If the two do not find the same parameters.
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
    with tempfile.TemporaryDirectory() as folder:
        problem = Path(folder, "problem.npz")
        np.savez(problem, Phi=Phi, y=y)
        command = [str(peers_python), "-c", PEER, str(problem), str(FORGETTING)]
        output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    peer, *theta = map(float, output.split())
    np.testing.assert_allclose(found.theta[-1], theta, rtol=1e-6)
    name = f"recursive least squares, {SAMPLES} x {TERMS}, against SysIdentPy"
    return [Row.of_times(name, min(seconds), peer, TARGET)]
