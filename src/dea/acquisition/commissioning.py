"""The first voltage on a device: a staircase to a few per cent, and what is learnt from it."""

import json
import math
import os
import signal
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dea.acquisition.acquire import acquire
from dea.acquisition.duty import duty_file, look
from dea.acquisition.flagged import flags_said
from dea.acquisition.latch import utc_now
from dea.acquisition.link_log import LinkLog
from dea.acquisition.panel import Panel
from dea.acquisition.poll import Poll
from dea.acquisition.retrying_link import BY_HAND, Link
from dea.acquisition.samples import DrivenSamples, Quality, asked_for
from dea.acquisition.settings import AcquisitionSettings
from dea.atomic_file import atomic
from dea.errors import DeviceError, InputError
from dea.modbus import Device, to_physical

if TYPE_CHECKING:
    import xarray as xr

STEPS = 5  # stairs
HOLD = 1.0  # s on each of them
SETTLED = 0.3  # share of a stair at its end that is taken as settled
TRIPPED, DID_NOT_TRIP = "tripped", "did not trip"
WATCHDOG_MARGIN = 1.5  # s beyond the watchdog's time
# Gains of a read-back that follows the output; noise makes that of a low staircase uncertain.
FOLLOWS = 0.5, 2.0
_AGAIN = "python -m dea.acquisition commission --arm NAME"
_MEND = f"Mend the device or its description, then: {_AGAIN}"


def commission(
    device: Device, partial: Path, settings: AcquisitionSettings, share: float
) -> dict[str, Any]:
    """Drive a staircase up to ``share`` of the upper limit; return what it showed.

    Where the device has a watchdog, its guardian is then killed at the top, to see whether the
    device takes the output to zero by itself.

    Raises
    ------
    InputError, DeviceError
        As :func:`dea.acquisition.acquire`.
    """
    limits = device["output"].limits
    if limits is None:
        raise InputError("no limits", file=device.source, field="registers.output.limits")
    stairs = np.linspace(0.0, share * limits[1], STEPS + 1)[1:]
    hold = max(round(HOLD * device.sampling_rate), 10)
    polled = replace(settings, mode="polled", paced=True)
    together = _read_together(device)
    acquired = acquire(device, np.repeat(stairs, hold), partial, polled)
    report: dict[str, Any] = {"device": device.name, "time": utc_now()}
    report |= {"armed_by": settings.armed_by, "read_together": together}
    report |= {"highest": float(stairs[-1])} | _learnt(acquired.record, acquired.link, hold)
    if "watchdog_time" in device and "watchdog_latched" in device:
        partial.unlink()
        report["watchdog"] = _trip_watchdog(device, np.repeat(stairs, hold), partial, polled)
    partial.unlink(missing_ok=True)
    return report


def _read_together(device: Device) -> list[list[str]]:
    """Return the names of registers by the requests that a sample takes; applies no voltage."""
    link = Link(device, BY_HAND)
    try:
        poll = Poll(Panel(link))
        poll.learn()
    finally:
        link.close()
    return [[register.name for register in window.registers] for window in poll.windows]


def _learnt(record: "xr.Dataset", link: "xr.Dataset", hold: int) -> dict[str, Any]:
    """Return gain, offset, delay and noise of the read-back, noise of the sensor, round trips."""
    stairs = record.isel(time=asked_for(record.quality.values))
    settled = np.arange(stairs.sizes["time"]) % hold >= (1 - SETTLED) * hold
    settled &= stairs.quality.values == Quality.GOOD
    if not settled.any():
        raise DeviceError(f"{flags_said(record)}. {_MEND}")
    asked = stairs.voltage_requested.values[settled]
    applied, displacement = stairs.voltage.values[settled], stairs.displacement.values[settled]
    gain, offset = np.polyfit(asked, applied, 1)
    trips = link.receive_time.values - link.send_time.values
    return {
        "read_back_gain": float(gain),
        "read_back_offset": float(offset),
        "read_back_delay": _delay(stairs, link, hold),
        "read_back_noise": _noise(asked, applied),
        "displacement_noise": _noise(asked, displacement),
        "round_trip_median": float(np.median(trips)),
        "round_trip_longest": float(trips.max()),
        "flagged_samples": int(np.count_nonzero(record.quality.values)),
    }


def _delay(record: "xr.Dataset", link: "xr.Dataset", hold: int) -> float:
    """Return how long after a step is written the read-back shows it, s; NaN where never.

    The mean of all steps counts, so that the noise of one does not, and the half of it is waited
    for. Resolved to a sampling interval.
    """
    times = link.set_index(sample="device_index").sel(sample=record.device_index.values)
    since = (times.read_time.values.reshape(-1, hold) - times.write_time.values[::hold, None])[1:]
    asked = record.voltage_requested.values[::hold]
    applied = record.voltage.values.reshape(-1, hold)
    before = _mean(applied[:-1, -round(SETTLED * hold) :], axis=1)
    steps = (applied[1:] - before[:, None]) / np.diff(asked)[:, None]
    there = np.isfinite(steps + since)  # a busy host leaves samples out
    response = _mean(np.where(there, steps, np.nan), axis=0)
    shown = np.flatnonzero(response >= 0.5 * _mean(response[-round(SETTLED * hold) :], axis=0))
    if not shown.size:
        return np.nan
    return float(np.median(since[there[:, shown[0]], shown[0]]))


def _mean(values: np.ndarray, axis: int) -> np.ndarray:
    """Return the mean of what there is along an axis, NaN where there is nothing."""
    there = np.isfinite(values)
    total = np.sum(values, axis=axis, where=there)
    count = np.count_nonzero(there, axis=axis)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _noise(asked: np.ndarray, values: np.ndarray) -> float:
    """Return the standard deviation within a stair."""
    stairs = [values[asked == level] for level in np.unique(asked)]
    return float(np.sqrt(np.mean([np.var(stair) for stair in stairs])))


class _WatchedError(DeviceError):
    """The watchdog has been looked at."""


def _trip_watchdog(
    device: Device, volts: np.ndarray, partial: Path, settings: AcquisitionSettings
) -> str:
    """Kill the guardian while it drives; return what the device did, and reset it."""
    found: dict[str, float] = {}

    def kill(samples: DrivenSamples, _: LinkLog) -> None:
        if to_physical(device["output"], samples.requested).max() < volts.max():
            return
        notice = look(duty_file(device))
        if not notice.alive:
            raise DeviceError(f"no guardian is known to {duty_file(device)}, which should name it")
        os.kill(notice.process, signal.SIGKILL)
        link = Link(device)
        try:
            panel = Panel(link)
            time.sleep(panel.number("watchdog_time") + WATCHDOG_MARGIN)
            found["latched"] = panel.number("watchdog_latched")
        finally:
            link.close()
        raise _WatchedError

    try:
        acquire(device, volts, partial, settings, watch=kill)
    except _WatchedError:
        partial.unlink()
    if not found.get("latched"):
        return DID_NOT_TRIP
    acquire(device, volts[:1], partial, settings, reset=True)
    partial.unlink()
    return TRIPPED


def report_file(description: Path) -> Path:
    """Return where the report on a device description is kept."""
    return description.with_suffix(".commissioned.json")


def write_report(device: Device, description: Path, report: Mapping[str, Any]) -> Path:
    """Write the report beside the description, with the hash of what the device was driven with.

    Raises
    ------
    DeviceError
        Where a check has failed; the report is written all the same.
    """
    path = report_file(description)
    content = {**report, "description_sha256": _hash(device)}
    with atomic(path) as partial:
        partial.write_text(json.dumps(content, indent=2, sort_keys=True) + "\n")
    for field, why in _failed(report):
        raise DeviceError(f"{path}: {field}: {why}. {_MEND}")
    return path


def refuse_uncommissioned(device: Device, description: Path) -> None:
    """Refuse a device with a safety model whose description has not been commissioned as it is.

    Raises
    ------
    InputError
        Where there is no report, a check failed, or the description has been changed since.
    """
    if device.safety is None:
        return
    path = report_file(description)
    report = _read_report(path) if path.exists() else {}
    known = report.get("description_sha256")
    if known != _hash(device):
        raise InputError(
            "changed since it was commissioned" if report else "not commissioned",
            file=description,
            remedy=_AGAIN,
        )
    for field, why in _failed(report):
        raise InputError(why, file=path, field=field, remedy=_MEND)


def _read_report(path: Path) -> dict[str, Any]:
    try:
        report = json.loads(path.read_bytes())
    except ValueError as error:
        raise InputError(f"is damaged ({error})", file=path, remedy=_AGAIN) from error
    if not isinstance(report, dict):
        raise InputError("is no report of a commissioning", file=path, remedy=_AGAIN)
    return report


def _failed(report: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield each field of a report that shows a device not to be as it must, and why."""
    if report.get("watchdog", TRIPPED) != TRIPPED:
        yield "watchdog", f"{report['watchdog']} when the guardian was killed while driving"
    for field, value in report.items():
        if isinstance(value, float) and not math.isfinite(value):
            yield field, f"could not be measured, it is {value}"
    gain = report.get("read_back_gain", 1.0)
    if not FOLLOWS[0] <= gain <= FOLLOWS[1]:
        yield "read_back_gain", f"the applied output reads {gain:.3g} times what was asked for"


def _hash(device: Device) -> str:
    """Return the hash of a description as it was read: its file may have been edited since."""
    return sha256(device.described.encode()).hexdigest()
