"""Identify, track and explain dielectric elastomer actuators from their records.

The names below, and the rooms themselves (``dea.progress``), are loaded on first use, so that a
small job imports only its own room.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from dea.compiled import keep_compiled_functions
from dea.declared_code import refuse_undeclared_code

if TYPE_CHECKING:
    from dea.control import (
        OnlineTracker,
        linearise,
        linearise_over_time,
        to_c,
        to_iosystem,
        write_fmu,
    )
    from dea.discrepancy import diagnose
    from dea.gfrf import frequency_response, frequency_response_band
    from dea.narx import (
        NarxModel,
        parameter_interval,
        select_common_terms,
        select_lags,
        select_terms,
        simulation_interval,
    )
    from dea.nonparametric import best_linear_approximation
    from dea.store import Record, read_record
    from dea.tracking import track_parameters

__all__ = [
    "NarxModel",
    "OnlineTracker",
    "Record",
    "best_linear_approximation",
    "diagnose",
    "frequency_response",
    "frequency_response_band",
    "linearise",
    "linearise_over_time",
    "parameter_interval",
    "read_record",
    "select_common_terms",
    "select_lags",
    "select_terms",
    "simulation_interval",
    "to_c",
    "to_iosystem",
    "track_parameters",
    "write_fmu",
]

# Numba reads where to keep what it compiles when it is imported first.
keep_compiled_functions()
# After it, since that reads every module to tell whether any has changed.
refuse_undeclared_code()

_ROOM_OF = {
    "NarxModel": "dea.narx",
    "OnlineTracker": "dea.control",
    "Record": "dea.store",
    "best_linear_approximation": "dea.nonparametric",
    "diagnose": "dea.discrepancy",
    "frequency_response": "dea.gfrf",
    "frequency_response_band": "dea.gfrf",
    "linearise": "dea.control",
    "linearise_over_time": "dea.control",
    "parameter_interval": "dea.narx",
    "read_record": "dea.store",
    "select_common_terms": "dea.narx",
    "select_lags": "dea.narx",
    "select_terms": "dea.narx",
    "simulation_interval": "dea.narx",
    "to_c": "dea.control",
    "to_iosystem": "dea.control",
    "track_parameters": "dea.tracking",
    "write_fmu": "dea.control",
}


def __getattr__(name: str) -> Any:
    if name in _ROOM_OF:
        return getattr(import_module(_ROOM_OF[name]), name)
    if name.startswith("_") or not name.isidentifier() or find_spec(f"dea.{name}") is None:
        raise AttributeError(f"module 'dea' has no attribute {name!r}")
    return import_module(f"dea.{name}")


def __dir__() -> list[str]:
    return __all__
