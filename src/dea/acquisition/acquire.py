"""One acquisition: excitation in, record out, and the film at zero volts whatever happens."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr

from dea.acquisition import buffered, polled
from dea.acquisition.link import Link, LinkLog, LinkSettings
from dea.acquisition.panel import Panel
from dea.acquisition.partial import PartialFile, set_aside
from dea.acquisition.record import link_dataset, record_dataset
from dea.acquisition.safety import SafeOutput, check_excitation, ended_by_signals, ramp
from dea.acquisition.samples import BrokenRecordError, Samples
from dea.errors import InputError
from dea.modbus import Device, to_counts

Watcher = Callable[[Samples, LinkLog], None]


@dataclass(frozen=True)
class AcquisitionSettings:
    """How to drive: see ``acquisition`` in config/config.yaml for the meaning and units."""

    mode: Literal["buffered", "polled"] = "buffered"
    ramp_rate: float = 1.0  # V/s
    on_break: Literal["stop", "restart"] = "stop"
    restarts: int = 2
    timeout: float = 2.0  # s
    retries: int = 5
    reconnect_time: float = 10.0  # s
    late_after: float = 5e-3  # s
    paced: bool = True

    @classmethod
    def from_mapping(cls, values: dict[str, Any]) -> "AcquisitionSettings":
        """Check settings read from a file; raises InputError for a misspelt key or bad value."""
        known = {f.name for f in fields(cls)}
        for key in values:
            if key not in known:
                raise InputError(
                    "unknown key", field=f"acquisition.{key}", remedy=f"Known: {sorted(known)}."
                )
        settings = cls(**values)
        for key, allowed in {
            "mode": ("buffered", "polled"),
            "on_break": ("stop", "restart"),
        }.items():
            if getattr(settings, key) not in allowed:
                raise InputError(
                    f"{getattr(settings, key)!r}", field=f"acquisition.{key}",
                    remedy=f"Use {' or '.join(allowed)}.",
                )  # fmt: skip
        for key in ("ramp_rate", "timeout", "reconnect_time", "late_after"):
            if not getattr(settings, key) > 0:
                raise InputError(
                    "not positive", field=f"acquisition.{key}", remedy="Use a positive number."
                )
        return settings


class Acquisition(NamedTuple):
    """What an acquisition brought home: the record and how the link fared."""

    record: xr.Dataset
    link: xr.Dataset


class Plan(NamedTuple):
    """Output counts from zero to zero: ``lead`` samples of ramp, ``length`` of excitation, ramp."""

    counts: np.ndarray
    lead: int
    length: int


def plan_sequence(device: Device, excitation: np.ndarray, ramp_rate: float) -> Plan:
    """Put ramps at ``ramp_rate`` V/s before and after an excitation in V.

    Raises
    ------
    InputError
        Where the excitation leaves the device's limits, or is empty.
    """
    volts = np.asarray(excitation, float)
    if volts.ndim != 1 or not volts.size:
        raise InputError("the excitation holds no samples", remedy="Give at least one voltage.")
    counts = check_excitation(device, volts)
    lead = ramp(device, 0.0, float(volts[0]), ramp_rate)
    tail = ramp(device, float(volts[-1]), 0.0, ramp_rate)
    zero = to_counts(device["output"], np.zeros(1))
    return Plan(np.concatenate([lead, counts, tail, zero]), lead.size, counts.size)


def acquire(
    device: Device,
    excitation: np.ndarray,
    partial: Path,
    settings: AcquisitionSettings | None = None,
    *,
    watch: Watcher | None = None,
    reset: bool = False,
) -> Acquisition:
    """Drive ``device`` with ``excitation`` and record what it applied and measured.

    Samples reach ``partial`` on the disk as they come; it is left there where the acquisition
    does not end well, and removed by the caller once the record is written.

    Parameters
    ----------
    device
        What to drive, see :func:`dea.modbus.read_device`.
    excitation
        V before the amplifier, one a sample period, shape (samples,).
    partial
        File for the samples while it runs; one that an earlier run left is set aside.
    watch
        Called with every block of samples and the link's log.
    reset
        Whether a latched watchdog is reset first.

    Raises
    ------
    InputError
        Before any voltage: excitation outside the limits, a device that does not match its
        description, does not answer, is driven or owned by another, or has tripped.
    BrokenRecordError
        Where samples were lost or undriven and the settings do not restart.
    LinkError, ZeroNotVerifiedError
        Where the device went away.
    """
    settings = settings or AcquisitionSettings()
    plan = plan_sequence(device, excitation, settings.ramp_rate)
    patience = LinkSettings(settings.timeout, settings.retries, settings.reconnect_time)
    log = LinkLog()
    attempts = settings.restarts + 1 if settings.on_break == "restart" else 1
    for attempt in range(attempts):
        link = Link(device, patience, log)
        set_aside(partial)
        note = {"device": device.name, "lead": plan.lead, "length": plan.length}
        file = PartialFile(partial, note | {"settings": asdict(settings)})
        try:
            samples = _run(link, plan.counts, settings, file, watch, reset or attempt > 0)
        except BrokenRecordError as error:
            file.note({"broken": str(error)})
            if attempt + 1 == attempts:
                raise
            log.errors["restarted"] += 1
        else:
            file.note({"complete": True})
            return Acquisition(
                record_dataset(device, samples, plan.lead, plan.length), link_dataset(log)
            )
        finally:
            file.close()
    raise AssertionError("unreachable: the last attempt returns or raises")


def _run(
    link: Link,
    sequence: np.ndarray,
    settings: AcquisitionSettings,
    file: PartialFile,
    watch: Watcher | None,
    reset: bool,
) -> Samples:
    blocks = []
    with ended_by_signals(), SafeOutput(
        link, ramp_rate=settings.ramp_rate, reset=reset
    ) as panel:  # fmt: skip
        for samples in _drive(panel, sequence, settings):
            file.samples(samples)
            blocks.append(samples)
            if watch is not None:
                watch(samples, link.log)
    return Samples(*(np.concatenate(columns) for columns in zip(*blocks, strict=True)))


def _drive(panel: Panel, sequence: np.ndarray, settings: AcquisitionSettings) -> Iterator[Samples]:
    if settings.mode == "polled":
        return polled.drive(panel, sequence, late_after=settings.late_after, paced=settings.paced)
    if "block_samples" not in panel:
        raise InputError(
            "the device has no block registers to be driven buffered",
            file=panel.device.source,
            field="registers.block_samples",
            remedy="Set acquisition.mode to polled, or describe them.",
        )
    return buffered.play(panel, sequence)
