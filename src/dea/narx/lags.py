"""Lags of a model from the record it is identified from, by the error on parts left out."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.autocovariance import autocovariance
from dea.errors import InputError
from dea.inputs import input_count
from dea.narx.candidate_terms import InputLags, Lags, input_lag_lists, lag_list
from dea.narx.checks import as_record, as_signal, refuse_missing
from dea.narx.held_out import check_parts, held_out_error
from dea.narx.labels import Labels, pair
from dea.narx.model import NarxModel
from dea.narx.search import Refined
from dea.narx.selection import select_terms
from dea.progress import tell
from dea.store import Record

_COUNTS = (2, 3)  # output lags
_FINEST = 5  # spacings of lags in the time until the autocorrelation is least
_REACHES = (2, 3, 4, 5)  # such times over which inputs without a sign act
_EVEN_COUNTS = (2, 3, 4)  # output lags of a model that is even in its input
_CUTS = (3, 4, 5)  # numbers of parts into which a record is cut
_LONGEST = 0.1  # share of the record that the largest lag may be


class LagChoice(NamedTuple):
    """Lags of the output and those of the inputs: the same for all, or a tuple for each."""

    y_lags: tuple[int, ...]
    u_lags: tuple[int, ...] | tuple[tuple[int, ...], ...]


class Compared(NamedTuple):
    """A setting that was tried."""

    lags: LagChoice
    threshold: float | None  # None where it came from the record
    error: float  # held-out, geometric mean over the cuts, units of the output
    model: NarxModel


def select_lags(
    u: ArrayLike | Record,
    y: ArrayLike | None = None,
    choices: Sequence[tuple[Lags, InputLags]] | None = None,
    *,
    degree: int = 3,
    even_in_input: bool = False,
    thresholds: Sequence[float | None] = (None,),
    cuts: Sequence[int] = _CUTS,
) -> list[Compared]:
    """Select the terms for each choice of lags, and order the models by their held-out errors.

    Each model is that of :func:`dea.select_terms`. Its error is :func:`dea.narx.held_out_error`,
    geometric mean over several numbers of parts, since one way of cutting a short record ranks
    models by where the cuts happen to be. All runs start after the longest lag of all models.

    Parameters
    ----------
    u, y
        One record, as for :func:`dea.narx.held_out_error`.
    choices
        Pairs of output lags and input lags, as for :func:`dea.select_terms`. By default
        :func:`dea.narx.lag_choices` of the record, none of which leaves out the first lags: give
        input lags that begin after a pure delay where there may be one, as ``(3, [10, 11, 12])``.
        Those from which nothing can be selected, or that are longer than a part, are left out.
    degree, even_in_input
        As for :func:`dea.select_terms`.
    thresholds
        Tried with each choice; None is that which the record gives. On a few hundred samples the
        folds of the default search leave too little to select from, and lower ones may do better.
    cuts
        The numbers of parts.

    Returns
    -------
    list of Compared
        The least error first. Models whose :meth:`~dea.NarxModel.stability` is not ``stable`` come
        last, those that are ``slow`` (a pole too slow for the record) included.

    Raises
    ------
    InputError
        If there is nothing to choose from, no choice is left, or an output is missing.
    """
    given = pair(Labels(), u, y, 1)
    refuse_missing(given[1], "Give a part without a missing sample, as record.part(first, last)")
    inputs, outputs = as_record(*given)
    offered: Sequence[tuple[Lags, InputLags]] = (
        lag_choices(outputs, even_in_input=even_in_input) if choices is None else choices
    )
    _check_offered(offered, thresholds, cuts)
    settings = [_choice(y_lags, u_lags, input_count(inputs)) for y_lags, u_lags in offered]
    found: list[tuple[LagChoice, float | None, NarxModel]] = []
    refused: list[InputError] = []
    for lags, threshold in product(settings, thresholds):
        try:
            for parts in cuts:
                check_parts(parts, outputs.size, _longest(lags))
            model = select_terms(
                *((u,) if isinstance(u, Record) else (inputs, outputs)),
                y_lags=lags.y_lags, u_lags=lags.u_lags, degree=degree,
                even_in_input=even_in_input, search=Refined(threshold),
            )  # fmt: skip
        except InputError as refusal:
            tell(f"lags {lags.y_lags} and {lags.u_lags} are left out: {refusal}")
            refused.append(refusal)
            continue
        tell(f"lags {lags.y_lags} and {lags.u_lags}: {len(model.terms)} terms")
        found.append((lags, threshold, model))
    if not found:
        raise refused[0]
    longest = max(_longest(lags) for lags, _, _ in found)
    compared = []
    for lags, threshold, model in found:
        errors = [
            held_out_error(model, inputs, outputs, parts=parts, start=longest) for parts in cuts
        ]
        error = float(np.exp(np.mean(np.log(errors))))
        tell(f"lags {lags.y_lags} and {lags.u_lags}: held-out error {error:.3g}")
        compared.append(Compared(lags, threshold, error, model))
    return sorted(compared, key=lambda each: (not each.model.stability().stable, each.error))


def _check_offered(
    choices: Sequence[Any], thresholds: Sequence[float | None], cuts: Sequence[int]
) -> None:
    if not choices or not thresholds or not cuts:
        raise InputError(
            "there is nothing to choose from",
            field="choices, thresholds, cuts",
            remedy="Give at least one of each.",
        )
    for each in choices:
        if not isinstance(each, Sequence) or len(each) != 2:
            raise InputError(
                f"one is {each!r}",
                field="choices",
                remedy="Give pairs of output lags and input lags, as (3, [10, 11, 12])",
            )


def lag_choices(y: ArrayLike, *, even_in_input: bool = False) -> list[LagChoice]:
    """Return lags worth comparing for an output, shape (samples,).

    The unit is the lag at which the autocorrelation of the output, or of its square where that is
    earlier, has its first minimum. Where a record is sampled faster than a fifth of it, terms of
    neighbouring lags are nearly equal, and lags further apart distinguish them: S. A. Billings and
    L. A. Aguirre, Int. J. Bifurcation and Chaos 5 (1995) 1541-1556. So two or three lags of output
    and input alike are spaced by 1 to a fifth of it, in steps of the root of two.

    Where only terms even in the input are offered, the sign of the response shows in products of
    inputs alone, over as long as the system rings. Then the inputs reach over two to five times the
    time until the output's autocorrelation is least, every lag, or every second from the first or
    the second on, beside two to four lags of the output.

    No lag is longer than a tenth of the record. For a record shorter than 20 samples the only
    choice is lags 1 and 2.

    Raises
    ------
    InputError
        If the output is not one-dimensional, or a sample of it is missing.
    """
    outputs = as_signal(y, "y")
    centred = outputs - outputs.mean()
    if even_in_input:
        unit = _first_least(centred)
        found = [
            LagChoice(tuple(range(1, count + 1)), tuple(range(first, times * unit + 1, spacing)))
            for count in _EVEN_COUNTS
            for times in _REACHES
            for spacing, first in ((1, 1), (2, 1), (2, 2))
        ]
    else:
        unit = min(_first_least(centred), _first_least(centred**2 - np.mean(centred**2)))
        found = [
            LagChoice(lags, lags)
            for count in _COUNTS
            for spacing in _spacings(unit // _FINEST)
            for lags in [tuple(1 + spacing * k for k in range(count))]
        ]
    most = _LONGEST * outputs.size
    return [lags for lags in found if _longest(lags) <= most] or [LagChoice((1, 2), (1, 2))]


def _choice(y_lags: Lags, u_lags: InputLags, inputs: int) -> LagChoice:
    of_each = [tuple(lags) for lags in input_lag_lists(u_lags, inputs)]
    same = all(lags == of_each[0] for lags in of_each)
    return LagChoice(tuple(lag_list(y_lags, "y_lags")), of_each[0] if same else tuple(of_each))


def _longest(lags: LagChoice) -> int:
    return max((*lags.y_lags, *(max(np.atleast_1d(each)) for each in lags.u_lags)), default=0)


def _spacings(most: int) -> Iterator[int]:
    """Yield 1, 2, 3, 4, 6, 8, 11, 16 and so on up to ``most``; 1 in any case."""
    spacing, power = 1, 0.0
    while spacing <= max(most, 1):
        yield spacing
        power += 0.5
        while round(2.0**power) <= spacing:
            power += 0.5
        spacing = round(2.0**power)


def _first_least(centred: Array) -> int:
    """Return the first lag of less autocorrelation than all up to half as far again.

    A fifth of the record where it falls all along.
    """
    samples = centred.size
    far = max(samples // 2, 2)
    correlation = autocovariance(centred, far)
    for lag in range(1, far - 1):
        if correlation[lag - 1] > correlation[lag] == correlation[lag : lag + lag // 2 + 2].min():
            return lag
    return max(samples // 5, 1)
