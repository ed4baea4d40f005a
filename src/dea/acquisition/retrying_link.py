"""A Modbus connection that reconnects, and repeats a request until it has a valid reply.

A repeated request must be idempotent, since the device may have carried out one whose reply was
lost. The blocks of the buffered protocol carry sequence numbers for that reason.
"""

import itertools
import logging
import math
import select
import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ConnectionException, ModbusException
from pymodbus.pdu import ModbusPDU
from pymodbus.pdu.bit_message import (
    ReadCoilsRequest,
    ReadDiscreteInputsRequest,
    WriteSingleCoilRequest,
)
from pymodbus.pdu.register_message import (
    ReadHoldingRegistersRequest,
    ReadInputRegistersRequest,
    WriteMultipleRegistersRequest,
    WriteSingleRegisterRequest,
)

from dea.acquisition.link_log import LinkLog
from dea.acquisition.transport import Client, connect, place
from dea.errors import DeviceError, InputError
from dea.modbus import Device, ReadWriteRequest

# Failures are counted and reported here; pymodbus would print each one to the terminal.
logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

# Exceptions that say "not now": acknowledge, server busy, gateway path unavailable, gateway target
# failed to respond.
BUSY = (5, 6, 10, 11)
BUSY_PAUSE = 0.02  # s
FIRST_PAUSE, LONGEST_PAUSE = 0.01, 0.5  # s, before reconnecting
LONGEST_SLEEP = 0.1  # s
_LOST = (ConnectionException, ConnectionError)
_TRANSIENT = (ModbusException, OSError, struct.error, ValueError, IndexError)


# What the exceptions of the standard mean for whoever wrote the description.
_MEANINGS = {
    1: "illegal function: the device does not know it",
    2: "illegal address: is a register's address, table or count wrong?",
    3: "illegal value",
    4: "the device failed",
    5: "accepted, and it takes long",
    6: "the device is busy",
    10: "the gateway has no path to the device",
    11: "the gateway's target failed to respond: is unit_id wrong?",
}


_READS = {
    "holding": ReadHoldingRegistersRequest,
    "input": ReadInputRegistersRequest,
    "coil": ReadCoilsRequest,
    "discrete": ReadDiscreteInputsRequest,
}


@dataclass(frozen=True)
class LinkSettings:
    """Seconds to wait for a reply, repetitions of a request, seconds to try to reconnect."""

    timeout: float = 2.0
    retries: int = 5
    reconnect_time: float = 10.0


# Where a person waits for the answer.
BY_HAND = LinkSettings(retries=1, reconnect_time=2.0)


class LinkError(DeviceError, ConnectionError):
    """The device cannot be reached, or does not answer."""


class UnreachableError(LinkError):
    """The device cannot be connected to."""


class StoppedError(DeviceError):
    """The drive is to end: somebody asked for it, or the recorder has died or stalls."""


class DeviceRefusedError(DeviceError):
    """The device answered with a Modbus exception ``code``."""

    def __init__(self, code: int, function: int) -> None:
        meaning = f" ({_MEANINGS[code]})" if code in _MEANINGS else ""
        super().__init__(
            f"the device refused function {function} with Modbus exception {code}{meaning}"
        )
        self.code = code


class Link:
    """A connection to ``device`` that reconnects and repeats requests.

    ``on_connect`` is called after every reconnection; the owner claims the outputs again there.
    ``check`` is called before each attempt and may raise to end the repetition.
    ``longest_repetition`` is for how many s after its first attempt a request is repeated at most.
    """

    def __init__(
        self, device: Device, settings: LinkSettings | None = None, log: LinkLog | None = None
    ) -> None:
        self.device, self.settings = device, settings or LinkSettings()
        self.log = log or LinkLog()
        self.on_connect: Callable[[], None] | None = None
        self.check: Callable[[], None] | None = None
        self.longest_repetition = math.inf
        self.client: Client | None = None

    def open(self, deadline: float | None = None) -> None:
        """Connect, trying for ``reconnect_time``, or until ``deadline`` of the monotonic clock.

        Raises
        ------
        UnreachableError
            Where nothing answers until then.
        InputError
            Where the description does not allow a connection.
        """
        if deadline is None:
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
                    problem = f"{place(self.device)} does not answer: {error}"
                    raise UnreachableError(problem) from error
            time.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE)

    def close(self) -> None:
        """Drop the connection."""
        if self.client is not None:
            self.client.close()
            self.client = None

    def rest(self, seconds: float) -> None:
        """Sleep, and call ``check`` meanwhile."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            time.sleep(min(left, LONGEST_SLEEP))
            if self.check is not None:
                self.check()

    def read(self, address: int, count: int, table: str = "holding") -> list[int]:
        """Registers or bits of a table (function codes 1 to 4)."""
        return self._exchange(_READS[table](address=address, count=count))

    def write(
        self, address: int, words: Sequence[int], table: str = "holding", *, retry: bool = True
    ) -> None:
        """Write registers (function code 6 for one, 16 for more) or a coil (5)."""
        if table == "coil":
            self._exchange(WriteSingleCoilRequest(address=address, bits=[bool(words[0])]), retry)
            return
        kind = WriteSingleRegisterRequest if len(words) == 1 else WriteMultipleRegistersRequest
        self._exchange(kind(address=address, registers=list(words)), retry)

    def read_write(
        self, read_address: int, count: int, write_address: int, words: Sequence[int],
        *, retry: bool = True,
    ) -> list[int]:  # fmt: skip
        """Write, then read, in one exchange (function code 23) or, without it, in two."""
        if not self.device.read_write_multiple:
            self.write(write_address, words, retry=retry)
            return self.read(read_address, count)
        return self._exchange(ReadWriteRequest(read_address, count, write_address, words), retry)

    def _exchange(self, request: ModbusPDU, retry: bool = True) -> list[int]:
        """Return the registers of the reply to a request, repeated as the settings allow.

        A request without a valid reply is repeated ``retries`` times. One whose connection was
        lost, or that a busy device refused, is repeated for ``reconnect_time`` at least: a gateway
        accepts connections, and closes them again or refuses, while its device starts. One that
        finds no connection within this time is given up, whatever retries are left. Without
        ``retry``, it is sent once.
        """
        request.dev_id = self.device.unit_id
        end = (begun := time.monotonic()) + self.longest_repetition
        deadline, pause = min(begun + self.settings.reconnect_time, end), FIRST_PAUSE
        for attempt in itertools.count():
            if self.check is not None:
                self.check()
            try:
                if self.client is None:
                    self._reconnect(deadline)
                sent = time.monotonic()
                registers = self._attempt(request)
            except (DeviceRefusedError, *_TRANSIENT) as error:
                last, lost = error, isinstance(error, _LOST)
                passing = lost or _busy(error)
                self._failed(error)
            else:
                self.log.send_time.append(sent - self.log.started)
                self.log.receive_time.append(time.monotonic() - self.log.started)
                self.log.retries.append(attempt)
                self.log.samples.append(0)
                return registers
            now = time.monotonic()
            spent = attempt >= self.settings.retries or isinstance(last, UnreachableError)
            if not retry or now >= end or (spent and not (passing and now < deadline)):
                break
            if lost:
                time.sleep(pause)
                pause = min(2 * pause, LONGEST_PAUSE)
        if isinstance(last, DeviceRefusedError | LinkError):
            raise last
        raise LinkError(
            f"{place(self.device)}: no valid reply after {attempt + 1} attempts ({last})"
        ) from last

    def _attempt(self, request: ModbusPDU) -> list[int]:
        """Registers of one reply."""
        assert self.client is not None
        if self._stray_bytes():
            raise ConnectionError("bytes have come that no request asked for")
        reply = self.client.execute(False, request)
        if reply.isError():
            raise DeviceRefusedError(reply.exception_code, request.function_code)
        if not _answers(reply, request):
            raise ValueError("a reply that does not answer the request")
        if isinstance(request, ReadCoilsRequest | ReadDiscreteInputsRequest):
            return [int(bit) for bit in reply.bits[: request.count]]  # whole bytes come
        return list(reply.registers)

    def _stray_bytes(self) -> bool:
        """Whether a reply is there before its request: RTU frames carry no transaction number."""
        if self.device.framing != "rtu_over_tcp":
            return False
        assert isinstance(self.client, ModbusTcpClient)
        connection = self.client.socket
        return connection is None or bool(select.select([connection], [], [], 0)[0])

    def _reconnect(self, deadline: float) -> None:
        try:
            self.open(deadline)
        except InputError as error:
            raise UnreachableError(str(error)) from error
        self.log.reconnects += 1
        if self.on_connect is not None:
            # Its own requests may fail too, and must not call it again.
            resume, self.on_connect = self.on_connect, None
            try:
                resume()
            finally:
                self.on_connect = resume

    def _failed(self, error: Exception) -> None:
        """Count a failure and close the connection: a late reply on it belongs to no request."""
        if isinstance(error, DeviceRefusedError):
            self.log.errors[f"exception {error.code}"] += 1
            if _busy(error):
                time.sleep(BUSY_PAUSE)
        else:
            self.log.errors[_kind(error)] += 1
            self.close()


def _busy(error: Exception) -> bool:
    return isinstance(error, DeviceRefusedError) and error.code in BUSY


def _kind(error: Exception) -> str:
    """Return the name under which a failure is counted."""
    if isinstance(error, _LOST):
        return "connection lost"
    if isinstance(error, ModbusException) and "No response" in str(error):
        return "no reply"
    return "invalid reply"


def _answers(reply: ModbusPDU, request: ModbusPDU) -> bool:
    """Whether a reply holds what was asked for, or echoes what was written."""
    if reply.function_code != request.function_code:
        return False
    match request:
        case ReadWriteRequest():
            return len(reply.registers) == request.read_count
        case WriteSingleRegisterRequest():
            return (reply.address, reply.registers) == (request.address, request.registers)
        case WriteMultipleRegistersRequest():
            return (reply.address, reply.count) == (request.address, len(request.registers))
        case WriteSingleCoilRequest():
            return (reply.address, reply.bits[:1]) == (request.address, request.bits[:1])
        case ReadCoilsRequest() | ReadDiscreteInputsRequest():
            return len(reply.bits) >= request.count
    return len(reply.registers) == request.count
