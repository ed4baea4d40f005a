"""A piezo actuator in a flexure stage: a displacement proportional to the command, soon reached.

Aye and Ang (2018) measured such a stage. Its resonance is far above what a slow command excites, so
that a gain, a short lag and the offset of the sensor are the plainest simulation.
"""

import numpy as np
from numba import njit

from dea.simulation.force_port import ForcePort
from dea.simulation.parameter import Parameter
from dea.simulation.signatures import DERIVATIVE, OUTPUT
from dea.simulation.simulation import Simulation
from dea.simulation.state import State


@njit(DERIVATIVE, cache=True, error_model="numpy")
def derivative(x: np.ndarray, u: float, p: np.ndarray, dx: np.ndarray) -> None:
    """Displacement x₀ follows the command with one lag."""
    dx[0] = (p[1] * u - x[0]) / p[0]


@njit(OUTPUT, cache=True, error_model="numpy")
def output(x: np.ndarray, u: float, p: np.ndarray) -> float:
    """Displacement of the stage."""
    return float(x[0])


simulation = Simulation(
    name="piezo_stage",
    input_unit="V",
    output_unit="um",
    states=(State("displacement", "um", 25.0, 15.0),),
    parameters=(
        # Amplifier, piezo and stage: a few milliseconds.
        Parameter("lag", "s", 0.005, 0.7, 5e-4, 0.1, log=True),
        Parameter("gain", "um/V", 14.0, 0.5, 1.0, 100.0, log=True),
    ),
    derivative=derivative,
    output=output,
    drive="gain",
    # The stage's balance of forces: flexure and piezo against each other.
    force_ports=(ForcePort(equation="displacement", position="displacement", velocity=None),),
    # The capacitive sensor's zero lies anywhere in its range.
    output_offset_spread=100.0,
)
