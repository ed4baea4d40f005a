"""Reading a device from the YAML file that describes it, every key checked."""

from collections.abc import Mapping
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from typing import Any, get_args

import yaml

from dea.errors import InputError
from dea.modbus.device import (
    Access,
    Device,
    Framing,
    Order,
    Parity,
    Register,
    RegisterType,
    Serial,
    Table,
    Tls,
)
from dea.modbus.section import Section

_INTEGERS = tuple(kind for kind in get_args(RegisterType) if "int" in kind)
_LAST_ADDRESS = 0xFFFF


def read_device(path: str | Path) -> Device:
    """Read and check a device description.

    Raises
    ------
    InputError
        Naming the file, the field and the remedy: unreadable YAML, a misspelt key, an unknown
        type, overlapping registers, crossing limits, a unit id or address out of range.
    """
    path = Path(path)
    try:
        content = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"the device description cannot be read: {error}",
            file=path,
            remedy="Name one of config/devices/*.yaml or a file written like them.",
        ) from error
    except yaml.YAMLError as error:
        raise InputError(f"not valid YAML: {error}", file=path, remedy="Mend the syntax.") from None
    return parse_device(content, source=path)


def parse_device(content: Any, source: Path | None = None) -> Device:
    """Check a description given as the mapping its YAML holds; see :func:`read_device`."""
    top = Section(content, source, "")
    top.allow(
        "name", "endpoint", "unit_id", "framing", "tls", "serial", "sampling_rate",
        "read_write_multiple", "word_order", "byte_order", "registers",
    )  # fmt: skip
    framing = top.choice("framing", Framing, "tcp")
    endpoint = top.section("endpoint") if framing != "serial" else None
    if endpoint is not None:
        endpoint.allow("host", "port")
    if framing == "serial" and "serial" not in top.values:
        raise top.error("serial", "missing, though framing is serial", "Give the port of the line.")
    orders = {key: top.choice(key, Order, "big") for key in ("word_order", "byte_order")}
    registers = {
        str(name): _register(str(name), top.section("registers"), orders)
        for name in top.section("registers").values
    }
    if not registers:
        raise top.error("registers", "empty", "Describe at least the output and the measurement.")
    _refuse_overlaps(registers, top)
    return Device(
        name=top.text("name"),
        unit_id=top.integer("unit_id", 0, 247),
        sampling_rate=top.number("sampling_rate", positive=True),
        registers=registers,
        host=endpoint.text("host") if endpoint else "",
        port=endpoint.integer("port", 0, 65535) if endpoint else 0,
        framing=framing,  # type: ignore[arg-type]
        tls=_tls(top),
        serial=_serial(top) if framing == "serial" else None,
        read_write_multiple=top.boolean("read_write_multiple", False),
        source=source,
    )


def _register(name: str, parent: Section, orders: Mapping[str, str]) -> Register:
    section = parent.section(name)
    section.allow(*(f.name for f in fields(Register) if f.name != "name"))
    kind = section.choice("type", RegisterType, "uint16")
    word_order = section.choice("word_order", Order, orders["word_order"])
    span = section.interval("range")
    if span and (kind not in _INTEGERS or "scale" in section.values or "offset" in section.values):
        raise section.error(
            "range", "only for an integer type and without scale and offset", "Keep one of them."
        )
    scale, offset = _scaling(kind, span)
    register = Register(
        name=name,
        address=section.integer("address", 0, _LAST_ADDRESS),
        type=kind,  # type: ignore[arg-type]
        table=section.choice("table", Table, "holding"),  # type: ignore[arg-type]
        count=section.integer("count", 1, 125, default=1),
        word_order=word_order,  # type: ignore[arg-type]
        byte_order=section.choice("byte_order", Order, orders["byte_order"]),  # type: ignore[arg-type]
        scale=section.number("scale", default=scale),
        offset=section.number("offset", default=offset),
        unit=section.text("unit", default="1"),
        access=section.choice("access", Access, "read"),  # type: ignore[arg-type]
        range=span,
        limits=section.interval("limits"),
        expect=section.values.get("expect"),
    )
    if register.scale == 0:
        raise section.error("scale", "zero", "Give the value of one count.")
    if register.end > _LAST_ADDRESS + 1:
        raise section.error(
            "address", f"{register.address} runs past {_LAST_ADDRESS}", "Lower address or count."
        )
    if register.table == "input" and register.access != "read":
        raise section.error(
            "access", f"{register.access}, but input registers can only be read",
            "Use table: holding, or access: read.",
        )  # fmt: skip
    if register.expect is not None and isinstance(register.expect, str) != (kind == "string"):
        raise section.error(
            "expect", f"{register.expect!r} is not a {kind}", "Give a value of the register's type."
        )
    return register


def _scaling(kind: str, span: tuple[float, float] | None) -> tuple[float, float]:
    """Scale and offset that spread ``span`` over all raw values of the type."""
    if span is None:
        return 1.0, 0.0
    bits, signed = int(kind.lstrip("uint")), not kind.startswith("u")
    scale = (span[1] - span[0]) / (2**bits - 1)
    return scale, span[0] + scale * 2 ** (bits - 1) * signed


def _refuse_overlaps(registers: Mapping[str, Register], top: Section) -> None:
    for table in get_args(Table):
        ordered = sorted(
            (r for r in registers.values() if r.table == table), key=lambda r: r.address
        )
        for first, second in pairwise(ordered):
            if second.address < first.end:
                raise top.error(
                    f"registers.{second.name}.address",
                    f"{second.address} overlaps {first.name}, which holds "
                    f"{first.address} to {first.end - 1} ({table})",
                    f"Move it to {first.end} or later, or correct the types.",
                )


def _tls(top: Section) -> Tls:
    if "tls" not in top.values:
        return Tls()
    section = top.section("tls")
    section.allow(*(f.name for f in fields(Tls)))
    return Tls(**{key: section.text(key) for key in section.values})


def _serial(top: Section) -> Serial:
    section = top.section("serial")
    section.allow(*(f.name for f in fields(Serial)))
    return Serial(
        port=section.text("port"),
        baudrate=section.integer("baudrate", 300, 4_000_000, default=19200),
        parity=section.choice("parity", Parity, "E"),  # type: ignore[arg-type]
        stopbits=section.integer("stopbits", 1, 2, default=1),
    )
