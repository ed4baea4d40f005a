"""A position servo whose carriage nothing pulls back: dry friction, or a reading behind a gear."""

import numpy as np
import pytest
import xarray as xr
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose

pytestmark = pytest.mark.slow

DT, PARTS = 0.01, 50
SIMULATION = """
from dea.simulation import ForcePort, Parameter, Simulation, State


def derivative(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = (p[2] * u - p[1] * x[1]) / p[0]


def output(x, u, p):
    return x[0]


simulation = Simulation(
    name="servo", input_unit="V", output_unit="m",
    states=(State("position", "m", 0.0, 0.05), State("velocity", "m/s", 0.0, 0.05)),
    parameters=(
        Parameter("mass", "kg", 100.0, 0.3, log=True),
        Parameter("viscous", "N s/m", 250.0, 0.6, log=True),
        Parameter("gain", "N/V", 35.0, 0.02, log=True),
    ),
    derivative=derivative, output=output, drive="gain", input_offset_spread=0.2,
    force_ports=(ForcePort(equation="velocity", position=None, velocity="velocity"),),
)
"""


def recorded(seed, friction, seconds=25.0):
    """A carriage that a controller moves from place to place, by small steps; size as in EMPS."""
    rng = np.random.default_rng(seed)
    h, n = DT / PARTS, round(seconds / DT)
    t, reference = np.arange(n) * DT, np.zeros(n)
    begin, place = 0.3, 0.0
    while begin < seconds:
        target, lasts = rng.uniform(0.0, 0.25), rng.uniform(1.2, 2.0)
        part = np.clip((t - begin) / lasts, 0.0, 1.0)
        reference += (target - place) * part**3 * (10 - 15 * part + 6 * part**2)
        begin, place = begin + lasts + rng.uniform(0.2, 0.8), target
    q = v = 0.0
    u, y = np.zeros(n), np.zeros(n)
    for k in range(n):
        y[k] = q
        u[k] = (160.0 * (reference[k] - q) - v) * 243.0 / 35.15
        for _ in range(PARTS):
            v += h * (35.15 * u[k] - 203.5 * v - 3.16) / 95.1
            # Dry friction takes away what velocity there is, up to its impulse.
            v -= np.sign(v) * min(abs(v), h * friction / 95.1)
            q += h * v
    y += 2e-6 * rng.standard_normal(n)
    return xr.Dataset(
        {"input": ("time", u, {"units": "V"}), "output": ("time", y, {"units": "m"})},
        coords={"time": ("time", t, {"units": "s"})},
    )


@pytest.fixture
def simulation(tmp_path):
    path = tmp_path / "servo.py"
    path.write_text(SIMULATION)
    return path.as_posix()


def test_friction_of_a_servo_is_named_beside_a_constant_load(simulation):
    offered = ("coulomb_friction", "dead_zone", "gain_drift", "sensor_lag", "cyclic_softening")
    found = diagnose(
        recorded(1, 20.4), simulation, settings=Settings(effects=offered, budget=SEARCH),
        test_records={"another": recorded(2, 20.4)},
    )  # fmt: skip
    assert found.verdict.names == ("coulomb_friction",), found.verdict.sentence
    assert found.verdict.status == "named", found.verdict.sentence
    proof = found.verdict.certified["records"]["another"]
    assert proof["after"] < 0.25 * proof["before"]


def behind_a_gear(seed, gap):
    """The same without friction, read behind a gear that plays."""
    record = recorded(seed, 0.0)
    y = record["output"].values
    read = np.empty_like(y)
    low, high = y[0] - 0.5 * gap, y[0] + 0.5 * gap  # the gap's ends, which what is read drags along
    for k, place in enumerate(y):
        shift = min(place - low, 0.0) + max(place - high, 0.0)
        low, high = low + shift, high + shift
        read[k] = 0.5 * (low + high)
    read += 4e-5 * np.random.default_rng(seed).standard_normal(y.size)
    return record.assign(output=("time", read, record["output"].attrs))


def test_play_of_a_gear_before_the_sensor_is_named_with_its_gap(simulation):
    offered = ("backlash", "coulomb_friction", "dead_zone", "sensor_lag", "transport_delay")
    found = diagnose(
        behind_a_gear(1, 0.004), simulation, settings=Settings(effects=offered, budget=SEARCH),
        test_records={"another": behind_a_gear(2, 0.004)},
    )  # fmt: skip
    assert found.verdict.names == ("backlash",), found.verdict.sentence
    assert found.verdict.status == "named", found.verdict.sentence
    gap = found.verdict.effects[0].parameters["gap"]
    assert gap.low <= 0.004 <= gap.high
    assert gap.value == pytest.approx(0.004, rel=0.03)
    proof = found.verdict.certified["records"]["another"]
    assert proof["after"] < 0.1 * proof["before"]
