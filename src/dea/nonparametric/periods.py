"""Whole periods of the realisations of a periodic excitation, cut from a record."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.given_numbers import is_positive
from dea.store import signals


class Periods(NamedTuple):
    """Input and output of one stretch, shape (realisations, periods, samples of a period).

    ``time`` is the middle of the stretch in s.
    """

    u: Array
    y: Array
    time: float


def periods_of(record: xr.Dataset, period: float) -> list[Periods]:
    """Cut the probing stretches of a record into realisations and periods.

    Parameters
    ----------
    record
        With ``probing(time)``, the number of the stretch that a sample is in, from 1, or 0, and
        ``realisation(time)``, the number of its multisine in that stretch, from 1, or 0.
    period
        In s.

    Raises
    ------
    InputError
        If the period is no positive number, there is no such stretch, a realisation is interrupted,
        holds samples that are flagged or not finite or no two whole periods, or a stretch has fewer
        than two realisations.
    """
    for name in ("probing", "realisation"):
        if name not in record:
            raise InputError(
                "the variable is missing",
                field=name,
                remedy="Number the samples of whole periods by stretch and realisation, from 1; 0"
                " elsewhere.",
            )
    if not is_positive(period):
        raise InputError(
            f"it is {period!r}", field="period", remedy="Give the period of the excitation in s."
        )
    whole = signals(record)
    length = round(period * whole.sampling_rate)
    if abs(length / whole.sampling_rate - period) > 1e-6 * period or length < 2:
        raise InputError(
            f"{period:g} s is not a whole number of samples at {whole.sampling_rate:g} Hz",
            field="period",
            remedy="Give the period of the excitation in s.",
        )
    probing, realisation = record["probing"].values, record["realisation"].values
    found = []
    for stretch in np.unique(probing[probing > 0]):
        inside = np.flatnonzero((probing == stretch) & (realisation > 0))
        cut = [
            _cut(inside[realisation[inside] == number], length, int(stretch))
            for number in np.unique(realisation[inside])
        ]
        count = min((part.shape[0] for part in cut), default=0)
        if len(cut) < 2 or count < 2:
            raise InputError(
                f"stretch {stretch} holds {len(cut)} realisations of {count} whole periods",
                field="realisation",
                remedy="Two of each at least tell noise and nonlinear distortion apart.",
            )
        at = np.stack([part[:count] for part in cut])
        missing = int(np.count_nonzero(np.isnan(whole.y[at])))
        if missing:
            raise InputError(
                f"{missing} samples of stretch {stretch} are flagged or not finite; responses over"
                " whole periods need every sample",
                field="quality",
                remedy="Record the multisines again, or cut the stretch.",
            )
        middle = float(whole.time[[inside[0], inside[-1]]].mean())
        found.append(Periods(whole.u[at], whole.y[at], middle))
    if not found:
        raise InputError(
            "no sample belongs to a stretch",
            field="probing",
            remedy="Number the samples of whole periods from 1.",
        )
    return found


def _cut(samples: NDArray[np.int64], length: int, stretch: int) -> NDArray[np.int64]:
    """Return the indices of whole periods, shape (periods, length)."""
    if samples[-1] - samples[0] != samples.size - 1:
        raise InputError(
            f"a realisation of stretch {stretch} is interrupted",
            field="realisation",
            remedy="Give samples that follow each other without a gap",
        )
    count = samples.size // length
    return samples[: count * length].reshape(count, length)
