"""Magnitude of the third-order frequency response H3(f1, f2, f3) at chosen times, f3 held."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from dea.figures import style
from dea.figures.frequency_maps import as_complex, magnitude_scale, slow_reference
from dea.figures.planes_over_time import PlaneQuantity, excited_values, planes_over_time
from dea.store import Sources


def draw(sources: Sources) -> Figure:
    """Draw it from ``gfrf.nc`` of one or several systems."""
    return fig4_h3(sources.datasets("gfrf"))


@style.styled
def fig4_h3(responses: Mapping[str, xr.Dataset]) -> Figure:
    """Draw |H3| (contract ``gfrf``, by the systems' names) on the plane of one third frequency.

    The maps show it relative to the system's own at the lowest frequencies and the middle time;
    the curves show |H3(f, f, f3)| in physical units. It has no band. The systems have one input.
    """
    sizes = {name: abs(as_complex(response["H3"])) for name, response in responses.items()}
    maps = {name: size / slow_reference(size) for name, size in sizes.items()}
    # A share of the sampling rate, which systems may not have in common.
    each = [f"{float(response['frequency_3']):.3g}" for response in responses.values()]
    third = ", ".join(dict.fromkeys(each))
    shown = PlaneQuantity(
        maps,
        magnitude_scale(excited_values(maps, responses)),
        style.GAIN_MAP,
        rf"$|H_3(f_1, f_2,$ {third} Hz$)|$ / own at lowest $f$, middle time",
        sizes,
        {},
        {},
        {
            name: style.quantity(rf"$|H_3(f, f,$ {held} Hz$)|$", response["H3"].attrs["units"])
            for held, (name, response) in zip(each, responses.items(), strict=True)
        },
        from_zero=True,
    )
    return planes_over_time(responses, shown)
