"""A force that no effect has is told from noise: carriages of another integrator."""

from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from dea.discrepancy import Settings, diagnose
from dea.discrepancy.evidence.colour import leaves_coloured_noise, predictable
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.evidence.unknown_force import unknown_force
from dea.discrepancy.fitting.fit import fit
from dea.discrepancy.problem.problem import Samples
from dea.discrepancy.problem.records import prepare
from dea.discrepancy.rules import Rules
from dea.simulation import ExtendedSimulation, load_simulation
from dea.simulation.signatures import DERIVATIVE
from dea.store import Record
from made_carriage import CARRIAGE

MOST = Rules().may_follow()

N, DT, NOISE = 1500, 0.02, 0.01
U = np.random.default_rng(1).uniform(-1.0, 1.0, N // 10 + 1).repeat(10)[:N]
OMEGA = 2.0 * np.pi * 1.5  # of the carriage, whose damping ratio is a half


def moved(force):
    """The positions under a further force of place and speed."""
    x, positions = np.zeros(2), []
    for u in U:
        positions.append(x[0])
        x = solve_ivp(
            lambda t, x, u=u: (x[1], OMEGA**2 * (u - x[0]) - OMEGA * x[1] + force(*x)),
            (0.0, DT), x, "LSODA", rtol=1e-8, atol=1e-10,
        ).y[:, -1]  # fmt: skip
    return np.array(positions)


def fitted(y):
    problem, _, extended = prepare([Samples(U, y, DT)], CARRIAGE, Settings())
    found = fit(problem, extended, np.zeros(extended.layout.free.size), iterations=30)
    return problem, found, problem.blocks(N / 8)


def noise(colour):
    drawn = np.random.default_rng(2).standard_normal(N)
    slow = lfilter([1.0], [1.0, -colour], drawn)
    return NOISE * slow / slow.std()


FORCES = {
    "the speed": lambda z, w: -2.0 * w * abs(w),
    "place and speed": lambda z, w: -6.0 * z * w,
    "the place": lambda z, w: -70.0 * z**3,
}


@pytest.mark.parametrize("of", FORCES)
def test_a_force_that_follows_the_motion_is_no_noise(of):
    problem, found, blocks = fitted(moved(FORCES[of]) + noise(0.0))
    assert problem.seen_rmse(found.residual) > 3.0 * NOISE
    force = unknown_force(problem, found)
    assert force.part > 0.5
    assert force.of == of
    assert force.port == "velocity"
    assert not leaves_coloured_noise(problem, found, blocks, MOST)


@pytest.mark.parametrize("colour", [0.0, 0.9, 0.98])
def test_no_force_predicts_noise_of_any_colour(colour):
    problem, found, _ = fitted(moved(lambda z, w: 0.0) + 5.0 * noise(colour))
    assert unknown_force(problem, found).part < 0.1


def test_what_was_simulated_predicts_less_than_the_force_does():
    """The device filters the force, which a regression on its output cannot know."""
    problem, found, _ = fitted(moved(FORCES["the speed"]) + noise(0.0))
    assert unknown_force(problem, found).part > predictable(problem, found.residual) + 0.3


def test_a_force_on_a_speed_alone_depends_on_it():
    """The motors of a drive have no position among its states."""
    simulation = load_simulation("electric_drive")
    own = simulation.compiled_derivative

    @njit(DERIVATIVE)
    def dragged(x, u, p, dx):
        own(x, u, p, dx)
        dx[1] -= 1.5 * x[1] * abs(x[1])

    def simulated(derivative):
        plain = ExtendedSimulation(replace(simulation, derivative=derivative))
        return plain.simulate(plain.layout.prior_means, 3.0 * U, DT)

    y = simulated(dragged)
    change = np.std(y - simulated(own))
    drawn = np.random.default_rng(3).standard_normal(N)
    record = Samples(3.0 * U, y + 0.05 * change * drawn, DT)
    problem, _, extended = prepare([record], simulation, Settings())
    found = fit(problem, extended, np.zeros(extended.layout.free.size), iterations=30)
    force = unknown_force(problem, found)
    assert force.part > 0.6
    assert force.of == "the speed"


def test_what_is_nothing_is_caused_by_nothing():
    problem, found, _ = fitted(moved(lambda z, w: 0.0) + noise(0.0))
    nothing = 0.0 * found.residual
    assert unknown_force(problem, replace(found, residual=nothing)).part == 0.0
    assert residual_model(problem, nothing).ratio == 1.0


def test_a_drag_that_no_effect_has_is_unknown_and_described():
    y = moved(FORCES["the speed"]) + noise(0.0)
    record = Record.of(U, y, 1.0 / DT, units=("V", "V"))
    verdict = diagnose(record, CARRIAGE, settings=Settings(effects=("dead_zone",))).verdict
    assert verdict.status == "unknown"
    assert "depends on the speed" in " ".join(verdict.remarks)
