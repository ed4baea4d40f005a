"""Where effects act on a simulation: at which force ports and inputs, and in which units."""

from dataclasses import dataclass

from dea.effect_label import labelled
from dea.simulation.attached import Attached
from dea.simulation.effects import Effect
from dea.simulation.force_port import ForcePort
from dea.simulation.inputs import Input
from dea.simulation.normalisation import Normalisation
from dea.simulation.parameter import Parameter
from dea.simulation.simulation import Simulation
from dea.units import product


@dataclass(frozen=True)
class Places:
    """The force ports and inputs of a simulation.

    Parameters
    ----------
    simulation
        Which declares them.
    normalisations
        How the motion at each of its force ports is normalised.
    """

    simulation: Simulation
    normalisations: tuple[Normalisation, ...]

    def label(self, attached: Attached) -> str:
        """Return an effect's name, with its force port or input where there are several."""
        port = self.force_port_of(attached)
        return labelled(attached.effect.name, port.name) if port else self.name_of(attached)

    def name_of(self, attached: Attached) -> str:
        """Return an effect's name, with the input it acts on where the simulation has several."""
        at = self.input_of(attached)
        return labelled(attached.effect.name, at.name if at else None)

    def input_of(self, attached: Attached) -> Input | None:
        """Return the input that an effect acts on, if the simulation has several."""
        effect = attached.effect
        if not effect.on_input or self.number_for(effect) < 2:
            return None
        return self.simulation.inputs[attached.place]

    def ports_for(self, effect: Effect) -> list[int]:
        """Return the numbers of the force ports that a force law can act at."""
        ports = enumerate(self.simulation.force_ports)
        return [k for k, port in ports if port.position is not None or not effect.needs_position]

    def number_for(self, effect: Effect) -> int:
        """Return at how many force ports, or inputs, an effect can act."""
        own = self.simulation
        if effect.force is not None:
            return len(self.ports_for(effect))
        if effect.shape_input is not None:
            return len(own.inputs)
        return len(own.drives) if effect.scale_drive is not None else 1

    def force_port_of(self, attached: Attached) -> ForcePort | None:
        """Return the force port of a force law, if the simulation has several."""
        ports = self.simulation.force_ports
        if attached.effect.force is None or len(ports) < 2:
            return None
        return ports[attached.place]

    def frame_of(self, attached: Attached) -> tuple[Normalisation, str]:
        """Return how the motion that a force law acts on is normalised, and its position's unit."""
        port = self.simulation.force_ports[attached.place]
        return self.normalisations[attached.place], self._length_at(port)

    def own_unit(self, attached: Attached, parameter: Parameter) -> tuple[float, float, str]:
        """Return where a parameter of an effect counts from, what its unit is, and the unit's name.

        Places and lengths of a force law are in the unit of its port's position, or of the integral
        of its velocity. Its forces are in that of the port's equation: that of its state per
        second, times that of the divisor.
        """
        as_it_is = 0.0, 1.0, parameter.unit
        if not parameter.at_port:
            return as_it_is
        port = self.simulation.force_ports[attached.place]
        frame = self.normalisations[attached.place]
        force, length = self._force_at(port), self._length_at(port)
        units = {
            "force": (0.0, frame.unit_force, force),
            "place": (frame.rest, frame.scale, length),
            "length": (0.0, frame.scale, length),
            "rate": (0.0, frame.scale, product(length, below="s")),
            "stiffness": (0.0, frame.unit_force / frame.scale, product(force, below=length)),
        }
        found = units.get(parameter.at_port, as_it_is)
        return found if found[1] else as_it_is

    def force_unit(self, attached: Attached) -> tuple[float, str]:
        """Return the unit of the force of a law at its port: its size and its name.

        Where the port has none, forces are as they are.
        """
        size = self.normalisations[attached.place].unit_force
        port = self.simulation.force_ports[attached.place]
        return (size, self._force_at(port)) if size else (1.0, "1")

    def _length_at(self, port: ForcePort) -> str:
        """Return the unit of a port's position, or of the integral of its velocity."""
        states = {each.name: each.unit for each in self.simulation.states}
        if port.position is not None:
            return states[port.position]
        return product(states[port.velocity or ""], "s")

    def _force_at(self, port: ForcePort) -> str:
        """Return the unit of a port's forces: of its equation, times that of the divisor."""
        states = {each.name: each.unit for each in self.simulation.states}
        divisors = {each.name: each.unit for each in self.simulation.parameters}
        return product(states[port.equation], divisors.get(port.divisor or "", "1"), below="s")
