"""What the integrator takes: equations and their values, the input over time, and the forces.

The types are those under which numba compiles the integrator: of one input ahead of its first call,
of several when they are first met.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba import float64, int64, types
from numba.extending import typeof_impl

from dea.simulation.exponential import ROOM
from dea.simulation.signatures import (
    CUBE,
    DERIVATIVE,
    DERIVATIVE_OF_SEVERAL,
    FORCE,
    INDEX,
    INDICES,
    MATRIX,
    OUTPUT,
    OUTPUT_OF_SEVERAL,
    SLOTS,
    UPDATE,
    VECTOR,
)

VECTORS = 8  # of states that the integrator works in
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

    parameters: np.ndarray  # (parameters,), of which those of the drive are overwritten
    initial: np.ndarray  # (states,) at the first sample
    drive: int | np.ndarray
    """Index of the parameter that is multiplied by ``Course.drive_scale``; of several inputs those
    of the parameters (drives,)."""


class Course(NamedTuple):
    """The input, and the factor on the drive, over a run of n samples.

    Several inputs, and several drives, are columns.
    """

    u: np.ndarray  # (n,) input at each sample, which the output may depend on
    steps: np.ndarray
    """(n substeps + 1,) input, or its action, at the start of each step and at the end."""
    straight: int  # 1: the input is straight from one step to the next; 0: it is held
    drive_scale: np.ndarray  # (n,)
    interval: float  # s between samples
    substeps: int  # integration steps per sample
    lead: int  # samples before the record begins


class Forces(NamedTuple):
    """Where each of the attached forces acts, and its numbers, one row per slot."""

    attached: int  # number of slots in use
    ports: np.ndarray
    """(SLOTS + 1, 4): states that are equation, position, velocity and reaction (-1: there is
    none); the last row is the port whose position is returned."""
    normalisations: np.ndarray
    """(SLOTS + 1, 3): rest position and scale of the port's motion, and the change of its
    equation per unit of force."""
    still: np.ndarray  # (SLOTS,), 1: the memory stays as it is until the record begins
    memory: np.ndarray  # (SLOTS, MEMORY), changed in place
    parameters: np.ndarray  # (SLOTS, MEMORY)


class Reading(NamedTuple):
    """The low-pass that the output is read through, over a step of the integration.

    It has k states, the reading and its derivatives: none where the output is read as it is.
    """

    states: np.ndarray  # (k, k), what takes them over a step
    gains: np.ndarray
    """(4, k): what they gain from the output at the step's start and end, and from its rates
    there, per step."""


class Workspace(NamedTuple):
    """Arrays that the integrator works in, all of which it overwrites."""

    result: np.ndarray
    """(2, n): reading of the output, and normalised position; NaN from where the states diverge."""
    vectors: np.ndarray  # (VECTORS, states)
    matrices: np.ndarray  # (1 + ROOM, states, states)

    @classmethod
    def of(cls, samples: int, states: int) -> "Workspace":
        """Return it for a run of so many samples."""
        return cls(
            np.full((2, samples), np.nan),
            np.zeros((VECTORS, states)),
            np.zeros((1 + ROOM, states, states)),
        )


_FORCE_LAW = types.NamedTuple([types.FunctionType(FORCE), types.FunctionType(UPDATE)], ForceLaw)
FORCES = types.NamedTuple([int64, INDEX, MATRIX, INDICES, MATRIX, MATRIX], Forces)
READING = types.NamedUniTuple(MATRIX, 2, Reading)
WORKSPACE = types.NamedTuple([MATRIX, MATRIX, CUBE], Workspace)
EQUATIONS, EQUATIONS_OF_SEVERAL = (
    types.NamedTuple(
        [types.FunctionType(derivative), types.FunctionType(output), *[_FORCE_LAW] * SLOTS],
        Equations,
    )
    for derivative, output in (
        (DERIVATIVE, OUTPUT),
        (DERIVATIVE_OF_SEVERAL, OUTPUT_OF_SEVERAL),
    )
)
ARGUMENTS = (
    EQUATIONS,
    types.NamedTuple([VECTOR, VECTOR, int64], Values),
    types.NamedTuple([VECTOR, VECTOR, int64, VECTOR, float64, int64, int64], Course),
    FORCES,
    READING,
    WORKSPACE,
)
ARGUMENTS_OF_SEVERAL = (
    EQUATIONS_OF_SEVERAL,
    types.NamedTuple([VECTOR, VECTOR, INDICES], Values),
    types.NamedTuple([MATRIX, MATRIX, int64, MATRIX, float64, int64, int64], Course),
    FORCES,
    READING,
    WORKSPACE,
)


@typeof_impl.register(Equations)
def _type_of(equations: Equations, context: Any) -> types.NamedTuple | None:
    """Return the type of equations, or None, which numba refuses, for another signature.

    Numba would put the type together anew at every call, which takes longer than a short record.
    """
    derivative, output, *laws = equations
    own = (derivative.numba_type, output.numba_type)
    pushing = all((law.force.numba_type, law.update.numba_type) == _FORCE_LAW.types for law in laws)
    if pushing and own == EQUATIONS.types[:2]:
        return EQUATIONS
    return EQUATIONS_OF_SEVERAL if pushing and own == EQUATIONS_OF_SEVERAL.types[:2] else None
