"""Fig. 4: magnitude of the second-order frequency response H2(f1, f2) at chosen times."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import as_complex, magnitude_scale, one_by_one, slow_reference
from dea.figures.planes_over_time import PlaneQuantity, excited_values, planes_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``gfrf.nc`` of one or several systems."""
    return fig4_h2(sources.datasets("gfrf"))


@style.styled
def fig4_h2(responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw |H2| (contract ``gfrf``, by the systems' names).

    The maps show it relative to the system's own at the lowest frequencies and the middle time;
    the curves show |H2(f, f)| in physical units.
    """
    responses = one_by_one(responses, "pair")
    sizes = {name: abs(as_complex(response["H2"])) for name, response in responses.items()}
    maps = {name: size / slow_reference(size) for name, size in sizes.items()}
    shown = PlaneQuantity(
        maps,
        magnitude_scale(excited_values(maps, responses)),
        style.GAIN_MAP,
        r"$|H_2(f_1, f_2)|$ / own at lowest $f$, middle time",
        sizes,
        {name: response["H2_gain_low"] for name, response in responses.items()},
        {name: response["H2_gain_high"] for name, response in responses.items()},
        {
            name: style.quantity("$|H_2(f, f)|$", response["H2"].attrs["units"])
            for name, response in responses.items()
        },
        from_zero=True,
    )
    return planes_over_time(responses, shown)
