"""Trips of the safety model, kept on disk until somebody acknowledges them."""

import json
import os
import re
import time
from pathlib import Path

from dea.errors import InputError
from dea.modbus import Device


def latch(path: Path, device: str, reason: str) -> None:
    """Note a trip at :func:`latch_file`; its output is not driven until it is acknowledged."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"device": device, "reason": reason, "time": _now()}))


def refuse_latched(device: Device) -> None:
    """Refuse to drive an output whose trip nobody has acknowledged.

    Raises
    ------
    InputError
        Naming the trip.
    """
    path = latch_file(device)
    if path.exists():
        trip = json.loads(path.read_text())
        raise InputError(
            f"tripped at {trip['time']}: {trip['reason']}",
            file=device.source,
            field="safety",
            remedy="Find out why, then: python -m dea.acquisition acknowledge --by NAME.",
        )


def acknowledge(device: Device, person: str) -> str | None:
    """Clear a trip; return its reason, or None where there is none. What was is kept beside it."""
    path = latch_file(device)
    if not path.exists():
        return None
    trip = json.loads(path.read_text()) | {"acknowledged_by": person, "acknowledged": _now()}
    with path.with_suffix(".log").open("a") as log:
        log.write(json.dumps(trip) + "\n")
    path.unlink()
    return str(trip["reason"])


def latch_file(device: Device) -> Path:
    """Return where a trip of an output is kept."""
    root = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state"
    where = device.serial.port if device.serial else f"{device.host}_{device.port}"
    name = f"{where}_{device.unit_id}_{device['output'].address}"
    return Path(root, "dea", f"{re.sub('[^A-Za-z0-9.-]+', '_', name)}.trip")


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
