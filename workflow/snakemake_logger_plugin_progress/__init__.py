"""Progress of a run for a person: one line for each step, `snakemake --logger progress`."""

import re
import sys
import threading
import time
from dataclasses import dataclass, field
from logging import WARNING, LogRecord
from pathlib import Path

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

STILL = 30.0  # s after which a step that runs is named again
STEP = "step: "  # begins the line of a log that says what its job is doing
# Of all steps, the part that must be done before it is said how long the others may take: the first
# ones are the longest.
KNOWN = 0.1
# What Snakemake says once a person has pressed Ctrl-C.
STOPPED = ("Terminating processes on user request", "Cancelling snakemake on user request")
# Of a failed job the log says why; Snakemake's own messages repeat its whole command.
REPEATED = re.compile(
    r"\bRuleException|CalledProcessError|At least one job did not|Exiting because"
)
NO_STEP = re.compile(r"No rule to produce (\S+)")
PLACE = re.compile(
    r"\s*(WorkflowError|InputFunctionException|Error|Wildcards|Traceback|File)\b.*|  \w+=\S+$"
)


@dataclass
class Job:
    """A step that was begun: what it does, of whom, where it writes, since when."""

    name: str
    logs: list[str]
    begun: float = field(default_factory=time.monotonic)

    @property
    def seconds(self) -> float:
        """How long it has been running."""
        return time.monotonic() - self.begun

    @property
    def doing(self) -> str:
        """What it last wrote that it is doing."""
        said = [line for log in self.logs for line in _lines(log) if line.startswith(STEP)]
        return said[-1].removeprefix(STEP) if said else ""


class LogHandler(LogHandlerBase):
    """Writes to the terminal which steps begin and end, how many are left and for how long."""

    writes_to_stream = True
    writes_to_file = False
    has_filter = True
    has_formatter = True
    needs_rulegraph = False

    def __post_init__(self) -> None:
        """Begin without any job."""
        self._jobs: dict[int, Job] = {}
        self._begun = time.monotonic()
        self._done = self._total = 0
        self._stopping = False
        self._write_lock = threading.Lock()
        watch = threading.Thread(target=self._name_long_steps, daemon=True)
        watch.start()

    def emit(self, record: LogRecord) -> None:
        """Write what the record tells, where a person needs it."""
        event = getattr(record, "event", None)
        match event:
            case LogEvent.RUN_INFO:
                self._total = int(record.stats.get("total", 0))
                self._write(f"{self._total} step{'s' * (self._total != 1)} to do")
            case LogEvent.JOB_INFO:
                # What makes nothing is a goal, whose name may hold that of a case.
                name = _described(record) if record.output else record.rule_name
                self._jobs[record.jobid] = Job(name, list(record.log or []))
                together = len(self._jobs)
                beside = f"  ({together} in parallel)" if together > 1 else ""
                self._write(f"{name}{beside}")
            case LogEvent.JOB_FINISHED:
                self._finish(record.job_id)
            case LogEvent.JOB_ERROR:
                job = self._jobs.pop(record.jobid, None)
                end = "was stopped" if self._stopping else "failed"
                self._write(f"{job.name if job else record.rule_name} {end}")
            case LogEvent.PROGRESS:
                self._done, self._total = record.done, record.total
            case _ if record.getMessage().startswith(STOPPED):
                self._stop()
            case _ if record.getMessage().startswith("Nothing to be done"):
                self._write("everything is up to date")
            case _ if record.levelno >= WARNING and not _repeated(record.getMessage()):
                self._write(_without_places(record.getMessage()))

    def _finish(self, job_id: int) -> None:
        job = self._jobs.pop(job_id, None)
        # The count that Snakemake reports follows the end of a job.
        self._done += 1
        if job is None:
            return
        left = max(self._total - self._done, 0)
        passed = time.monotonic() - self._begun
        foreseen = left and self._done >= KNOWN * self._total
        rest = f", about {_duration(passed / self._done * left)}" if foreseen else ""
        self._write(f"{job.name} took {_duration(job.seconds)}; {left} of {self._total} left{rest}")

    def _stop(self) -> None:
        if not self._stopping:
            self._stopping = True
            self._write("stopping; finished steps are kept, the same command goes on from there")

    def _name_long_steps(self) -> None:
        named: dict[int, float] = {}
        while True:
            time.sleep(1.0)
            for job_id, job in list(self._jobs.items()):
                if job.seconds - named.get(job_id, 0.0) >= STILL:
                    named[job_id] = job.seconds
                    said = f"{job.name} has been running for {_duration(job.seconds)}"
                    self._write("; ".join(filter(None, (said, job.doing))))

    def _write(self, text: str) -> None:
        with self._write_lock:
            print(f"{time.strftime('%H:%M:%S')}  {text}", file=sys.stderr, flush=True)


def _lines(log: str) -> list[str]:
    """Return what a log holds, which a job may not have begun."""
    try:
        return Path(log).read_text(errors="replace").splitlines()
    except OSError:
        return []


def _described(job: LogRecord) -> str:
    """Return whose step it is and which, such as ``dea1: track``."""
    step = job.rule_name.replace("_", " ")
    whose = " ".join(map(str, (job.wildcards or {}).values()))
    return f"{whose}: {step}" if whose else step


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


def _without_places(message: str) -> str:
    """Return what a message says, without the lines on where the workflow raised it."""
    if unknown := NO_STEP.search(message):
        return f"{unknown[1]}: no step makes it. results/README.md says what there is"
    lines = [line.strip() for line in message.splitlines() if not PLACE.match(line)]
    return "\n".join(lines) or message


def _repeated(message: str) -> bool:
    return not message.strip() or REPEATED.search(message) is not None
