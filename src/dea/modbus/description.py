"""A device from the YAML file that describes it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dea.configuration import device as described
from dea.configuration.files import parse_yaml, read_text_and_yaml
from dea.configuration.problems import validated
from dea.configuration.register import Register as DescribedRegister
from dea.modbus.device import Device, Register, Serial, Tls


def read_device(path: str | Path) -> Device:
    """Read and check a device description.

    Raises
    ------
    InputError
        Naming the file, the field and the remedy: unreadable YAML, a misspelt key, an unknown
        type, overlapping registers, crossing limits, a unit id or address out of range.
    """
    path = Path(path)
    text, content = read_text_and_yaml(
        path, what="the device description", example="one of config/devices/*.yaml"
    )
    return replace(parse_device(content, source=path), described=text)


def device_described(text: str, source: Path, *, virtual: bool) -> Device:
    """Return the device of a description that a file holds; raises as :func:`read_device`."""
    device = parse_device(parse_yaml(text, source), source=source)
    return replace(device, described=text, virtual=virtual)


def parse_device(content: Any, source: Path | None = None) -> Device:
    """Check a description given as the mapping its YAML holds; see :func:`read_device`."""
    description = validated(described.DeviceDescription, content, source)
    endpoint = description.endpoint if description.framing != "serial" else None
    serial = description.serial if description.framing == "serial" else None
    return Device(
        name=description.name,
        unit_id=description.unit_id,
        sampling_rate=float(description.sampling_rate),
        registers={
            name: _register(name, register, description)
            for name, register in description.registers.items()
        },
        host=endpoint.host if endpoint else "",
        port=endpoint.port if endpoint else 0,
        framing=description.framing,
        tls=Tls(**description.tls.model_dump()),
        serial=Serial(**serial.model_dump()) if serial else None,
        read_write_multiple=description.read_write_multiple,
        quarantine=_quarantine(description),
        safety=description.safety,
        source=source,
    )


def _register(
    name: str, register: DescribedRegister, description: described.DeviceDescription
) -> Register:
    scale, offset = _scaling(register)
    return Register(
        name=name,
        address=register.address,
        type=register.type,
        table=register.table,
        count=register.count,
        word_order=register.word_order or description.word_order,
        byte_order=register.byte_order or description.byte_order,
        scale=scale,
        offset=offset,
        unit=register.unit,
        access=register.access,
        range=_pair(register.range),
        limits=_pair(register.limits),
        expect=register.expect,
        tolerance=float(register.tolerance),
    )


def _quarantine(description: described.DeviceDescription) -> float:
    """As given; none where the device refuses a late write, since nobody owns it any more."""
    if description.quarantine is not None:
        return float(description.quarantine)
    return 0.0 if "claim" in description.registers else described.LONGEST_LATE_WRITE


def _scaling(register: DescribedRegister) -> tuple[float, float]:
    """Scale and offset: as given, or such that the range spreads over all counts of the type."""
    if register.range is None:
        scale = 1.0 if register.scale is None else float(register.scale)
        return scale, 0.0 if register.offset is None else float(register.offset)
    low, high = map(float, register.range)
    counts = np.iinfo(register.type)
    scale = (high - low) / (counts.max - counts.min)
    return scale, low - scale * counts.min


def _pair(interval: list[float] | None) -> tuple[float, float] | None:
    return None if interval is None else (float(interval[0]), float(interval[1]))
