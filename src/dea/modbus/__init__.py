"""What bench and acquisition share of Modbus: device descriptions and register codecs."""

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
from dea.modbus.description import parse_device, read_device
from dea.modbus.device import Device, Register, Serial, Tls
from dea.modbus.pdu import ReadWriteRequest, ReadWriteResponse, RegistersResponse
from dea.modbus.window import Window

__all__ = [
    "Device",
    "ReadWriteRequest",
    "ReadWriteResponse",
    "Register",
    "RegistersResponse",
    "Serial",
    "Tls",
    "Value",
    "Window",
    "checksum",
    "decode",
    "encode",
    "limit_counts",
    "parse_device",
    "read_device",
    "representable",
    "to_counts",
    "to_physical",
]
