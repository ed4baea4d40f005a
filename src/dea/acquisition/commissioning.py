"""The first voltage on a device: a staircase to a few per cent, and what is learnt from it."""

import os
import signal
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dea.acquisition.acquire import acquire
from dea.acquisition.commissioned import DID_NOT_TRIP, TRIPPED, mend
from dea.acquisition.duty import duty_file, look
from dea.acquisition.flagged import flags_said
from dea.acquisition.latch import utc_now
from dea.acquisition.link_log import LinkLog
from dea.acquisition.panel import Panel
from dea.acquisition.poll import Poll
from dea.acquisition.retrying_link import BY_HAND, Link
from dea.acquisition.samples import DrivenSamples, Quality, asked_for
from dea.acquisition.settings import AcquisitionSettings
from dea.errors import DeviceError, InputError
from dea.modbus import Device, to_counts

if TYPE_CHECKING:
    import xarray as xr

STEPS = 5  # stairs
HOLD = 1.0  # s on each of them
SETTLED = 0.3  # share of a stair at its end that is taken as settled
WATCHDOG_MARGIN = 1.5  # s beyond the watchdog's time


def commission(
    device: Device, partial: Path, settings: AcquisitionSettings, share: float
) -> dict[str, Any]:
    """Drive a staircase to ``share`` of the limit farther from 0 V; return what it showed.

    Where the device has a watchdog, its guardian is then killed at the top, to see whether the
    device takes the output to zero by itself.

    Raises
    ------
    InputError, DeviceError
        As :func:`dea.acquisition.acquire`.
    """
    limits = device["output"].limits
    if limits is None:
        raise InputError(
            "no limits",
            file=device.source,
            field="registers.output.limits",
            remedy="Give the lowest and the highest voltage that film and amplifier bear",
        )
    farther = max(reversed(limits), key=abs)
    stairs = np.linspace(0.0, share * farther, STEPS + 1)[1:]
    hold = max(round(HOLD * device.sampling_rate), 10)
    polled = replace(settings, mode="polled", paced=True)
    together = _read_together(device)
    acquired = acquire(device, np.repeat(stairs, hold), partial, polled, first=True)
    report: dict[str, Any] = {"device": device.name, "time": utc_now()}
    report |= {"armed_by": settings.armed_by, "read_together": together}
    report |= {"highest": float(stairs[-1])} | _learnt(device, acquired.record, acquired.link, hold)
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


def _learnt(device: Device, record: "xr.Dataset", link: "xr.Dataset", hold: int) -> dict[str, Any]:
    """Return gain, offset, delay and noise of the read-back, noise of the sensor, round trips."""
    stairs = record.isel(time=asked_for(record.quality.values))
    settled = np.arange(stairs.sizes["time"]) % hold >= (1 - SETTLED) * hold
    settled &= stairs.quality.values == Quality.GOOD
    if not settled.any():
        raise DeviceError(f"{flags_said(record)}. {mend(device)}")
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
    top = int(to_counts(device["output"], volts[-1]))

    def kill(samples: DrivenSamples, _: LinkLog) -> None:
        if top not in samples.requested:
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
        acquire(device, volts, partial, settings, watch=kill, first=True)
    except _WatchedError:
        partial.unlink()
    if not found.get("latched"):
        return DID_NOT_TRIP
    acquire(device, volts[:1], partial, settings, reset=True, first=True)
    partial.unlink()
    return TRIPPED
