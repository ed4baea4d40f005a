"""The check, before any voltage, that the device that answers is the one described."""

from collections.abc import Iterator
from contextlib import contextmanager

from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import DeviceRefusedError, Link, LinkError
from dea.errors import InputError
from dea.modbus import Device

RANGE_TOLERANCE = 1e-5  # of the range; float32 registers hold seven digits


def open_described(link: Link) -> None:
    """Connect to a device.

    Raises
    ------
    InputError
        Where it does not answer, naming the file of its description.
    """
    try:
        link.open()
    except LinkError as error:
        if link.device.serial is not None:
            field, remedy = "serial.port", "Correct it, plug the line in, or end the other program."
        else:
            field, remedy = "endpoint", "Correct host and port, or switch the device on."
        raise InputError(str(error), file=link.device.source, field=field, remedy=remedy) from error


@contextmanager
def answering_as_described(device: Device, place: str = "registers") -> Iterator[None]:
    """Within the block, blame the description for what the device refuses or leaves unanswered.

    Raises
    ------
    InputError
        Naming the file of the description, and the ``place`` in it.
    """
    try:
        yield
    except (LinkError, DeviceRefusedError) as error:
        raise InputError(
            f"the device does not answer as described: {error}",
            file=device.source, field=f"unit_id, {place}",
            remedy="Correct the unit id or the register map.",
        ) from error  # fmt: skip


def verify_device(panel: Panel) -> None:
    """Read back identity, ranges, sampling rate and limits, and compare them with the description.

    Raises
    ------
    InputError
        Naming the register that does not match.
    """
    device = panel.device
    for name, register in device.registers.items():
        if register.expect is not None:
            _compare(device, name, panel.physical(name), register.expect)
        if register.range is not None:
            for end, expected in zip(("low", "high"), register.range, strict=True):
                if f"{name}_range_{end}" in panel:
                    found = panel.number(f"{name}_range_{end}")
                    span = register.range[1] - register.range[0]
                    _compare(device, f"{name}_range_{end}", found, expected, span)
    if "device_rate" in panel:
        _compare(device, "device_rate", panel.number("device_rate"), device.sampling_rate)
    _verify_limits(panel)


def _verify_limits(panel: Panel) -> None:
    """Refuse a device that clamps inside the described limits, beyond one count of rounding."""
    output = panel.device["output"]
    if output.limits is None:
        return
    for end, limit, sign in zip(("low", "high"), output.limits, (1, -1), strict=True):
        if f"output_{end}_limit" in panel:
            found = panel.number(f"output_{end}_limit")
            if sign * (found - limit) > abs(output.scale):
                raise InputError(
                    f"the device clamps at {found:g} {output.unit}, inside the limit {limit:g}",
                    file=panel.device.source,
                    field="registers.output.limits",
                    remedy="Narrow the limits, or widen the device's.",
                )


def _compare(
    device: Device, name: str, found: object, expected: object, span: float | None = None
) -> None:
    if isinstance(found, float) and isinstance(expected, int | float):
        same = abs(found - expected) <= RANGE_TOLERANCE * (span or abs(expected))
    else:
        same = found == expected
    if not same:
        raise InputError(
            f"the device says {found!r}, the description {expected!r}",
            file=device.source,
            field=f"registers.{name}",
            remedy="Point the endpoint at the device described, or correct the register map.",
        )
