"""One acquisition: from an excitation to a record, with the output at zero volts at the end."""

from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from dea.acquisition import buffered, polled
from dea.acquisition.endpoint_lock import endpoint_lock
from dea.acquisition.interrupts import Interruption
from dea.acquisition.panel import Panel
from dea.acquisition.partial import PartialFile, set_aside
from dea.acquisition.record import link_dataset, record_dataset
from dea.acquisition.retrying_link import Link, LinkLog, LinkSettings
from dea.acquisition.safety import SafeOutput
from dea.acquisition.samples import BrokenRecordError, Samples
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.voltage_plan import Plan, plan_sequence
from dea.errors import InputError
from dea.modbus import Device

Watcher = Callable[[Samples, LinkLog], None]


class Acquisition(NamedTuple):
    """The result of an acquisition: the record, and the log of the link as a dataset."""

    record: xr.Dataset
    link: xr.Dataset


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

    Samples are written to ``partial`` as they arrive. The file stays if the acquisition fails; the
    caller removes it once the record is written.

    Parameters
    ----------
    device
        What to drive, see :func:`dea.modbus.read_device`.
    excitation
        V before the amplifier, one per sample period, shape (samples,).
    partial
        File for the samples while it runs; one left by an earlier run is renamed.
    watch
        Called with every block of samples and the link's log.
    reset
        Whether a latched watchdog is reset first.

    Raises
    ------
    InputError
        Before any voltage: the excitation leaves the limits, or the device does not match its
        description, does not answer, is driven or owned by another master, or has tripped.
    BrokenRecordError
        Where samples were lost or not driven, and the settings do not restart.
    LinkError, ZeroNotVerifiedError
        Where the connection is lost, or the output cannot be read back as zero.
    ReadBackError
        Where the register of the applied output does not hold what is played.
    """
    settings = settings or AcquisitionSettings()
    plan = plan_sequence(device, excitation, settings.ramp_rate)
    timing = LinkSettings(settings.timeout, settings.retries, settings.reconnect_time)
    log = LinkLog()
    attempts = settings.restarts + 1 if settings.on_break == "restart" else 1
    with endpoint_lock(device):
        for attempt in range(attempts):
            link = Link(device, timing, log)
            try:
                samples = _attempt(link, plan, partial, settings, watch, reset or attempt > 0)
                break
            except BrokenRecordError:
                if attempt + 1 == attempts:
                    raise
                log.errors["restarted"] += 1
    return Acquisition(record_dataset(device, samples, plan.lead, plan.length), link_dataset(log))


def _attempt(
    link: Link,
    plan: Plan,
    partial: Path,
    settings: AcquisitionSettings,
    watch: Watcher | None,
    reset: bool,
) -> Samples:
    """Return everything measured while the plan was driven, zero verified before and after."""
    blocks = []
    interruption = Interruption()
    output = SafeOutput(link, ramp_rate=settings.ramp_rate, reset=reset)
    note = {"device": link.device.name, "lead": plan.lead, "length": plan.length}
    with interruption, output as panel:
        link.check = interruption.check
        driven = _drive(panel, plan.counts, settings)
        set_aside(partial)
        with PartialFile(partial, note | {"settings": asdict(settings)}) as file:
            try:
                for samples in driven:
                    file.samples(samples)
                    blocks.append(samples)
                    if watch is not None:
                        watch(samples, link.log)
                    interruption.check()
            except BrokenRecordError as error:
                file.samples(error.samples)
                file.note({"broken": str(error)})
                raise
            file.note({"complete": True})
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
    return buffered.play(panel, sequence, tolerance=settings.read_back_tolerance)
