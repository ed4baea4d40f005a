"""Serve a block device over Modbus TCP: `python serve.py --host 0.0.0.0 --port 5020`.

One loop takes samples and answers masters; between the two it sleeps until the next sample is due.
"""

import argparse
import select
import socket
import struct
import time

from block_device import BlockDevice, Hardware, RefusedError, Session

MASTERS = 4
IDLE_TIME = 60 * 1000000  # us of silence, after which a master is dropped
ILLEGAL_FUNCTION = 1
LONGEST = 260  # bytes of a frame


def now():
    """Return microseconds of a clock that never goes back."""
    return time.monotonic_ns() // 1000


class Master:
    """A connection, what has come of its next frame, and when it was last heard."""

    def __init__(self, connection):
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.connection, self.data, self.heard = connection, b"", now()
        self.session = Session()

    def frames(self):
        """Yield whole frames: transaction, unit, request. Raises ValueError where it is none."""
        while len(self.data) >= 8:
            transaction, protocol, length = struct.unpack(">HHH", self.data[:6])
            if protocol or not 2 <= length <= LONGEST - 6:
                raise ValueError("no Modbus")
            if len(self.data) < 6 + length:
                return
            frame, self.data = self.data[: 6 + length], self.data[6 + length :]
            yield transaction, frame[6], frame[7:]


def answer(device, session, request):
    """Return the reply to one request."""
    function = request[0]
    try:
        device.heard(session, now())
        if function == 3 and len(request) == 5:
            address, count = struct.unpack(">HH", request[1:])
            return function_and(function, device.read(session, address, checked(count, 125)))
        if function == 6 and len(request) == 5:
            address, word = struct.unpack(">HH", request[1:])
            device.write(session, address, [word], now())
            return request
        if function == 16 and len(request) >= 6:
            address, count = struct.unpack(">HH", request[1:5])
            device.write(session, address, words(request[5:], checked(count, 123)), now())
            return request[:5]
        if function == 23 and len(request) >= 10:
            at, many, address, count = struct.unpack(">HHHH", request[1:9])
            checked(many, 125)
            device.write(session, address, words(request[9:], checked(count, 121)), now())
            return function_and(function, device.read(session, at, many))
    except RefusedError as refusal:
        return bytes([function | 0x80, refusal.code])
    return bytes([function | 0x80, ILLEGAL_FUNCTION])


def checked(count, most):
    """Return a number of registers that the standard allows."""
    if not 0 < count <= most:
        raise RefusedError(3)
    return count


def words(data, count):
    """Return the registers of a request: a byte that says how many bytes follow, and these."""
    if len(data) != 1 + 2 * count or data[0] != 2 * count:
        raise RefusedError(3)
    return list(struct.unpack(f">{count}H", data[1:]))


def function_and(function, registers):
    """Return the reply that holds registers."""
    return struct.pack(f">BB{len(registers)}H", function, 2 * len(registers), *registers)


def serve(device, listening):
    """Take samples and answer, for ever."""
    masters = []
    while True:
        device.advance(now())
        wait = max(device.due - now(), 0) / 1000000
        ready = select.select([listening, *(m.connection for m in masters)], [], [], wait)[0]
        for master in [m for m in masters if m.connection in ready]:
            if not attend(device, master):
                masters.remove(master)
        for master in [m for m in masters if now() - m.heard > IDLE_TIME]:
            drop(masters, master)
        if listening in ready:
            welcome(device, masters, listening)


def welcome(device, masters, listening):
    """Add the master that connects; where there are too many, the longest silent makes room.

    Of an owner only its longest silent connection goes, and that where all are its own: those
    before the last were lost on the way.
    """
    try:
        connection, _ = listening.accept()
    except OSError:  # it has gone again
        return
    if len(masters) == MASTERS:
        others = [m for m in masters if not device.owner or m.session.token != device.owner]
        drop(masters, min(others or masters, key=lambda m: m.heard))
    masters.append(Master(connection))


def drop(masters, master):
    """Close a connection and forget it."""
    master.connection.close()
    masters.remove(master)


def attend(device, master):
    """Answer what a master has sent; return whether it is still there.

    One that does not fetch its replies is dropped, since half a reply cannot be mended.
    """
    try:
        data = master.connection.recv(4096)
    except BlockingIOError:
        return True
    except OSError:
        data = b""
    try:
        if not data:
            raise ValueError("closed")
        master.data += data
        for transaction, unit, request in master.frames():
            master.heard = now()
            reply = answer(device, master.session, request)
            head = struct.pack(">HHHB", transaction, 0, len(reply) + 1, unit)
            master.connection.sendall(head + reply)
    except (OSError, ValueError):
        master.connection.close()
        return False
    return True


def main():
    """Serve until killed; the output is then at zero."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=5020)
    options = parser.parse_args()
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listening.bind((options.host, options.port))
    listening.listen(MASTERS)
    host, port = listening.getsockname()[:2]
    print(f"serving at {host}:{port}", flush=True)
    hardware = Hardware()
    try:
        serve(BlockDevice(hardware, now(), boot=now() & 0xFFFFFFFF), listening)
    finally:
        hardware.write(0)


if __name__ == "__main__":
    main()
