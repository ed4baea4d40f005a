"""A device that speaks the block protocol of docs/acquisition.md: its registers and its time.

Standard library alone, integers and plain lists, so that it also runs on a small board. `Hardware`
is what to replace; nothing here knows of networks (serve.py) or reads a clock: the caller says what
time it is, in microseconds.
"""

import struct
import zlib

IDLE, RAMPING, RUNNING, TRIPPED = 0, 1, 2, 3  # state
START, STOP, RESET, CLEAR = 1, 2, 3, 4  # command
PLAYED, HELD, REST, RAMP, TRIP, POLLED = 1, 2, 3, 4, 5, 6  # reply_origin
ILLEGAL_ADDRESS, ILLEGAL_VALUE, NOT_ALLOWED = 2, 3, 7  # Modbus exception codes

STATUS_SIZE = 74
BLOCK, BLOCK_SIZE, BLOCK_SAMPLES = 100, 62, 55
REPLY, REPLY_SIZE = 200, 124
END = REPLY + REPLY_SIZE
WRITABLE = {70: 1, 71: 2, 73: 1}  # command, claim, output: address and size
PATIENCE = 5  # periods until the device's own clock follows a polled sample


class Hardware:
    """The converters. This one is a film of 0.1 s that moves 1 mm per 1 V, for trying it out.

    On a real board `write` sets the analogue output and `read` reads the sensor, as 16-bit counts;
    the output must go to zero by itself where this program hangs or loses its power.
    """

    def __init__(self):
        self.count, self.position = 0, 0

    def write(self, count):
        """Set the analogue output."""
        self.count = count

    def read(self):
        """Return what the sensor reads now."""
        self.position += (self.count * 3 // 2 - self.position) // 5
        return max(0, min(self.position, 0xFFFF))


class RefusedError(Exception):
    """The request is answered with the Modbus exception in `code`."""

    def __init__(self, code):
        super().__init__(f"Modbus exception {code}")
        self.code = code


class Session:
    """One master: its token as owner, and the index from which it wants samples."""

    def __init__(self):
        self.token = 0
        self.read_index = 0


class BlockDevice:
    """Plays samples from a FIFO at its own clock, and keeps what it measured in a ring.

    `highest` and `step` are counts: no output exceeds the one, no ramp to zero changes by more than
    the other in a sample. `rate` is in Hz, `watchdog` in ms.
    """

    def __init__(
        self,
        hardware,
        now,
        *,
        boot,
        rate=50,
        highest=16427,
        step=218,
        watchdog=1000,
        fifo_length=512,
        ring_length=4096,
    ):
        self.hardware, self.boot, self.rate = hardware, boot, rate
        self.highest, self.step, self.watchdog = highest, step, watchdog
        self.fifo_length, self.ring_length = fifo_length, ring_length
        self.period = 1000000 // rate
        self.due, self.heard_at = now + self.period, now
        self.state, self.owner, self.latched, self.trips = IDLE, 0, 0, 0
        self.fifo, self.ring = [], []  # counts; (applied, measured, origin, position)
        self.end = 0  # index of the next sample
        self.sequence = self.position = 0
        self.requested = self.applied = self.measured = 0
        self.polled = False
        self.collected = 0  # index up to which the owner has read
        self.underruns = self.overruns = self.clamped = self.refused = 0
        self.hardware.write(0)

    # Time.

    def advance(self, now):
        """Take the samples that are due at `now`, and watch the owner.

        Where this program was held up, samples are not made up for in a burst: the output was held
        meanwhile, and the ring says so.
        """
        if self.driven() or self.state == RUNNING:
            if self.state != TRIPPED and now - self.heard_at > 1000 * self.watchdog:
                self.trip()
        elif self.owner and now - self.heard_at > 1000 * self.watchdog:
            self.owner = 0
        if now < self.due:
            return
        missed = (now - self.due) // self.period
        for _ in range(missed):
            self.keep(HELD if self.requested else REST)
        self.underruns += missed if self.requested else 0
        self.sample()
        self.due += (missed + 1) * self.period

    def driven(self):
        """Return whether the output is not zero, or will not be."""
        return bool(self.applied or self.requested or self.fifo)

    def trip(self):
        """Take the output to zero at once, and latch."""
        del self.fifo[:]
        self.requested, self.state = 0, TRIPPED
        self.latched, self.trips = 1, self.trips + 1
        self.put(0)
        self.keep(TRIP)

    def sample(self):
        """Apply the next value and measure."""
        if self.state == RAMPING:
            if not self.applied:
                self.state, self.requested = IDLE, 0
                self.keep(REST)
                return
            self.requested = max(self.applied - self.step, 0)
            origin = RAMP
        elif self.state == RUNNING and self.fifo:
            self.requested = self.fifo.pop(0)
            self.put(self.requested)
            self.keep(PLAYED)
            self.position += 1
            return
        elif self.state == TRIPPED:
            origin = TRIP
        elif self.polled and self.state == RUNNING:
            origin = POLLED
        else:
            origin = HELD if self.requested else REST
            self.underruns += origin == HELD
        self.put(self.requested)
        self.keep(origin)

    def put(self, count):
        """Set the output, within its limits."""
        self.applied = min(count, self.highest)
        self.clamped += self.applied != count
        self.hardware.write(self.applied)

    def keep(self, origin):
        """Measure, and add the sample to the ring."""
        self.measured = self.hardware.read()
        self.ring.append((self.applied, self.measured, origin, self.position))
        self.end += 1
        if len(self.ring) > self.ring_length:
            del self.ring[0]
            if self.state == RUNNING and self.collected < self.end - self.ring_length:
                self.overruns += 1

    # Requests.

    def heard(self, session, now):
        """Note a request; the owner's keep the watchdog quiet."""
        if self.owner and session.token == self.owner:
            self.heard_at = now

    def read(self, session, address, count):
        """Return registers; addresses between those of the map hold zero."""
        if address + count > END:
            raise RefusedError(ILLEGAL_ADDRESS)
        words = [0] * count
        for start, part in ((0, self.status), (REPLY, self.reply)):
            if address < start + (STATUS_SIZE if not start else REPLY_SIZE) and (
                address + count > start
            ):
                for offset, word in enumerate(part(session)):
                    if 0 <= start + offset - address < count:
                        words[start + offset - address] = word
        return words

    def write(self, session, address, words, now):
        """Write a whole register, or a whole block."""
        if address == BLOCK and len(words) == BLOCK_SIZE:
            self.take_block(session, words)
            return
        if WRITABLE.get(address) != len(words):
            raise RefusedError(ILLEGAL_ADDRESS)
        if address == 71:
            self.claim(session, (words[0] << 16) + words[1], now)
            return
        self.require_owner(session)
        if address == 70:
            self.command(words[0])
        elif self.state != RUNNING:
            raise RefusedError(NOT_ALLOWED)
        else:  # a polled value is the trigger of a sample, too
            self.requested, self.polled = words[0], True
            self.sample()
            self.due = now + PATIENCE * self.period

    def require_owner(self, session):
        """Refuse a master that does not own the outputs."""
        if not self.owner or session.token != self.owner:
            raise RefusedError(NOT_ALLOWED)

    def claim(self, session, token, now):
        """Give the outputs to a master; at zero, a token of 0 gives them back."""
        if not token:
            self.require_owner(session)
            if self.driven():
                raise RefusedError(NOT_ALLOWED)
        elif self.owner not in (0, token):
            raise RefusedError(NOT_ALLOWED)
        self.owner = session.token = token
        self.heard_at = now

    def command(self, command):
        """Start, stop, reset or clear, where the state allows it."""
        if command == START:
            allowed = self.state == RUNNING or (
                self.state == IDLE and not self.latched and not self.applied
            )
            if allowed and self.state == IDLE:
                self.state, self.requested, self.polled = RUNNING, 0, False
        elif command == STOP:
            del self.fifo[:]
            allowed = True
            self.state = RAMPING if self.state == RUNNING else self.state
        elif command == RESET:
            allowed = not self.applied
            if allowed:
                self.latched, self.state = 0, IDLE
        elif command == CLEAR:
            allowed = self.state in (IDLE, TRIPPED)
            if allowed:
                del self.fifo[:]
                self.sequence = self.position = 0
        else:
            raise RefusedError(ILLEGAL_VALUE)
        if not allowed:
            raise RefusedError(NOT_ALLOWED)

    def take_block(self, session, words):
        """Append a block once. One that is damaged or out of turn shows in `reply_sequence`."""
        data = struct.pack(f">{BLOCK_SIZE}H", *words)
        crc, sequence, index, count = struct.unpack(">IIIH", data[:14])
        if zlib.crc32(data[4:]) != crc:
            self.refused += 1
            return
        session.read_index = index
        if self.owner and session.token == self.owner:
            self.collected = max(self.collected, index)
        if not sequence:
            return
        self.require_owner(session)
        if not 0 < count <= BLOCK_SAMPLES:
            raise RefusedError(ILLEGAL_VALUE)
        if sequence == self.sequence:
            return
        room = len(self.fifo) + count <= self.fifo_length
        if not room or sequence != self.sequence + 1 or self.state not in (IDLE, RUNNING):
            self.refused += 1
            return
        self.fifo += words[7 : 7 + count]
        self.polled, self.sequence = False, sequence

    # What a master reads.

    def status(self, session):
        """Return registers 0 to 73."""
        volts = 15.0 * self.highest / 65535
        mine = 0 if not self.owner else 2 if session.token == self.owner else 1
        tick = self.end * 1000 // self.rate
        data = struct.pack(
            ">16sH16sIfffffffHHf", b"dea-block", 1, b"controller", self.boot, self.rate,
            0.0, 15.0, 0.0, volts, 0.0, 10.0, self.fifo_length, self.ring_length,
            self.watchdog / 1000,
        ) + bytes(6)  # fmt: skip
        data += struct.pack(
            ">HHIIHHHIIIIH", self.state, self.latched, tick & 0xFFFFFFFF, self.end, len(self.fifo),
            self.latched, self.trips & 0xFFFF, self.underruns, self.overruns, self.clamped,
            self.refused, mine,
        ) + bytes(4)  # fmt: skip
        data += struct.pack(">HHI", self.applied, self.measured, max(self.end - 1, 0)) + bytes(12)
        data += struct.pack(">HIH", 0, 0, self.requested)
        return struct.unpack(f">{STATUS_SIZE}H", data)

    def reply(self, session):
        """Return a run of samples of one origin, from the index that the master asked for."""
        oldest = self.end - len(self.ring)
        first = min(max(session.read_index, oldest), self.end)
        run = self.ring[first - oldest : first - oldest + BLOCK_SAMPLES]
        origin, position = run[0][2:] if run else (self.ring[-1][2] if self.ring else REST, 0)
        pairs, count = [0] * (2 * BLOCK_SAMPLES), 0
        for applied, measured, each, place in run:
            if each != origin or place != position + (count if origin == PLAYED else 0):
                break
            pairs[2 * count : 2 * count + 2] = applied, measured
            count += 1
        data = struct.pack(
            ">IIIIHHHH", self.sequence, first, position, self.end, count, origin, self.state,
            len(self.fifo),
        ) + struct.pack(f">{len(pairs)}H", *pairs)  # fmt: skip
        return struct.unpack(f">{REPLY_SIZE}H", struct.pack(">I", zlib.crc32(data)) + data)
