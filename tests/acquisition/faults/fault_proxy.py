"""A proxy between client and bench that harms what passes, frame by frame, as a schedule says."""

import asyncio
import threading
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from dea.modbus import Device

Way = Literal["request", "reply"]
TIMEOUT = 0.08  # s, that the client under test waits for a reply


@dataclass(frozen=True)
class Fault:
    """``kind`` befalls frame ``number`` going one ``way``, counted over all connections.

    ``amount`` in [0, 1) says where in the frame, how long, or with which code, see ``FAULTS``.
    With ``driven`` the first frame that drives the output, or its reply, is number 0: how many
    frames go before that depends on how busy the host is.
    """

    way: Way
    number: int
    kind: str
    amount: float = 0.5
    driven: bool = False


def drives(frame: bytes, device: Device) -> bool:
    """Whether a request of Modbus TCP hands over samples, or writes an output above zero."""
    function, body = frame[7], frame[8:]
    if function == 23:
        body = body[4:]
    elif function not in (6, 16):
        return False
    address, content = int.from_bytes(body[:2], "big"), body[2 if function == 6 else 5 :]
    if address == device["output"].address:
        return any(content[:2])
    # A block with the sequence number 0 only reads.
    return address == device["block_crc"].address and any(content[4:8])


class FaultProxy:
    """Listens on a free loopback port, :attr:`port`, and passes frames on to ``target``.

    ``restart`` is called where the schedule restarts the bench. ``device`` describes it; where its
    frames are RTU's, faults of Modbus TCP's header mean nothing. :attr:`done` lists the faults that
    came to pass.
    """

    def __init__(
        self,
        target: tuple[str, int],
        faults: Sequence[Fault],
        restart: Callable[[], None],
        device: Device,
    ) -> None:
        self.target, self.restart, self.device = target, restart, device
        self.rtu = device.framing == "rtu_over_tcp"
        self.done: list[Fault] = []
        self.closed_until = self.frozen_until = 0.0  # s, the loop's time
        self._faults = {(fault.way, fault.number, fault.driven): fault for fault in faults}
        self._passed = {"request": 0, "reply": 0}
        self._undriven: dict[str, int] | None = None  # frames that had passed before the drive

    def __enter__(self) -> "FaultProxy":
        listening = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve(listening)))
        self._thread.start()
        assert listening.wait(5), "the proxy does not listen"
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join()

    def next_fault(self, way: Way, frame: bytes) -> Fault | None:
        """What befalls the frame that passes now."""
        number = self._passed[way]
        fault = self._faults.get((way, number, False))
        undriven = self._undriven is None and way == "request" and not self.rtu
        if undriven and drives(frame, self.device):
            self._undriven = self._passed.copy()
        if self._undriven is not None:
            fault = self._faults.get((way, number - self._undriven[way], True), fault)
        self._passed[way] += 1
        if fault is not None:
            self.done.append(fault)
        return fault

    async def thaw(self) -> None:
        """Wait while everything is frozen."""
        while (pause := self.frozen_until - self._loop.time()) > 0:
            await asyncio.sleep(pause)

    def now(self) -> float:
        """The loop's time, s."""
        return self._loop.time()

    async def _serve(self, listening: threading.Event) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        listening.set()
        await self._ended.wait()
        server.close()

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await self.thaw()
        if self.now() < self.closed_until:
            writer.transport.abort()
            return
        try:
            from_bench, to_bench = await asyncio.open_connection(*self.target)
        except OSError:
            writer.transport.abort()
            return
        wires = Wire(self, "request", reader, to_bench), Wire(self, "reply", from_bench, writer)
        wires[0].other, wires[1].other = wires[1], wires[0]
        with suppress(asyncio.CancelledError):  # the proxy ends
            await asyncio.gather(*(wire.pump() for wire in wires))


class Wire:
    """One way of one connection."""

    def __init__(
        self,
        proxy: FaultProxy,
        way: Way,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        self.proxy, self.way, self._reader, self._writer = proxy, way, reader, writer
        self.other = self
        self.previous = b""
        self.deaf = False

    async def pump(self) -> None:
        """Pass frames on until an end closes; what was delayed still arrives after that."""
        try:
            while True:
                frame = await self._frame()
                fault = self.proxy.next_fault(self.way, frame)
                await self.proxy.thaw()
                if fault is None:
                    self.send(frame)
                else:
                    await FAULTS[fault.kind](self, frame, fault.amount)
                self.previous = frame
        except (asyncio.IncompleteReadError, ConnectionError):
            if not self.deaf:
                self._writer.close()

    async def _frame(self) -> bytes:
        """The next frame; RTU's does not tell its length, but comes in one segment."""
        if self.proxy.rtu:
            frame = await self._reader.read(300)
            if not frame:
                raise asyncio.IncompleteReadError(frame, None)
            return frame
        header = await self._reader.readexactly(6)
        return header + await self._reader.readexactly(int.from_bytes(header[4:], "big"))

    def send(self, data: bytes) -> None:
        """Pass bytes on, unless nothing passes any more."""
        if not self.deaf:
            self._writer.write(data)

    def cut(self) -> None:
        """Break the connection at both ends."""
        self._writer.transport.abort()
        self.other._writer.transport.abort()

    def hang(self) -> None:
        """Leave both ends open with nothing passing."""
        self.deaf = self.other.deaf = True

    def abandon(self) -> None:
        """Break the connection at the bench's end; the client is not told."""
        self.hang()
        to_bench = self if self.way == "request" else self.other
        to_bench._writer.transport.abort()


async def _cut_before(wire: Wire, frame: bytes, amount: float) -> None:
    wire.cut()


async def _cut_after(wire: Wire, frame: bytes, amount: float) -> None:
    wire.send(frame)
    await asyncio.sleep(amount * 2e-3)
    wire.cut()


async def _outage(wire: Wire, frame: bytes, amount: float) -> None:
    wire.proxy.closed_until = wire.proxy.now() + 4 * amount * TIMEOUT
    wire.cut()


async def _delay(wire: Wire, frame: bytes, amount: float) -> None:
    await asyncio.sleep(3 * amount * TIMEOUT)
    wire.send(frame)


async def _freeze(wire: Wire, frame: bytes, amount: float) -> None:
    wire.proxy.frozen_until = wire.proxy.now() + 8 * amount * TIMEOUT
    await wire.proxy.thaw()
    wire.send(frame)


async def _half_open(wire: Wire, frame: bytes, amount: float) -> None:
    wire.hang() if amount < 0.5 else wire.abandon()


async def _lose(wire: Wire, frame: bytes, amount: float) -> None:
    """Let the frame vanish, which TCP cannot do but a gateway to a serial line can."""


async def _duplicate(wire: Wire, frame: bytes, amount: float) -> None:
    """Send the frame twice, in one segment or one after the other."""
    if amount < 0.5:
        wire.send(frame + frame)
    else:
        wire.send(frame)
        await asyncio.sleep((amount - 0.5) * 4e-3)
        wire.send(frame)


async def _merge(wire: Wire, frame: bytes, amount: float) -> None:
    """Put the frame before this one into the same segment once more."""
    wire.send(wire.previous + frame)


async def _split(wire: Wire, frame: bytes, amount: float) -> None:
    step = 1 + int(amount * 60)
    for start in range(0, len(frame), step):
        wire.send(frame[start : start + step])
        await asyncio.sleep(5e-4)


async def _truncate(wire: Wire, frame: bytes, amount: float) -> None:
    wire.send(frame[: int(amount * len(frame))])


async def _garble(wire: Wire, frame: bytes, amount: float) -> None:
    place, bits = divmod(amount * len(frame), 1)
    data = bytearray(frame)
    data[int(place)] ^= 1 + int(bits * 255)
    wire.send(bytes(data))


async def _wrong_transaction(wire: Wire, frame: bytes, amount: float) -> None:
    number = int.from_bytes(frame[:2], "big") + 1 + int(amount * 0xFFFE)
    wire.send((number % 0x10000).to_bytes(2, "big") + frame[2:])


async def _wrong_unit(wire: Wire, frame: bytes, amount: float) -> None:
    wire.send(frame[:6] + bytes([frame[6] ^ (1 + int(amount * 255))]) + frame[7:])


async def _exception(wire: Wire, frame: bytes, amount: float) -> None:
    """Answer with an exception: instead of the bench, or instead of its answer."""
    code = (1, 2, 3, 4, 5, 6, 10, 11)[int(amount * 8)]
    answer = frame[:4] + b"\0\3" + frame[6:7] + bytes([frame[7] | 0x80, code])
    (wire.other if wire.way == "request" else wire).send(answer)


async def _restart(wire: Wire, frame: bytes, amount: float) -> None:
    await asyncio.to_thread(wire.proxy.restart)


FAULTS: dict[str, Callable[[Wire, bytes, float], Awaitable[None]]] = {
    "cut before": _cut_before,
    "cut after": _cut_after,
    "outage": _outage,
    "delay": _delay,
    "freeze": _freeze,
    "half-open": _half_open,
    "lose": _lose,
    "duplicate": _duplicate,
    "merge": _merge,
    "split": _split,
    "truncate": _truncate,
    "garble": _garble,
    "wrong transaction": _wrong_transaction,
    "wrong unit": _wrong_unit,
    "exception": _exception,
    "restart": _restart,
}
