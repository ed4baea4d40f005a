"""A gateway between client and device that misbehaves as its schedule says."""

import asyncio
import time
from collections.abc import Callable, Coroutine, Sequence

from benchmarks.faults.modbus_frame import WRITES, Frame, read_frame, written
from benchmarks.faults.schedule import LinkFault

Connection = asyncio.StreamWriter


class FaultProxy:
    """Forwards frames to ``port``; the faults' times count from the first write of the client."""

    def __init__(
        self, port: int, faults: Sequence[LinkFault], on_first_write: Callable[[], None]
    ) -> None:
        self.origin: float | None = None  # monotonic s of the first write
        self.requests: list[tuple[float, dict[int, int]]] = []  # time and registers of each write
        self._port = port
        self._faults = faults
        self._held: set[LinkFault] = set()  # of which a write has been held already
        self._half_open: set[Connection] = set()
        self._clients: set[Connection] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._server: asyncio.Server | None = None
        self._on_first_write = on_first_write

    async def start(self) -> int:
        """Listen on a free port of loopback, and return it."""
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        return int(self._server.sockets[0].getsockname()[1])

    async def stop(self) -> None:
        """Close every connection and forget what is still held."""
        if self._server is not None:
            self._server.close()
        for task in self._tasks:
            task.cancel()
        for writer in self._clients:
            writer.close()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _spawn(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _active(self, *kinds: str) -> LinkFault | None:
        if self.origin is None:
            return None
        now = time.monotonic() - self.origin
        for fault in self._faults:
            if fault.kind in kinds and fault.start <= now < fault.end:
                return fault
        return None

    async def _at(self, fault: LinkFault) -> None:
        """Break the connections that stand when a fault begins."""
        assert self.origin is not None
        await asyncio.sleep(max(0.0, self.origin + fault.start - time.monotonic()))
        if fault.kind == "half_open":
            self._half_open |= self._clients
        else:
            for writer in list(self._clients):
                writer.transport.abort()

    def _note_write(self, frame: Frame) -> None:
        if frame.pdu[0] not in WRITES:
            return
        self.requests.append((time.monotonic(), written(frame.pdu)))
        if self.origin is None:
            self.origin = time.monotonic()
            self._on_first_write()
            for fault in self._faults:
                if fault.kind in ("drop", "refuse", "half_open"):
                    self._spawn(self._at(fault))

    async def _serve(self, reader: asyncio.StreamReader, writer: Connection) -> None:
        if self._active("refuse"):
            writer.transport.abort()
            return
        self._clients.add(writer)
        frames: asyncio.Queue[Frame | None] = asyncio.Queue()
        self._spawn(self._forward(frames, writer))
        while (frame := await read_frame(reader)) is not None:
            self._note_write(frame)
            frames.put_nowait(frame)
        frames.put_nowait(None)

    async def _forward(self, frames: "asyncio.Queue[Frame | None]", writer: Connection) -> None:
        """Forward the frames of one connection in order, those of a closed one too."""
        upstream: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
        try:
            while (frame := await frames.get()) is not None:
                if upstream is None:
                    upstream = await asyncio.open_connection("127.0.0.1", self._port)
                if writer in self._half_open:
                    continue
                reply = await self._answer(frame, *upstream)
                if reply is not None and not writer.is_closing():
                    writer.write(reply.encode())
        except (ConnectionError, OSError):
            pass  # the device has gone; the client finds its connection closed
        finally:
            self._clients.discard(writer)
            writer.close()
            if upstream is not None:
                upstream[1].close()

    async def _answer(
        self, frame: Frame, reader: asyncio.StreamReader, writer: Connection
    ) -> Frame | None:
        fault = self._active("cut", "exception", "hold", "delay")
        if fault is not None and fault.kind == "cut":
            await self._until(fault)
            if not fault.executed:
                return None
        holds = fault is not None and fault.kind == "hold" and fault not in self._held
        if fault is not None and holds and frame.pdu[0] in WRITES:
            self._held.add(fault)
            await asyncio.sleep(fault.length)
        if fault is not None and fault.kind == "delay":
            await asyncio.sleep(fault.code / 1000)
        if fault is not None and fault.kind == "exception" and not fault.executed:
            return frame.exception(fault.code)
        writer.write(frame.encode())
        reply = await read_frame(reader)
        if reply is None:
            raise ConnectionResetError
        if self._active("cut"):
            return None
        return frame.exception(fault.code) if fault and fault.kind == "exception" else reply

    async def _until(self, fault: LinkFault) -> None:
        assert self.origin is not None
        await asyncio.sleep(max(0.0, self.origin + fault.end - time.monotonic()))
