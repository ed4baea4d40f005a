"""The plain devices that trials hide effects in, and what is drawn about each."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from dea.arrays import Array
from dea.plant.chamber import ROOM, Chamber, heat
from dea.plant.drive import Drive, turn
from dea.plant.film import FAULT, Y, vertical_stiffness
from dea.plant.film import advance as advance_film
from dea.plant.film import rest as film_at_rest
from dea.plant.forces import ForceLaw, stack
from dea.plant.parameters import Parameters, read_plain


class Machine(Protocol):
    """A device in motion; it carries its state from call to call."""

    def advance(self, command: Array) -> Array:
        """Return the output before each sub-step's command (V) takes effect, in its unit."""
        ...

    @property
    def broken(self) -> bool:
        """Whether it has failed."""
        ...


class Plain(Protocol):
    """A device without hidden effects, at certain parameters."""

    def machine(self, laws: Sequence[ForceLaw]) -> Machine:
        """Return the device at rest, with forces on it."""
        ...

    def changed(self, factors: dict[str, float]) -> "Plain":
        """Return the device with parameters multiplied."""
        ...

    def rest_and_stiffness(self) -> tuple[float, float]:
        """Return the output without command, and the restoring force over output."""
        ...


@dataclass(frozen=True)
class PlainFilm:
    """The film of config/bench.yaml under its mass, driven by an ideal amplifier; output in m."""

    parameters: Parameters

    def machine(self, laws: Sequence[ForceLaw]) -> Machine:
        """Return the film at rest."""
        return _FilmMachine(self.parameters, laws)

    def changed(self, factors: dict[str, float]) -> "PlainFilm":
        """Return the film with parameters multiplied."""
        film = self.parameters.film
        values = {name: getattr(film, name) * factor for name, factor in factors.items()}
        return PlainFilm(replace(self.parameters, film=film._replace(**values)))

    def rest_and_stiffness(self) -> tuple[float, float]:
        """Return the displacement (m) under the weight alone, and the film's stiffness (N/m)."""
        film = self.parameters.film
        rest = float(film_at_rest(film, self.parameters.rest).scalars[Y])
        return rest, vertical_stiffness(film)


class _FilmMachine:
    def __init__(self, parameters: Parameters, laws: Sequence[ForceLaw]) -> None:
        self._film, self._amplifier = parameters.film, parameters.amplifier
        self._forces = stack(list(laws)) if laws else None
        self._state = film_at_rest(self._film, parameters.rest)

    def advance(self, command: Array) -> Array:
        supply = np.clip(self._amplifier.gain * command, 0.0, self._amplifier.output_limit)
        displacement, voltage = np.empty_like(supply), np.empty_like(supply)
        advance_film(self._film, self._state, self._forces, supply, displacement, voltage)
        return displacement

    @property
    def broken(self) -> bool:
        return bool(self._state.scalars[FAULT])


@dataclass(frozen=True)
class PlainDrive:
    """The positioning drive; output in degrees, forces over inertia."""

    drive: Drive = field(default_factory=Drive)

    def machine(self, laws: Sequence[ForceLaw]) -> Machine:
        """Return the drive at rest."""
        return _DriveMachine(self.drive, laws)

    def changed(self, factors: dict[str, float]) -> "PlainDrive":
        """Return the drive with parameters multiplied."""
        values = {name: getattr(self.drive, name) * factor for name, factor in factors.items()}
        return PlainDrive(self.drive._replace(**values))

    def rest_and_stiffness(self) -> tuple[float, float]:
        """Return angle 0 and the stiffness."""
        return 0.0, self.drive.stiffness


class _DriveMachine:
    broken = False

    def __init__(self, drive: Drive, laws: Sequence[ForceLaw]) -> None:
        self._drive, self._forces, self._state = drive, stack(list(laws)), np.zeros(2)

    def advance(self, command: Array) -> Array:
        angle = np.empty_like(command)
        turn(self._drive, self._state, self._forces, command, angle)
        return angle


@dataclass(frozen=True)
class PlainChamber:
    """The heated chamber; output in °C. Nothing moves, so that no force acts."""

    chamber: Chamber = field(default_factory=Chamber)

    def machine(self, laws: Sequence[ForceLaw]) -> Machine:
        """Return the chamber at room temperature."""
        assert not laws, "no force acts in a chamber"
        return _ChamberMachine(self.chamber)

    def changed(self, factors: dict[str, float]) -> "PlainChamber":
        """Return the chamber with parameters multiplied."""
        values = {name: getattr(self.chamber, name) * factor for name, factor in factors.items()}
        return PlainChamber(self.chamber._replace(**values))

    def rest_and_stiffness(self) -> tuple[float, float]:
        """Return room temperature, and no stiffness."""
        return ROOM, 0.0


class _ChamberMachine:
    broken = False

    def __init__(self, chamber: Chamber) -> None:
        self._chamber, self._state = chamber, np.zeros(2)

    def advance(self, command: Array) -> Array:
        temperature = np.empty_like(command)
        heat(self._chamber, self._state, command, temperature)
        return temperature


@dataclass(frozen=True)
class DeviceKind:
    """What is drawn about a device, and how its records are diagnosed.

    Attributes
    ----------
    name, simulation
        Its name; the simulation (a name or a file) that its records are compared with.
    unit, scale
        The output's unit in records, and that unit over the plant's own.
    time
        One over the band of its excitation, s.
    power, force
        Exponent of the command in what drives it; whether forces act on it.
    lows, highs
        Ranges of the least and the largest command, V.
    rates, durations
        Sampling rates, Hz, and the least and the longest record, s.
    noise
        RMS, in the plant's unit, at its least and largest.
    settling
        Seconds at the first command before a record begins, as the plant's clock counts.
    free, spread
        Parameters that a refit changes besides scale and offset of the reading, none of which
        does what the scale does; those that are drawn, by their range of the logarithm.
    """

    name: str
    simulation: str
    unit: str
    scale: float
    time: float
    power: float
    force: bool
    lows: tuple[float, float]
    highs: tuple[float, float]
    rates: tuple[int, ...]
    durations: tuple[float, float]
    noise: tuple[float, float]
    settling: float
    free: tuple[str, ...]
    spread: dict[str, float]

    def plain(self, bench: Path, factors: dict[str, float]) -> Plain:
        """Return the device with drawn ``factors``; the film is that of the file ``bench``."""
        plains: dict[str, Any] = {"drive": PlainDrive, "chamber": PlainChamber}
        plain: Plain = PlainFilm(read_plain(bench)) if self.name == "film" else plains[self.name]()
        return plain.changed(factors)


DEVICES = {
    kind.name: kind
    for kind in (
        DeviceKind(
            name="film", simulation="dea_membrane", unit="mm", scale=1e3, time=1.0, power=2.0,
            force=True, lows=(0.2, 1.1), highs=(3.4, 3.75), rates=(10, 20, 50, 100, 200),
            durations=(20.0, 300.0), noise=(0.4e-6, 1.2e-6), settling=2.0,
            free=("permittivity", "yeoh_1", "damping"),
            spread={"prestretch": 0.015, "yeoh_1": 0.05, "damping": 0.3, "contact_radius": 0.05},
        ),
        DeviceKind(
            name="drive", simulation="config/simulations/positioning_drive.py", unit="deg",
            scale=1.0, time=0.5, power=1.0, force=True, lows=(0.3, 1.0), highs=(4.0, 5.0),
            rates=(25, 50, 100, 200), durations=(20.0, 300.0), noise=(0.02, 0.06), settling=2.0,
            free=("damping", "stiffness"),
            spread={"gain": 0.15, "damping": 0.3, "stiffness": 0.15},
        ),
        DeviceKind(
            name="chamber", simulation="config/simulations/heated_chamber.py", unit="degC",
            scale=1.0, time=40.0, power=2.0, force=False, lows=(0.5, 1.5), highs=(4.0, 5.0),
            rates=(10,), durations=(1500.0, 1800.0), noise=(0.02, 0.06), settling=0.0,
            free=("exchange", "uptake", "loss"),
            spread={"heating": 0.15, "exchange": 0.2, "uptake": 0.2, "loss": 0.2},
        ),
    )
}  # fmt: skip
