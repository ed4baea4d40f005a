"""Messages between the recorder and the guardian, which never waits for the recorder."""

import pickle
import select
import socket
import struct
from typing import Any

_LENGTH = struct.Struct("<I")
_PIECE = 1 << 16  # bytes taken or given at once


class Wire:
    """One end of a socket pair: whole messages, sent and received without waiting.

    What the other end does not take is kept in memory, so that a reader that has stopped does not
    block the writer.
    Messages are pickled: both ends are this program.
    """

    def __init__(self, end: socket.socket) -> None:
        end.setblocking(False)
        self._end, self._out, self._in = end, bytearray(), bytearray()
        self.closed = False

    @property
    def unsent(self) -> bool:
        """Whether the other end has not taken everything."""
        return bool(self._out)

    def post(self, *message: Any) -> None:
        """Send a message, or keep it until the other end takes it."""
        if self.closed:
            return
        data = pickle.dumps(message)
        self._out += _LENGTH.pack(len(data)) + data
        self.flush()

    def flush(self) -> None:
        """Send as much as the other end takes now."""
        try:
            while self._out and not self.closed:
                del self._out[: self._end.send(self._out[:_PIECE])]
        except BlockingIOError:
            pass
        except OSError:
            self.closed = True

    def take(self) -> list[tuple[Any, ...]]:
        """Return the whole messages that have come; sets ``closed`` where the other end has."""
        self.flush()
        try:
            while data := self._end.recv(_PIECE):
                self._in += data
            self.closed = True
        except BlockingIOError:
            pass
        except OSError:
            self.closed = True
        return self._whole()

    def wait(self, seconds: float) -> None:
        """Return when something has come, the other end has closed, or ``seconds`` have passed."""
        ready = select.poll()  # a host may have more files open than select can name
        ready.register(self._end, select.POLLIN | (select.POLLOUT if self._out else 0))
        ready.poll(1e3 * seconds)

    def close(self) -> None:
        """Close this end."""
        self.closed = True
        self._end.close()

    def _whole(self) -> list[tuple[Any, ...]]:
        messages = []
        while len(self._in) >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(self._in)
            end = _LENGTH.size + length
            if len(self._in) < end:
                break
            messages.append(pickle.loads(self._in[_LENGTH.size : end]))
            del self._in[:end]
        return messages


def packed(error: BaseException) -> tuple[Any, ...]:
    """Return what :func:`unpacked` makes the exception from again, without its traceback."""
    return type(error), error.args, dict(error.__dict__)


def unpacked(content: tuple[Any, ...]) -> BaseException:
    """Inverse of :func:`packed`."""
    kind, arguments, attributes = content
    error: BaseException = kind.__new__(kind, *arguments)
    error.args = arguments
    error.__dict__.update(attributes)
    return error
