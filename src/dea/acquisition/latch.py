"""Trips of the safety model, kept on disk until somebody acknowledges them."""

import json
import os
import time
from pathlib import Path

from dea.acquisition.duty import duty_file
from dea.errors import InputError
from dea.modbus import Device


def latch(device: Device, reason: str) -> None:
    """Note a trip; nothing is driven on this output until it is acknowledged."""
    path = _file(device)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"device": device.name, "reason": reason, "time": _now()}))


def refuse_latched(device: Device) -> None:
    """Refuse to drive an output whose trip nobody has acknowledged.

    Raises
    ------
    InputError
        Naming the trip.
    """
    path = _file(device)
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
    path = _file(device)
    if not path.exists():
        return None
    trip = json.loads(path.read_text()) | {"acknowledged_by": person, "acknowledged": _now()}
    with path.with_suffix(".log").open("a") as log:
        log.write(json.dumps(trip) + "\n")
    path.unlink()
    return str(trip["reason"])


def _file(device: Device) -> Path:
    root = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state"
    return Path(root, "dea", f"{duty_file(device).name}.trip")


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
