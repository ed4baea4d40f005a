"""Neighbouring registers that are read or written in one request."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from dea.modbus.codec import Value, checksum, decode, encode
from dea.modbus.device import Register


class Window:
    """Registers of one table, read or written together.

    Parameters
    ----------
    registers
        At least one; undescribed addresses between them are sent as zero.
    seal
        The register among them that holds the checksum of all the others, if there is one.
    """

    def __init__(self, registers: Iterable[Register], seal: Register | None = None) -> None:
        self.registers = sorted(registers, key=lambda r: r.address)
        self.address, end = self.registers[0].address, self.registers[-1].end
        self.size, self.table, self.seal = end - self.address, self.registers[0].table, seal
        self._named = {r.name: (r, self._place(r)) for r in self.registers}

    def decode(self, words: Sequence[int]) -> dict[str, Any]:
        """Raw values of the registers, by name."""
        return {name: decode(r, words[place]) for name, (r, place) in self._named.items()}

    def encode(self, values: Mapping[str, Value]) -> list[int]:
        """Words that hold ``values`` and the checksum; registers not named hold zero."""
        words = [0] * self.size
        for name, value in values.items():
            register, place = self._named[name]
            words[place] = encode(register, value)
        if self.seal is not None:
            words[self._place(self.seal)] = encode(self.seal, self._checksum(words))
        return words

    def intact(self, words: Sequence[int]) -> bool:
        """Whether the checksum is that of the words."""
        return self.seal is None or (
            decode(self.seal, words[self._place(self.seal)]) == self._checksum(words)
        )

    def _checksum(self, words: Sequence[int]) -> int:
        assert self.seal is not None
        place = self._place(self.seal)
        return checksum([*words[: place.start], *words[place.stop :]])

    def _place(self, register: Register) -> slice:
        return slice(register.address - self.address, register.end - self.address)


def adjoining(registers: Iterable[Register], span: int = 0) -> list[Window]:
    """Return windows of registers of one table that follow each other without a gap.

    With gaps, too, where a window does not get longer than ``span`` registers.
    """
    groups: list[list[Register]] = []
    for register in sorted(registers, key=lambda r: (r.table, r.address)):
        group = groups[-1] if groups else [register]
        follows = group[-1].end == register.address
        near = follows or register.end - group[0].address <= span
        if groups and near and group[0].table == register.table:
            group.append(register)
        else:
            groups.append([register])
    return [Window(group) for group in groups]
