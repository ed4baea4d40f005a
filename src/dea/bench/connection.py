"""One master's connection: its frames answered in order, its use of the server limited.

pymodbus 3.16 handles one request per connection: a second one in the same segment overtakes or
blocks the first. Here each frame is answered before the next one is decoded.
"""

import socket
import time
from typing import Protocol

from pymodbus.constants import ExcCodes
from pymodbus.framer import FramerRTU, FramerSocket
from pymodbus.pdu import ExceptionResponse, ModbusPDU
from pymodbus.server import ModbusTcpServer, ModbusTlsServer
from pymodbus.server.requesthandler import ServerRequestHandler

from dea.bench.device import Session

READING = (3, 4)
FUNCTIONS = (*READING, 6, 16, 23)
MAX_FRAME = 260  # bytes of a Modbus frame on TCP
MAX_BURST = 16  # frames of one master answered before the other masters' frames
MAX_CONNECTIONS = 64
MAX_SILENCE = 60.0  # s without a request, after which a master that does not own the outputs goes
MAX_UNREAD = 64 * 1024  # bytes of replies that a client may leave unread


class RequestHandler(Protocol):
    """What answers the masters' requests."""

    connections: set["Connection"]

    def owns(self, session: Session) -> bool:
        """Whether this master owns the outputs."""
        ...

    def may_write(self, certificate: bytes | None) -> bool:
        """Whether a master with this certificate (DER; ``None`` without TLS) may write."""
        ...

    def answer(self, session: Session, request: ModbusPDU) -> ModbusPDU:
        """Reply to one request of one master."""
        ...

    def pump(self) -> None:
        """Continue after a reply has been sent."""
        ...


class Connection(ServerRequestHandler):
    """One master's connection: decodes its frames and sends the replies."""

    def __init__(self, owner: "TcpServer | TlsServer") -> None:
        super().__init__(owner, None, None, None)
        self.bench, self.session, self.pending = owner.bench, Session(), b""
        self.heard = time.monotonic()

    def callback_connected(self) -> None:
        """Add this master, with its role and a limit of the replies that it may leave unread.

        Where there are as many connections as are allowed, the one without a request for longest is
        closed. One of the owner of the outputs is only where all are the owner's, since those
        before the last were lost on the way.
        """
        super().callback_connected()
        present = self.bench.connections
        others = [other for other in present if not self.bench.owns(other.session)]
        if len(present) >= MAX_CONNECTIONS:
            min(others or present, key=lambda other: other.heard).drop()
        self.bench.connections.add(self)
        encrypted = self.transport.get_extra_info("ssl_object")
        certificate = encrypted.getpeercert(binary_form=True) if encrypted else None
        self.session.may_write = self.bench.may_write(certificate)
        self.transport.set_write_buffer_limits(high=MAX_UNREAD)  # type: ignore[attr-defined]
        plain: socket.socket = self.transport.get_extra_info("socket")
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MAX_UNREAD)

    def callback_disconnected(self, exc: Exception | None) -> None:
        """Forget the master; the watchdog ends what it drives."""
        super().callback_disconnected(exc)
        self.bench.connections.discard(self)

    def drop(self) -> None:
        """Close the connection at once."""
        self.bench.connections.discard(self)
        self.transport.abort()  # type: ignore[attr-defined]

    def pause_writing(self) -> None:
        """Drop a client that does not read its replies."""
        self.drop()

    def resume_writing(self) -> None:
        """Do nothing: a paused client has been dropped."""

    def data_received(self, data: bytes) -> None:
        """Answer every whole frame in the order of arrival; drop a client that sends no frames."""
        self.pending += data
        self._work()

    def _work(self) -> None:
        """Answer at most MAX_BURST frames, then let the other masters' frames be answered."""
        for _ in range(MAX_BURST):
            if self.transport is None or self.transport.is_closing():
                return
            if isinstance(self.framer, FramerSocket) and _malformed(self.pending):
                break
            used, frame = self._frame()
            if not used:
                if len(self.pending) > MAX_FRAME:
                    break
                self.transport.resume_reading()  # type: ignore[attr-defined]
                return
            self.pending = self.pending[used:]
            if frame:
                self._serve(*frame)
        else:
            self.transport.pause_reading()  # type: ignore[attr-defined]
            self.loop.call_soon(self._work)
            return
        self.transport.abort()  # type: ignore[attr-defined]

    def _frame(self) -> tuple[int, tuple[int, int, bytes] | None]:
        used, unit, transaction, pdu = self.framer.decode(self.pending)
        if isinstance(self.framer, FramerRTU) and used:
            # pymodbus's RTU framer claims the whole buffer; a master sends one request at a time.
            used = len(self.pending)
        return used, (unit, transaction, pdu) if pdu else None

    def _serve(self, unit: int, transaction: int, pdu: bytes) -> None:
        self.heard = time.monotonic()
        request = self.framer.decoder.decode(pdu)
        if request is None:
            code = ExcCodes.ILLEGAL_VALUE if pdu[0] in FUNCTIONS else ExcCodes.ILLEGAL_FUNCTION
            reply: ModbusPDU = ExceptionResponse(pdu[0] & 0x7F, code)
        else:
            request.dev_id, request.transaction_id = unit, transaction
            reply = self.bench.answer(self.session, request)
        reply.dev_id, reply.transaction_id = unit, transaction
        self.pdu_send(reply)
        # After the reply, so that the plant is simulated while the host processes it.
        self.bench.pump()


class TcpServer(ModbusTcpServer):
    """Listens for masters over TCP."""

    bench: RequestHandler

    def callback_new_connection(self) -> Connection:
        """Return a new master's connection."""
        return Connection(self)


class TlsServer(ModbusTlsServer):
    """Listens for masters over TLS."""

    bench: RequestHandler

    def callback_new_connection(self) -> Connection:
        """Return a new master's connection."""
        return Connection(self)


def _malformed(data: bytes) -> bool:
    """Whether a Modbus TCP header has the wrong protocol or an impossible length."""
    if len(data) < 6:
        return False
    length = int.from_bytes(data[4:6], "big")
    return data[2:4] != b"\0\0" or not 2 <= length <= MAX_FRAME - 6
