"""pymodbus's register messages, packed by one call instead of register by register.

A block of samples fills the largest Modbus frames; pymodbus 3.16 packs each register by itself and
formats every message for its debug log. These classes are registered with it for the exchange of
blocks; the bytes on the wire are the same.
"""

import struct

from pymodbus.exceptions import ModbusIOException
from pymodbus.pdu.register_message import (
    ReadHoldingRegistersResponse,
    ReadWriteMultipleRegistersRequest,
    ReadWriteMultipleRegistersResponse,
)


class ReadWriteRequest(ReadWriteMultipleRegistersRequest):
    """Write registers, then read others (function code 23)."""

    def encode(self) -> bytes:
        """Data of the request."""
        count = len(self.write_registers)
        return struct.pack(
            f">HHHHB{count}H", self.read_address, self.read_count, self.write_address, count,
            2 * count, *self.write_registers,
        )  # fmt: skip

    def decode(self, data: bytes) -> None:
        """Read the request's data; see :attr:`valid`."""
        head = struct.unpack_from(">HHHHB", data)
        self.read_address, self.read_count, self.write_address, self.write_count = head[:4]
        self.write_byte_count, self._payload_byte_count = head[4], len(data) - 9
        whole = min(self._payload_byte_count, self.write_byte_count) // 2
        self.write_registers = list(struct.unpack_from(f">{whole}H", data, 9))

    @property
    def valid(self) -> bool:
        """Whether the counts are those the standard allows and agree with each other."""
        return (
            1 <= self.read_count <= self.MAX_READ_COUNT
            and 1 <= self.write_count <= self.MAX_WRITE_COUNT
            and self.write_byte_count == 2 * self.write_count == self._payload_byte_count
        )

    def __str__(self) -> str:
        return type(self).__name__


class RegistersResponse(ReadHoldingRegistersResponse):
    """Registers that were read (function code 3)."""

    def encode(self) -> bytes:
        """Data of the response."""
        count = len(self.registers)
        return struct.pack(f">B{count}H", 2 * count, *self.registers)

    def decode(self, data: bytes) -> None:
        """Read the response's data."""
        if len(data) != 1 + data[0] or data[0] % 2:
            raise ModbusIOException(f"{data[0]} bytes announced, {len(data) - 1} sent")
        self.registers = list(struct.unpack_from(f">{data[0] // 2}H", data, 1))

    def __str__(self) -> str:
        return type(self).__name__


class ReadWriteResponse(RegistersResponse, ReadWriteMultipleRegistersResponse):
    """Registers that were read after a write (function code 23)."""

    function_code = 23
