"""Phase of the second-order frequency response H2(f1, f2) at chosen times."""

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
from dea.figures.planes_over_time import PlaneQuantity, excited_values, planes_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``gfrf.nc`` of one or several systems."""
    return fig4_h2_phase(sources.datasets("record"), sources.datasets("gfrf"))


@style.styled
def fig4_h2_phase(records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the phase of H2 (contracts ``record`` and ``gfrf``, by the systems' names).

    The delay of one sample, at the sum of both frequencies, is taken off; that of the instruments
    is not.
    """
    parts = one_by_one(responses, "pair")
    phases, low, high = {}, {}, {}
    for name, response in parts.items():
        record = records[system_of(records, name)]
        phases[name], added = phase_without_delay(as_complex(response["H2"]), record)
        low[name] = response["H2_phase_low"] + added
        high[name] = response["H2_phase_high"] + added
    shown = PlaneQuantity(
        phases,
        phase_scale(excited_values(phases, parts)),
        style.PHASE_MAP,
        "phase of $H_2(f_1, f_2)$\nwithout the delay of one sample (degrees)",
        phases,
        low,
        high,
        dict.fromkeys(parts, "phase of\n$H_2(f, f)$ (degrees)"),
        from_zero=False,
    )
    return planes_over_time(parts, shown)
