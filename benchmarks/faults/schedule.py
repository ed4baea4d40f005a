"""One run of the command and the faults it meets, as plain data that JSON can hold."""

import json
import signal
from dataclasses import asdict, dataclass, field

from benchmarks.faults.plain_module import ReadBack

LIMIT = 3.76  # V, of the device descriptions
TIMEOUT = 2.0  # s, of one reply: the command's default
HOST = 1.5  # s that a busy host may add
WATCHDOG = 1.0  # s, of the bench
# Until zero after whatever ends a run, beside the ramp: one reply and one connection waited for in
# vain, on the bench its watchdog, and a busy host.
STOPPING = 2 * TIMEOUT + HOST


@dataclass(frozen=True)
class LinkFault:
    """A fault of the network or of a gateway, ``start`` s after the first write."""

    kind: str  # hold, delay, exception, drop, refuse, cut, half_open
    start: float
    length: float = 0.0  # s
    code: int = 0  # of an exception; ms of a delay
    executed: bool = False  # whether a refused or cut request reaches the device after all

    @property
    def end(self) -> float:
        """S after the first write."""
        return self.start + self.length


@dataclass(frozen=True)
class HostFault:
    """A fault of the host on which the command runs, ``start`` s after the first write."""

    kind: str  # signal, slow_sync, full_disk, clock_step
    start: float
    length: float = 0.0  # s until SIGCONT, or until the disk works again
    signal: str = ""  # name
    group: bool = False  # to the whole process group, as a terminal sends it
    step: float = 0.0  # s, of the wall clock

    @property
    def number(self) -> int:
        """The signal's number."""
        return int(signal.Signals[self.signal])

    @property
    def ends_the_run(self) -> bool:
        """Whether the film must be at zero soon after it: a short stop may be made up for."""
        stopped = self.signal in ("SIGSTOP", "SIGTSTP")
        return self.kind == "signal" and (not stopped or self.length > STOPPING)


@dataclass(frozen=True)
class DeviceFault:
    """What goes wrong behind the module, ``start`` s after the first write, and stays so."""

    kind: str  # interlock, current, monitor
    start: float


@dataclass(frozen=True)
class Schedule:
    """A run: what is played, on which device, and what goes wrong."""

    victim: str  # plain, bench
    mode: str = "polled"
    low: float = 0.5  # V
    high: float = 3.5  # V
    ramp_rate: float = 10.0  # V/s
    duration: float = 2.5  # s
    seed: int = 1
    quarantine: float = 5.0  # s for which the plain module is watched: no write is held longer
    both: bool = False  # whether the plain module answers function code 23
    stuck_terminal: bool = False  # nobody reads what the command prints
    as_command: bool = False  # an interpreter of its own; else a fork of one that has imported
    read_back: ReadBack = field(default_factory=ReadBack)
    link: tuple[LinkFault, ...] = ()
    host: tuple[HostFault, ...] = ()
    safety: bool = False  # whether the plain module has a monitor, an interlock and so on
    device: tuple[DeviceFault, ...] = ()  # only with ``safety``

    @property
    def band(self) -> float:
        """Hz, the highest frequency of the excitation."""
        return 1.0

    def dumps(self) -> str:
        """Return the schedule as one line of JSON."""
        return json.dumps(asdict(self))

    @property
    def around(self) -> tuple[LinkFault | HostFault, ...]:
        """What goes wrong with the network and the host."""
        return (*self.link, *self.host)

    @property
    def ramp(self) -> float:
        """S of the longest ramp to zero."""
        return self.high / self.ramp_rate

    @property
    def stopping(self) -> float:
        """S until zero after whatever ends the run, while the link works."""
        return STOPPING + self.ramp + (WATCHDOG if self.victim == "bench" else 0.0)

    def faults(self) -> int:
        """Return how many things go wrong."""
        return (
            len(self.link)
            + len(self.host)
            + len(self.device)
            + self.stuck_terminal
            + (self.read_back.kind != "true")
        )


def loads(text: str) -> Schedule:
    """Return the schedule that ``dumps`` wrote."""
    raw = json.loads(text)
    raw["read_back"] = ReadBack(**raw.get("read_back", {}))
    raw["link"] = tuple(LinkFault(**fault) for fault in raw.get("link", ()))
    raw["device"] = tuple(DeviceFault(**fault) for fault in raw.get("device", ()))
    raw["host"] = tuple(HostFault(**fault) for fault in raw.get("host", ()))
    return Schedule(**raw)
