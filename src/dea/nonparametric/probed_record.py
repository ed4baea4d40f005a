"""The best linear approximation of a record with probing stretches, as a labelled dataset."""

from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from dea.errors import InputError
from dea.nonparametric.best_linear import BestLinear, Lines, best_linear
from dea.nonparametric.periods import Periods, periods_of
from dea.store import Described, complex_parts, read_record, signals, variable
from dea.units import ratio


class Estimates(NamedTuple):
    """The best linear approximation in each probing stretch of a record.

    ``stretches`` are the periods and ``found`` the estimates from them, one each; ``dataset`` is
    what :func:`best_linear_approximation` returns.
    """

    stretches: list[Periods]
    found: list[BestLinear]
    dataset: xr.Dataset


def best_linear_approximation(
    record: xr.Dataset | str | Path,
    *,
    period: float | None = None,
    drift: int = 3,
    excited_above: float = 0.01,
) -> xr.Dataset:
    """Measure the best linear approximation in each probing stretch of a record.

    The best linear approximation is the linear response that explains most of the output for
    inputs of this spectrum (Pintelon and Schoukens 2012, chapter 3). No model is involved: see
    :func:`dea.nonparametric.best_linear` for the robust method that estimates it.

    Parameters
    ----------
    record
        An xarray.Dataset or its file, with ``time`` in s, ``input`` and ``output`` with their
        units (or ``voltage`` and ``displacement``), and ``probing(time)`` and
        ``realisation(time)``, which number the samples of whole periods from 1 by stretch and by
        multisine, and hold 0 elsewhere.
    period
        Of the multisines in s; by default the record's attribute ``probing_period``.
    drift
        Order of the polynomial in time that outputs are freed of.
    excited_above
        Share of the strongest line's input amplitude above which a line is excited. Weaker lines of
        the multisine count as not excited, and the output there as distortion.

    Returns
    -------
    xarray.Dataset
        Over (stretch, frequency), excited frequencies in Hz: ``response(..., part)`` in output
        units per input unit; its standard deviations ``response_noise`` by noise and
        ``response_std`` by noise and nonlinear distortion, and ``distortion``, the standard
        deviation of the response to one realisation by nonlinear distortion alone; the 95 % bands
        ``gain_low``, ``gain_high``, ``phase_low``, ``phase_high`` (degrees), which hold zero and a
        whole turn where the response is not told from zero; ``excited_level``, the root mean
        square of the output's Fourier coefficients in output units. Over (stretch,
        detection_frequency), lines that are not excited: the same as ``output_level``, and
        ``output_noise``, what of it noise explains; ``odd`` (detection_frequency) is 1 at odd and 0
        at even lines.

    Raises
    ------
    InputError
        If the record does not number stretches and realisations, its period is unknown,
        realisations hold fewer than two whole periods or samples that are missing, ``drift`` is
        not an order, or ``excited_above`` no share.
    """
    return estimates(record, period=period, drift=drift, excited_above=excited_above).dataset


def estimates(
    record: xr.Dataset | str | Path,
    *,
    period: float | None = None,
    drift: int = 3,
    excited_above: float = 0.01,
) -> Estimates:
    """Return what :func:`best_linear_approximation` does, with the estimates it is made from.

    Parameters and errors are the same.
    """
    if not isinstance(record, xr.Dataset | str | PathLike):
        raise InputError(
            f"it is a {type(record).__name__}, which does not number stretches and realisations",
            field="record",
            remedy="Give the path of the record, or its dataset (dea.read_record)",
        )
    content = record if isinstance(record, xr.Dataset) else read_record(record)
    units = signals(content)
    u_units = units.unit_of_one_input("A measured response")
    length = content.attrs.get("probing_period", None) if period is None else period
    if length is None:
        raise InputError(
            "the period of the multisines is not known",
            field="period",
            remedy="Give it in s, or as the record's attribute probing_period.",
        )
    stretches = periods_of(content, length)
    found = [best_linear(stretch, drift, excited_above) for stretch in stretches]
    if any(not np.array_equal(each.lines, found[0].lines) for each in found):
        raise InputError(
            "the stretches excite different lines",
            field="probing",
            remedy="Take a record with one multisine design.",
        )
    times = np.array([stretch.time for stretch in stretches])
    dataset = labelled(found, times, float(length), (u_units, units.y_units))
    return Estimates(stretches, found, dataset)


def labelled(
    found: list[BestLinear], time: np.ndarray, period: float, units: tuple[str, str]
) -> xr.Dataset:
    """Return the estimates of all stretches as :func:`best_linear_approximation` does."""
    first, (u, y) = found[0], units
    gain_units = ratio(y, u)
    response = np.stack([each.response for each in found])
    half = np.stack([each.half_width() for each in found])
    gain, angle = np.abs(response), np.degrees(np.angle(response))
    turn = np.where(half < gain, np.degrees(half / gain), 180.0)
    detection = first.detection
    coefficient = "Fourier coefficient of the output, root mean square over realisations"

    def at_lines(values: np.ndarray, unit: str, name: str) -> Described:
        return variable(("stretch", "frequency"), values, unit, name)

    def elsewhere(variances: np.ndarray, name: str) -> Described:
        return variable(("stretch", "detection_frequency"), np.sqrt(variances), y, name)

    def power(lines: Lines) -> np.ndarray:
        return np.stack([np.mean(np.abs(each.output[:, lines]) ** 2, axis=0) for each in found])

    def std(variances: list[np.ndarray], name: str) -> Described:
        return at_lines(np.sqrt(np.stack(variances)), gain_units, f"standard deviation {name}")

    def hertz(values: np.ndarray, name: str) -> Described:
        return variable(name, values / period, "Hz", name.replace("_", " "))

    return xr.Dataset(
        {
            "response": variable(
                ("stretch", "frequency", "part"),
                complex_parts(response),
                gain_units,
                "best linear approximation",
            ),
            "response_noise": std([each.noise for each in found], "by noise"),
            "response_std": std([each.total for each in found], "by noise and distortion"),
            "distortion": std(
                [each.distortion for each in found], "by nonlinear distortion, one realisation"
            ),
            "gain_low": at_lines(
                np.maximum(gain - half, 0.0), gain_units, "lower end of the gain's 95 % band"
            ),
            "gain_high": at_lines(gain + half, gain_units, "upper end of the gain's 95 % band"),
            "phase_low": at_lines(angle - turn, "degree", "lower end of the phase's 95 % band"),
            "phase_high": at_lines(angle + turn, "degree", "upper end of the phase's 95 % band"),
            "excited_level": at_lines(np.sqrt(power(first.lines)), y, coefficient),
            "output_level": elsewhere(power(detection), coefficient),
            "output_noise": elsewhere(
                np.stack([np.mean(each.output_noise[:, detection], axis=0) for each in found]),
                "standard deviation of that coefficient by noise",
            ),
            "odd": variable(
                "detection_frequency",
                (detection % 2).astype(np.int8),
                "1",
                "1 at odd lines, 0 at even ones",
            ),
        },
        coords={
            "time": variable("stretch", time, "s", "middle of the stretch"),
            "frequency": hertz(first.lines, "frequency"),
            "detection_frequency": hertz(detection, "detection_frequency"),
            "part": variable("part", ["real", "imag"], "1", "part"),
        },
    )
