"""The command, run as a user runs it, with the faults of its host."""

import asyncio
import json
import os
import resource
import signal
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.faults.host_faults import CLOCK_STEP, SLOW_SYNC
from benchmarks.faults.schedule import HostFault
from dea.acquisition.shared_file import OWN_FOLDER

ROOT = Path(__file__).parents[2]
MARK = "FAULTS_RUN"  # in the environment of every process that a run has started


class Launcher:
    """The process that starts the commands, and what it says of them."""

    def __init__(self) -> None:
        self._process: asyncio.subprocess.Process | None = None
        self._begun: dict[int, asyncio.Future[int]] = {}
        self._ended: dict[int, asyncio.Future[int]] = {}
        self._listening: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Start the launcher; it imports the library once."""
        self._process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "benchmarks.faults.launcher", cwd=ROOT,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
        )  # fmt: skip
        self._listening = asyncio.get_running_loop().create_task(self._listen())

    async def stop(self) -> None:
        """End the launcher."""
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.close()
        with suppress(TimeoutError):
            await asyncio.wait_for(self._process.wait(), 5)
        if self._process.returncode is None:
            self._process.kill()
        if self._listening is not None:
            await self._listening

    async def launch(self, **request: Any) -> tuple[int, "asyncio.Future[int]"]:
        """Start a command; return its process id, and a future of its exit status."""
        assert self._process is not None
        assert self._process.stdin is not None
        loop = asyncio.get_running_loop()
        number = len(self._begun)
        self._begun[number], self._ended[number] = loop.create_future(), loop.create_future()
        self._process.stdin.write(json.dumps({"id": number, **request}).encode() + b"\n")
        return await self._begun[number], self._ended[number]

    async def _listen(self) -> None:
        assert self._process is not None
        assert self._process.stdout is not None
        while line := await self._process.stdout.readline():
            said = json.loads(line)
            if "pid" in said:
                self._begun[said["id"]].set_result(said["pid"])
            else:
                self._ended[said["id"]].set_result(said["status"])


@dataclass
class Client:
    """One run of the command in a folder of its own."""

    folder: Path
    number: int  # of the run, unlike any other's
    process: int = 0

    @property
    def mark(self) -> str:
        """What the environment of each of its processes says."""
        return f"{os.getpid()}.{self.number}"

    def environment(self) -> dict[str, str]:
        """Return what the command finds in its environment."""
        path = f"{Path(__file__).parent / 'interpreter'}:{ROOT}:{os.environ.get('PYTHONPATH', '')}"
        return {
            MARK: self.mark,
            # Locks and latches belong to an address; ports are used again by other runs.
            OWN_FOLDER: str(self.folder),
            "PYTHONPATH": path, "COLUMNS": "200",
            SLOW_SYNC: str(self.folder / "slow_sync"),
            CLOCK_STEP: str(self.folder / "clock_step"),
        }  # fmt: skip

    async def suffer(self, fault: HostFault, origin: float) -> None:
        """Put one fault on the command when its time has come."""
        await _until(origin + fault.start)
        if fault.kind == "signal":
            self._signal(fault.number, fault.group)
            if fault.signal in ("SIGSTOP", "SIGTSTP"):
                await _until(origin + fault.start + fault.length)
                self._signal(signal.SIGCONT, fault.group)
        elif fault.kind == "slow_sync":
            file = self.folder / "slow_sync"
            file.touch()
            await _until(origin + fault.start + fault.length)
            file.unlink()
        elif fault.kind == "full_disk":
            await self._full_disk(fault, origin)
        elif fault.kind == "clock_step":
            (self.folder / "clock_step").write_text(str(fault.step))

    async def _full_disk(self, fault: HostFault, origin: float) -> None:
        """Let no file of the command grow any further."""
        with suppress(ProcessLookupError):
            largest = max((f.stat().st_size for f in self.folder.iterdir()), default=0)
            _, hard = resource.prlimit(self.process, resource.RLIMIT_FSIZE)
            resource.prlimit(self.process, resource.RLIMIT_FSIZE, (largest, hard))
            await _until(origin + fault.start + fault.length)
            resource.prlimit(self.process, resource.RLIMIT_FSIZE, (hard, hard))

    def _signal(self, number: int, group: bool) -> None:
        with suppress(ProcessLookupError):
            (os.killpg if group else os.kill)(self.process, number)


def processes(client: Client) -> list[int]:
    """Return the processes that a run has started and that still are there.

    They are in its process group or carry its mark; a fork shows its parent's environment.
    """
    wanted = f"{MARK}={client.mark}".encode()
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        with suppress(OSError):
            number = int(entry.name)
            marked = wanted in (entry / "environ").read_bytes().split(b"\0")
            if (marked or os.getpgid(number) == client.process) and _alive(entry):
                found.append(number)
    return found


def _alive(entry: Path) -> bool:
    state = (entry / "stat").read_text().rpartition(")")[2].split()[0]
    return state not in "ZX"


async def _until(when: float) -> None:
    await asyncio.sleep(max(0.0, when - time.monotonic()))
