"""An electric positioning drive: a motor turns a load against a return spring.

With the armature's inductance neglected, torque over inertia (J. Chiasson, Modeling and
High-Performance Control of Electric Machines, 2005)::

    θ̈ = K u − d θ̇ − k θ − F

θ in degrees, u in V, F the sum of the hidden forces (:mod:`dea.plant.forces`) over the inertia.
"""

from typing import NamedTuple

from numba import njit

from dea.arrays import Array
from dea.plant.dry_friction import DRY_STEPS, is_stiff, slowed
from dea.plant.film import SUBSTEP
from dea.plant.forces import Forces, total_force, update_memory


class Drive(NamedTuple):
    """The parameters: gain K (°/(s² V)), damping d (1/s) and stiffness k (1/s²)."""

    gain: float = 6000.0
    damping: float = 18.0
    stiffness: float = 600.0


@njit(cache=True, error_model="numpy")
def turn(drive: Drive, state: Array, forces: Forces, command: Array, angle: Array) -> None:
    """Advance by one sub-step per element of ``command`` (V), filling ``angle`` (°), by RK4.

    ``state`` holds angle and speed and changes in place; ``angle[k]`` is the value before
    ``command[k]`` takes effect. A sub-step is divided where dry friction is taken implicitly.
    """
    for k in range(command.shape[0]):
        angle[k] = state[0]
        stiff = is_stiff(forces, state[0], SUBSTEP)
        steps = DRY_STEPS if stiff else 1
        for _ in range(steps):
            _step(drive, state, forces, command[k], SUBSTEP / steps, stiff)
        update_memory(forces, state[0], state[1], SUBSTEP)


@njit(cache=True, error_model="numpy")
def _step(
    drive: Drive, state: Array, forces: Forces, command: float, dt: float, stiff: bool
) -> None:
    y, v = state[0], state[1]
    sum_y, sum_v, stage_y, stage_v = 0.0, 0.0, y, v
    for stage in range(4):
        push = drive.gain * command - drive.damping * stage_v - drive.stiffness * stage_y
        push -= total_force(forces, stage_y, 0.0 if stiff else stage_v)
        slope_y = stage_v
        weight = 2.0 if stage in (1, 2) else 1.0
        sum_y += weight * slope_y
        sum_v += weight * push
        ahead = dt if stage == 2 else 0.5 * dt
        stage_y, stage_v = y + ahead * slope_y, v + ahead * push
    state[0] = y + dt / 6.0 * sum_y
    state[1] = v + dt / 6.0 * sum_v
    if stiff:
        state[0], state[1] = slowed(forces, state[0], state[1], 1.0, drive.damping, dt)
