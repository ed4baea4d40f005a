"""The first voltage on a device: a staircase to a few per cent, and what is learnt from it."""

import json
import os
import signal
import time
from collections.abc import Mapping
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dea.acquisition.acquire import acquire
from dea.acquisition.duty import duty_file, look
from dea.acquisition.link_log import LinkLog, LinkSettings
from dea.acquisition.panel import Panel
from dea.acquisition.poll import Poll
from dea.acquisition.retrying_link import Link
from dea.acquisition.samples import Samples
from dea.acquisition.settings import AcquisitionSettings
from dea.errors import DeviceError, InputError
from dea.modbus import Device, to_physical

STEPS = 5  # stairs
HOLD = 1.0  # s on each of them
SETTLED = 0.3  # share of a stair at its end that is taken as settled
WATCHDOG_MARGIN = 1.5  # s beyond the watchdog's time


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
    partial.unlink()
    report: dict[str, Any] = {"device": device.name, "time": _now()}
    report |= {"armed_by": settings.armed_by, "read_together": together}
    report |= {"highest": float(stairs[-1])} | _learnt(acquired.record, acquired.link, hold)
    if "watchdog_time" in device and "watchdog_latched" in device:
        report["watchdog"] = _trip_watchdog(device, np.repeat(stairs, hold), partial, polled)
    return report


def _read_together(device: Device) -> list[list[str]]:
    """Return the names of registers by the requests that a sample takes; applies no voltage."""
    link = Link(device, LinkSettings(retries=1, reconnect_time=2.0))
    try:
        poll = Poll(Panel(link))
        poll.learn()
    finally:
        link.close()
    return [[register.name for register in window.registers] for window in poll.windows]


def _learnt(record: xr.Dataset, link: xr.Dataset, hold: int) -> dict[str, Any]:
    """Return gain, offset, delay and noise of the read-back, noise of the sensor, round trips."""
    settled = np.arange(record.sizes["time"]) % hold >= (1 - SETTLED) * hold
    settled &= record.quality.values == 0
    asked = record.voltage_requested.values[settled]
    applied, displacement = record.voltage.values[settled], record.displacement.values[settled]
    gain, offset = np.polyfit(asked, applied, 1)
    trips = link.receive_time.values - link.send_time.values
    return {
        "read_back_gain": float(gain),
        "read_back_offset": float(offset),
        "read_back_delay": _delay(record, link, hold),
        "read_back_noise": _noise(asked, applied),
        "displacement_noise": _noise(asked, displacement),
        "round_trip_median": float(np.median(trips)),
        "round_trip_longest": float(trips.max()),
        "late_samples": int(np.count_nonzero(record.quality.values)),
    }


def _delay(record: xr.Dataset, link: xr.Dataset, hold: int) -> float:
    """Return how long after a step is written the read-back shows it, s; NaN where never.

    The mean of all steps counts, so that the noise of one does not, and the half of it is waited
    for. Resolved to a sampling interval.
    """
    times = link.set_index(sample="device_index").sel(sample=record.device_index.values)
    since = (times.read_time.values.reshape(-1, hold) - times.write_time.values[::hold, None])[1:]
    asked = record.voltage_requested.values[::hold]
    applied = record.voltage.values.reshape(-1, hold)
    before = np.nanmean(applied[:-1, -round(SETTLED * hold) :], axis=1)
    steps = (applied[1:] - before[:, None]) / np.diff(asked)[:, None]
    there = np.isfinite(steps + since)  # a busy host leaves samples out
    if not there.any(axis=0).all():
        return np.nan
    response = np.mean(steps, axis=0, where=there)
    shown = np.flatnonzero(response >= 0.5 * response[-round(SETTLED * hold) :].mean())[0]
    return float(np.median(since[there[:, shown], shown]))


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

    def kill(samples: Samples, _: LinkLog) -> None:
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
        return "did not trip"
    acquire(device, volts[:1], partial, settings, reset=True)
    partial.unlink()
    return "tripped"


def report_file(description: Path) -> Path:
    """Return where the report on a device description is kept."""
    return description.with_suffix(".commissioned.json")


def write_report(description: Path, report: Mapping[str, Any]) -> Path:
    """Write the report beside the description, with the description's hash."""
    path = report_file(description)
    content = {**report, "description_sha256": _hash(description)}
    path.write_text(json.dumps(content, indent=2, sort_keys=True) + "\n")
    return path


def refuse_uncommissioned(device: Device, description: Path) -> None:
    """Refuse a device with a safety model whose description has not been commissioned as it is.

    Raises
    ------
    InputError
        Where there is no report, or the description has been changed since.
    """
    if device.safety is None:
        return
    path = report_file(description)
    known = json.loads(path.read_text())["description_sha256"] if path.exists() else None
    if known != _hash(description):
        raise InputError(
            "not commissioned" if known is None else "changed since it was commissioned",
            file=description,
            remedy="python -m dea.acquisition commission --arm NAME",
        )


def _hash(description: Path) -> str:
    return sha256(description.read_bytes()).hexdigest()


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
