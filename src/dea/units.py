"""Units as text: their spelling, those of time, and products such as ``(ticks/s)^2``, ``mm/V``."""

import re

# How many seconds each unit of time has.
SECONDS = {
    "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86_400.0
}  # fmt: skip
# How many hertz each unit of a rate has.
HERTZ = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "1/s": 1.0, "1/min": 1.0 / 60.0}
_JOINING = " */·"  # between units that make another one
_TIMES = re.compile(r"[\s*·]+")
_POWER = re.compile(r"(.+)\^([-+]?\d+\.?\d*)")
_BRACKETS = re.compile(r"^[\[(]([^\[\]()]*)[\])]$")
_SINCE = re.compile(r"\s+since\s.*", re.IGNORECASE)
_SPELLINGS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "millisecond": "ms",
    "milliseconds": "ms", "millis": "ms", "µs": "us", "μs": "us", "usec": "us", "micros": "us",
    "microsecond": "us", "microseconds": "us", "nanosecond": "ns", "nanoseconds": "ns",
    "minute": "min", "minutes": "min",
    "hour": "h", "hours": "h", "hr": "h", "day": "d", "days": "d",
    "volt": "V", "volts": "V", "°c": "degC", "℃": "degC", "deg c": "degC", "degc": "degC",
    "celsius": "degC", "-": "1", "": "1",
}  # fmt: skip


def plain_units(text: str) -> str:
    """Return units in the spelling of this project: ``(sec)`` is ``s``."""
    bare = _BRACKETS.sub(r"\1", text.strip()).strip()
    # A time in NetCDF is a number of these units since a date.
    if (unit := _SINCE.sub("", bare)) != bare and plain_units(unit) in SECONDS:
        return plain_units(unit)
    return _SPELLINGS.get(bare.lower(), bare.replace("µ", "u").replace("μ", "u"))


def power(units: str, exponent: int) -> str:
    """Return the units of a power of a quantity; without units they are ``1``."""
    if units == "1":
        return units
    compound = any(sign in units for sign in f"{_JOINING}^")
    return f"({units})^{exponent}" if compound else f"{units}^{exponent}"


def product(*above: str, below: str = "1") -> str:
    """Return the units of a product of quantities over one, without what cancels."""
    powers: dict[str, float] = {}
    for sign, units in (*((1, each) for each in above), (-1, below)):
        for place, part in enumerate([units] if "(" in units else units.split("/")):
            for factor in [part] if "(" in part else filter(None, _TIMES.split(part)):
                raised = None if "(" in factor else _POWER.fullmatch(factor)
                name, exponent = raised.groups() if raised else (factor, "1")
                if name != "1":
                    side = -sign if place else sign
                    powers[name] = powers.get(name, 0.0) + side * float(exponent)

    def written(name: str) -> str:
        size = abs(powers[name])
        return name if size == 1.0 else f"{name}^{size:g}"

    upper = " ".join(written(name) for name, exponent in powers.items() if exponent > 0.0)
    lower = [written(name) for name, exponent in powers.items() if exponent < 0.0]
    return "/".join([upper or "1", *lower])


def ratio(above: str, below: str) -> str:
    """Return the units of one quantity over another."""
    if below == "1":
        return above
    return f"{above}/({below})" if any(sign in below for sign in _JOINING) else f"{above}/{below}"
