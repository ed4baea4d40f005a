"""Device descriptions and register codecs, shared by bench and acquisition."""

from dea.modbus.block import BLOCK, REPLY, block_window, reply_window
from dea.modbus.codec import (
    Value,
    checksum,
    decode,
    encode,
    limit_counts,
    representable,
    to_counts,
    to_physical,
)
from dea.modbus.codes import Command, DeviceState, Origin, Refusal
from dea.modbus.description import device_described, parse_device, read_device
from dea.modbus.device import Device, Register, Serial, Tls
from dea.modbus.pdu import ReadWriteRequest, ReadWriteResponse, RegistersResponse
from dea.modbus.window import Window, adjoining

__all__ = [
    "BLOCK",
    "REPLY",
    "Command",
    "Device",
    "DeviceState",
    "Origin",
    "ReadWriteRequest",
    "ReadWriteResponse",
    "Refusal",
    "Register",
    "RegistersResponse",
    "Serial",
    "Tls",
    "Value",
    "Window",
    "adjoining",
    "block_window",
    "checksum",
    "decode",
    "device_described",
    "encode",
    "limit_counts",
    "parse_device",
    "read_device",
    "reply_window",
    "representable",
    "to_counts",
    "to_physical",
]
