"""The report of a commissioning, and what may be driven by it."""

import json
import math
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from dea.acquisition.command_line import typed
from dea.acquisition.shared_file import endpoint
from dea.atomic_file import atomic
from dea.errors import DeviceError, InputError
from dea.modbus import Device

TRIPPED, DID_NOT_TRIP = "tripped", "did not trip"
# Gains of a read-back that follows the output; noise makes that of a low staircase uncertain.
FOLLOWS = 0.5, 2.0


def mend(device: Device) -> str:
    """Return what to do where a check has failed."""
    return f"Mend the device or its description, then: {_again(device)}"


def _again(device: Device) -> str:
    return typed("commission --arm YOUR.NAME", device)


def report_file(description: Path) -> Path:
    """Return where the report on a device description is kept."""
    return description.with_suffix(".commissioned.json")


def write_report(device: Device, report: Mapping[str, Any]) -> Path:
    """Write the report on a device beside the file that describes it; return where.

    It holds the endpoint and the description's hash, too.

    Raises
    ------
    DeviceError
        Where a check has failed; the report is written all the same.
    """
    assert device.source is not None
    path = report_file(device.source)
    content = {**report, "description_sha256": _hash(device), "endpoint": endpoint(device)}
    with atomic(path) as partial:
        partial.write_text(json.dumps(content, indent=2, sort_keys=True) + "\n")
    for field, why in _failed(report):
        raise DeviceError(f"{path}: {field}: {why}. {mend(device)}")
    return path


def refuse_uncommissioned(device: Device) -> None:
    """Refuse a device with a safety model that has not been commissioned as it is, where it is.

    One that no file describes has no place for a report, and a virtual one, which is served anew
    for each record, no place of its own: neither is asked for it.

    Raises
    ------
    InputError
        Where there is no report, a check failed, the description has been changed since, or the
        report is of a device at another endpoint or unit.
    """
    if device.safety is None or device.source is None or device.virtual:
        return
    path = report_file(device.source)
    report = _read_report(path, _again(device)) if path.exists() else {}
    if report.get("description_sha256") != _hash(device):
        raise InputError(
            "changed since it was commissioned" if report else "not commissioned",
            file=device.source,
            remedy=_again(device),
        )
    if (commissioned := report.get("endpoint", "an unknown place")) != endpoint(device):
        raise InputError(
            f"the device that was commissioned is at {commissioned}, and this one at "
            f"{endpoint(device)}",
            file=path,
            field="endpoint",
            remedy=_again(device),
        )
    for field, why in _failed(report):
        raise InputError(why, file=path, field=field, remedy=mend(device))


def _read_report(path: Path, remedy: str) -> dict[str, Any]:
    try:
        report = json.loads(path.read_bytes())
    except ValueError as error:
        raise InputError(f"is damaged ({error})", file=path, remedy=remedy) from error
    if not isinstance(report, dict):
        raise InputError("is no report of a commissioning", file=path, remedy=remedy)
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
