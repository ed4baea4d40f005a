"""Many runs at a time, since they mostly wait; one that breaks a law is reduced to its cause."""

import asyncio
import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.faults.bench_victim import BenchVictim
from benchmarks.faults.client import Launcher
from benchmarks.faults.lag import Lag
from benchmarks.faults.laws import broken
from benchmarks.faults.plain_module import ReadBack
from benchmarks.faults.run import run
from benchmarks.faults.schedule import Schedule
from benchmarks.faults.verdicts import Verdict, Verdicts

AT_A_TIME = 8


class Campaign:
    """Runs schedules, ``at_a_time`` together; benches are served once and used in turn.

    ``keep`` is a folder for what runs that break a law leave, ``verdicts`` those of earlier runs.
    """

    def __init__(
        self,
        at_a_time: int = AT_A_TIME,
        keep: Path | None = None,
        verdicts: Verdicts | None = None,
    ) -> None:
        self._at_a_time = at_a_time
        self._keep = keep
        self._verdicts = verdicts or Verdicts()
        kept = keep.glob("[0-9]*") if keep is not None else ()
        self._number = max((int(folder.name) for folder in kept), default=0)
        self._launcher = Launcher()
        self._lag = Lag()
        self._benches: asyncio.Queue[BenchVictim] = asyncio.Queue()

    def judge(
        self,
        schedules: Sequence[Schedule],
        reduce: bool = False,
        tell: Callable[[int, Verdict], None] = lambda number, verdict: None,
    ) -> list[Verdict]:
        """Return a verdict for each schedule, in order; ``tell`` hears of each as it comes."""
        return asyncio.run(self._judge(schedules, reduce, tell))

    async def _judge(
        self,
        schedules: Sequence[Schedule],
        reduce: bool,
        tell: Callable[[int, Verdict], None],
    ) -> list[Verdict]:
        on_bench = sum(schedule.victim == "bench" for schedule in schedules)
        benches = [BenchVictim() for _ in range(min(on_bench, max(1, self._at_a_time // 2)))]
        gate = asyncio.Semaphore(self._at_a_time)
        errors: list[str] = []  # of the proxy and the devices, which must not pass for a fault
        asyncio.get_running_loop().set_exception_handler(
            lambda _, context: errors.append(str(context.get("exception", context["message"])))
        )
        with tempfile.TemporaryDirectory() as scratch:
            try:
                self._lag.start()
                await asyncio.gather(self._launcher.start(), *(b.start() for b in benches))
                for bench in benches:
                    self._benches.put_nowait(bench)

                async def one(number: int, schedule: Schedule) -> Verdict:
                    async with gate:
                        verdict = self._verdicts.on(schedule)
                        if verdict is None:
                            verdict = await self._once(schedule, Path(scratch))
                            if reduce:
                                verdict = await self._reduced(verdict, Path(scratch))
                            self._verdicts.add(schedule, verdict)
                    tell(number, verdict)
                    return verdict

                runs = (one(number, schedule) for number, schedule in enumerate(schedules))
                verdicts = await asyncio.gather(*runs)
                if errors:
                    raise RuntimeError(f"the campaign itself fails: {errors[0]}")
                return verdicts
            finally:
                for bench in benches:
                    await bench.stop()
                await self._launcher.stop()
                self._lag.stop()

    async def _once(self, schedule: Schedule, scratch: Path) -> Verdict:
        self._number += 1
        number, folder = self._number, scratch / str(self._number)
        began = time.monotonic()
        bench = await self._benches.get() if schedule.victim == "bench" else None
        try:
            outcome = await run(schedule, number, folder, self._launcher, bench)
        finally:
            if bench is not None:
                self._benches.put_nowait(bench)
        outcome.lag = self._lag.worst(began)
        laws = tuple(broken(outcome))
        driven = any(entry.volts for entry in outcome.trace.applied)
        if laws and self._keep is not None:
            kept = self._keep / f"{number:04d}"
            shutil.copytree(folder, kept)
            (kept / "schedule.json").write_text(schedule.dumps() + "\n")
            (kept / "broken").write_text("\n".join(laws) + "\n")
        shutil.rmtree(folder)
        return Verdict(schedule, laws, outcome.status, driven)

    async def _reduced(self, verdict: Verdict, scratch: Path) -> Verdict:
        """Leave out each fault in turn, for as long as some law stays broken without it."""
        for smaller in _smaller(verdict.schedule) if verdict.broken else ():
            tried = await self._once(smaller, scratch)
            if tried.broken:
                return await self._reduced(tried, scratch)
        return verdict


def _smaller(schedule: Schedule) -> list[Schedule]:
    if schedule.faults() < 2:
        return []
    candidates = [
        replace(schedule, link=schedule.link[:k] + schedule.link[k + 1 :])
        for k in range(len(schedule.link))
    ]
    if schedule.host:
        candidates.append(replace(schedule, host=()))
    if schedule.device:
        candidates.append(replace(schedule, device=()))
    if schedule.stuck_terminal:
        candidates.append(replace(schedule, stuck_terminal=False))
    if schedule.read_back != ReadBack():
        candidates.append(replace(schedule, read_back=ReadBack()))
    return candidates
