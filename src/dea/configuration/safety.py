"""``safety`` of a device description: what must hold while there is high voltage."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, Self

from pydantic import model_validator

from dea.configuration.section import (
    Name,
    NotNegative,
    Number,
    Positive,
    Section,
    WholeNotNegative,
    key,
    refuse,
)
from dea.errors import InputError

Mode = Literal["buffered", "polled"]
# Signals of one register each, by their keys: those that are read, and those that are written.
READ, WRITTEN = ("monitor", "current"), ("enable", "heartbeat")
# Share by which a heartbeat may be faster than its device is asked: 0.033 s stands for 30 Hz.
ROUNDING = 0.02


class Monitor(Section):
    """A measurement of the high voltage behind the amplifier: gain · output + offset."""

    name: Name = key("register that holds it")
    gain: Number = key("its value per volt of the output, not zero")
    offset: Number = key("its value at zero volts, in the register's unit", default=0.0)
    tolerance: Positive = key("how far it may be off, noise included, in the register's unit")
    delay: NotNegative = key("how long it may be behind the output", unit="s", default=0.0)

    @model_validator(mode="after")
    def _relations(self) -> Self:
        if self.gain == 0:
            raise refuse("gain", "zero", "Give the monitor's value per volt of the output.")
        return self


class Bound(Section):
    """A register whose magnitude must stay below a limit."""

    name: Name = key("register that holds it")
    limit: Positive = key("magnitude that trips, in the register's unit")


class Condition(Section):
    """A register that must hold a value: an interlock that is closed, a trip that is not set."""

    name: Name = key("register, also a coil or discrete input")
    value: WholeNotNegative = key("raw value without which there is no voltage", default=1)


class Enable(Section):
    """A register that switches the high voltage on and off."""

    name: Name = key("register, also a coil")
    on: WholeNotNegative = key("raw value written to arm", default=1)
    off: WholeNotNegative = key("raw value written once zero is shown", default=0)


class Heartbeat(Section):
    """A register that the device expects to change as long as the host is well."""

    name: Name = key("register that is counted up")
    period: Positive = key(
        "time between two counts, of which each waits for the next sample, or for the next check"
        " where the device itself plays them",
        unit="s",
    )


class FilmCapacitor(Section):
    """The film, for the field and charge that a dry run shows."""

    thickness: Positive = key("between the electrodes", unit="µm")
    capacitance: Positive = key("between the electrodes", unit="nF")


class Safety(Section):
    """What keeps a drive safe: some of it is checked with every sample, the rest before the drive.

    A violation of a monitor, the current or an interlock within a drive zeroes the output and
    latches a trip.
    """

    max_rate: Positive | None = key(
        "largest rate of change of the output, of ramps and excitation", unit="V/s", default=None
    )
    amplifier_gain: Positive | None = key(
        "high voltage per volt of the output, for what a dry run shows", default=None
    )
    film: FilmCapacitor | None = key("what is driven, for what a dry run shows", default=None)
    monitor: Monitor | None = key("measurement of the high voltage", default=None)
    current: Bound | None = key("measurement of the current", default=None)
    interlocks: Mapping[Name, Condition] = key("conditions, by name", default={})
    enable: Enable | None = key("switch of the high voltage", default=None)
    heartbeat: Heartbeat | None = key("sign of life that the device expects", default=None)
    interval: Positive = key(
        "time between two checks where the device itself plays the samples", unit="s", default=0.1
    )

    def named_registers(self) -> dict[str, str]:
        """Names of the registers that it needs, by the key that names them."""
        named = {
            key: part.name for key in (*READ, *WRITTEN) if (part := getattr(self, key)) is not None
        }
        named |= {f"interlocks.{key}": each.name for key, each in self.interlocks.items()}
        return {f"{key}.name": name for key, name in named.items()}

    def unkept_heartbeat(self, mode: Mode, sampling_rate: float) -> tuple[str, str] | None:
        """Return problem and remedy where counts are due more often than a mode gives them."""
        shortest = self.interval if mode == "buffered" else 1 / sampling_rate
        if self.heartbeat is None or self.heartbeat.period >= (1 - ROUNDING) * shortest:
            return None
        faster = "a shorter interval" if mode == "buffered" else "a higher sampling_rate"
        return (
            f"{self.heartbeat.period:g} s, and a {mode} device is given one in {shortest:g} s",
            f"Give {shortest:g} s or more, here and in the device, or {faster}.",
        )


def refuse_unkept_heartbeat(
    safety: Safety | None, mode: Mode, sampling_rate: float, file: str | Path | None
) -> None:
    """Refuse a heartbeat that is due more often than a mode gives it, at ``sampling_rate`` Hz.

    Raises
    ------
    InputError
        Naming the device description ``file``.
    """
    if safety is not None and (unkept := safety.unkept_heartbeat(mode, sampling_rate)):
        problem, remedy = unkept
        raise InputError(problem, file=file, field="safety.heartbeat.period", remedy=remedy)
