"""Commands as a message tells a person to type them."""

from dea.modbus import Device


def typed(words: str, device: Device) -> str:
    """Return a command line, such as ``zero``, for the device that a message is about.

    Its description is named, since another device may be meant without it.
    """
    return f"python -m dea.acquisition {words} --device {device.source or 'FILE'}"
