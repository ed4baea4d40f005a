"""Effects that were never tried at a place, and why."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.problem.problem import Problem
from dea.effect_label import labelled
from dea.inputs import by_input
from dea.simulation import Effect, ExtendedSimulation


class Obstacle(StrEnum):
    """Why an effect was never compared with the others."""

    SETTINGS = "the settings do not list it among the effects to offer"
    NO_PORT = "the simulation declares no force port"
    NO_POSITION = "the force port knows a velocity alone, and the law needs a position"
    STILL = "the input does not move in this record"
    NO_START = "the record shows nothing that its law could start from"
    UNSTABLE = "the simulation runs away with it from every start"


@dataclass(frozen=True)
class NotOffered:
    """An effect, the kind of port, its force port or input where there are several, and why."""

    name: str
    port: str
    place: str | None
    reason: Obstacle

    @property
    def label(self) -> str:
        """The effect's name, with its force port or input where there are several."""
        return labelled(self.name, self.place)

    @classmethod
    def at(
        cls, extended: ExtendedSimulation, effect: Effect, place: int, reason: Obstacle
    ) -> "NotOffered":
        """Return an effect that was not tried at a place of a simulation."""
        own = extended.simulation
        named: Sequence[str] = ()
        if effect.force is not None:
            named = [port.name for port in own.force_ports]
        elif effect.on_input and extended.places.number_for(effect) > 1:
            named = [each.name for each in own.inputs]
        where = named[place] if len(named) > 1 else None
        return cls(effect.name, str(effect.port), where, reason)

    @classmethod
    def by_settings(cls, effect: Effect) -> "NotOffered":
        """Return an effect that the settings leave out."""
        return cls(effect.name, str(effect.port), None, Obstacle.SETTINGS)


def places(
    problem: Problem, extended: ExtendedSimulation, effect: Effect
) -> tuple[list[int], list[NotOffered]]:
    """Return the force ports, or inputs, at which an effect can act, and where it cannot."""
    if effect.force is None:
        count = extended.places.number_for(effect)
        obstacles = (
            {k: Obstacle.STILL for k, u in enumerate(by_input(problem.u)) if np.ptp(u) == 0.0}
            if count > 1
            else {}
        )
    else:
        ports = extended.simulation.force_ports
        if not ports:
            return [], [NotOffered.at(extended, effect, 0, Obstacle.NO_PORT)]
        count = len(ports)
        closed = set(range(count)).difference(extended.places.ports_for(effect))
        obstacles = dict.fromkeys(sorted(closed), Obstacle.NO_POSITION)
    free = [place for place in range(count) if place not in obstacles]
    return free, [NotOffered.at(extended, effect, *each) for each in obstacles.items()]


def never_tried(
    skipped: Iterable[NotOffered], candidates: Iterable[Candidate]
) -> tuple[NotOffered, ...]:
    """Return those of the effects ``skipped`` that none of the candidates holds."""
    tried = {label for candidate in candidates for label in candidate.labels}
    return tuple(each for each in skipped if each.label not in tried)
