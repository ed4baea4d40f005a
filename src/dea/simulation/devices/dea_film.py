"""A dielectric elastomer membrane that carries a mass, with a port for forces within the film.

The film is that of :mod:`~dea.simulation.devices.dea_membrane`. Here the stretch x of the disc is a
state, so that what a film does beyond elasticity acts where it arises, and pull-in magnifies it as
it does the voltage. A viscous stress, the only damping, balances what the elastic and the Maxwell
stress leave. The mass follows the film's stiffness at once: its inertia matters above the excited
band.
"""

import numpy as np
from numba import njit

from dea.simulation.devices import dea_membrane
from dea.simulation.devices.dea_membrane import GRAVITY, squares_of, suspending, work
from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State

# In N s/m: the mass follows within milliseconds.
FOLLOWING = 0.05


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Balance of the stresses in the film's plane, and of the mass: c ẏ = m g - k(x) y."""
    resisting, sigma, compliance = work(x[0], u, p, squares_of(p))
    dx[0] = -resisting / p[1]
    dx[1] = (p[0] * GRAVITY - suspending(x[0], sigma, compliance, p) * x[1]) / FOLLOWING


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Displacement in mm."""
    return float(1e3 * x[1])


def _parameters() -> tuple[Parameter, ...]:
    """Return those of the membrane, with the film's viscosity in place of the dashpot."""
    own = {p.name: p for p in dea_membrane.simulation.parameters}
    own["dashpot"] = Parameter("viscosity", "Pa s", 1.5e4, 0.8, 10.0, 1e7, log=True)
    return tuple(own.values())


simulation = Simulation(
    name="dea_film",
    input_unit="V",
    output_unit="mm",
    states=(State("stretch", "1", 1.02), State("position", "m", 6e-4)),
    parameters=_parameters(),
    derivative=derivative,
    output=output,
    drive="permittivity",
    force_ports=(ForcePort(equation="stretch", position="stretch", velocity=None, rest=1.0),),
    output_offset_spread=0.1,
    lead_in=2.0,
)
