"""A tracked model's frequency responses set against the best linear approximation, as a dataset."""

from typing import NamedTuple, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea.arrays import Array, Complex
from dea.nonparametric.agreement import RelativeBand, compare_intermodulation, compare_response
from dea.nonparametric.best_linear import BestLinear
from dea.nonparametric.intermodulation import Intermodulation, intermodulation, signed
from dea.store import complex_parts, variable

# Dimensions, values, units and label of each variable.
Variables: TypeAlias = dict[str, tuple[tuple[str, ...], Array | NDArray[np.int8], str, str]]
_LINES = ("stretch", "frequency")
_EVEN = ("stretch", "even_frequency")


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
    measured: xr.Dataset,
    found: list[BestLinear],
    modelled: list[Modelled],
    highest: float,
    even_above: float,
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
    even_above
        Part of the predicted power of an even line that pairs of lines in the band make up, from
        which the line is judged.

    Returns
    -------
    xarray.Dataset
        As ``confirmation.nc`` holds it.
    """
    frequency = measured["frequency"].values
    step = frequency[0] / found[0].lines[0]
    last = int(highest / step + 1e-9)
    even = [
        intermodulation(each, model.H2, last) for each, model in zip(found, modelled, strict=True)
    ]
    variables = {
        **_of_models(modelled, measured["response"].attrs["units"]),
        "in_band": (
            ("frequency",),
            (frequency <= highest * (1 + 1e-9)).astype(np.int8),
            "1",
            "1 where the model was identified",
        ),
        **_of_ratios(even, even_above),
        **_of_agreements(found, modelled),
        **_of_even_lines(found, even, measured["output_level"].attrs["units"]),
        **_of_even_agreements(found, even, modelled, last),
    }
    result = measured.assign({name: variable(*each) for name, each in variables.items()})
    lines = variable("even_frequency", even[0].lines * step, "Hz", "frequency of an even line")
    return result.assign_coords(even_frequency=lines)


def _of_models(modelled: list[Modelled], units: str) -> Variables:
    H1 = np.stack([model.H1 for model in modelled])
    gain, phase = np.abs(H1), np.degrees(np.angle(H1))
    factor = 1.0 + np.stack([model.band.gain for model in modelled])
    phase_band = np.degrees(np.stack([model.band.phase for model in modelled]))
    low, high = "lower end of its 95 % band", "upper end of its 95 % band"
    return {
        "model": ((*_LINES, "part"), complex_parts(H1), units, "first-order response of the model"),
        "model_gain_low": (_LINES, gain / factor, units, low),
        "model_gain_high": (_LINES, gain * factor, units, high),
        "model_phase_low": (_LINES, phase - phase_band, "degree", low),
        "model_phase_high": (_LINES, phase + phase_band, "degree", high),
    }


def _of_ratios(even: list[Intermodulation], even_above: float) -> Variables:
    in_band = np.stack([each.in_band for each in even])
    return {
        "ratio": (
            (*_EVEN, "part"),
            complex_parts(np.stack([each.ratio for each in even])),
            "1",
            "even line measured over predicted from the second-order response",
        ),
        "even_in_band": (
            _EVEN,
            in_band,
            "1",
            "1 less the squared part of the prediction by pairs of lines outside the band",
        ),
        "even_judged": (
            _EVEN,
            (in_band >= even_above).astype(np.int8),
            "1",
            "1 where pairs of lines in the band make up enough of the prediction to judge it",
        ),
    }


def _of_agreements(found: list[BestLinear], modelled: list[Modelled]) -> Variables:
    each = [
        compare_response(measured, model.H1, model.band)
        for measured, model in zip(found, modelled, strict=True)
    ]
    return {
        "gain_difference": (
            _LINES,
            np.stack([one.gain for one in each]),
            "1",
            "relative difference of the measured gain from the model's",
        ),
        "phase_difference": (
            _LINES,
            np.degrees(np.stack([one.phase for one in each])),
            "degree",
            "difference of the measured phase from the model's",
        ),
        "gain_band": (
            _LINES,
            np.stack([one.gain_band for one in each]),
            "1",
            "half-width of the joint 95 % band of the relative difference",
        ),
        "phase_band": (
            _LINES,
            np.degrees(np.stack([one.phase_band for one in each])),
            "degree",
            "half-width of the joint 95 % band of the difference",
        ),
        "inside": (
            _LINES,
            np.stack([one.inside for one in each]).astype(np.int8),
            "1",
            "1 where gain and phase agree within their joint 95 % band",
        ),
    }


def _of_even_lines(found: list[BestLinear], even: list[Intermodulation], units: str) -> Variables:
    noise = [
        np.sqrt(each.output_noise[:, lines.lines]) for each, lines in zip(found, even, strict=True)
    ]
    return {
        f"even_{name}": (
            _EVEN,
            np.stack([_level(one) for one in coefficients]),
            units,
            f"even line, {name}, root mean square over realisations",
        )
        for name, coefficients in (
            ("measured", [lines.measured for lines in even]),
            ("predicted", [lines.predicted for lines in even]),
            ("noise", noise),
        )
    }


def _of_even_agreements(
    found: list[BestLinear], even: list[Intermodulation], modelled: list[Modelled], last: int
) -> Variables:
    inside = np.abs(signed(found[0].lines)) <= last
    radius = np.stack([np.full(even[0].lines.size, model.radius(inside)) for model in modelled])
    agree = [compare_intermodulation(*each) for each in zip(even, radius, strict=True)]
    return {
        "ratio_radius": (
            _EVEN,
            np.hypot(np.stack([lines.radius for lines in even]), radius),
            "1",
            "radius of the joint 95 % disc of the ratio",
        ),
        "even_inside": (
            _EVEN,
            np.stack(agree).astype(np.int8),
            "1",
            "1 where the ratio is 1 within its joint 95 % disc",
        ),
    }


def _level(coefficients: Complex | Array) -> Array:
    """Root mean square over realisations."""
    return np.asarray(np.sqrt(np.mean(np.abs(coefficients) ** 2, axis=0)))
