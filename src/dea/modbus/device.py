"""A Modbus device as its description gives it: where it is, how it is framed, its registers."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Self

from dea.configuration.device import Endpoint, Framing, Parity
from dea.configuration.problems import validated
from dea.configuration.register import WORDS, Access, Order, RegisterType, Table
from dea.configuration.safety import Safety
from dea.errors import InputError


@dataclass(frozen=True)
class Register:
    """One named value of the device, ``value = offset + scale * raw``.

    ``count`` is the number of values of an array, or of registers of a string. ``limits`` and
    ``range`` are in ``unit``; a ``range`` is what the lowest and the highest raw value mean, and
    stands for scale and offset. ``expect`` is what must be read before any voltage is applied.
    ``tolerance``, in ``unit``, is how far a reading may be off.
    """

    name: str
    address: int
    type: RegisterType = "uint16"
    table: Table = "holding"
    count: int = 1
    word_order: Order = "big"
    byte_order: Order = "big"
    scale: float = 1.0
    offset: float = 0.0
    unit: str = "1"
    access: Access = "read"
    range: tuple[float, float] | None = None
    limits: tuple[float, float] | None = None
    expect: float | str | None = None
    tolerance: float = 0.0

    @property
    def size(self) -> int:
        """Number of 16-bit registers the value occupies."""
        return WORDS[self.type] * self.count

    @property
    def end(self) -> int:
        """First address after the value."""
        return self.address + self.size


@dataclass(frozen=True)
class Tls:
    """Certificates of a TLS link; ``ca_file`` signs the device's, the others are the client's."""

    ca_file: str | None = None
    server_name: str | None = None
    certificate_file: str | None = None
    key_file: str | None = None


@dataclass(frozen=True)
class Serial:
    """A serial line; ``baudrate`` in bit/s."""

    port: str
    baudrate: int = 19200
    parity: Parity = "E"
    stopbits: int = 1


@dataclass(frozen=True)
class Device:
    """A Modbus device: endpoint, framing and register map.

    ``read_write_multiple`` says whether it answers function code 23. ``quarantine`` is how long
    zero is held and watched before it is believed. ``virtual`` says that the device is a process
    started for the purpose, whose film ends with it. ``safety`` is what must hold while there is
    high voltage. ``source`` is the file the description came from, for messages, and ``described``
    its text as it was read; ``elsewhere`` says that the device is at another host or port.
    """

    name: str
    unit_id: int
    sampling_rate: float  # Hz
    registers: Mapping[str, Register]
    host: str = "127.0.0.1"
    port: int = 502
    framing: Framing = "tcp"
    tls: Tls = field(default_factory=Tls)
    serial: Serial | None = None
    read_write_multiple: bool = False
    quarantine: float = 0.0  # s
    virtual: bool = False
    safety: Safety | None = None
    source: Path | None = None
    described: str = ""
    elsewhere: bool = False

    def at(self, host: str | None = None, port: int | None = None) -> Self:
        """Return the same device at another host or TCP port, where they are given.

        Raises
        ------
        InputError
            If the port is none.
        """
        there = {
            "host": self.host if host is None else host,
            "port": self.port if port is None else port,
        }
        elsewhere = self.elsewhere or there != {"host": self.host, "port": self.port}
        return replace(self, **validated(Endpoint, there).model_dump(), elsewhere=elsewhere)

    def __getitem__(self, name: str) -> Register:
        """Return the register called ``name``; raise InputError where the device has none."""
        try:
            return self.registers[name]
        except KeyError:
            raise InputError(
                f"the device has no register {name!r}",
                file=self.source,
                field="registers",
                remedy=f"Describe it; there are {', '.join(sorted(self.registers))}.",
            ) from None

    def __contains__(self, name: str) -> bool:
        return name in self.registers
