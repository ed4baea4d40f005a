"""``registers`` of a device description: one named value of the device."""

from collections.abc import Mapping
from typing import Literal, Self

from pydantic import model_validator

from dea.configuration.section import Interval, NotNegative, Number, Section, Whole, key, refuse

Table = Literal["holding", "input", "coil", "discrete"]
Order = Literal["big", "little"]
Access = Literal["read", "write", "read_write"]
RegisterType = Literal[
    "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64", "string", "bool"
]

# Registers that the acquisition looks for by name. A device needs the first two; what else it has
# gets the checks and the modes that it allows (docs/acquisition.md). Others are free to be added.
NEEDED = ("output", "displacement")
KNOWN = (
    *NEEDED,
    *("applied_output", "device_index", "device_rate", "state", "command", "claim", "boot"),
    *("watchdog_latched", "watchdog_time", "fifo_length", "output_low_limit", "output_high_limit"),
    *(f"{name}_range_{end}" for name in NEEDED for end in ("low", "high")),
    *(f"block_{name}" for name in ("crc", "sequence", "read_index", "count", "samples")),
    *(f"reply_{name}" for name in ("crc", "sequence", "index", "position", "next", "count")),
    *(f"reply_{name}" for name in ("origin", "state", "fifo", "samples")),
)

INTEGERS: tuple[RegisterType, ...] = ("uint16", "int16", "uint32", "int32", "uint64", "int64")
NUMBERS: tuple[RegisterType, ...] = (*INTEGERS, "float32", "float64")
LONG: tuple[RegisterType, ...] = ("uint32", "uint64", "int64")  # hold 32 bits without a sign
ARRAYS = ("block_samples", "reply_samples")
# What the known registers hold; `boot` is only compared.
TYPES: Mapping[str, tuple[RegisterType, ...]] = (
    dict.fromkeys(KNOWN, NUMBERS)
    | dict.fromkeys(("output", "device_index"), INTEGERS)
    | dict.fromkeys(("state", "command", "fifo_length", "block_count", *ARRAYS), INTEGERS)
    | dict.fromkeys(("reply_count", "reply_origin", "reply_state", "reply_fifo"), INTEGERS)
    | dict.fromkeys(("claim", "block_crc", "block_sequence", "block_read_index"), LONG)
    | dict.fromkeys((f"reply_{name}" for name in ("crc", "sequence", "index", "position")), LONG)
    | {"reply_next": LONG, "watchdog_latched": (*NUMBERS, "bool")}
    | {"boot": (*NUMBERS, "string")}
)
# 16-bit registers that one value occupies.
WORDS: Mapping[RegisterType, int] = {
    "uint16": 1,
    "int16": 1,
    "uint32": 2,
    "int32": 2,
    "float32": 2,
    "uint64": 4,
    "int64": 4,
    "float64": 4,
    "string": 1,
    "bool": 1,
}
LAST_ADDRESS = 0xFFFF


class Register(Section):
    """One named value of the device."""

    address: Whole = key("of the first register, from 0", ge=0, le=LAST_ADDRESS)
    type: RegisterType = key("how registers make a number", default="uint16")
    table: Table = key("registers, or coils and discrete inputs of one bit", default="holding")
    count: Whole = key("values of an array, or registers of a string", default=1, ge=1, le=125)
    word_order: Order | None = key("first word; the device's where not given", default=None)
    byte_order: Order | None = key("first byte; the device's where not given", default=None)
    scale: Number | None = key("value of one count, not zero; 1 where not given", default=None)
    offset: Number | None = key("value of count 0; 0 where not given", default=None)
    unit: str = key("unit of the value; `output` is in V, `displacement` in mm", default="1")
    access: Access = key("what a master may do", default="read")
    range: Interval | None = key(
        "values of the lowest and the highest count of an integer, instead of scale and offset",
        default=None,
    )
    limits: Interval | None = key(
        "values that are never left, whatever the excitation asks for", default=None
    )
    expect: int | float | str | None = key(
        "what must be read before any voltage is applied", default=None
    )
    tolerance: NotNegative = key(
        "how far a reading may be off: offset and noise of a read-back, in the register's unit",
        default=0.0,
    )

    @property
    def end(self) -> int:
        """First address after the value."""
        return self.address + WORDS[self.type] * self.count

    @model_validator(mode="after")
    def _relations(self) -> Self:
        scaled = self.scale is not None or self.offset is not None
        if self.range is not None and (scaled or self.type not in INTEGERS):
            raise refuse(
                "range",
                "only for an integer type and without scale and offset",
                "Keep one of them.",
            )
        if self.range is not None and self.limits is not None:
            (low, high), limits = self.range, self.limits
            if limits[0] < low or limits[1] > high:
                raise refuse(
                    "limits",
                    f"[{limits[0]:g}, {limits[1]:g}] leaves the range [{low:g}, {high:g}]",
                    "Give limits inside the range.",
                )
        if self.scale == 0:
            raise refuse("scale", "zero", "Give the value of one count.")
        if self.end > LAST_ADDRESS + 1:
            raise refuse(
                "address", f"{self.address} runs past {LAST_ADDRESS}", "Lower address or count."
            )
        if (self.type == "bool") != (self.table in ("coil", "discrete")) or (
            self.type == "bool" and self.count > 1
        ):
            raise refuse(
                "type",
                f"{self.type}, count {self.count}, in table {self.table}",
                "Use type: bool and count: 1 for table: coil or discrete, and for no other.",
            )
        if self.table in ("input", "discrete") and self.access != "read":
            raise refuse(
                "access",
                f"{self.access}, but inputs can only be read",
                "Use table: holding or coil, or access: read.",
            )
        if self.expect is not None and self.type != "string" and self.count > 1:
            raise refuse(
                "expect",
                f"{self.expect!r}, and the register holds {self.count} values",
                "Describe the value that is expected as a register of its own.",
            )
        if self.expect is not None and isinstance(self.expect, str) != (self.type == "string"):
            raise refuse(
                "expect",
                f"{self.expect!r} is not a {self.type}",
                "Give a value of the register's type.",
            )
        return self
