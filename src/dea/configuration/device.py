"""Device descriptions: the files in config/devices."""

from difflib import get_close_matches
from itertools import pairwise
from typing import Annotated, Literal, Self, get_args

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from dea.configuration.register import ARRAYS, KNOWN, NUMBERS, TYPES, Order, Register, Table
from dea.configuration.safety import Mode, Safety
from dea.configuration.safety_registers import check_registers
from dea.configuration.section import NotNegative, Positive, Section, Truth, Whole, key, refuse

Framing = Literal["tcp", "rtu_over_tcp", "tls", "serial"]
Parity = Literal["N", "E", "O"]
# What a record holds the registers needed in (`dea.store`).
UNITS = {"output": "V", "displacement": "mm"}
# Why registers hold a whole number, where that is not plain from their names.
WHOLE = {
    "output": "the output is driven in whole counts",
    "device_index": "the device counts its samples in it",
}
# Registers of one value of a signal.
SIGNALS = ("output", "applied_output", "displacement")
LONGEST_LATE_WRITE = 5.0  # s
# Similarity from which a name is taken for a known one, misspelt: two letters of five swapped.
MISSPELT = 0.8


class Endpoint(Section):
    """Where the device, or the gateway before it, answers."""

    host: str = key("name or address")
    port: Whole = key("TCP port", ge=0, le=65535)


class Tls(Section):
    """Certificates of a TLS link, as file names."""

    ca_file: str | None = key("authority that signs the device's certificate", default=None)
    server_name: str | None = key("name in the device's certificate", default=None)
    certificate_file: str | None = key("the client's certificate", default=None)
    key_file: str | None = key("the client's key", default=None)


class Serial(Section):
    """A serial line."""

    port: str = key("device file of the line")
    baudrate: Whole = key("speed", unit="bit/s", default=19200, ge=300, le=4_000_000)
    parity: Parity = key("none, even or odd", default="E")
    stopbits: Whole = key("stop bits", default=1, ge=1, le=2)


def _apart(registers: dict[str, Register]) -> dict[str, Register]:
    for table in get_args(Table):
        ordered = sorted(
            ((r.address, r.end, name) for name, r in registers.items() if r.table == table),
        )
        for (first, end, held), (address, _, name) in pairwise(ordered):
            if address < end:
                raise refuse(
                    f"{name}.address",
                    f"{address} overlaps {held}, which holds {first} to {end - 1} ({table})",
                    f"Move it to {end} or later, or correct the types.",
                )
    return registers


def _spelt(registers: dict[str, Register]) -> dict[str, Register]:
    """Refuse a misspelt name: the check that needs the register would be left out silently."""
    missing = [name for name in KNOWN if name not in registers]
    for name in registers:
        if name not in KNOWN and (near := get_close_matches(name, missing, 1, MISSPELT)):
            raise refuse(
                name,
                f"unknown register {name!r}",
                f"Did you mean {near[0]!r}? If not, give it a name less like that one.",
            )
    return registers


def _unheld(name: str, register: Register) -> PydanticCustomError:
    """Return the refusal of a register that has another type or count than its name asks for."""
    if name in SIGNALS and (register.count > 1 or register.type not in NUMBERS):
        return refuse(
            f"registers.{name}.count",
            f"{register.count} values of type {register.type}",
            "Give the address of the one value; describe its neighbours apart.",
        )
    held = f"{register.type}, count {register.count}"
    if name in WHOLE:
        return refuse(
            f"registers.{name}.type",
            f"{held}, and {WHOLE[name]}",
            "Use the device's integer register and count: 1.",
        )
    return refuse(
        f"registers.{name}.type",
        f"{held}, which cannot hold it",
        f"Give one of {', '.join(TYPES[name])}"
        + (", as the device has it." if name in ARRAYS else ", and count: 1."),
    )


class DeviceDescription(Section):
    """A Modbus device: endpoint, framing and register map (docs/acquisition.md)."""

    name: str = key("of the device, for people")
    endpoint: Endpoint | None = key("where it answers; not for a serial line", default=None)
    unit_id: Whole = key("Modbus unit id", ge=0, le=247)
    framing: Framing = key("of the link", default="tcp")
    tls: Tls = key("certificates, where framing is tls", default=Tls())
    serial: Serial | None = key("the line, where framing is serial", default=None)
    sampling_rate: Positive = key("of the device's clock, or of the host's", unit="Hz")
    read_write_multiple: Truth = key("true where it answers function code 23", default=False)
    quarantine: NotNegative | None = key(
        "how long zero is written again and watched before it is believed, longer than a gateway"
        " may hold a write back; where not given, 5 s, or none for a device with `claim`, which"
        " refuses the writes of a master that owns it no longer",
        unit="s",
        default=None,
    )
    word_order: Order = key("word that comes first in a value of several", default="big")
    byte_order: Order = key("byte that comes first in a word", default="big")
    safety: Safety | None = key("what must hold while there is high voltage", default=None)
    registers: Annotated[
        dict[str, Register],
        Field(min_length=1),
        AfterValidator(_apart),
        AfterValidator(_spelt),
    ] = key("`output`, `displacement` and what else the device has, by name")

    @model_validator(mode="after")
    def _held(self) -> Self:
        """Refuse a register that cannot hold what its name says."""
        for name, types in TYPES.items():
            register = self.registers.get(name)
            if register is None:
                continue
            if register.type not in types or (register.count > 1 and name not in ARRAYS):
                raise _unheld(name, register)
        return self

    @model_validator(mode="after")
    def _driven(self) -> Self:
        if "command" in self.registers and "state" not in self.registers:
            raise refuse(
                "registers.state",
                "missing beside a register command",
                "Describe it too, since it shows when a commanded stop is at zero; or give the "
                "register command another name, and the output is ramped by writes.",
            )
        output = self.registers.get("output")
        if output and output.access == "read":
            raise refuse(
                "registers.output.access",
                "read" if "access" in output.model_fields_set else "missing, which means read",
                "Give write or read_write: it is what is driven.",
            )
        if output and output.limits and not output.limits[0] <= 0 <= output.limits[1]:
            raise refuse(
                "registers.output.limits",
                f"[{output.limits[0]:g}, {output.limits[1]:g}] leaves out 0 V",
                "Give limits around 0 V, at which every drive begins and ends.",
            )
        for name in ("applied_output", "displacement"):
            register = self.registers.get(name)
            if register and register.access == "write":
                raise refuse(
                    f"registers.{name}.access",
                    "write",
                    "Give read or read_write: it is what is measured.",
                )
        return self

    @model_validator(mode="after")
    def _units(self) -> Self:
        for name, unit in UNITS.items():
            register = self.registers.get(name)
            if register and register.unit != unit:
                told = "unit" in register.model_fields_set
                raise refuse(
                    f"registers.{name}.unit",
                    f"{register.unit!r}, and a record holds it in {unit}" if told else "missing",
                    f"Give the scale or range that makes the value {unit}, and `unit: {unit}`.",
                )
        return self

    @model_validator(mode="after")
    def _safety(self) -> Self:
        if self.safety is None:
            return self
        check_registers(self.safety, self.registers)
        modes: tuple[Mode, ...] = ("polled", "buffered")
        possible = modes if "block_samples" in self.registers else modes[:1]
        unkept = [self.safety.unkept_heartbeat(mode, self.sampling_rate) for mode in possible]
        if all(unkept) and unkept[0]:
            raise refuse("safety.heartbeat.period", *unkept[0])
        return self

    @model_validator(mode="after")
    def _link(self) -> Self:
        if self.framing == "serial" and self.serial is None:
            raise refuse("serial", "missing, though framing is serial", "Give the line's port.")
        if self.framing != "serial" and self.endpoint is None:
            raise refuse("endpoint", "missing", "Give the host and port of the device.")
        output, echo = (self.registers.get(name) for name in ("output", "applied_output"))
        if output and echo and output.unit != echo.unit:
            raise refuse(
                "registers.applied_output.unit",
                f"{echo.unit!r}, and the output is in {output.unit!r}",
                "Give the scale or range that makes it the output's unit; a monitor behind the"
                " amplifier is another register.",
            )
        return self
