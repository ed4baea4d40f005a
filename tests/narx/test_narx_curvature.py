"""How far the free run is from linear at the ends of an estimate's interval."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from dea.narx import curvature, fit_free_runs
from dea.terms import Term

SAMPLES, NOISE = 300, 0.3


def record(seed=1):
    rng = np.random.default_rng(seed)
    u = rng.standard_normal(SAMPLES)
    y = np.zeros(SAMPLES)
    for t in range(1, SAMPLES):
        y[t] = 0.9 * y[t - 1] + u[t - 1]
    return u, y + NOISE * rng.standard_normal(SAMPLES)


def test_a_run_that_is_linear_in_its_parameters_has_none():
    terms = (Term.parse("u(t-1)"), Term.parse("u(t-1)^3"))
    segment = record()
    fit = fit_free_runs(terms, np.array([0.5, 0.1]), [segment], trend=2)
    assert curvature(fit) < 1e-10


def test_of_one_pole_it_is_that_of_the_run_written_out():
    """One parameter beside the output that the run starts from, by differences of a plain loop."""
    terms = (Term.parse("y(t-1)"),)
    u, y = record()
    y = 3.0 * 0.9 ** np.arange(SAMPLES) + 0.05 * np.random.default_rng(2).standard_normal(SAMPLES)
    fit = fit_free_runs(terms, np.array([0.85]), [(u, y)])

    def run(x):
        return x[1] * x[0] ** np.arange(SAMPLES)

    slope = np.stack([approx_fprime(fit.unknowns, lambda x, t=t: run(x)[t], 1e-7)
                      for t in range(SAMPLES)])  # fmt: skip
    move = 2.0 * np.sqrt(fit.covariance[0, 0])
    step = move * np.array([1.0, -(slope[:, 1] @ slope[:, 0]) / (slope[:, 1] @ slope[:, 1])])
    linear = slope @ step
    apart = [run(fit.unknowns + s * step) - run(fit.unknowns) - s * linear for s in (1.0, -1.0)]
    expected = max(map(np.linalg.norm, apart)) / np.linalg.norm(linear)
    assert expected > 1e-3
    assert curvature(fit) == pytest.approx(expected, rel=1e-3)


def test_it_falls_with_the_noise():
    terms = (Term.parse("y(t-1)"), Term.parse("u(t-1)"))
    u, y = record()
    clean = y - NOISE * np.random.default_rng(1).standard_normal(SAMPLES)
    found = []
    for noise in (0.1, 0.01):
        noisy = clean + noise * np.random.default_rng(3).standard_normal(SAMPLES)
        fit = fit_free_runs(terms, np.array([0.8, 1.0]), [(u, noisy)])
        found.append(curvature(fit))
    assert found[1] < found[0]


def test_an_estimate_whose_run_diverges_has_no_bound():
    terms = (Term.parse("y(t-1)"), Term.parse("u(t-1)"))
    segment = record()
    fit = fit_free_runs(terms, np.array([4.0, 1.0]), [segment])
    assert not np.isfinite(fit.msse)
    assert curvature(fit) == np.inf


def test_terms_that_the_record_cannot_tell_apart_have_none_either():
    terms = (Term.parse("u(t-1)"), Term.parse("u(t-1)^3"))
    u = np.sign(record()[0])  # of a binary input the cube is the input itself
    y = np.append(0.0, 2.0 * u[:-1]) + 0.1 * record(4)[0]
    fit = fit_free_runs(terms, np.array([1.0, 1.0]), [(u, y)])
    assert curvature(fit) == np.inf
