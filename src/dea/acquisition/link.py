"""One Modbus connection that is repaired: every request is repeated until it has its reply.

A repeated request must mean the same as the first, since the device may have carried out one
whose reply was lost. The blocks of the buffered protocol carry sequence numbers for that.
"""

import itertools
import logging
import struct
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pymodbus.exceptions import ConnectionException, ModbusException

from dea.acquisition.connection import Client, connect, place
from dea.errors import InputError
from dea.modbus import Device

# Every failure is counted and reported here; pymodbus would print each one to the terminal.
logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

ACKNOWLEDGE, BUSY = 5, 6
BUSY_PAUSE = 0.02  # s
FIRST_PAUSE, LONGEST_PAUSE = 0.01, 0.5  # s, before a lost connection is made again
_LOST = (ConnectionException, ConnectionError)
_TRANSIENT = (ModbusException, OSError, struct.error, ValueError, IndexError)


class LinkError(ConnectionError):
    """The device cannot be reached, or does not answer."""


class DeviceRefusedError(RuntimeError):
    """The device answered with a Modbus exception ``code``."""

    def __init__(self, code: int, request: str) -> None:
        super().__init__(f"the device refused {request} with Modbus exception {code}")
        self.code = code


@dataclass(frozen=True)
class LinkSettings:
    """Patience of a link: seconds for a reply, retries of a request, seconds to reconnect."""

    timeout: float = 2.0
    retries: int = 5
    reconnect_time: float = 10.0


@dataclass
class LinkLog:
    """What was sent and how it went, an element per exchange; times in s since ``started``.

    ``jitter`` has an element per polled sample, s behind its deadline.
    """

    started: float = field(default_factory=time.monotonic)
    send_time: list[float] = field(default_factory=list)
    receive_time: list[float] = field(default_factory=list)
    retries: list[int] = field(default_factory=list)
    samples: list[int] = field(default_factory=list)
    errors: Counter[str] = field(default_factory=Counter)
    jitter: list[float] = field(default_factory=list)
    reconnects: int = 0


class Link:
    """A repaired connection to ``device``.

    ``on_connect`` is called after every reconnection; the session claims its ownership there.
    ``check`` is called before each attempt and may raise, to end the patience.
    """

    def __init__(
        self, device: Device, settings: LinkSettings | None = None, log: LinkLog | None = None
    ) -> None:
        self.device, self.settings = device, settings or LinkSettings()
        self.log = log or LinkLog()
        self.on_connect: Callable[[], None] | None = None
        self.check: Callable[[], None] | None = None
        self.client: Client | None = None

    def open(self) -> None:
        """Connect, trying for ``reconnect_time``; raises :class:`LinkError` or InputError."""
        deadline = time.monotonic() + self.settings.reconnect_time
        pause = FIRST_PAUSE
        while True:
            self.close()
            if self.check is not None:
                self.check()
            try:
                self.client = connect(self.device, self.settings.timeout)
                return
            except OSError as error:
                if time.monotonic() + pause > deadline:
                    raise LinkError(f"{place(self.device)} does not answer: {error}") from error
            time.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE)

    def close(self) -> None:
        """Drop the connection."""
        if self.client is not None:
            self.client.close()
            self.client = None

    def read(self, address: int, count: int, table: str = "holding") -> list[int]:
        """Registers of a table (function code 3 or 4)."""
        if table == "input":
            return self._exchange(
                "read_input_registers", expect=count, address=address, count=count
            )
        return self._exchange("read_holding_registers", expect=count, address=address, count=count)

    def write(self, address: int, words: Sequence[int], *, retry: bool = True) -> None:
        """Write registers (function code 6 for one, 16 for more)."""
        if len(words) == 1:
            self._exchange("write_register", retry=retry, address=address, value=words[0])
        else:
            self._exchange("write_registers", retry=retry, address=address, values=list(words))

    def read_write(
        self, read_address: int, count: int, write_address: int, words: Sequence[int],
        *, retry: bool = True,
    ) -> list[int]:  # fmt: skip
        """Write, then read, in one exchange (function code 23) or, without it, in two."""
        if not self.device.read_write_multiple:
            self.write(write_address, words, retry=retry)
            return self.read(read_address, count)
        return self._exchange(
            "readwrite_registers", retry=retry, expect=count,
            read_address=read_address, read_count=count,
            write_address=write_address, values=list(words),
        )  # fmt: skip

    def _exchange(
        self, request: str, *, retry: bool = True, expect: int | None = None, **arguments: Any
    ) -> list[int]:
        """Registers of the reply to a request, repeated as the settings allow.

        A request without a valid reply is repeated ``retries`` times. One whose connection was
        lost is repeated for ``reconnect_time`` at least, since a gateway accepts connections and
        drops them again while its device starts.
        """
        sent = time.monotonic()
        patient_until, pause = sent + self.settings.reconnect_time, FIRST_PAUSE
        for attempt in itertools.count():
            if self.check is not None:
                self.check()
            try:
                if self.client is None:
                    self._reconnect()
                    sent = time.monotonic()
                registers = self._attempt(request, expect, arguments)
            except (DeviceRefusedError, *_TRANSIENT) as error:
                last, lost = error, isinstance(error, _LOST)
                self._failed(error)
            else:
                self.log.send_time.append(sent - self.log.started)
                self.log.receive_time.append(time.monotonic() - self.log.started)
                self.log.retries.append(attempt)
                self.log.samples.append(0)
                return registers
            spent = attempt >= self.settings.retries
            if not retry or (spent and not (lost and time.monotonic() < patient_until)):
                break
            if lost:
                time.sleep(pause)
                pause = min(2 * pause, LONGEST_PAUSE)
        if isinstance(last, DeviceRefusedError | LinkError):
            raise last
        raise LinkError(
            f"{place(self.device)}: no valid reply after {attempt + 1} attempts ({last})"
        ) from last

    def _attempt(self, request: str, expect: int | None, arguments: Mapping[str, Any]) -> list[int]:
        """Registers of one reply, ``expect`` of them, or an echo of what was written."""
        reply = getattr(self.client, request)(device_id=self.device.unit_id, **arguments)
        if reply.isError():
            raise DeviceRefusedError(reply.exception_code, request)
        if expect is not None:
            valid = len(reply.registers) == expect
        elif "value" in arguments:
            valid = (reply.address, reply.registers) == (arguments["address"], [arguments["value"]])
        else:
            echo = arguments["address"], len(arguments["values"])
            valid = (reply.address, reply.count) == echo
        if not valid:
            raise ValueError("a reply that does not answer the request")
        return list(reply.registers)

    def _reconnect(self) -> None:
        try:
            self.open()
        except InputError as error:
            raise LinkError(str(error)) from error
        self.log.reconnects += 1
        if self.on_connect is not None:
            resume, self.on_connect = self.on_connect, None  # whose own requests may fail too
            try:
                resume()
            finally:
                self.on_connect = resume

    def _failed(self, error: Exception) -> None:
        """Count, and drop the connection: what still arrives on it belongs to no request."""
        if isinstance(error, DeviceRefusedError):
            self.log.errors[f"exception {error.code}"] += 1
            if error.code in (ACKNOWLEDGE, BUSY):
                time.sleep(BUSY_PAUSE)
        else:
            self.log.errors[_kind(error)] += 1
            self.close()


def _kind(error: Exception) -> str:
    """Class of a failure, as it is counted."""
    if isinstance(error, _LOST):
        return "connection lost"
    if isinstance(error, ModbusException) and "No response" in str(error):
        return "no reply"
    return "invalid reply"
