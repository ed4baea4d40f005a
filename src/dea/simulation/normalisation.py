"""How the motion at a force port is normalised."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Normalisation:
    """Units of position and force at a force port.

    Position ``rest`` and excursion ``scale`` in the position's unit; ``unit_force``, the change
    of the state equation per unit of force, equals the elastic force at the excursion or, where
    there is none, the force of the input's whole range. It is times the port's divisor, if any.
    ``inertia`` is then the unit of force over the acceleration of the normalised position that it
    causes (s^2), and zero where an elastic force is the unit.
    """

    rest: float = 0.0
    scale: float = 1.0
    unit_force: float = 0.0
    inertia: float = 0.0
