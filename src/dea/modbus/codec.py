"""Values to 16-bit registers and back, in every word and byte order."""

import struct
import zlib
from collections.abc import Sequence

import numpy as np

from dea.errors import InputError
from dea.modbus.device import Device, Register

_FORMATS = {
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}
Value = int | float | str | list[int] | list[float]


def encode(register: Register, value: Value) -> list[int]:
    """Return ``register.size`` words that hold ``value`` (raw, before scale and offset).

    ``word_order`` little puts the least significant word first; ``byte_order`` little swaps the
    two bytes within each word.

    Raises
    ------
    ValueError
        Where the value does not fit the register's type or count.
    """
    if register.type == "string":
        if not isinstance(value, str):
            raise ValueError(f"{register.name} holds text, not {value!r}")
        data = value.encode("ascii")
        if len(data) > 2 * register.count:
            raise ValueError(f"{value!r} is longer than the {2 * register.count} characters held")
        return _ordered(register, _words(data.ljust(2 * register.count, b"\0")))
    if register.type == "bool":
        if value not in (0, 1):
            raise ValueError(f"{register.name} is 0 or 1, not {value!r}")
        return [int(value)]
    values = value if isinstance(value, list) else [value]
    if len(values) != register.count:
        raise ValueError(f"{register.name} holds {register.count} values, not {len(values)}")
    try:
        data = struct.pack(f">{register.count}{_FORMATS[register.type]}", *values)
    except (struct.error, OverflowError) as error:
        raise ValueError(f"{value!r} does not fit {register.name} ({register.type})") from error
    return _ordered(register, _words(data))


def decode(register: Register, words: Sequence[int]) -> Value:
    """Raw value (list for an array) that the registers hold; inverse of :func:`encode`."""
    if register.type == "uint16" and register.byte_order == "big" and len(words) == 1:
        return words[0]  # the fast path of every polled sample
    if len(words) != register.size:
        raise ValueError(f"{register.name} needs {register.size} registers, not {len(words)}")
    if register.type == "bool":
        return int(words[0])
    data = struct.pack(f">{len(words)}H", *_ordered(register, words))
    if register.type == "string":
        return data.rstrip(b"\0").decode("ascii", errors="replace")
    values = list(struct.unpack(f">{register.count}{_FORMATS[register.type]}", data))
    return values if register.count > 1 else values[0]


def _words(data: bytes) -> tuple[int, ...]:
    return struct.unpack(f">{len(data) // 2}H", data)


def _ordered(register: Register, words: Sequence[int]) -> list[int]:
    """Convert between the wire's order and big-endian, in either direction."""
    ordered = list(words)
    if register.byte_order == "little":
        ordered = [(word >> 8) | (word & 0xFF) << 8 for word in ordered]
    if register.word_order == "little" and register.type != "string":
        width = register.size // register.count
        ordered = [
            ordered[place - within]
            for place in range(width - 1, len(ordered), width)
            for within in range(width)
        ]
    return ordered


def to_physical(register: Register, counts: np.ndarray | float) -> np.ndarray:
    """Return ``offset + scale * counts`` in ``register.unit``, in the shape of ``counts``."""
    return register.offset + register.scale * np.asarray(counts, dtype=float)


def to_counts(register: Register, values: np.ndarray | float) -> np.ndarray:
    """Nearest integer counts of ``values`` in ``register.unit``; int64, same shape.

    Raises
    ------
    InputError
        Where a value lies outside the register's type.
    """
    wanted = np.asarray(values, dtype=float)
    counts = np.rint((wanted - register.offset) / register.scale)
    info = np.iinfo(register.type)
    outside = ~((counts >= info.min) & (counts <= info.max))
    if outside.any():
        low, high = representable(register)
        raise InputError(
            f"no count of {register.name} stands for {wanted[outside][0]:g} {register.unit}",
            field=f"registers.{register.name}",
            remedy=f"Stay between {low:g} and {high:g} {register.unit}.",
        )
    return counts.astype(np.int64)


def representable(register: Register) -> tuple[float, float]:
    """Lowest and highest value, in ``register.unit``, that an integer register can hold."""
    info = np.iinfo(register.type)
    low, high = sorted(to_physical(register, np.array([info.min, info.max])).tolist())
    return low, high


def limit_counts(device: Device) -> tuple[int, int]:
    """Return the lowest and the highest raw counts of the output inside its ``limits``.

    Counts are rounded inwards, so that no representable value exceeds a limit.

    Raises
    ------
    InputError
        If it has none.
    """
    register = device["output"]
    if register.limits is None:
        raise InputError(
            "no limits",
            file=device.source,
            field="registers.output.limits",
            remedy=f"Give [low, high] in {register.unit}.",
        )
    # 1e-9 counts of tolerance keep a limit that is exactly representable despite rounding.
    edges = sorted((limit - register.offset) / register.scale for limit in register.limits)
    info = np.iinfo(register.type)
    low = max(int(np.ceil(edges[0] - 1e-9)), int(info.min))
    high = min(int(np.floor(edges[1] + 1e-9)), int(info.max))
    return low, high


def checksum(words: Sequence[int]) -> int:
    """CRC-32 of registers in the order of the wire; Modbus TCP itself has no checksum."""
    return zlib.crc32(struct.pack(f">{len(words)}H", *words))
