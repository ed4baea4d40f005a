"""Frames of Modbus TCP, right ones and spoilt ones."""

import struct


def frame(pdu, transaction=7, unit=1, protocol=0, length=None):
    """Return a PDU behind its header; a ``length`` that is given may be wrong."""
    length = len(pdu) + 1 if length is None else length
    return struct.pack(">HHHB", transaction, protocol, length, unit) + pdu
