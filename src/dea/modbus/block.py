"""The registers of the block protocol: a block of samples to play, and a run of measured ones."""

from dea.modbus.device import Device
from dea.modbus.window import Window

BLOCK = ("block_crc", "block_sequence", "block_read_index", "block_count", "block_samples")
REPLY = (
    "reply_crc",
    "reply_sequence",
    "reply_index",
    "reply_position",
    "reply_next",
    "reply_count",
    "reply_origin",
    "reply_state",
    "reply_fifo",
    "reply_samples",
)


def block_window(device: Device) -> Window:
    """Return the registers of a block that is sent, sealed by its checksum.

    Raises
    ------
    InputError
        Where the device does not describe one of them.
    """
    return Window((device[name] for name in BLOCK), device["block_crc"])


def reply_window(device: Device) -> Window:
    """Return the registers of the reply to a block, sealed by its checksum.

    Raises
    ------
    InputError
        Where the device does not describe one of them.
    """
    return Window((device[name] for name in REPLY), device["reply_crc"])
