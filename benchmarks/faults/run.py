"""One run: the command against a device behind the proxy, until all is over."""

import asyncio
import json
import math
import os
import re
import signal
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.faults import plain_module
from benchmarks.faults.bench_victim import MAP, BenchVictim
from benchmarks.faults.client import Client, Launcher, processes
from benchmarks.faults.plain_module import PlainModule
from benchmarks.faults.proxy import FaultProxy
from benchmarks.faults.schedule import Schedule
from benchmarks.faults.trace import Trace
from dea.acquisition.commissioned import report_file, write_report
from dea.errors import DeviceError
from dea.modbus import read_device

PATIENCE = 90.0  # s beyond the plan and its faults until the command is held to hang
UNREAD = 20.0  # s, of a command that waits for somebody to read its terminal; its guardian does not
NOTICED = 0.1  # s, some samples: a fault of the device that lasts less with voltage on may pass
# What the command says of a trip. With "error:" it refuses to begin, and there is nothing to latch.
TRIP = re.compile(
    r"^failed: .*(interlock \w+: |the current is |the monitor of the high voltage reads)", re.M
)
WATCHED = 1.0  # s of zero after the last process and the last held write


@dataclass(kw_only=True)
class Outcome:
    """What happened, for the laws to judge."""

    schedule: Schedule
    trace: Trace
    folder: Path
    requests: list[tuple[float, dict[int, int]]]
    origin: float | None  # monotonic s of the first write, None where there was none
    exit_time: float  # of the command
    status: int | None  # None where it did not end by itself
    over: float  # when the last of its processes had ended
    until: float  # how long the device was watched
    printed: str = ""
    left: list[int] = field(default_factory=list)  # processes that did not end
    lag: float = 0.0  # s, the longest for which the host kept this process waiting
    again: int | None = None  # exit status of a second run after a fault of the device
    driven_again: bool = False  # whether the second run has put out anything
    recovered: int | None = None  # exit status of `recover`, None where it was not needed


async def run(
    schedule: Schedule, number: int, folder: Path, launcher: Launcher, bench: BenchVictim | None
) -> Outcome:
    """Run the command once and return what the device, the network and the disk have seen."""
    folder.mkdir(parents=True)
    if bench is None:
        device = PlainModule(schedule.read_back, schedule.seed)
        port = await device.start()
        trace = device.trace
    else:
        device, port = None, bench.port
        bench.forget()
        trace = bench.trace
    client = Client(folder, number)
    suffering: list[asyncio.Task[None]] = []

    def begin() -> None:
        assert proxy.origin is not None
        loop = asyncio.get_running_loop()
        suffering.extend(
            loop.create_task(client.suffer(fault, proxy.origin)) for fault in schedule.host
        )
        for fault in schedule.device:
            assert device is not None
            loop.call_later(fault.start, device.faults.add, fault.kind)

    proxy = FaultProxy(port, schedule.link, begin)
    try:
        arguments = _arguments(schedule, folder, await proxy.start(), bench)
        request = {
            "arguments": arguments, "environment": client.environment(),
            "printed": str(folder / "printed"), "stuck_terminal": schedule.stuck_terminal,
            "as_command": schedule.as_command,
        }  # fmt: skip
        if device is not None and schedule.safety:
            await _commission(folder, launcher, request, port)
            device.forget()
        client.process, ended = await launcher.launch(**request)
        longest = schedule.duration + sum(f.length for f in schedule.around)
        try:
            patience = UNREAD if schedule.stuck_terminal else PATIENCE
            status = await asyncio.wait_for(asyncio.shield(ended), longest + patience)
        except TimeoutError:
            status = None
        exit_time = time.monotonic()
        left = await _gone(client, PATIENCE if status is not None else 0)
        over = time.monotonic()
        quiet = max(over, _last_fault(schedule, proxy)) + WATCHED
        await asyncio.sleep(quiet - over)
        last = quiet + schedule.stopping + WATCHED  # nothing is allowed to be driven longer
        while trace.applied and trace.applied[-1].volts and time.monotonic() < last:
            await asyncio.sleep(0.1)
        until = time.monotonic()
        again = None
        printed = _printed(folder)
        tripped = _tripping(schedule, trace, proxy.origin, until) or TRIP.search(printed)
        if device is not None and not left and tripped:
            device.faults.clear()
            again, stays = await _again(folder, launcher, request)
            left += stays
        for process in left:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGCONT)
                os.kill(process, signal.SIGKILL)
    finally:
        for task in suffering:
            task.cancel()
        await proxy.stop()
        if device is not None:
            await device.stop()
    outcome = Outcome(
        schedule=schedule,
        trace=trace.before(until),
        folder=folder,
        requests=proxy.requests,
        origin=proxy.origin,
        exit_time=exit_time,
        status=status,
        over=over,
        until=until,
        printed=printed,
        left=left,
        again=again,
        driven_again=any(entry.volts for entry in trace.applied if entry.time > until),
    )
    if status != 0:
        outcome.recovered = await _recover(folder, launcher, client, arguments)
    return outcome


def _printed(folder: Path) -> str:
    file = folder / "printed"
    return file.read_text() if file.exists() else ""


def _arguments(schedule: Schedule, folder: Path, port: int, bench: BenchVictim | None) -> list[str]:
    if bench is None:
        description = folder / "module.yaml"
        description.write_text(
            plain_module.DESCRIPTION.format(
                port=port, both=str(schedule.both).lower(), quarantine=schedule.quarantine
            )
            + (plain_module.SAFETY if schedule.safety else "")
        )
        # As if it had been commissioned.
        write_report(read_device(description), {"device": "plain module"})
    else:
        description = MAP
    arguments = [
        "drive", "--device", str(description), "--host", "127.0.0.1", "--port", str(port),
        "--output", str(folder / "record.nc"), "--kind", "gaussian", "--mode", schedule.mode,
        "--duration", str(schedule.duration), "--low", str(schedule.low),
        "--high", str(schedule.high), "--ramp-rate", str(schedule.ramp_rate),
        "--seed", str(schedule.seed),
    ]  # fmt: skip
    if schedule.safety:
        arguments += ["--arm", "campaign"]
    return [*arguments, "--reset"] if bench is not None and bench.latched else arguments


def _last_fault(schedule: Schedule, proxy: FaultProxy) -> float:
    """Return when nothing that the proxy holds can reach the device any more."""
    if proxy.origin is None:
        return 0.0
    held = sum(fault.length for fault in schedule.link if fault.kind == "hold")
    return proxy.origin + max((fault.end for fault in schedule.link), default=0.0) + held


async def _commission(folder: Path, launcher: Launcher, request: dict[str, Any], port: int) -> None:
    """Commission the module, past the proxy: its safety model asks for that before a drive."""
    description = request["arguments"][2]
    arguments = ["commission", "--device", description, "--host", "127.0.0.1", "--port", str(port),
                 "--arm", "campaign"]  # fmt: skip
    printed = str(folder / "commission_printed")
    request = request | {"arguments": arguments, "printed": printed, "stuck_terminal": False}
    _, ended = await launcher.launch(**request)
    await ended
    _name_the_proxy(Path(description))


def _name_the_proxy(description: Path) -> None:
    """Have the report be of the module behind the proxy, which is where the drives go."""
    report = json.loads(report_file(description).read_text())
    with suppress(DeviceError):  # a check has failed, and the report says so
        write_report(read_device(description), report)


def _tripping(schedule: Schedule, trace: Trace, origin: float | None, until: float) -> bool:
    """Whether a fault of the device, before any other, lasted for long enough with voltage on.

    What the network or the host does may keep the guardian from looking at the device.
    """
    others = min((f.start for f in schedule.around), default=math.inf)
    begun = origin or 0.0
    return any(
        min(end, begun + others) - max(start, begun + fault.start) > NOTICED
        for fault in schedule.device
        for start, end in trace.driven(until)
    )


async def _again(
    folder: Path, launcher: Launcher, request: dict[str, Any]
) -> tuple[int | None, list[int]]:
    """Run the same command once more, the fault of the device mended, before a person who reads.

    Return its status, or the process that does not end.
    """
    arguments = [
        str(folder / "again.nc") if argument == str(folder / "record.nc") else argument
        for argument in request["arguments"]
    ]
    request |= {
        "arguments": arguments, "printed": str(folder / "again_printed"), "stuck_terminal": False,
    }  # fmt: skip
    process, ended = await launcher.launch(**request)
    try:
        return await asyncio.wait_for(asyncio.shield(ended), PATIENCE), []
    except TimeoutError:
        return None, [process]


async def _gone(client: Client, patience: float) -> list[int]:
    """Wait until every process of the run has ended, and return those that have not."""
    end = time.monotonic() + patience
    while (left := processes(client)) and time.monotonic() < end:
        await asyncio.sleep(0.2)
    return left


async def _recover(
    folder: Path, launcher: Launcher, client: Client, drive: list[str]
) -> int | None:
    partial = folder / "record.partial"
    if not partial.exists() or partial.stat().st_size == 0:
        return None
    arguments = ["recover", str(partial), "--device", drive[2], "--output",
                 str(folder / "recovered.nc")]  # fmt: skip
    (folder / "slow_sync").unlink(missing_ok=True)
    _, ended = await launcher.launch(
        arguments=arguments, environment=client.environment(), as_command=False,
        printed=str(folder / "recover_printed"), stuck_terminal=False,
    )  # fmt: skip
    return await ended
