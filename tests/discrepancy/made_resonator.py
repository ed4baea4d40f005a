"""A resonator with hidden effects, fits of it, and residuals that are given."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.fitting.fit import Fit, at
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.rules import Rules
from dea.simulation import (
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
)

INTERVAL, NOISE = 0.02, 0.002
SPRING = load_simulation("mass_spring_damper")
DEVICE = replace(
    SPRING,
    parameters=tuple(
        replace(each, nominal={"natural_frequency": 3.0, "damping_ratio": 0.5}.get(each.name, 1.0))
        for each in SPRING.parameters
    ),
)
PRESENT = {
    "slew_limit": {"rate": 20.0},
    "input_saturation": {"limit": 1.0},
    "dead_zone": {"threshold": 0.4},
    "sensor_lag": {"time_constant": 0.12},
    "stress_relaxation": {"relaxation": 0.3, "time": 10.0},
    "viscoelastic_creep": {"stiffness": 0.2},
    "charge_leakage": {"loss": 0.2, "field_growth": 3.0, "settling_time": 2.0},
}


class Predicted(HeldOut):
    """Held-out residuals that are given by a function of the fit."""

    def __init__(self, problem, residual):
        super().__init__(problem)
        self._given = residual

    def residual(self, fitted, beside=None):
        return self._given(fitted)


def hidden(*names, seed=1):
    """Return a problem in which the named effects are hidden, and the simulation without them."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-2, 2, 60), 25)
    extended = prepared(DEVICE, u, INTERVAL, 1e-4)
    values = extended.layout.prior_means
    everything = np.ones(u.size, bool)
    told = measured_scales(
        extended, values, Problem(u, u, INTERVAL, everything, everything, everything)
    )
    truth = extended
    for name in names:
        effect = catalogue()[name]
        truth = truth.attach(effect, told)
        own = dict(
            zip((p.name for p in effect.parameters(told)), effect.starts(told)[0], strict=True)
        )
        values = np.concatenate([values, list((own | PRESENT[name]).values())])
    y = truth.simulate(values, u, INTERVAL) + NOISE * rng.standard_normal(u.size)
    parts = split(u, INTERVAL, 0.1)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    return problem, extended


def graded():
    """Return evidence on a hidden dead zone, and what makes candidates of a given misfit."""
    problem, extended = hidden("dead_zone")
    plain = at(problem, extended, np.zeros(extended.layout.free.size))
    told = measured_scales(extended, extended.layout.prior_means, problem)
    u = problem.u / problem.u.std()
    noise = NOISE * np.random.default_rng(4).standard_normal(u.size)

    def candidate(size, *names):
        longer = extended
        for name in names:
            longer = longer.attach(catalogue()[name], told)
        residual = noise + NOISE * np.sqrt(size**2 - 1.0) * u**3 / (u**3).std()
        fitted = Fit(longer, np.zeros(longer.layout.free.size), residual, plain.jacobian, 0.0)
        return Candidate(fitted, problem.seen_rmse(residual), problem.seen_rmse(residual), 9.0)

    held_out = Predicted(problem, lambda fitted: fitted.residual)
    evidence = Evidence(
        problem, candidate(9.0).fit, held_out,
        [slice(k, k + 100) for k in range(0, 1500, 100)], NOISE, 0.0, Rules(misfit=1e-3),
        np.random.default_rng(5),
    )  # fmt: skip
    return evidence, candidate


def in_noise(size, *, follows=0.0):
    """Return coloured noise of so many floors beside white noise of one, (1500,).

    It ``follows`` the input of the record by so many floors.
    """
    problem, _ = hidden("dead_zone")
    rng = np.random.default_rng(12)
    slow = lfilter([1.0], [1.0, -0.95], rng.standard_normal(1500))
    white = rng.standard_normal(1500)
    u = problem.u / problem.u.std()
    return NOISE * (white + size * slow / slow.std() + follows * u)


def leaving(candidate, residual, *names):
    """Return a candidate that leaves a residual."""
    made = candidate(1.0, *names)
    rmse = float(np.sqrt(np.mean(residual**2)))
    return replace(made, fit=replace(made.fit, residual=residual), rmse=rmse, error=rmse)
