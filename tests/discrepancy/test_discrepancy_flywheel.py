"""A motor whose simulation knows its speed alone, with a flywheel on a soft shaft."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose
from dea.simulation import ForcePort, Parameter, Simulation, State
from dea.store import Record

pytestmark = pytest.mark.slow

RATE, SAMPLES, LEVEL = 50.0, 3000, 50


def motor():
    def derivative(x, u, p, dx):
        dx[0] = (p[1] * u - x[0]) / p[0]

    return Simulation(
        name="motor", input_unit="V", output_unit="rad/s",
        states=(State("speed", "rad/s", 0.0, 0.5),),
        parameters=(
            Parameter("time_constant", "s", 0.3, 0.3, 1e-3, 10.0, log=True),
            Parameter("gain", "rad/s/V", 2.0, 0.3, 1e-2, 1e2, log=True),
        ),
        derivative=derivative, output=lambda x, u, p: x[0], drive="gain",
        force_ports=(ForcePort("speed", position=None, velocity="speed"),),
    )  # fmt: skip


def recorded(ratio, seed=1):
    """Return a record of levels; the flywheel has ``ratio`` times the motor's inertia."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-5.0, 5.0, SAMPLES // LEVEL), LEVEL)
    t, own, damping = np.arange(SAMPLES) / RATE, 2 * np.pi * 3.0, 0.08

    def slope(now, x):
        angle, speed, other_angle, other_speed = x
        held = u[min(int(now * RATE + 1e-9), SAMPLES - 1)]
        pull = own**2 * (angle - other_angle) + 2 * damping * own * (speed - other_speed)
        return [speed, (2.2 * held - speed) / 0.25 - ratio * pull, other_speed, pull]

    y = solve_ivp(slope, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-7, max_step=0.5 / RATE).y[1]
    y += 0.01 * y.std() * rng.standard_normal(SAMPLES)
    return Record.of(u, y, RATE, units=("V", "rad/s"))


@pytest.mark.parametrize("ratio", [0.0, 0.4])
def test_a_flywheel_is_named_with_its_frequency_and_its_inertia(ratio):
    offered = ("second_mode", "coulomb_friction", "sensor_lag", "electrode_lag", "gain_drift")
    settings = Settings(effects=offered, budget=SEARCH)
    verdict = diagnose(recorded(ratio), motor(), settings=settings).verdict
    if not ratio:
        assert (verdict.status, verdict.names) == ("none", ())
        return
    assert (verdict.status, verdict.names) == ("named", ("second_mode",))
    [effect] = verdict.effects
    for name, truth in (("frequency", 3.0), ("coupling", ratio)):
        told = effect.parameters[name]
        assert told.low < truth < told.high
