"""The virtual bench as a victim: its own process, watched sample by sample over a link of its own.

The watch reads the state registers, which every master may read, a little faster than samples come,
and keeps each sample of the bench's own count with the time at which it was first seen.
"""

import asyncio
import json
import struct
import sys
import time
from contextlib import suppress
from pathlib import Path

import yaml

from benchmarks.faults.modbus_frame import Frame, read_frame
from benchmarks.faults.schedule import WATCHDOG
from benchmarks.faults.trace import Applied, Trace

ROOT = Path(__file__).parents[2]
MAP = ROOT / "config" / "devices" / "virtual_bench.yaml"
FIRST, COUNT = 40, 24  # state to device_index
PERIOD = 0.018  # s


class BenchVictim:
    """A served bench, and what it has put out since ``forget``."""

    def __init__(self) -> None:
        self.trace = Trace()
        self.latched = False
        self.port = 0
        registers = yaml.safe_load(MAP.read_text())["registers"]
        self._span = registers["output"]["range"][1]
        self._process: asyncio.subprocess.Process | None = None
        self._watch: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Serve an actuator at a free port and begin to watch it."""
        self._process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "dea.bench", "--actuator", "dea1", "--port", "0",
            "--watchdog", str(WATCHDOG), "--until-stdin-closes", cwd=ROOT,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
        )  # fmt: skip
        assert self._process.stdout is not None
        self.port = json.loads(await self._process.stdout.readline())["port"]
        self._watch = asyncio.get_running_loop().create_task(self._look())

    async def stop(self) -> None:
        """End the bench."""
        if self._watch is not None:
            self._watch.cancel()
        if self._process is not None and self._process.returncode is None:
            with suppress(ProcessLookupError):
                self._process.terminate()
            await self._process.wait()

    def forget(self) -> None:
        """Begin a new trace; raises what has ended the watch, if anything has."""
        assert self._watch is not None
        if self._watch.done():
            self._watch.result()
        self.trace = Trace()

    async def _look(self) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        request = Frame(1, 1, struct.pack(">BHH", 3, FIRST, COUNT)).encode()
        try:
            while True:
                writer.write(request)
                reply = await read_frame(reader)
                if reply is None or reply.pdu[0] != 3:
                    raise ConnectionError("the bench does not answer the watch")
                self._see(struct.unpack(f">{COUNT}H", reply.pdu[2:]))
                await asyncio.sleep(PERIOD)
        finally:
            writer.close()

    def _see(self, registers: tuple[int, ...]) -> None:
        self.latched = bool(registers[47 - FIRST])
        counts, displacement = registers[60 - FIRST], registers[61 - FIRST]
        index = registers[62 - FIRST] << 16 | registers[63 - FIRST]
        seen = self.trace.applied
        if not seen or (seen[-1].index, seen[-1].counts) != (index, counts):
            volts = counts / 65535 * self._span
            seen.append(Applied(time.monotonic(), volts, counts, displacement, index))
