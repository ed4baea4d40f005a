"""Modbus/TCP frames by the standard alone (MODBUS Messaging on TCP/IP, V1.0b): no library."""

import asyncio
import struct
from dataclasses import dataclass

READ_COILS, READ_DISCRETE, WRITE_COIL = 1, 2, 5
READ_HOLDING, READ_INPUT, WRITE_SINGLE, WRITE_MULTIPLE, READ_WRITE = 3, 4, 6, 16, 23
WRITES = (WRITE_SINGLE, WRITE_MULTIPLE, READ_WRITE)


@dataclass(frozen=True)
class Frame:
    """One request or reply: transaction, unit and protocol data unit."""

    transaction: int
    unit: int
    pdu: bytes

    def encode(self) -> bytes:
        """Return the bytes on the wire."""
        return struct.pack(">HHHB", self.transaction, 0, len(self.pdu) + 1, self.unit) + self.pdu

    def exception(self, code: int) -> "Frame":
        """Return the reply that refuses this request."""
        return Frame(self.transaction, self.unit, bytes([self.pdu[0] | 0x80, code]))


async def read_frame(reader: asyncio.StreamReader) -> Frame | None:
    """Return the next frame, or None where the other side has closed."""
    try:
        header = await reader.readexactly(7)
        transaction, _, length, unit = struct.unpack(">HHHB", header)
        return Frame(transaction, unit, await reader.readexactly(length - 1))
    except (asyncio.IncompleteReadError, ConnectionError, OSError):
        return None


def written(pdu: bytes) -> dict[int, int]:
    """Return the registers, and their values, that a request writes."""
    if pdu[0] == WRITE_SINGLE:
        address, value = struct.unpack(">HH", pdu[1:5])
        return {address: value}
    if pdu[0] == WRITE_MULTIPLE:
        address, count = struct.unpack(">HH", pdu[1:5])
        values = struct.unpack(f">{count}H", pdu[6 : 6 + 2 * count])
    elif pdu[0] == READ_WRITE:
        address, count = struct.unpack(">HH", pdu[5:9])
        values = struct.unpack(f">{count}H", pdu[10 : 10 + 2 * count])
    else:
        return {}
    return dict(enumerate(values, start=address))
