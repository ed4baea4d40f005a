"""A bench device on the network, served by pymodbus until cancelled."""

import asyncio
import contextlib
import ssl
import time
from collections.abc import Callable, Collection, Coroutine
from typing import Any, cast

from pymodbus.constants import ExcCodes
from pymodbus.datastore import ModbusServerContext
from pymodbus.framer import FramerType
from pymodbus.pdu import ExceptionResponse, ModbusPDU
from pymodbus.simulator import DataType, SimData, SimDevice

from dea.bench.connection import (
    FUNCTIONS,
    MAX_SILENCE,
    READING,
    Connection,
    TcpServer,
    TlsServer,
)
from dea.bench.device import BenchDevice, RefusedError, Session
from dea.errors import InputError
from dea.modbus import ReadWriteRequest, ReadWriteResponse

WRITER = "operator"  # the role that may write
_PDUS: list[type[ModbusPDU]] = [ReadWriteRequest]
# Within TLS frames are those of TCP. pymodbus's own framer takes each record for a whole frame.
_FRAMERS = {"tcp": FramerType.SOCKET, "rtu_over_tcp": FramerType.RTU, "tls": FramerType.SOCKET}


class BenchServer:
    """Serve a :class:`BenchDevice` until cancelled.

    Parameters
    ----------
    device
        What is served; its description gives unit id and framing.
    host, port
        Where to listen; port 0 takes a free one, which :attr:`port` holds after :meth:`start`.
    tls
        Server-side context, needed where the framing is ``tls``.
    writers
        Roles whose masters may write, where ``tls`` asks for the masters' certificates; the others
        read. Without TLS, everyone may write.
    """

    def __init__(
        self,
        device: BenchDevice,
        host: str,
        port: int,
        tls: ssl.SSLContext | None = None,
        writers: Collection[str] = (WRITER,),
    ) -> None:
        description = device.description
        if description.framing not in _FRAMERS:
            raise InputError(
                f"the bench cannot be reached by {description.framing}",
                file=description.source,
                field="framing",
                remedy=f"Use {', '.join(_FRAMERS)}.",
            )
        self.device, self.host, self.port, self._tls = device, host, port, tls
        self._writers = frozenset(writers)
        self.connections: set[Connection] = set()
        self._session = Session()
        self._failure: Exception | None = None
        self._server: TcpServer | TlsServer | None = None

    async def start(self) -> None:
        """Listen; raises OSError if the address is not available."""
        description = self.device.description
        table = SimDevice(
            id=description.unit_id,
            simdata=[SimData(0, count=0x10000, datatype=DataType.REGISTERS)],
            action=self._action,
        )
        framer, address = _FRAMERS[description.framing], (self.host, self.port)
        if description.framing == "tls":
            self._server = TlsServer(
                table, framer=framer, address=address, sslctx=self._tls, custom_pdu=_PDUS
            )
        else:
            self._server = TcpServer(table, framer=framer, address=address, custom_pdu=_PDUS)
        self._server.bench = self
        if not await self._server.listen():
            raise OSError(f"cannot listen on {self.host}:{self.port}")
        self.port = self._server.transport.sockets[0].getsockname()[1]  # type: ignore[attr-defined]

    async def run(self) -> None:
        """Run the clock and the watchdog until cancelled; then close.

        An exception of the plant ends the server with that exception.
        """
        device = self.device
        pause = min(device.period, device.player.watchdog.timeout / 4)
        device.wind(time.monotonic())
        try:
            while self._failure is None:
                now = time.monotonic()
                device.watch(now)
                self._drop_the_silent(now)
                due = device.tick(now) - time.monotonic()
                await asyncio.sleep(pause if device.virtual_clock else max(0.0, due))
            raise self._failure
        finally:
            await self.close()

    async def close(self) -> None:
        """Stop listening and drop every connection."""
        if self._server is not None:
            await self._server.shutdown()

    def pump(self) -> None:
        """Let the device's virtual clock run; an exception of the plant ends the server."""
        try:
            self.device.pump()
        except Exception as error:
            self._failure = error

    def owns(self, session: Session) -> bool:
        """Whether this master owns the outputs."""
        return self.device.owns(session)

    def may_write(self, certificate: bytes | None) -> bool:
        """Whether a master with this certificate (DER; ``None`` where it gave none) may write."""
        if self._tls is None or self._tls.verify_mode != ssl.CERT_REQUIRED:
            return True
        # Few benches ask for certificates, and their parser takes a while to import.
        from dea.bench.role import role

        return certificate is not None and role(certificate) in self._writers

    def _drop_the_silent(self, now: float) -> None:
        for connection in list(self.connections):
            if now - connection.heard > MAX_SILENCE and not self.owns(connection.session):
                connection.drop()

    def answer(self, session: Session, request: ModbusPDU) -> ModbusPDU:
        """Reply to one request of one master."""
        device, self._session = self.device, session
        if request.dev_id != device.description.unit_id:
            return ExceptionResponse(request.function_code, ExcCodes.GATEWAY_NO_RESPONSE)
        allowed = FUNCTIONS if session.may_write else READING
        if request.function_code not in allowed:
            return ExceptionResponse(request.function_code, ExcCodes.ILLEGAL_FUNCTION)
        if isinstance(request, ReadWriteRequest):
            reply = self._read_write(request)
        else:
            assert self._server is not None
            context = cast(ModbusServerContext, self._server.context)
            reply = _finish(request.datastore_update(context, request.dev_id))
        device.heard(session, time.monotonic())
        return reply

    def _read_write(self, request: ReadWriteRequest) -> ModbusPDU:
        """Answer function code 23, which carries the blocks, without pymodbus's slow checks."""
        if not request.valid:
            return ExceptionResponse(request.function_code, ExcCodes.ILLEGAL_VALUE)
        try:
            # Before the write: an exception beyond the map says that nothing has been done.
            self.device.refuse_beyond(request.read_address, request.read_count)
            self.device.write(self._session, request.write_address, request.write_registers)
            words = self.device.read(self._session, request.read_address, request.read_count)
        except RefusedError as refusal:
            return ExceptionResponse(request.function_code, refusal.code)
        return ReadWriteResponse(registers=words)

    async def _action(
        self,
        function: int,
        start: int,
        address: int,
        count: int,
        registers: list[int],
        values: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        """Called by pymodbus before it stores (values given) and before it reads."""
        try:
            if values is not None:
                self.device.write(self._session, address, [int(v) for v in values])
            elif function not in (6, 16):
                offset = address - start
                registers[offset : offset + count] = self.device.read(self._session, address, count)
        except RefusedError as refusal:
            return ExcCodes(refusal.code)
        return None


def _finish(answer: Coroutine[Any, Any, ModbusPDU]) -> ModbusPDU:
    """Return the result of a coroutine that never waits."""
    try:
        answer.send(None)
    except StopIteration as done:
        reply: ModbusPDU = done.value
        return reply
    answer.close()
    raise RuntimeError("a device's answer must not wait")


async def serve(server: BenchServer, announce: Callable[[BenchServer], None]) -> None:
    """Start ``server``, announce its address and run until cancelled."""
    await server.start()
    announce(server)
    with contextlib.suppress(asyncio.CancelledError):
        await server.run()
