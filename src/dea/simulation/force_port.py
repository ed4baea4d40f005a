"""Where a force law attaches to a simulation."""

from dataclasses import dataclass

from dea.effect_label import between


@dataclass(frozen=True)
class ForcePort:
    """A state equation that a force law can add to.

    Parameters
    ----------
    equation
        State whose derivative the force adds to.
    position
        State that the elastic part of the force depends on, or ``None`` if there is no such state.
    velocity
        State that is the rate of the motion; ``None`` takes the derivative of ``position``.
    rest
        Position at which the elastic force vanishes, in the unit of ``position``.
    reaction
        State equation that the same force is subtracted from, where it acts between two parts of
        the device: two bodies, or two vessels. ``None`` where it acts from outside.
    divisor
        Parameter that the equation divides forces by, such as a mass or a viscosity, where that is
        uncertain: the force then keeps its ratio to the device's own forces whatever its value.
    """

    equation: str
    position: str | None = None
    velocity: str | None = None
    rest: float = 0.0
    reaction: str | None = None
    divisor: str | None = None

    @property
    def name(self) -> str:
        """Name of the port, unique within its simulation."""
        return between(self.equation, self.reaction)

    @property
    def rate(self) -> str:
        """What the velocity is called: the state that is one, or the rate of the position."""
        return self.velocity or f"rate of {self.position}"
