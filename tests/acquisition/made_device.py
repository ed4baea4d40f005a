"""Descriptions of devices for tests."""

from pathlib import Path

from dea.modbus import parse_device


def described(registers, **changes):
    """Return a device with these registers, and with other keys of its description changed."""
    content = {
        "name": "module",
        "endpoint": {"host": "127.0.0.1", "port": 502},
        "unit_id": 1,
        "sampling_rate": 50,
        "quarantine": 0,
        "registers": registers,
    }
    return parse_device(content | changes, source=Path("module.yaml"))


STEP = 0.001  # V, one count
OUTPUT = {"address": 0, "type": "int16", "access": "write", "scale": STEP, "unit": "V"}
ECHO = {"address": 1, "type": "int16", "scale": STEP, "unit": "V"}


def module(limits=(-10, 4), **registers):
    """Return a module whose output counts millivolts, with these registers besides."""
    return described({"output": OUTPUT | {"limits": list(limits)}} | registers, sampling_rate=100)
