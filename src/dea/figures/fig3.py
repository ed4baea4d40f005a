"""Fig. 3: gain of the first-order frequency response over time, below the raw output."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import (
    as_complex,
    magnitude_scale,
    one_by_one,
    slow_reference,
    system_of,
)
from dea.figures.h1_over_time import H1Quantity, excited_values, h1_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``gfrf.nc`` of one or several systems."""
    return fig3(sources.datasets("record"), sources.datasets("gfrf"))


@style.styled
def fig3(records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the gain of H1(f, t) (contracts ``record`` and ``gfrf``, by the systems' names).

    The maps show it relative to the system's own gain at the lowest frequency in the middle of the
    record, so that one colour scale suits systems of different size; the curves in physical units.
    """
    parts = one_by_one(responses, "input")
    gains = {name: abs(as_complex(response["H1"])) for name, response in parts.items()}
    references = {name: slow_reference(gain) for name, gain in gains.items()}
    relative = {name: gain / references[name] for name, gain in gains.items()}
    shown = H1Quantity(
        relative,
        magnitude_scale(excited_values(relative, parts)),
        style.GAIN_MAP,
        r"$|H_1(f, t)|$ / $|H_1|$ at the lowest $f$ and half time",
        gains,
        "gain_low",
        "gain_high",
        {
            name: style.quantity(r"gain $|H_1|$", response["H1"].attrs["units"])
            for name, response in parts.items()
        },
        references,
    )
    of_system = {name: records[system_of(records, name)] for name in parts}
    return h1_over_time(of_system, parts, shown)
