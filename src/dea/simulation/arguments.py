"""What the integrator takes: equations and their values, the input over time, and the forces.

The types are those under which numba compiles the integrator ahead of its first call.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba import float64, int64, types
from numba.extending import typeof_impl

from dea.simulation.signatures import (
    DERIVATIVE,
    FORCE,
    INDEX,
    MATRIX,
    OUTPUT,
    SLOTS,
    UPDATE,
    VECTOR,
)

Function: TypeAlias = Any  # a FirstClass, which is callable in compiled code alone


class ForceLaw(NamedTuple):
    """A force, of the signatures FORCE and UPDATE."""

    force: Function
    update: Function


class Equations(NamedTuple):
    """First-class functions of a simulation and of the forces attached, one law per slot."""

    derivative: Function
    output: Function
    law_1: ForceLaw
    law_2: ForceLaw
    law_3: ForceLaw


class Values(NamedTuple):
    """The numbers that the equations are integrated with."""

    parameters: np.ndarray  # (parameters,)
    initial: np.ndarray  # (states,) at the first sample
    drive: int  # index of the parameter that is multiplied by ``Course.drive_scale``


class Course(NamedTuple):
    """The input, and the factor on the drive, over a run of n samples."""

    u: np.ndarray  # (n,) input at each sample, which the output may depend on
    steps: np.ndarray
    """(n substeps + 1,) input, or its action, at the start of each step and at the end."""
    straight: int  # 1: the input is straight from one step to the next; 0: it is held
    drive_scale: np.ndarray  # (n,)
    interval: float  # s between samples
    substeps: int  # integration steps per sample


class Forces(NamedTuple):
    """Where each of the attached forces acts, and its numbers, one row per slot."""

    attached: int  # number of slots in use
    ports: np.ndarray
    """(SLOTS + 1, 4): states that are equation, position, velocity and reaction (-1: there is
    none); the last row is the port whose position is returned."""
    frames: np.ndarray
    """(SLOTS + 1, 3): rest position and scale of the port's motion, and the change of its
    equation per unit of force."""
    memory: np.ndarray  # (SLOTS, MEMORY), changed in place
    parameters: np.ndarray  # (SLOTS, MEMORY)


_FORCE_LAW = types.NamedTuple([types.FunctionType(FORCE), types.FunctionType(UPDATE)], ForceLaw)
EQUATIONS = types.NamedTuple(
    [types.FunctionType(DERIVATIVE), types.FunctionType(OUTPUT), *[_FORCE_LAW] * SLOTS], Equations
)
VALUES = types.NamedTuple([VECTOR, VECTOR, int64], Values)
COURSE = types.NamedTuple([VECTOR, VECTOR, int64, VECTOR, float64, int64], Course)
FORCES = types.NamedTuple([int64, INDEX, MATRIX, MATRIX, MATRIX], Forces)


@typeof_impl.register(Equations)
def _type_of(equations: Equations, context: Any) -> types.NamedTuple | None:
    """Return EQUATIONS, or None, which numba refuses, for a function of another signature.

    Numba would put the type together anew at every call, which takes longer than a short record.
    """
    derivative, output, *laws = equations
    own = (derivative.numba_type, output.numba_type)
    pushing = all((law.force.numba_type, law.update.numba_type) == _FORCE_LAW.types for law in laws)
    return EQUATIONS if pushing and own == EQUATIONS.types[:2] else None
