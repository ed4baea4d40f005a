"""What the maps of frequency responses share: complex values, hatching, colours."""

from collections.abc import Iterable, Mapping
from textwrap import wrap

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from dea.arrays import Array
from dea.figures import style
from dea.store import signals

_PER_MM = 0.72  # characters of a note below the maps
_DECADE = 10.0
_VEIL, _VEIL_ALPHA = "#C9C9C9", 0.65


def as_complex(response: xr.DataArray) -> xr.DataArray:
    """Return the complex values of a response stored with a last dimension ``part``."""
    values = response.sel(part="real") + 1j * response.sel(part="imag")
    return values.drop_vars("part", errors="ignore").assign_attrs(response.attrs)


def one_by_one(responses: Mapping[str, xr.Dataset], dimension: str) -> dict[str, xr.Dataset]:
    """Return the response of each input, or of each ``pair`` of several, as if of its own system.

    Their names follow those of the systems; a system with one input stays as it is.
    """
    found: dict[str, xr.Dataset] = {}
    for name, response in responses.items():
        if dimension not in response.dims:
            found[name] = response
            continue
        for k, label in enumerate(response[dimension].values.tolist()):
            part = response.isel({dimension: k}, drop=True)
            for variable in part.data_vars:
                if dimension in response[variable].dims:
                    units = response[variable].attrs["units"].split(", ")
                    part[variable].attrs["units"] = units[k if len(units) > 1 else 0]
            found[f"{name}, {label}"] = part
    return found


def system_of(names: Iterable[str], part: str) -> str:
    """Return which of the systems ``names`` a response of :func:`one_by_one` is of."""
    return next(name for name in names if part == name or part.startswith(f"{name}, "))


def slow_reference(size: xr.DataArray) -> float:
    """Return a magnitude at the lowest frequencies, at the time nearest the middle that has one.

    Its dimensions are a time and frequencies. Times without a steady state, or of magnitude zero
    there, are passed over; it is missing if none is left, and one where the magnitude is zero
    everywhere, as of a model without terms of that order or input.
    """
    if size.max() == 0.0:
        return 1.0
    lowest = {name: 0 for name in size.dims if str(name).startswith("frequency")}
    slow = size.isel(lowest).values
    known = np.flatnonzero(np.isfinite(slow) & (slow > 0.0))
    if not known.size:
        return float("nan")
    return float(slow[known[np.argmin(np.abs(known - slow.size // 2))]])


def hatch(ax: Axes, x: Array, y: Array, where: NDArray[np.bool_]) -> None:
    """Grey and hatch the cells ``where`` (shape (y, x)) the input held no power."""
    if not where.any():
        return
    cells = where.astype(float)
    ax.contourf(x, y, cells, [0.5, 1.5], colors=[_VEIL], alpha=_VEIL_ALPHA)
    ax.contourf(x, y, cells, [0.5, 1.5], colors="none", hatches=["////"])
    if not where.all():
        ax.contour(x, y, cells, [0.5], colors=[style.BLACK], linewidths=0.6)


def veil_handle() -> Patch:
    """Return the legend's entry for what :func:`hatch` marks."""
    return Patch(
        facecolor=_VEIL, edgecolor=style.BLACK, hatch="////", lw=0.4,
        label="no excitation here: the model extrapolates",
    )  # fmt: skip


def missing_handles(maps: Mapping[str, xr.DataArray]) -> list[Patch]:
    """Return the legend's entry for missing values, if there are any."""
    if not any(bool(values.isnull().any()) for values in maps.values()):
        return []
    return [
        Patch(facecolor="white", edgecolor=style.BLACK, lw=0.4,
              label="the model of that time has no steady state")
    ]  # fmt: skip


def reservations(responses: Mapping[str, xr.Dataset], width: float, *, banded: bool = True) -> str:
    """Return which systems have no band and why, and whose estimate is another than asked for.

    In lines that fit a figure of ``width`` mm; of bands only where it shows them (``banded``).
    """
    reasons: dict[str, list[str]] = {}
    for name, response in responses.items():
        if banded and response.attrs["withheld"]:
            reasons.setdefault(f"no 95 % band: {response.attrs['withheld']}", []).append(name)
        elif response.attrs["estimator"] != response.attrs["tracker"]:
            said = f"parameters of {response.attrs['estimator']}, not {response.attrs['tracker']}"
            reasons.setdefault(said, []).append(name)
    return "\n".join(
        line
        for reason, names in reasons.items()
        for line in wrap(f"{', '.join(names)}: {reason}", int(_PER_MM * width))
    )


def common_moment(of_each: Iterable[str], part: float) -> str:
    """Say when: the moment in each record, or the part of each where the moments differ."""
    moments = set(of_each)
    return moments.pop() if len(moments) == 1 else f"{100 * part:.0f} % of the record"


def magnitude_scale(trusted: Array) -> Normalize:
    """Return the colour scale of the magnitudes ``trusted``, logarithmic if they span a decade.

    Without any finite positive one, as for a model that has no steady state, it is 0 to 1.
    """
    positive = trusted[np.isfinite(trusted) & (trusted > 0)]
    if not positive.size:
        return Normalize(0.0, 1.0)
    low, high = positive.min(), positive.max()
    return LogNorm(low, high) if high > _DECADE * low else Normalize(low, high)


def phase_scale(trusted: Array) -> Normalize:
    """Return the colour scale of phases (degrees); -180 to 0 without any finite one."""
    finite = trusted[np.isfinite(trusted)]
    return Normalize(finite.min(), finite.max()) if finite.size else Normalize(-180.0, 0.0)


def phase_without_delay(
    response: xr.DataArray, record: xr.Dataset
) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the phase (degrees) without the delay of one sample, and what that adds to the angle.

    It is unwrapped along the frequencies, at whose sum the delay acts. Zero stands where the
    ``response`` (complex) is zero.
    """
    angle = response.copy(data=np.degrees(np.angle(response)))
    unwrapped, total = angle, xr.DataArray(0.0)
    for axis in (str(name) for name in response.dims if str(name).startswith("frequency")):
        turned = np.unwrap(unwrapped, axis=response.get_axis_num(axis), period=360.0)
        unwrapped, total = unwrapped.copy(data=turned), total + response[axis]
    delay = 360.0 * total / signals(record).sampling_rate
    added = (unwrapped - angle + delay).where(response != 0.0, 0.0)
    return (angle + added).transpose(*response.dims), added


def colour_bar(figure: Figure, mesh: QuadMesh, axes: NDArray[np.object_], label: str) -> None:
    """Draw one colour bar beside all maps."""
    bar = figure.colorbar(mesh, ax=axes, label=label, aspect=45, pad=0.01)
    if isinstance(mesh.norm, LogNorm):
        style.plain_log_ticks(bar.ax.yaxis)
