"""Fig. 3: gain of the first-order frequency response over time, below the raw output."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import as_complex, magnitude_scale
from dea.figures.h1_over_time import Scale, excited_values, h1_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``gfrf.nc`` of one or several systems."""
    return fig3(sources.datasets("record"), sources.datasets("gfrf"))


@style.styled
def fig3(records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the gain of H1(f, t) (contracts ``record`` and ``gfrf``, by the systems' names)."""
    maps = {name: abs(as_complex(response["H1"])) for name, response in responses.items()}
    units = next(iter(responses.values()))["H1"].attrs["units"]
    label = style.quantity(r"gain $|H_1(f, t)|$", units)
    scale = Scale(magnitude_scale(excited_values(maps, responses)), style.GAIN_MAP, label)
    return h1_over_time(records, responses, maps, scale)
