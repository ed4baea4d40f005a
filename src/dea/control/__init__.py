"""From model to control: code, linear models and trackers that run beside a device."""

from dea.control.c_code import CCode, to_c
from dea.control.fmu import write_fmu

__all__ = ["CCode", "to_c", "write_fmu"]
