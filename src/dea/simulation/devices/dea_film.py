"""A dielectric elastomer membrane that carries a mass, with a port for forces within the film.

The film is that of :mod:`~dea.simulation.devices.dea_membrane`. Here the stretch x of the disc is a
state, so that what a film does beyond elasticity acts where it arises, and pull-in magnifies it as
it does the voltage. A viscous stress balances what the elastic and the Maxwell stress leave. The
mass swings on the film, damped by a dashpot: at 2 mm of displacement its resonance is down at
11 Hz, which a jump of the voltage excites. The laser reads it through its anti-alias filter.
"""

from dataclasses import replace
from math import log, nan, pi

import numpy as np
from numba import njit

from dea.simulation.cubic import weights
from dea.simulation.devices import dea_membrane
from dea.simulation.devices.dea_membrane import (
    GRAVITY,
    VACUUM_PERMITTIVITY,
    squares_of,
    suspending,
    work,
)
from dea.simulation.force_port import ForcePort
from dea.simulation.input_action import InputAction
from dea.simulation.parameter import Parameter
from dea.simulation.sensor_filter import SensorFilter
from dea.simulation.signatures import DERIVATIVE, OUTPUT, VECTOR
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

# The position is in cm: its rate in m/s is then of like size as the other entries of the Jacobian,
# which keeps the steps of the integrator few.
PER_METRE = 100.0
# Stretches at which the film is tabulated: their number, the first, and how far the last one is on
# the way to where the annulus is crushed. Beyond them the stresses are computed.
NODES, FIRST, LAST = 256, 0.95, 0.8
COLUMNS = 4
# In Hz: the anti-alias filter of a laser that is sampled at 50 Hz.
LASER_CUTOFF = 15.0


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Balance of the stresses in the film's plane, and of the mass: m ÿ = m g - c ẏ - k(x) y."""
    resisting, sigma, compliance = work(x[0], u, p, squares_of(p))
    dx[0] = -resisting / p[1]
    dx[1] = PER_METRE * x[2]
    pull = suspending(x[0], sigma, compliance, p) * x[1] / PER_METRE
    dx[2] = GRAVITY - (pull + p[12] * x[2]) / p[0]


@njit(VECTOR(VECTOR, VECTOR, VECTOR), cache=True, nogil=True, error_model="numpy")
def pressure(u: np.ndarray, scale: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the Maxwell stress (m,) in Pa at voltages ``u`` (m,) where x is 1: it goes with x⁴."""
    field = p[11] * p[5] * p[5] / p[10] * u
    stress: np.ndarray = VACUUM_PERMITTIVITY * p[6] * scale * field * field
    return stress


@njit(VECTOR(VECTOR), cache=True, nogil=True, error_model="numpy")
def table(p: np.ndarray) -> np.ndarray:
    """Return ``p``, nodes per stretch, the mass's stiffness over its compliance, and the nodes.

    A node holds, without a voltage, the work, the stress and the integral of :func:`work`, and x²
    times the logarithm in :func:`suspending`.
    """
    outer = (p[7] / p[8]) ** 2
    end = 1.0 + LAST * (outer - 1.0) / (outer + 1.0)
    spacing = (end - FIRST) / (NODES - 1)
    result = np.empty(p.size + 2 + COLUMNS * NODES)
    result[: p.size] = p
    result[p.size], result[p.size + 1] = 1.0 / spacing, 2.0 * pi * p[10] / (p[5] * p[5])
    squares = squares_of(p)
    for k in range(NODES):
        x = FIRST + k * spacing
        row = p.size + 2 + COLUMNS * k
        result[row], result[row + 1], result[row + 2] = work(x, 0.0, p, squares)
        result[row + 3] = x * x * log(p[8] * x / p[9])
    return result


@njit(DERIVATIVE, cache=True, error_model="numpy")
def tabulated(x: np.ndarray, stress: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Do as :func:`derivative` from the Maxwell stress where x is 1, with cubics between nodes."""
    header = p.size - 2 - COLUMNS * NODES
    place = (x[0] - FIRST) * p[header]
    squared = x[0] * x[0]
    if 0.0 <= place < NODES - 1:
        node = min(max(int(place) - 1, 0), NODES - 4)
        w0, w1, w2, w3 = weights(place - node)
        k0 = header + 2 + COLUMNS * node
        k1, k2, k3 = k0 + COLUMNS, k0 + 2 * COLUMNS, k0 + 3 * COLUMNS
        resisting = w0 * p[k0] + w1 * p[k1] + w2 * p[k2] + w3 * p[k3]
        sigma = w0 * p[k0 + 1] + w1 * p[k1 + 1] + w2 * p[k2 + 1] + w3 * p[k3 + 1]
        compliance = w0 * p[k0 + 2] + w1 * p[k1 + 2] + w2 * p[k2 + 2] + w3 * p[k3 + 2]
        of_disc = w0 * p[k0 + 3] + w1 * p[k1 + 3] + w2 * p[k2 + 3] + w3 * p[k3 + 3]
    else:
        resisting, sigma, compliance = work(x[0], 0.0, p, squares_of(p))
        of_disc = squared * log(p[8] * x[0] / p[9])
    resisting -= stress * squared * x[0]
    sigma -= stress * squared * squared
    stiffness = p[header + 1] * sigma / (compliance * sigma + of_disc) if sigma > 0.0 else nan
    dx[0] = -resisting / p[1]
    dx[1] = PER_METRE * x[2]
    dx[2] = GRAVITY - (stiffness * (1.0 / PER_METRE) * x[1] + p[12] * x[2]) / p[0]


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Displacement in mm."""
    return float(10.0 * x[1])


def _parameters() -> tuple[Parameter, ...]:
    """Return those of the membrane with the film's viscosity, and the dashpot as the last one."""
    own = {p.name: p for p in dea_membrane.simulation.parameters}
    dashpot = replace(own["dashpot"], nominal=0.3)
    own["dashpot"] = Parameter("viscosity", "Pa s", 1e4, 1.2, 10.0, 1e7, log=True)
    return (*own.values(), dashpot)


simulation = Simulation(
    name="dea_film",
    input_unit="V",
    output_unit="mm",
    states=(
        State("stretch", "1", 1.02),
        State("position", "cm", 0.06),
        State("velocity", "m/s", 0.0),
    ),
    parameters=_parameters(),
    derivative=derivative,
    output=output,
    drive="permittivity",
    force_ports=(
        ForcePort("stretch", position="stretch", velocity=None, rest=1.0, divisor="viscosity"),
    ),
    output_offset_spread=0.1,
    action=InputAction(law=pressure, derivative=tabulated, table=table),
    lead_in=2.0,
    sensor_filter=SensorFilter(LASER_CUTOFF),
)
