"""Commands as a message tells a person to type them."""

from dea.modbus import Device


def typed(words: str, device: Device) -> str:
    """Return a command line, such as ``zero``, for the device that a message is about.

    The description is named, and host and port where they are not the described ones: without them
    the command would mean another device.
    """
    place = f" --host {device.host} --port {device.port}" if device.elsewhere else ""
    return f"python -m dea.acquisition {words} --device {device.source or 'FILE'}{place}"
