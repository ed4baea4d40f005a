"""Phase of the first-order frequency response over time, below the raw output."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from dea.figures import style
from dea.figures.frequency_maps import as_complex
from dea.figures.h1_over_time import Scale, excited_values, h1_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``record.nc`` and ``gfrf.nc`` of one or several systems."""
    return fig3_phase(sources.datasets("record"), sources.datasets("gfrf"))


@style.styled
def fig3_phase(records: Mapping[str, xr.Dataset], responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the phase of H1(f, t) (contracts ``record`` and ``gfrf``, by the systems' names)."""
    maps = {name: _degrees(response) for name, response in responses.items()}
    norm = _range(excited_values(maps, responses))
    label = r"phase $\angle H_1(f, t)$ (degrees)"
    return h1_over_time(records, responses, maps, Scale(norm, style.PHASE_MAP, label))


def _degrees(response: xr.Dataset) -> xr.DataArray:
    """Return the phase (degrees), unwrapped along the frequencies."""
    h1 = as_complex(response["H1"])
    unwrapped = np.unwrap(np.angle(h1), axis=h1.get_axis_num("frequency"))
    return h1.copy(data=np.degrees(unwrapped))


def _range(phases: NDArray[np.float64]) -> Normalize:
    finite = phases[np.isfinite(phases)]
    return Normalize(finite.min(), finite.max()) if finite.size else Normalize(-180.0, 0.0)
