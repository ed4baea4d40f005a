"""The record of an acquisition that failed, as it would have been: by what its file says."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dea.acquisition.partial import Recovered, recover
from dea.acquisition.record import kept_record
from dea.acquisition.settings import AcquisitionSettings
from dea.errors import InputError
from dea.modbus import Device, device_described, read_device

if TYPE_CHECKING:
    import xarray as xr


class Rescued(NamedTuple):
    """A record, how many samples there were to be, and what the file says of the failure.

    ``settings`` are those of the acquisition, ``damaged`` counts the stretches of the file that
    cannot be read.
    """

    record: "xr.Dataset"
    device: Device
    settings: dict[str, Any]
    length: int
    damaged: int
    reasons: list[str]


def rescue(partial: Path, description: Path | None = None) -> Rescued:
    """Return the record that a partial file holds, in the units it was recorded with.

    Parameters
    ----------
    description
        That of the device. It is needed where the file holds none, as those of earlier versions.

    Raises
    ------
    InputError
        Where the file holds no samples, or the description is another than it was recorded with.
    """
    found = recover(partial)
    heading = next((note for note in found.notes if "device" in note), None)
    if heading is None or not found.samples.position.size:
        raise InputError(
            "holds no samples", file=partial, remedy="Nothing can be rescued: record it again"
        )
    device = _device(heading, partial, description)
    settings = heading.get("settings", {})  # a file of an earlier version may hold none
    record = kept_record(
        device, found.samples, heading["lead"], heading["length"],
        clock_tolerance=settings.get("clock_tolerance", AcquisitionSettings.clock_tolerance),
        armed_by=settings.get("armed_by", ""),
    )  # fmt: skip
    record.attrs["notes"] = _notes(found)
    reasons = [note["broken"] for note in found.notes if "broken" in note]
    return Rescued(record, device, settings, heading["length"], found.damaged, reasons)


def _device(heading: dict[str, Any], partial: Path, description: Path | None) -> Device:
    """Return the device as it was recorded, whatever its description says by now."""
    given = None if description is None else read_device(description)
    if given is not None and heading["device"] != given.name:
        raise InputError(
            f"was recorded from {heading['device']!r}, and the description is of {given.name!r}",
            file=partial,
            field="device",
            remedy="Give the description it was recorded with: --device",
        )
    if not (text := heading.get("description")):
        if given is None:
            raise InputError(
                "holds no description of its device",
                file=partial,
                remedy="Give the one it was recorded with: --device",
            )
        return given
    if given is not None and given.described != text:
        raise InputError(
            f"was recorded with another description than {description} holds now",
            file=partial,
            field="description",
            remedy="Leave --device away: the file holds the one it was recorded with",
        )
    return device_described(text, partial, virtual=heading["virtual"])


def _notes(found: Recovered) -> str:
    """Return the notes without the description, which the record holds by itself."""
    notes = [{key: note[key] for key in note.keys() - {"description"}} for note in found.notes]
    return json.dumps(notes, sort_keys=True)
