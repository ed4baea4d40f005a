"""Dry friction of a motor that turns freely, found with its force."""

import numpy as np
import pytest

import dea
from dea.discrepancy import Settings
from dea.simulation import ForcePort, Parameter, Simulation, State

RATE, GAIN, TAU, FRICTION = 100, 20.0, 0.15, 40.0  # Hz, rad/s/V, s, rad/s^2


def driven(rng, samples=4000):
    """Return volts in steps and waves, and the speed of a motor with dry friction (rad/s).

    It is integrated by short steps of Euler's method, and stands still where friction holds it.
    """
    t = np.arange(samples) / RATE
    u = 0.6 * np.repeat(rng.uniform(-3.0, 3.0, samples // 20), 20)
    for f in (0.15, 0.4, 0.7, 1.1, 1.9, 3.0):
        u += 0.45 * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 2.0 * np.pi))
    h, speed, y = 1.0 / RATE / 50, 0.0, np.zeros(samples)
    for k in range(samples):
        y[k] = speed
        for _ in range(50):
            drive = (GAIN * u[k] - speed) / TAU
            if speed == 0.0 and abs(drive) <= FRICTION:
                continue
            moved = speed + h * (drive - FRICTION * np.sign(speed or drive))
            speed = 0.0 if speed * moved < 0.0 else moved
    return u, y + 0.05 * rng.standard_normal(samples)


def turning(x, u, p, dx):
    dx[0] = (p[0] * u - x[0]) / p[1]
    dx[1] = x[0]


def speed_alone(x, u, p, dx):
    dx[0] = (p[0] * u - x[0]) / p[1]


@pytest.mark.parametrize("place", [None, "angle"])
def test_dry_friction_of_a_motor_has_the_right_force(place):
    u, y = driven(np.random.default_rng(2))
    states = (State("speed", "rad/s", 0.0), State("angle", "rad", 0.0))
    motor = Simulation(
        name="motor", input_unit="V", output_unit="rad/s", states=states if place else states[:1],
        parameters=(
            Parameter("gain", "rad/s/V", 18.0, 0.3, 1.0, 1e3, log=True),
            Parameter("time_constant", "s", 0.2, 0.5, 1e-3, 10.0, log=True),
        ),
        derivative=turning if place else speed_alone, output=lambda x, u, p: x[0], drive="gain",
        force_ports=(ForcePort("speed", position=place, velocity="speed"),), lead_in=1.0,
    )  # fmt: skip
    record = dea.Record.of(u, y, RATE, units=("V", "rad/s"))
    found = dea.diagnose(record, motor, settings=Settings(effects=("coulomb_friction",)))
    assert found.verdict.names == ("coulomb_friction",)
    force = found.verdict.effects[0].parameters["force"]
    assert force.unit == "rad/s^2"
    assert force.low < FRICTION < force.high
    assert force.value == pytest.approx(FRICTION, rel=0.1)
