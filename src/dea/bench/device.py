"""The register map of the bench: what a master may read and write, and the effect of a write."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dea.bench.player import Player
from dea.errors import InputError
from dea.modbus import (
    Command,
    Device,
    DeviceState,
    Refusal,
    Register,
    Value,
    block_window,
    decode,
    encode,
    reply_window,
)

SILENCE = 1  # trip_reason
TRIGGER_PATIENCE = 5  # sample periods until the device's own clock follows a polled sample


class RefusedError(Exception):
    """The device refuses a request; ``code`` is the Modbus exception code."""

    def __init__(self, code: Refusal) -> None:
        super().__init__(f"Modbus exception {code}")
        self.code = code


@dataclass
class Session:
    """One master's connection: its token as owner, its sample index, and whether it may write."""

    token: int = 0
    read_index: int = 0
    may_write: bool = True


def _encoded(description: Device, name: str, value: float | int | str) -> list[int]:
    """Return the words of a register that never changes.

    Raises
    ------
    InputError
        Where the register cannot hold its value.
    """
    try:
        return encode(description[name], value)
    except ValueError as error:
        raise InputError(
            str(error),
            file=description.source,
            field=f"registers.{name}",
            remedy="Give it type and count as in config/devices/virtual_bench.yaml.",
        ) from error


class BenchDevice:
    """A Modbus device around a :class:`~dea.bench.player.Player`.

    Parameters
    ----------
    player
        What the registers control.
    description
        The register map; the names are those of ``config/devices/virtual_bench.yaml``.
    constants
        Values of the registers that never change, by name: identity, ranges, lengths.
    virtual_clock
        Whether time passes as fast as the owner sends samples, or at wall time.
    """

    def __init__(
        self,
        player: Player,
        description: Device,
        constants: Mapping[str, float | int | str],
        *,
        virtual_clock: bool,
    ) -> None:
        self.player, self.description, self.virtual_clock = player, description, virtual_clock
        self.owner = 0
        self.period = 1.0 / description.sampling_rate  # s
        self._due = 0.0
        self._constants = {n: _encoded(description, n, v) for n, v in constants.items()}
        self._by_address: dict[int, Register] = {}
        for register in description.registers.values():
            for address in range(register.address, register.end):
                self._by_address[address] = register
        self._end = max(self._by_address) + 1
        self._block = block_window(description)
        self._reply = reply_window(description)

    def read(self, session: Session, address: int, count: int) -> list[int]:
        """Registers ``address`` to ``address + count - 1``; gaps in the map read as zero."""
        self.refuse_beyond(address, count)
        start = address - self._reply.address
        if start >= 0 and start + count <= self._reply.size:
            return self._answer(session)[start : start + count]
        words: list[int] = []
        while len(words) < count:
            register = self._by_address.get(address + len(words))
            if register is None:
                words.append(0)
                continue
            skip = address + len(words) - register.address
            words += self._words(session, register)[skip:]
        return words[:count]

    def refuse_beyond(self, address: int, count: int) -> None:
        """Refuse to read registers beyond the end of the map."""
        if address + count > self._end:
            raise RefusedError(Refusal.ILLEGAL_ADDRESS)

    def write(self, session: Session, address: int, words: Sequence[int]) -> None:
        """Write whole registers: a block of samples, or one command, claim or output value."""
        register = self._by_address.get(address)
        if register is None or register.access == "read":
            raise RefusedError(Refusal.ILLEGAL_ADDRESS)
        if address == self._block.address and len(words) == self._block.size:
            self._write_block(session, words)
            return
        in_block = register in self._block.registers
        if in_block or register.address != address or register.size != len(words):
            raise RefusedError(Refusal.ILLEGAL_ADDRESS)
        value = decode(register, words)
        if not isinstance(value, int):
            raise RefusedError(Refusal.ILLEGAL_VALUE)
        if register.name == "claim":
            self._claim(session, value)
            return
        self._only_the_owner(session)
        if register.name == "output":
            self._hold(value)
        else:
            self._command(value)

    def owns(self, session: Session) -> bool:
        """Whether a master owns the outputs."""
        return bool(self.owner) and session.token == self.owner

    def heard(self, session: Session, now: float) -> None:
        """Reset the watchdog if the master is the owner."""
        if self.owns(session):
            self.player.watchdog.heard(now)

    def wind(self, now: float) -> None:
        """Start the wall clock at ``now``, s."""
        self._due = now + self.period

    def tick(self, now: float) -> float:
        """Let the samples due by ``now`` pass at wall time; return the next one's due time."""
        if not self.virtual_clock and now >= self._due:
            passed = int((now - self._due) / self.period) + 1
            self.player.advance(passed)
            self._due += passed * self.period
        return self._due

    def pump(self) -> None:
        """Let the virtual clock run as far as the owner has sent samples."""
        if self.virtual_clock:
            self.player.drain()

    def watch(self, now: float) -> None:
        """Run the watchdog; an owner who is silent at zero output loses the outputs."""
        silent = self.player.watchdog.expired(now)
        self.player.watch(now)
        if silent and self.owner and not self.player.driven:
            self.owner = 0

    def _only_the_owner(self, session: Session) -> None:
        if not self.owns(session):
            raise RefusedError(Refusal.NOT_ALLOWED)

    def _claim(self, session: Session, token: int) -> None:
        if token == 0:
            self._only_the_owner(session)
            if self.player.driven:
                raise RefusedError(Refusal.NOT_ALLOWED)
            self.owner = session.token = 0
            return
        if self.owner not in (0, token):
            raise RefusedError(Refusal.NOT_ALLOWED)
        self.owner = session.token = token
        self.player.watchdog.heard(time.monotonic())

    def _command(self, command: int) -> None:
        player = self.player
        if command == Command.START:
            done = player.start()
        elif command == Command.STOP:
            player.stop()
            done = True
        elif command == Command.RESET:
            done = player.reset()
        elif command == Command.CLEAR:
            done = player.state in (DeviceState.IDLE, DeviceState.TRIPPED)
            if done:
                player.clear()
        else:
            raise RefusedError(Refusal.ILLEGAL_VALUE)
        if not done:
            raise RefusedError(Refusal.NOT_ALLOWED)

    def _hold(self, count: int) -> None:
        if not self.player.hold(count):
            raise RefusedError(Refusal.NOT_ALLOWED)
        # A polled write triggers one sample. Where the next write is late, the device's own clock
        # continues with the output held.
        self.player.advance(1)
        # What it measured is in its registers, from which a polled master reads it.
        self.player.collected = self.player.ring.end
        self._due = time.monotonic() + TRIGGER_PATIENCE * self.period

    def _write_block(self, session: Session, words: Sequence[int]) -> None:
        if not self._block.intact(words):
            # No exception: the echoed sequence number tells the host that the block did not arrive.
            self.player.refused += 1
            return
        block = self._block.decode(words)
        sequence, count = block["block_sequence"], block["block_count"]
        samples, session.read_index = block["block_samples"], block["block_read_index"]
        if self.owns(session):
            self.player.collected = max(self.player.collected, session.read_index)
        if sequence:
            self._only_the_owner(session)
            if not 0 < count <= len(samples):
                raise RefusedError(Refusal.ILLEGAL_VALUE)
            self.player.load(sequence, samples[:count])

    def _answer(self, session: Session) -> list[int]:
        player = self.player
        samples = self.description["reply_samples"]
        run = player.ring.run(session.read_index, samples.count // 2)
        pairs = [0] * samples.count
        pairs[0 : 2 * run.applied.size : 2] = run.applied.tolist()
        pairs[1 : 2 * run.applied.size : 2] = run.displacement.tolist()
        values: dict[str, Value] = {
            "reply_sequence": player.sequence,
            "reply_index": run.index,
            "reply_position": run.position,
            "reply_next": player.ring.end,
            "reply_count": run.applied.size,
            "reply_origin": int(run.origin),
            "reply_state": int(player.state),
            "reply_fifo": player.fifo_level,
            "reply_samples": pairs,
        }
        return self._reply.encode(values)

    def _words(self, session: Session, register: Register) -> list[int]:
        name = register.name
        if name in self._constants:
            return self._constants[name]
        if register in self._reply.registers:
            place = register.address - self._reply.address
            return self._answer(session)[place : place + register.size]
        if register in self._block.registers:
            return [0] * register.size
        if name == "owner":
            return [0 if not self.owner else 2 if session.token == self.owner else 1]
        return encode(register, self._live(name))

    def _live(self, name: str) -> int:
        player = self.player
        match name:
            case "state":
                return player.state
            case "trip_reason":
                return SILENCE if player.watchdog.latched else 0
            case "tick":
                return round(player.ring.end * 1000 * self.period) % 2**32
            case "sample_index":
                return player.ring.end
            case "device_index":
                return max(player.ring.end - 1, 0)
            case "fifo_level":
                return player.fifo_level
            case "watchdog_latched":
                return int(player.watchdog.latched)
            case "watchdog_trips":
                return min(player.watchdog.trips, 0xFFFF)
            case "underruns":
                return player.underruns
            case "overruns":
                return player.overruns
            case "clamped":
                return player.clamped
            case "refused_blocks":
                return player.refused
            case "applied_output":
                return player.applied
            case "displacement":
                return player.displacement
            case "output":
                return player.requested
            case "command" | "claim":
                return 0
        raise RefusedError(Refusal.ILLEGAL_ADDRESS)
