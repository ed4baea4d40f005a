"""A plain analogue module, written on bare sockets, that fails in the ways real ones do."""

import socket
import struct
import threading
import time
from contextlib import suppress

import numpy as np

from dea.acquisition import duty
from dea.modbus import parse_device

FULL_SCALE = 10.0  # V, and mm
ILLEGAL_ADDRESS = 2  # Modbus exception code


class PlainModule:
    """Holding register 0 is the output, 1 its read-back; input register 0 the displacement.

    No watchdog, no owner, no clock. The attributes below may be changed at any time; ``history``
    holds the time and the volts of everything that was written.
    """

    def __init__(self):
        self.read_back = lambda count: count
        self.refuse_with = 0  # Modbus exception code of every answer; 0 for none
        self.deaf = False  # whether connections are cut and none is taken
        self.hold_next = 0.0  # s that the next write is held back, without an answer
        self.only = None  # holding registers that may be read; None for all
        self.index = 0  # of 16 bits in holding register 5, which counts the writes from here on
        self.closed = 1  # discrete input 0
        self.enabled = False  # coil 0
        self.history = []
        self._count, self._ended = 0, threading.Event()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def description(self, **changes):
        """Its description."""
        scale = {"range": [0, FULL_SCALE]}
        return parse_device(
            {
                "name": "plain module", "unit_id": 1, "sampling_rate": 50, "quarantine": 0.5,
                "endpoint": {"host": "127.0.0.1", "port": self.port},
                "registers": {
                    "output": {"address": 0, **scale, "limits": [0, 4], "unit": "V",
                               "access": "write"},
                    "applied_output": {"address": 1, **scale, "unit": "V"},
                    "displacement": {"address": 0, "table": "input", **scale, "unit": "mm"},
                },
            } | changes
        )  # fmt: skip

    @property
    def volts(self):
        return self._count / 65535 * FULL_SCALE

    def path(self):
        """Times, s, and volts of all that was written, from zero on."""
        times, volts = np.array([(0.0, 0.0), *self.history]).T
        return times, volts

    def stop(self):
        self._ended.set()
        self._listening.close()

    def _accept(self):
        while not self._ended.is_set():
            try:
                connection, _ = self._listening.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection):
        with connection:
            connection.settimeout(0.05)
            data = b""
            while not self._ended.is_set() and not self.deaf:
                try:
                    received = connection.recv(260)
                except TimeoutError:
                    continue
                except OSError:
                    return
                if not received:
                    return
                data += received
                while len(data) > 6 and len(data) >= (end := 6 + data[5]):
                    self._answer(connection, data[:end])
                    data = data[end:]

    def _answer(self, connection, frame):
        function, address, value = struct.unpack(">BHH", frame[7:12])
        if self.refuse_with:
            body = bytes([function | 0x80, self.refuse_with])
        elif function in (1, 2):
            body = bytes([function, 1, self.closed | 0xFE])
        elif function == 5:
            self.enabled = bool(value)
            body = frame[7:]
        elif function == 6:
            if self.hold_next:
                held, self.hold_next = self.hold_next, 0.0
                threading.Timer(held, self._write, (value,)).start()
                return
            self._write(value)
            body = frame[7:]
        else:
            count = self._count
            index = (self.index + len(self.history)) % 65536
            holding = {0: count, 1: int(self.read_back(count)), 5: index}
            registers = holding if function == 3 else {0: count}
            asked = range(address, address + value)
            words = [registers.get(place, 0) for place in asked]
            body = struct.pack(f">BB{len(words)}H", function, 2 * len(words), *words)
            if self.only and function == 3 and not self.only.issuperset(asked):
                body = bytes([function | 0x80, ILLEGAL_ADDRESS])
        head = frame[:4] + struct.pack(">H", len(body) + 1) + frame[6:7]
        with suppress(OSError):  # the client has gone
            connection.sendall(head + body)

    def _write(self, count):
        self._count = count
        self.history.append((time.monotonic(), count / 65535 * FULL_SCALE))


def guardian_of(module):
    """The process that guards a module."""
    notice = duty.look(duty.duty_file(module.description()))
    assert notice.alive  # process 0 would be the whole group of this one
    return notice.process
