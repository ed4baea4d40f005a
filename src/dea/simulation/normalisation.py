"""How the motion at a force port is normalised."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Normalisation:
    """Units of position and force at a force port.

    Position ``rest`` and excursion ``scale`` in the position's unit; ``unit_force``, the change
    of the state equation per unit of force, equals the elastic force at the excursion or, where
    there is none, the force of the input's whole range. Where the port has a divisor, the unit is
    multiplied by its value. ``inertia`` (s^2) is zero where an elastic force is the unit; otherwise
    it is the unit over the acceleration of the normalised position that it causes.

    Where a port knows a velocity alone, that has the ``scale`` and what opposes it is the unit of
    force. Its position is the integral of the velocity from the start on, in seconds, and so is
    the ``inertia``.
    """

    rest: float = 0.0
    scale: float = 1.0
    unit_force: float = 0.0
    inertia: float = 0.0
