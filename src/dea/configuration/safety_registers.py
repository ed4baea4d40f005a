"""What ``safety`` and ``registers`` of a device description must agree on."""

from collections.abc import Mapping

from dea.configuration.register import INTEGERS, KNOWN, NEEDED, WORDS, Register
from dea.configuration.safety import WRITTEN, Enable, Safety
from dea.configuration.section import refuse


def check_registers(safety: Safety, registers: Mapping[str, Register]) -> None:
    """Check that each signal has a register of its own that can hold what it must.

    Raises
    ------
    PydanticCustomError
        Naming the key that is wrong.
    """
    taken: dict[str, str] = {}
    for place, name in safety.named_registers().items():
        signal = place.removesuffix(".name")
        if name not in registers:
            raise refuse(f"safety.{place}", f"no register {name!r}", "Describe it under registers.")
        if name in (KNOWN if signal in WRITTEN else NEEDED):
            raise refuse(
                f"safety.{place}",
                f"{name!r} is a register that the acquisition itself uses",
                "Name another register, which holds this signal alone.",
            )
        if name in taken:
            raise refuse(
                f"safety.{place}",
                f"{name!r} is the register of safety.{taken[name]} already",
                "Give each signal a register of its own.",
            )
        taken[name] = place
        _check_access(signal, name, registers[name])
        _check_values(signal, name, registers[name])
    if safety.enable is not None:
        _check_switch(safety.enable, registers[safety.enable.name])


def _check_access(signal: str, name: str, register: Register) -> None:
    written = signal in WRITTEN
    if register.access == ("read" if written else "write"):
        raise refuse(
            f"registers.{name}.access",
            f"{register.access}, and safety.{signal}.name needs it",
            f"Give {'write or read_write' if written else 'read or read_write'}.",
        )


def _check_values(signal: str, name: str, register: Register) -> None:
    """Refuse a register that holds no single number."""
    single = register.count == 1 and register.type != "string"
    if not single or (signal != "enable" and register.type == "bool" and "." not in signal):
        raise refuse(
            f"registers.{name}.type",
            f"{register.type}, count {register.count}, and safety.{signal} is one number",
            "Use a number type and count: 1, or name another register.",
        )


def _check_switch(enable: Enable, register: Register) -> None:
    """Refuse values that do not switch, or that the register cannot hold: it would stay on."""
    if enable.on == enable.off:
        raise refuse(
            "safety.enable.off",
            f"{enable.off}, as on",
            "Give the value that switches the high voltage off.",
        )
    highest = _highest(register)
    for key, value in (("on", enable.on), ("off", enable.off)):
        if highest is not None and value > highest:
            raise refuse(
                f"safety.enable.{key}",
                f"{value}, and {enable.name} ({register.type}) holds {highest} at most",
                "Give a value that it can hold, or correct its type.",
            )


def _highest(register: Register) -> int | None:
    if register.type == "bool":
        return 1
    if register.type not in INTEGERS:
        return None
    bits = 16 * WORDS[register.type] - register.type.startswith("int")
    return int(2**bits - 1)
