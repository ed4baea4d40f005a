"""A device's registers by name."""

from collections.abc import Iterable

from dea.acquisition.link import Link
from dea.errors import InputError
from dea.modbus import Register, Value, decode, encode

MAX_READ = 125


class Panel:
    """Read and write the registers of a device by the names of its description.

    ``last_output`` is the output last asked for, for a device that cannot be asked.
    """

    def __init__(self, link: Link) -> None:
        self.link, self.device = link, link.device
        self.last_output: int | None = None

    def __contains__(self, name: str) -> bool:
        return name in self.device

    def get(self, name: str) -> Value:
        """Raw value of a register."""
        register = self.device[name]
        return decode(register, self.link.read(register.address, register.size, register.table))

    def whole(self, name: str) -> int:
        """Raw value of an integer register."""
        value = self.get(name)
        if not isinstance(value, int):
            raise InputError(
                f"{name} holds {self.device[name].type}, not a whole number",
                file=self.device.source,
                field=f"registers.{name}.type",
                remedy="Use an integer type and count 1.",
            )
        return value

    def number(self, name: str) -> float:
        """Physical value of a numeric register."""
        register, value = self.device[name], self.get(name)
        assert isinstance(value, int | float)
        return register.offset + register.scale * value

    def set(self, name: str, value: Value, *, retry: bool = True) -> None:
        """Write a raw value."""
        register = self.device[name]
        self.link.write(register.address, encode(register, value), retry=retry)


class Window:
    """Neighbouring registers read or written in one request.

    ``places`` says where each register lies in the window's words.
    """

    def __init__(self, registers: Iterable[Register]) -> None:
        self.registers = sorted(registers, key=lambda r: r.address)
        self.address, end = self.registers[0].address, self.registers[-1].end
        self.size, self.table = end - self.address, self.registers[0].table
        self.places = {
            r.name: slice(r.address - self.address, r.end - self.address) for r in self.registers
        }

    def decode(self, words: list[int]) -> dict[str, Value]:
        """Raw values of the window's registers."""
        return {r.name: decode(r, words[self.places[r.name]]) for r in self.registers}

    def encode(self, values: dict[str, Value]) -> list[int]:
        """Words that hold ``values``; registers not named hold zero."""
        words = [0] * self.size
        for register in self.registers:
            if register.name in values:
                words[self.places[register.name]] = encode(register, values[register.name])
        return words
