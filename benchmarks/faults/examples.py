"""Runs with one fault each: the failures that are known of such programs, by name."""

from benchmarks.faults.plain_module import ReadBack
from benchmarks.faults.schedule import DeviceFault, HostFault, LinkFault, Schedule

STOP = 2.9  # s after the first write: in the ramp to zero, or about to begin it

LINK = {
    "a write held for 4 s": LinkFault("hold", 1.0, 4.0),
    "the last writes held for 4 s": LinkFault("hold", STOP, 4.0),
    "busy for 1 s in the stop": LinkFault("exception", STOP - 0.2, 1.0, code=6),
    "acknowledge for 1 s in the stop": LinkFault("exception", STOP - 0.2, 1.0, 5, executed=True),
    "device failure for 1 s in the stop": LinkFault("exception", STOP - 0.2, 1.0, code=4),
    "gateway without target for 1 s in the stop": LinkFault("exception", STOP - 0.2, 1.0, code=11),
    "gateway without path for 1 s": LinkFault("exception", 1.0, 1.0, code=10),
    "busy for 1 s": LinkFault("exception", 1.0, 1.0, code=6),
    "network lost for 5 s": LinkFault("cut", 1.0, 5.0),
    "network lost for 15 s": LinkFault("cut", 1.0, 15.0),
    "network lost for 15 s, late writes": LinkFault("cut", 1.0, 15.0, executed=True),
    "connections refused for 15 s": LinkFault("refuse", 1.0, 15.0),
    "a dropped connection": LinkFault("drop", 1.0),
    "a half-open connection": LinkFault("half_open", 1.0),
    "slow replies": LinkFault("delay", 1.0, 2.0, code=300),
}
HOST = {
    **{
        name: HostFault("signal", 1.0, signal=name)
        for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGKILL")
    },
    "Ctrl-C": HostFault("signal", 1.0, signal="SIGINT", group=True),
    "Ctrl-\\": HostFault("signal", 1.0, signal="SIGQUIT", group=True),
    "Ctrl-Z for 12 s": HostFault("signal", 1.0, 12.0, signal="SIGTSTP", group=True),
    "SIGSTOP for 1 s": HostFault("signal", 1.0, 1.0, signal="SIGSTOP"),
    "SIGSTOP for 12 s": HostFault("signal", 1.0, 12.0, signal="SIGSTOP"),
    "a disk that hangs for 12 s": HostFault("slow_sync", 1.0, 12.0),
    "a full disk": HostFault("full_disk", 1.0, 30.0),
    "the clock an hour back": HostFault("clock_step", 1.0, step=-3600.0),
}
LIES = {
    "read-back stuck at zero": ReadBack("stuck", 0.0),
    "read-back stuck at 2 V": ReadBack("stuck", 2.0),
    "output clamped at 2 V": ReadBack("clamped", 2.0),
    "read-back in kilovolts": ReadBack("scaled", 0.001),
    "read-back of half": ReadBack("scaled", 0.5),
    "read-back with an offset of 20 mV": ReadBack("offset", 0.02),
    "read-back with noise of 5 mV": ReadBack("noisy", 0.005),
}

DEVICE = {
    "an interlock that opens": DeviceFault("interlock", 1.0),
    "a current that is too large": DeviceFault("current", 1.0),
    "a high voltage that is not what was asked for": DeviceFault("monitor", 1.0),
    "an interlock that opens in the ramp": DeviceFault("interlock", 0.05),
}


def examples() -> dict[str, Schedule]:
    """Return every run by the name of its device and its fault."""
    runs = {"plain: no fault": Schedule("plain"), "bench: no fault": Schedule("bench")}
    runs["bench, buffered: no fault"] = Schedule("bench", "buffered")
    for name, link in LINK.items():
        runs[f"plain: {name}"] = Schedule("plain", link=(link,))
        runs[f"bench: {name}"] = Schedule("bench", "buffered", link=(link,))
    for name, host in HOST.items():
        runs[f"plain: {name}"] = Schedule("plain", host=(host,))
        runs[f"bench: {name}"] = Schedule("bench", "buffered", host=(host,))
    for name, lie in LIES.items():
        runs[f"plain: {name}"] = Schedule("plain", read_back=lie)
    runs["plain, safety: no fault"] = Schedule("plain", safety=True)
    for name, device in DEVICE.items():
        runs[f"plain, safety: {name}"] = Schedule("plain", safety=True, device=(device,))
    runs["plain: a terminal that nobody reads"] = Schedule("plain", stuck_terminal=True)
    return runs
