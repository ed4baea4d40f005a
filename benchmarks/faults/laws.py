"""The laws of the acquisition, judged by what the device has truly put out.

The times count from what was configured (``Schedule.stopping``).
"""

import itertools
import math
from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr

from benchmarks.faults.run import Outcome
from benchmarks.faults.schedule import LIMIT, STOPPING, TIMEOUT, HostFault

LAGS = 10  # times that a stop may be kept waiting by a busy host
JITTER = 0.1  # s by which two writes may be closer on a busy host than they were meant
RATE = 50  # Hz
SYNCED = 25  # samples that a killed recorder may not have written yet
RESOLUTION = 2e-4  # V, one count
TOLERANCE = 0.05 * LIMIT  # V, what a read-back may be off: the default of read_back_tolerance
HELD = 1  # the flag of samples beside those of the plan
LINKS_DOWN = ("hold", "exception", "refuse", "cut", "delay", "half_open")


def broken(outcome: Outcome) -> list[str]:
    """Return a sentence for each law that the run has broken."""
    return [sentence for law in LAWS for sentence in law(outcome)]


def _works(outcome: Outcome) -> Iterator[str]:
    """Without a fault the command plays its plan: laws that nothing puts to the test are kept."""
    if not outcome.schedule.faults() and outcome.status != 0:
        last = (outcome.printed.strip().splitlines() or ["nothing"])[-1]
        yield f"does not work: status {outcome.status} without any fault: {last[-200:]}"


def _within_range(outcome: Outcome) -> Iterator[str]:
    highest = max((entry.volts for entry in outcome.trace.applied), default=0.0)
    if highest > outcome.schedule.high + 2 * RESOLUTION:
        yield f"beyond range: {highest:.3f} V where {outcome.schedule.high} V is the highest"


def _within_rate(outcome: Outcome) -> Iterator[str]:
    """Judge what the command asked for, by when it asked; a plain module obeys at once.

    A band-limited excitation of amplitude A changes no faster than 2 pi f A (Bernstein).
    """
    schedule = outcome.schedule
    if schedule.victim != "plain":
        return
    amplitude = (schedule.high - schedule.low) / 2
    rate = max(schedule.ramp_rate, 2 * math.pi * schedule.band * amplitude)
    asked = [(when, registers[0] / 6553.5) for when, registers in outcome.requests
             if 0 in registers]  # fmt: skip
    jitter = JITTER + outcome.lag
    times = np.array([when for when, _ in asked])
    volts = np.array([value for _, value in asked])
    for start in range(len(asked)):
        near = slice(start + 1, int(np.searchsorted(times, times[start] + 0.5)) + 1)
        excess = np.abs(volts[near] - volts[start]) - rate * (times[near] - times[start] + jitter)
        if excess.size and excess.max() > 0:
            end = start + 1 + int(excess.argmax())
            yield (
                f"beyond rate: {abs(volts[end] - volts[start]):.2f} V in "
                f"{times[end] - times[start]:.3f} s, {_after(outcome, times[start])}, where "
                f"{rate:.1f} V/s is the highest"
            )
            return


def _zero_in_time(outcome: Outcome) -> Iterator[str]:
    """After whatever ends the run, zero within T; while the link is down, within T of its end."""
    if outcome.origin is None:
        return
    schedule = outcome.schedule
    pauses = sum(fault.length + TIMEOUT for fault in schedule.around)
    plan = schedule.duration + 2 * schedule.ramp + pauses
    reasons = [(outcome.origin + plan, "the end of the plan")]
    reasons += [
        (outcome.origin + fault.start, _name(fault)) for fault in schedule.host
        if fault.ends_the_run
    ]  # fmt: skip
    reasons += [(outcome.origin + f.start, f"a fault of the {f.kind}") for f in schedule.device]
    reasons.append((outcome.exit_time, f"the command had ended with status {outcome.status}"))
    for when, reason in reasons:
        limit = _link_is_back(outcome, when) + schedule.stopping + LAGS * outcome.lag
        driven = [
            (max(start, limit), end, volts)
            for start, end, volts in outcome.trace.spans(outcome.until)
            if end > limit + JITTER and volts > RESOLUTION
        ]
        if driven:
            yield (
                f"not zero in time: {driven[-1][2]:.2f} V {driven[-1][1] - when:.1f} s after "
                f"{reason}, where {limit - when:.1f} s are allowed"
            )
            return


def _never_driven_after_exit(outcome: Outcome) -> Iterator[str]:
    """Once its processes have ended and nobody killed them, the output is zero and stays so."""
    if outcome.left and not outcome.schedule.stuck_terminal:
        yield f"does not end: {len(outcome.left)} processes are still there"
        return
    killed = outcome.status is not None and outcome.status < 0
    if killed and outcome.over - outcome.exit_time < 0.5:
        return  # nobody is left to drive; _zero_in_time judges what stayed on
    admitted = "not" in outcome.printed and "zero" in outcome.printed and outcome.status != 0
    for start, end, volts in outcome.trace.spans(outcome.until):
        if volts > RESOLUTION and end > outcome.over + JITTER:
            said = " (it says that zero is not verified)" if admitted else ""
            yield (
                f"driven after exit: {volts:.2f} V from "
                f"{max(start - outcome.over, 0):.1f} s after the end{said}"
            )
            return


def _trips_latch(outcome: Outcome) -> Iterator[str]:
    """After a trip the film stays at zero, mended or not, until a person has acknowledged it."""
    if outcome.again is None or not any(
        fault.start < outcome.exit_time - (outcome.origin or 0) for fault in outcome.schedule.device
    ):
        return
    if outcome.driven_again or outcome.again == 0:
        yield f"does not latch: driven again with status {outcome.again} after a trip"


def _no_wrong_sample(outcome: Outcome) -> Iterator[str]:
    """A sample of quality 0 holds what the device put out when its displacement was read."""
    record = _record(outcome)
    if record is None:
        return
    truth = _truth(outcome)
    good = record["quality"].values == 0
    # A read-back that is wrong by less than its tolerance is recorded as it is.
    off = outcome.schedule.read_back.kind not in ("true", "clamped")
    tolerance = TOLERANCE if off else 2 * RESOLUTION
    wrong = 0
    example = ""
    for k in np.flatnonzero(good):
        known = truth(record, int(k))
        if known is None:
            continue
        volts = float(record["voltage"].values[k])
        if not any(abs(volts - value) <= tolerance for value in known):
            wrong += 1
            example = example or f"sample {k} says {volts:.3f} V and was {known[:1]} V"
    if wrong:
        yield f"wrong samples of quality 0: {wrong} of {good.sum()}; {example}"


def _no_record_lost(outcome: Outcome) -> Iterator[str]:
    """All samples are in the record, or what was played half a second before the failure."""
    schedule = outcome.schedule
    wanted = round(schedule.duration * RATE)
    record = _record(outcome)
    found = 0 if record is None else int(np.sum((record["quality"].values & HELD) == 0))
    if outcome.status == 0:
        if found != wanted:
            yield f"record lost: {found} of {wanted} samples though the status is 0"
        return
    played = _played(outcome) - SYNCED
    full = [fault for fault in schedule.host if fault.kind in ("full_disk", "slow_sync")]
    if full:
        played = min(played, *(fault.start * RATE - SYNCED for fault in full))
    if found < min(played, wanted):
        yield (
            f"record lost: {found} samples are left where {played:.0f} were played half a second "
            f"before (recover's status {outcome.recovered})"
        )


def _played(outcome: Outcome) -> float:
    """Return the least number of samples that were played, by the changes of the output.

    Samples that a device plays from its buffer are not recorded where the link stays down, or comes
    back only for the ramp to zero.
    """
    applied = outcome.trace.applied
    last = max((entry.time for entry in applied if entry.volts), default=0.0)
    down = [
        outcome.origin + fault.start
        for fault in outcome.schedule.link
        if outcome.schedule.mode == "buffered"
        and outcome.origin is not None
        and fault.kind in LINKS_DOWN
        and outcome.origin + fault.end >= last - outcome.schedule.ramp - SYNCED / RATE
    ]
    volts = [entry.volts for entry in applied if entry.time <= min(down, default=last)]
    low = outcome.schedule.low - 2 * RESOLUTION
    changes = sum(new != old and new > low for old, new in itertools.pairwise(volts))
    return changes - 2 * outcome.schedule.ramp * RATE


def _record(outcome: Outcome) -> xr.Dataset | None:
    for name in ("record.nc", "recovered.nc"):
        file = outcome.folder / name
        if file.exists():
            with xr.open_dataset(file) as record:
                return record.load()
    return None


def _truth(outcome: Outcome) -> Callable[[xr.Dataset, int], list[float] | None]:
    """Return what gives the true outputs that a sample may tell of, None where it is not known."""
    found: dict[int, list[float]] = {}
    if outcome.schedule.victim == "plain":
        for entry in outcome.trace.applied:
            found.setdefault(entry.displacement, []).append(entry.volts)
        return lambda record, k: found.get(int(record["displacement_counts"].values[k]), [])
    for entry in outcome.trace.applied:
        found.setdefault(entry.index, []).append(entry.volts)
    return lambda record, k: found.get(int(record["device_index"].values[k]))


def _link_is_back(outcome: Outcome, when: float) -> float:
    """Return the end of the faults of the link that overlap what follows ``when``."""
    assert outcome.origin is not None
    back = when
    for fault in sorted(outcome.schedule.link, key=lambda fault: fault.start):
        begins, ends = outcome.origin + fault.start, outcome.origin + fault.end
        if fault.kind in LINKS_DOWN and begins <= back + STOPPING:
            back = max(back, ends)
    return back


def _name(fault: HostFault) -> str:
    return f"{fault.signal}{' to the group' if fault.group else ''}"


def _after(outcome: Outcome, when: float) -> str:
    return f"{when - (outcome.origin or when):.2f} s after the first write"


LAWS = (
    _works,
    _within_range,
    _within_rate,
    _zero_in_time,
    _never_driven_after_exit,
    _trips_latch,
    _no_wrong_sample,
    _no_record_lost,
)
