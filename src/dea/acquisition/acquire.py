"""One acquisition: from an excitation to a record, with the output at zero volts at the end."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from functools import partial as partial_function
from pathlib import Path
from secrets import randbits
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dea.acquisition.closed_loop import ClosedLoop
from dea.acquisition.commissioned import refuse_uncommissioned
from dea.acquisition.disk import refuse_without_room
from dea.acquisition.drive_job import DriveJob
from dea.acquisition.interrupts import Interruption
from dea.acquisition.latch import latch_file, refuse_latched
from dea.acquisition.link_log import LinkLog
from dea.acquisition.partial import PartialFile, refuse_in_use, set_aside
from dea.acquisition.record import kept_record, link_dataset
from dea.acquisition.recorder import Recorder
from dea.acquisition.samples import BrokenRecordError, DrivenSamples
from dea.acquisition.settings import AcquisitionSettings
from dea.acquisition.transport import known
from dea.acquisition.voltage_plan import OutputPlan, plan_sequence
from dea.configuration.safety import refuse_unkept_heartbeat
from dea.errors import InputError
from dea.modbus import Device

if TYPE_CHECKING:
    import xarray as xr

Watcher = Callable[[DrivenSamples, LinkLog], None]


class AcquiredRecord(NamedTuple):
    """The result of an acquisition: the record, and the log of the link as a dataset."""

    record: "xr.Dataset"
    link: "xr.Dataset"


def acquire(
    device: Device,
    excitation: np.ndarray | ClosedLoop,
    partial: Path,
    settings: AcquisitionSettings | None = None,
    *,
    watch: Watcher | None = None,
    reset: bool = False,
    first: bool = False,
) -> AcquiredRecord:
    """Drive ``device`` with ``excitation`` and record what it applied and measured.

    Samples are written to ``partial`` as they arrive. The file stays if the acquisition fails; the
    caller removes it once the record is written.

    Parameters
    ----------
    device
        What to drive, see :func:`dea.modbus.read_device`.
    excitation
        V before the amplifier, one per sample period, shape (samples,); or a controller that gives
        them one by one.
    partial
        File for the samples while it runs; one left by an earlier run is renamed, and one to which
        another run still writes is refused.
    settings
        Mode, ramp, waiting times, restarts and who arms the device; the defaults if ``None``.
    watch
        Called with every block of samples and the link's log.
    reset
        Whether a latched watchdog is reset first.
    first
        Whether this is the first voltage, which commissions the device: no report is asked for.

    Raises
    ------
    InputError
        Before any voltage: the excitation leaves the limits, a controller is to drive buffered, the
        disk cannot take the record, or the device does not match its description, does not answer,
        is driven or owned by another master, or has tripped; or it has a safety model, and nobody
        has armed it, or it has not been commissioned as its file describes it.
    BrokenRecordError
        Where samples were lost or not driven, and the settings do not restart.
    TripError
        Where the safety model does not hold.
    StoppedError, GuardianLostError
        Where the guardian was asked to end, or this program or its disk was too far behind; where
        it was killed or gave no sign of life.
    ControllerError
        Where a controller asks for a voltage that is not allowed, or gives none in time; what it
        raises itself is raised.
    LinkError, ZeroNotVerifiedError
        Where the connection is lost, or the output cannot be read back as zero.
    ReadBackError
        Where the register of the applied output does not hold what is played.
    """
    settings = settings or AcquisitionSettings()
    loop = excitation if isinstance(excitation, ClosedLoop) else None
    if loop is None:
        plan = plan_sequence(device, np.asarray(excitation), settings.ramp_rate)
        in_loop: dict[str, Any] = {}
    else:
        _refuse_unless_polled(settings)
        plan = loop.plan(device, settings.ramp_rate)
        in_loop = {"closed_loop_samples": plan.length, "longest_step": loop.step(device)}
    _refuse_unbuffered(device, settings)
    refuse_unkept_heartbeat(device.safety, settings.mode, device.sampling_rate, device.source)
    refuse_unarmed(device, settings.armed_by)
    # Once: what is driven is then what was checked, whatever becomes of its name meanwhile.
    device = known(device)
    if not first:
        refuse_uncommissioned(device)
    refuse_latched(device)
    refuse_in_use(partial)
    refuse_without_room(partial, max(plan.counts.size, plan.lead + plan.length))
    log = LinkLog()
    job = DriveJob(
        device, settings, plan.counts, reset, _new_token(), latch_file(device), log.started,
        **in_loop,
    )  # fmt: skip
    samples = _driven(job, log, lambda each: _attempt(each, plan, partial, watch, log, loop))
    record = kept_record(
        device, samples, plan.lead, plan.length,
        clock_tolerance=settings.clock_tolerance, armed_by=settings.armed_by,
    )  # fmt: skip
    link = link_dataset(log, samples)
    return AcquiredRecord(record, link.assign_attrs(device_description=device.described))


def _new_token() -> int:
    return randbits(31) + 1


def _driven(
    job: DriveJob, log: LinkLog, attempt: Callable[[DriveJob], DrivenSamples]
) -> DrivenSamples:
    """Return everything measured in the first attempt that broke off nowhere."""
    broken = None
    for _ in range(job.settings.restarts + 1 if job.settings.on_break == "restart" else 1):
        try:
            return attempt(job)
        except BrokenRecordError as error:
            broken = error
            log.errors["restarted"] += 1
        except InputError as refusal:
            if broken is None:
                raise
            raise broken from refusal
        # Only the first attempt clears the latch of the device: one set since then is a new trip.
        job = job._replace(reset=False, token=_new_token())
    assert broken is not None
    raise broken


def _attempt(
    job: DriveJob,
    plan: OutputPlan,
    partial: Path,
    watch: Watcher | None,
    log: LinkLog,
    loop: ClosedLoop | None,
) -> DrivenSamples:
    """Return everything measured while a guardian drove the plan, zero shown before and after."""
    blocks: list[DrivenSamples] = []
    interruption = Interruption()
    note = {
        "device": job.device.name, "lead": plan.lead, "length": plan.length,
        "description": job.device.described, "virtual": job.device.virtual,
    }  # fmt: skip
    with (
        _telling_where(partial, blocks),
        interruption,
        Recorder(job, log, interruption.check) as recorder,
    ):
        recorder.await_ready()
        set_aside(partial)
        with PartialFile(partial, note | {"settings": asdict(job.settings)}) as file:
            recorder.kept = file.kept
            if loop is not None:
                recorder.answer = partial_function(loop.answer, job.device)
            try:
                for samples in recorder.samples():
                    file.samples(samples)
                    blocks.append(samples)
                    if watch is not None:
                        watch(samples, log)
            except BaseException as error:
                with suppress(OSError):  # of the disk: the error says so
                    if isinstance(error, BrokenRecordError):
                        file.samples(error.samples)
                    file.note({"broken": str(error)})
                recorder.end(error, file.samples)
                raise
            file.note({"complete": True, "zero": recorder.evidence})
    return DrivenSamples(*(np.concatenate(columns) for columns in zip(*blocks, strict=True)))


@contextmanager
def _telling_where(partial: Path, blocks: list[DrivenSamples]) -> Iterator[None]:
    """Add where the samples are, if there are any, to what costs the record."""
    try:
        yield
    except BaseException as error:
        if blocks:
            error.add_note(f"What the disk has taken of it is in {partial}: recover it.")
        raise


def refuse_unarmed(device: Device, armed_by: str) -> None:
    """Refuse a device with a safety model that nobody has armed by name.

    A virtual one has no high voltage; a name given for its sake would arm the real one as well.

    Raises
    ------
    InputError
        Naming the ways to arm it.
    """
    if device.safety is not None and not device.virtual and not armed_by.strip():
        raise InputError(
            "nobody has armed the high voltage",
            file=device.source,
            field="safety",
            remedy="Check the setup, then arm it in your name: OPERATOR=NAME with make, --arm NAME"
            " with drive and commission, or acquisition.armed_by in the configuration",
        )


def _refuse_unless_polled(settings: AcquisitionSettings) -> None:
    if settings.mode != "polled" or settings.on_break != "stop":
        raise InputError(
            f"a controller is to drive with mode {settings.mode}, on_break {settings.on_break}",
            field="acquisition.mode, on_break",
            remedy="Set mode to polled and on_break to stop: a controller cannot begin again.",
        )


def _refuse_unbuffered(device: Device, settings: AcquisitionSettings) -> None:
    if settings.mode == "buffered" and "block_samples" not in device:
        raise InputError(
            "the device has no block registers to be driven buffered",
            file=device.source,
            field="registers.block_samples",
            remedy="Set acquisition.mode to polled, or describe them.",
        )
