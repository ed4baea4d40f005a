"""A device's registers by name."""

from dea.acquisition.link import Link, LinkError
from dea.errors import InputError
from dea.modbus import Value, decode, encode

CONFIRMATIONS = 20  # readings, for two in a row that agree


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

    def confirmed(self, name: str) -> int:
        """Raw value of an integer register, read alike twice running: Modbus has no checksum.

        Raises
        ------
        LinkError
            Where it never reads alike.
        """
        last = self.whole(name)
        for _ in range(CONFIRMATIONS):
            last, before = self.whole(name), last
            if last == before:
                return last
        raise LinkError(f"{name} reads differently each time")

    def number(self, name: str) -> float:
        """Physical value of a numeric register."""
        register, value = self.device[name], self.get(name)
        assert isinstance(value, int | float)
        return register.offset + register.scale * value

    def set(self, name: str, value: Value, *, retry: bool = True) -> None:
        """Write a raw value."""
        register = self.device[name]
        self.link.write(register.address, encode(register, value), retry=retry)
