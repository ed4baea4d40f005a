"""Phase of the first-order frequency response over time, below the raw output."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import (
    as_complex,
    one_by_one,
    phase_scale,
    phase_without_delay,
    system_of,
)
from dea.figures.h1_over_time import H1Quantity, excited_values, h1_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``gfrf.nc`` of one or several systems."""
    return fig3_phase(sources.datasets("record"), sources.datasets("gfrf"))


@style.styled
def fig3_phase(records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the phase of H1(f, t) (contracts ``record`` and ``gfrf``, by the systems' names).

    The delay of one sample, which lies between an input and the first output that it can move, is
    taken off; that of the instruments is not.
    """
    parts = one_by_one(responses, "input")
    of_system = {name: records[system_of(records, name)] for name in parts}
    without = {name: _without_delay(response, of_system[name]) for name, response in parts.items()}
    maps = {name: response["phase"] for name, response in without.items()}
    shown = H1Quantity(
        maps,
        phase_scale(excited_values(maps, parts)),
        style.PHASE_MAP,
        "phase of $H_1(f, t)$ without the delay of one sample (degrees)",
        maps,
        "phase_low",
        "phase_high",
        dict.fromkeys(parts, "phase of $H_1$ (degrees)"),
    )
    return h1_over_time(of_system, without, shown)


def _without_delay(response: xr.Dataset, record: xr.Dataset) -> xr.Dataset:
    """Return the response with phase and band (degrees), unwrapped, less the delay of a sample."""
    phase, added = phase_without_delay(as_complex(response["H1"]), record)
    ends = {name: response[name] + added for name in ("phase_low", "phase_high")}
    return response.assign({"phase": phase, **ends})
