"""A tracked model's frequency responses set against the best linear approximation, as a dataset."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea.nonparametric.agreement import RelativeBand, compare_intermodulation, compare_response
from dea.nonparametric.best_linear import BestLinear
from dea.nonparametric.intermodulation import Complex, intermodulation, signed
from dea.nonparametric.periods import Array


class Modelled(NamedTuple):
    """The responses of a model at the time of a stretch, with their bands.

    ``H1`` (lines,), and ``H2`` at all pairs of signed lines.
    """

    H1: Complex
    band: RelativeBand
    H2: Complex
    H2_band: RelativeBand

    def radius(self, inside: NDArray[np.bool_]) -> float:
        """Return the radius of the disc of an even line's prediction, relative to it.

        The errors of H2 at all pairs have one cause, the parameters, and so hardly cancel: it is
        that of the median pair of signed lines ``inside`` the band.
        """
        return float(np.median(self.H2_band.radius()[np.ix_(inside, inside)]))


def confirmation(
    measured: xr.Dataset, found: list[BestLinear], modelled: list[Modelled], highest: float
) -> xr.Dataset:
    """Add what a model says, and whether it agrees, to a best linear approximation.

    Parameters
    ----------
    measured, found
        The approximation as a dataset and its estimates, by stretch.
    modelled
        The model's responses, by stretch.
    highest
        The highest frequency, in Hz, at which the model was identified: the end of the band.

    Returns
    -------
    xarray.Dataset
        As ``confirmation.nc`` holds it.
    """
    frequency = measured["frequency"].values
    step = frequency[0] / found[0].lines[0]
    last = int(highest / step + 1e-9)
    agreements = [
        compare_response(each, model.H1, model.band)
        for each, model in zip(found, modelled, strict=True)
    ]
    even = [
        intermodulation(each, model.H2, last) for each, model in zip(found, modelled, strict=True)
    ]
    units = measured["response"].attrs["units"]
    output_units = measured["output_level"].attrs["units"]
    H1 = np.stack([model.H1 for model in modelled])
    gain, phase = np.abs(H1), np.degrees(np.angle(H1))
    gain_band = gain * np.stack([model.band.gain for model in modelled])
    phase_band = np.degrees(np.stack([model.band.phase for model in modelled]))
    at_lines = ("stretch", "frequency")
    at_even = ("stretch", "even_frequency")
    variables: dict[str, tuple[tuple[str, ...], Array, str, str]] = {
        "model": ((*at_lines, "part"), _parts(H1), units, "first-order response of the model"),
        "model_gain_low": (at_lines, gain - gain_band, units, "lower end of its 95 % band"),
        "model_gain_high": (at_lines, gain + gain_band, units, "upper end of its 95 % band"),
        "model_phase_low": (at_lines, phase - phase_band, "degree", "lower end of its 95 % band"),
        "model_phase_high": (at_lines, phase + phase_band, "degree", "upper end of its 95 % band"),
        "in_band": (
            ("frequency",),
            (frequency <= highest * (1 + 1e-9)).astype(np.int8),
            "1",
            "1 where the model was identified",
        ),
        "ratio": (
            (*at_even, "part"),
            _parts(np.stack([each.ratio for each in even])),
            "1",
            "even line measured over predicted from the second-order response",
        ),
        "even_in_band": (
            at_even,
            np.stack([each.in_band for each in even]),
            "1",
            "1 less the squared part of the prediction by pairs of lines outside the band",
        ),
    }
    for name, field, units_of, label in (
        ("gain_difference", "gain", "1",
         "relative difference of the measured gain from the model's"),
        ("phase_difference", "phase", "degree",
         "difference of the measured phase from the model's"),
        ("gain_band", "gain_band", "1",
         "half-width of the joint 95 % band of the relative difference"),
        ("phase_band", "phase_band", "degree",
         "half-width of the joint 95 % band of the difference"),
    ):  # fmt: skip
        values = np.stack([getattr(each, field) for each in agreements])
        values = np.degrees(values) if units_of == "degree" else values
        variables[name] = (at_lines, values, units_of, label)
    variables["inside"] = (
        at_lines,
        np.stack([each.inside for each in agreements]).astype(np.int8),
        "1",
        "1 where gain and phase agree within their joint 95 % band",
    )
    pairs = list(zip(found, even, strict=True))
    for name, levels in (
        ("measured", [_level(lines.measured) for lines in even]),
        ("predicted", [_level(lines.predicted) for lines in even]),
        ("noise", [_level(np.sqrt(each.output_noise[:, lines.lines])) for each, lines in pairs]),
    ):
        label = f"even line, {name}, root mean square over realisations"
        variables[f"even_{name}"] = (at_even, np.stack(levels), output_units, label)
    inside = np.abs(signed(found[0].lines)) <= last
    radius = np.stack([np.full(even[0].lines.size, model.radius(inside)) for model in modelled])
    variables["ratio_radius"] = (
        at_even,
        np.hypot(np.stack([lines.radius for lines in even]), radius),
        "1",
        "radius of the joint 95 % disc of the ratio",
    )
    variables["even_inside"] = (
        at_even,
        np.stack(
            [compare_intermodulation(*each) for each in zip(even, radius, strict=True)]
        ).astype(np.int8),
        "1",
        "1 where the ratio is 1 within its joint 95 % disc",
    )
    result = measured.assign(
        {
            name: (dims, values, {"units": unit, "long_name": label})
            for name, (dims, values, unit, label) in variables.items()
        }
    )
    about = {"units": "Hz", "long_name": "frequency of an even line"}
    return result.assign_coords(even_frequency=("even_frequency", even[0].lines * step, about))


def _parts(values: Complex) -> Array:
    return np.stack([values.real, values.imag], axis=-1)


def _level(coefficients: Complex | Array) -> Array:
    """Root mean square over realisations."""
    return np.asarray(np.sqrt(np.mean(np.abs(coefficients) ** 2, axis=0)))
