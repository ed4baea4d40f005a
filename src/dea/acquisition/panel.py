"""A device's registers by name."""

import numpy as np

from dea.acquisition.retrying_link import Link, LinkError
from dea.modbus import Value, decode, encode, to_counts, to_physical

CONFIRMATIONS = 20  # readings at most until two in a row agree


class Panel:
    """Read and write the registers of a device by the names of its description.

    ``last_output`` is the last output written, for a device that cannot be read back.
    """

    def __init__(self, link: Link) -> None:
        self.link, self.device = link, link.device
        self.last_output: int | None = None

    @property
    def zero(self) -> int:
        """Count of the output at zero volts, which is not zero on a module over both signs."""
        return int(to_counts(self.device["output"], 0.0))

    def __contains__(self, name: str) -> bool:
        return name in self.device

    def get(self, name: str) -> Value:
        """Raw value of a register."""
        register = self.device[name]
        return decode(register, self.link.read(register.address, register.size, register.table))

    def confirmed(self, name: str) -> int | float:
        """Raw value of a numeric register, the same in two successive readings.

        Modbus TCP has no checksum of its own. Readings of a register with a tolerance are the same
        where both can stand for one value.

        Raises
        ------
        LinkError
            Where no two successive readings are equal, or are no numbers.
        """
        register = self.device[name]
        apart = 2 * register.tolerance / abs(register.scale)
        last = self._raw(name)
        for _ in range(CONFIRMATIONS):
            last, before = self._raw(name), last
            if abs(last - before) <= apart:
                return last
        raise LinkError(f"{name} reads differently each time")

    def number(self, name: str) -> float:
        """Physical value of a numeric register."""
        register = self.device[name]
        return register.offset + register.scale * self._raw(name)

    def physical(self, name: str) -> Value:
        """Physical value of a register: a number, a list of them, or text."""
        register, value = self.device[name], self.get(name)
        if isinstance(value, str):
            return value
        values = to_physical(register, np.asarray(value, float)).tolist()
        assert isinstance(values, float | list)
        return values

    def set(self, name: str, value: Value, *, retry: bool = True) -> None:
        """Write a raw value."""
        register = self.device[name]
        self.link.write(register.address, encode(register, value), register.table, retry=retry)

    def _raw(self, name: str) -> int | float:
        value = self.get(name)
        assert isinstance(value, int | float)
        return value
