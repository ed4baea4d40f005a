"""A plain analogue module on Modbus/TCP: sockets alone, no watchdog, no owner, no buffer.

Holding register 0 is the output. Input register 0 is the displacement, and input register 1 reads
the output back. Registers 2 and 3 measure the high voltage and the current behind it, discrete
input 0 is an interlock, coil 0 enables the high voltage, holding register 1 is a sign of life; only
a description with ``SAFETY`` names them. The module remembers every output it has applied, and
when. The displacement is a tag: it names the write that was in effect when it was read, so that a
recorded sample tells which output it belongs to.
"""

import asyncio
import random
import struct
import time
from dataclasses import dataclass

from benchmarks.faults.modbus_frame import (
    READ_COILS,
    READ_DISCRETE,
    READ_HOLDING,
    READ_INPUT,
    READ_WRITE,
    WRITE_COIL,
    WRITES,
    Frame,
    read_frame,
    written,
)
from benchmarks.faults.trace import Applied, Trace

FULL_SCALE = 10.0  # V of 65535 counts
OUTPUT, HEARTBEAT = 0, 1  # holding registers
TAG_FIRST, TAG_STEP, TAGS = 5000, 7, 7000  # counts of the displacement
DESCRIPTION = """\
name: plain module
endpoint: {{host: 127.0.0.1, port: {port}}}
unit_id: 1
sampling_rate: 50
read_write_multiple: {both}
quarantine: {quarantine}
registers:
  output: {{address: 0, table: holding, range: [0, 10], unit: V, limits: [0, 3.76],
           access: read_write}}
  displacement: {{address: 0, table: input, range: [0, 10], unit: mm}}
  applied_output: {{address: 1, table: input, range: [0, 10], unit: V}}
"""
SAFETY = """\
  monitor: {address: 2, table: input, range: [0, 10], unit: kV}
  current: {address: 3, table: input, range: [0, 10], unit: mA}
  interlock: {address: 0, table: discrete, type: bool}
  enable: {address: 0, table: coil, type: bool, access: read_write}
  heartbeat: {address: 1, table: holding, access: read_write}
safety:
  max_rate: 15
  monitor: {name: monitor, gain: 0.8, tolerance: 0.1}
  current: {name: current, limit: 1.0}
  interlocks: {door: {name: interlock}}
  enable: {name: enable}
  heartbeat: {name: heartbeat, period: 0.5}
"""
MONITOR_GAIN = 0.8  # kV/V
CURRENT, TOO_MUCH = 0.2, 2.0  # mA


def tag(serial: int) -> int:
    """Return the displacement, in counts, that names a write."""
    return TAG_FIRST + TAG_STEP * (serial % TAGS)


@dataclass(frozen=True)
class ReadBack:
    """How the module reads its output back: ``true``, or wrong in one of the ways below."""

    kind: str = "true"  # true, stuck, clamped, scaled, offset, noisy
    value: float = 0.0  # V of stuck, clamped, offset and noise; factor of scaled

    def applies(self, counts: int) -> int:
        """Return what the converter puts out where ``counts`` are asked for."""
        return min(counts, to_counts(self.value)) if self.kind == "clamped" else counts

    def reads(self, counts: int, rng: random.Random) -> int:
        """Return what the read-back register says while ``counts`` are put out."""
        if self.kind == "stuck":
            counts = to_counts(self.value)
        elif self.kind == "scaled":
            counts = round(counts * self.value)
        elif self.kind == "offset":
            counts += to_counts(self.value)
        elif self.kind == "noisy":
            counts += round(rng.gauss(0, to_counts(self.value)))
        return min(max(counts, 0), 65535)


def to_counts(volts: float) -> int:
    """Return the counts of a voltage."""
    return round(volts / FULL_SCALE * 65535)


class PlainModule:
    """The module; serves every connection, obeys every write at once."""

    def __init__(self, read_back: ReadBack, seed: int) -> None:
        self.read_back = read_back
        self.trace = Trace()
        self.faults: set[str] = set()  # kinds of DeviceFault that have begun
        self._enabled = 0
        self._heartbeat = 0
        self._rng = random.Random(seed)
        self._counts = 0
        self._serial = 0
        self._server: asyncio.Server | None = None
        self._writers: set[asyncio.StreamWriter] = set()

    async def start(self) -> int:
        """Listen on a free port of loopback, and return it."""
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self._remember(0)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Close every connection."""
        if self._server is not None:
            self._server.close()
        for writer in self._writers:
            writer.close()

    def forget(self) -> None:
        """Begin the trace anew."""
        self.trace.applied.clear()
        self._remember(self._counts)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.add(writer)
        while (request := await read_frame(reader)) is not None:
            reply = Frame(request.transaction, request.unit, self.answer(request.pdu))
            writer.write(reply.encode())
        self._writers.discard(writer)
        writer.close()

    def answer(self, pdu: bytes) -> bytes:
        """Execute one request and return the reply's protocol data unit."""
        function = pdu[0]
        if function in (READ_COILS, READ_DISCRETE, WRITE_COIL):
            return self._answer_bits(pdu)
        if function not in (READ_HOLDING, READ_INPUT, *WRITES):
            return bytes([function | 0x80, 1])
        for address, value in written(pdu).items():
            if address == OUTPUT:
                self._write(value)
            elif address == HEARTBEAT:
                self._heartbeat = value
            else:
                return bytes([function | 0x80, 2])
        if function in (READ_HOLDING, READ_INPUT, READ_WRITE):
            address, count = struct.unpack(">HH", pdu[1:5])
            table = self._holding() if function != READ_INPUT else self._input()
            if not 0 < count <= 125 or address + count > len(table):
                return bytes([function | 0x80, 2])
            values = table[address : address + count]
            return struct.pack(f">BB{count}H", function, 2 * count, *values)
        return pdu[:5]

    def _answer_bits(self, pdu: bytes) -> bytes:
        function, address, value = struct.unpack(">BHH", pdu[:5])
        if address != 0 or (function != WRITE_COIL and value != 1):
            return bytes([function | 0x80, 2])
        if function == WRITE_COIL:
            self._enabled = int(value == 0xFF00)
            return pdu[:5]
        closed = int("interlock" not in self.faults)
        return bytes([function, 1, self._enabled if function == READ_COILS else closed])

    def _holding(self) -> list[int]:
        return [self._counts, self._heartbeat]

    def _input(self) -> list[int]:
        read_back = self.read_back.reads(self._counts, self._rng)
        high_voltage = round(self._counts * MONITOR_GAIN * self._enabled)
        if "monitor" in self.faults:
            high_voltage //= 2
        current = to_counts(TOO_MUCH if "current" in self.faults else CURRENT)
        return [tag(self._serial), read_back, high_voltage, current]

    def _write(self, value: int) -> None:
        self._serial += 1
        self._remember(self.read_back.applies(value))

    def _remember(self, counts: int) -> None:
        self._counts = counts
        volts = counts / 65535 * FULL_SCALE
        entry = Applied(time.monotonic(), volts, counts, tag(self._serial), self._serial)
        self.trace.applied.append(entry)
