"""How an acquisition drives, waits and repeats."""

from dataclasses import dataclass, fields
from typing import Any, Literal

from dea.errors import InputError

_CHOICES = {"mode": ("buffered", "polled"), "on_break": ("stop", "restart"), "paced": (True, False)}
_LOWEST = {
    "ramp_rate": 1e-3,
    "restarts": 0,
    "timeout": 1e-3,
    "retries": 0,
    "reconnect_time": 0.0,
    "late_after": 0.0,
}


@dataclass(frozen=True)
class AcquisitionSettings:
    """How to drive: see ``acquisition`` in config/config.yaml for the meaning and units."""

    mode: Literal["buffered", "polled"] = "buffered"
    ramp_rate: float = 1.0  # V/s
    on_break: Literal["stop", "restart"] = "stop"
    restarts: int = 2
    timeout: float = 2.0  # s
    retries: int = 5
    reconnect_time: float = 10.0  # s
    late_after: float = 5e-3  # s
    paced: bool = True

    @classmethod
    def from_mapping(cls, values: dict[str, Any]) -> "AcquisitionSettings":
        """Check settings read from a file; raises InputError for a misspelt key or bad value."""
        known = {f.name for f in fields(cls)}
        for key in values:
            if key not in known:
                raise InputError(
                    "unknown key", field=f"acquisition.{key}", remedy=f"Known: {sorted(known)}."
                )
        settings = cls(**values)
        for key, allowed in _CHOICES.items():
            if getattr(settings, key) not in allowed:
                raise InputError(
                    f"{getattr(settings, key)!r}",
                    field=f"acquisition.{key}",
                    remedy=f"Use {' or '.join(map(str, allowed))}.",
                )
        for key, low in _LOWEST.items():
            number = getattr(settings, key)
            if isinstance(number, bool) or not isinstance(number, int | float) or number < low:
                raise InputError(
                    f"{number!r}",
                    field=f"acquisition.{key}",
                    remedy=f"Use a number of at least {low:g}.",
                )
        return settings
