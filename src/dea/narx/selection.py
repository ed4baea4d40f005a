"""Selection of the terms of NARX models."""

import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dea.arrays import Segment
from dea.errors import InputError
from dea.narx.candidate_models import CandidateModels
from dea.narx.candidate_terms import InputLags, Lags, candidate_terms
from dea.narx.descent import Descent
from dea.narx.estimation import (
    LeastSquares,
    as_segments,
    least_squares,
    normalised,
    scaling_of,
)
from dea.narx.forward import forward_and_prune
from dea.narx.free_run_fit import FreeRunFit
from dea.narx.labels import Labels, Signals, inputs_in, unpacked
from dea.narx.model import NarxModel
from dea.narx.refined_search import every_run_diverges, find
from dea.narx.scaling import Scaling, require_scaling
from dea.narx.search import Forward, Orthogonal, Refined, Search
from dea.narx.stability import StabilityTest, UnstableModel, assess
from dea.narx.trace import Trace
from dea.store import Record
from dea.terms import Term, max_lag


def select_terms(
    u: Signals | Record | Sequence[Record],
    y: Signals | None = None,
    *,
    y_lags: Lags = 3,
    u_lags: InputLags = 3,
    degree: int = 3,
    even_in_input: bool = False,
    search: Search | None = None,
    scaling: Scaling | None = None,
) -> NarxModel:
    """Select the terms of a NARX model by how well it simulates.

    Starts from what forward regression with orthogonal least squares proposes, then adds, drops
    and exchanges terms while their parameters minimise the simulated error itself, as long as a
    term explains more than a threshold that falls from step to step. It ends where the noise of
    the record begins, or where the errors on parts left out no longer fall. Structures that are
    not stable on inputs like the record's are passed over.

    Parameters
    ----------
    u, y
        Measured input and output in physical units, shape (samples,), or equally long lists of
        such records, which share one model. Several inputs are the columns of ``u``, shape
        (samples, inputs), and terms call them u1, u2 and so on; of a pandas frame the model learns
        their names. Or one or several
        :class:`dea.Record` alone: their missing samples are left out, and the model carries their
        rate, units and names.
    y_lags, u_lags
        Largest lag of output and input, or the lags themselves (input lags may include 0). Of
        several inputs a list of such lists, one for each, may give each its own.
    degree
        Largest polynomial order.
    even_in_input
        Consider only terms with an even number of factors of each input, for a system whose
        response to the negated input is the same: measured by a sensor without a sign, or driven by
        a stress proportional to V^2. The input is then scaled about zero.
    search
        :class:`~dea.narx.Refined` (the default) with its settings;
        :class:`~dea.narx.Forward`, the paper's; or :class:`~dea.narx.Orthogonal`.
    scaling
        By default mean and half-range of the records; ``Scaling()`` takes them as they are.

    Returns
    -------
    NarxModel
        With covariance, scaling, the trace of all candidate models, and :meth:`NarxModel.stability`
        of its final parameters.

    Warns
    -----
    UnstableModel
        If no structure found is stable; :attr:`Stability.status` of the model says so as well.

    Raises
    ------
    InputError
        If the records are not usable or too short, a setting is not one that there is, or if no
        model's run on them is bounded.
    """
    found = search_terms(
        u, y, y_lags=y_lags, u_lags=u_lags, degree=degree, even_in_input=even_in_input,
        search=search, scaling=scaling,
    )  # fmt: skip
    fit = found.fit or least_squares(found.terms, found.segments)
    return _model(found.terms, fit, found.scale, found.labels, found.test, found.trace)


class Searched(NamedTuple):
    """The terms that a search found for one system, and what it found them on."""

    terms: tuple[Term, ...]
    fit: FreeRunFit | None  # where the search refines parameters
    segments: list[Segment]  # normalised
    scale: Scaling
    labels: Labels
    test: StabilityTest
    trace: Trace


def search_terms(
    u: Signals | Record | Sequence[Record],
    y: Signals | None = None,
    *,
    y_lags: Lags = 3,
    u_lags: InputLags = 3,
    degree: int = 3,
    even_in_input: bool = False,
    search: Search | None = None,
    scaling: Scaling | None = None,
) -> Searched:
    """Search as :func:`select_terms` does, which makes and assesses a model of what is found."""
    _check_search(search, Refined, Forward, Orthogonal)
    candidates = _candidates(y_lags, u_lags, degree, even_in_input, inputs_in(u))
    lag, linear = max_lag(candidates), _linear(candidates)
    inputs, outputs, labels = unpacked(u, y, lag, linear)
    records = as_segments(inputs, outputs, lag, linear)
    scale = scaling_of(records, not even_in_input) if scaling is None else scaling
    require_scaling(scale)
    segments, trace = normalised(records, scale), Trace()
    test = StabilityTest(segments)
    if isinstance(search, Forward | Orthogonal):
        terms, fit = _by_least_squares(candidates, segments, search, trace), None
    else:
        terms, (fit,) = find(candidates, [segments], [test], search or Refined(), trace)
    return Searched(terms, fit, segments, scale, labels, test, trace)


def least_stretch(
    u: Signals | Record | Sequence[Record],
    *,
    y_lags: Lags = 3,
    u_lags: InputLags = 3,
    degree: int = 3,
    even_in_input: bool = False,
    **_: Any,
) -> tuple[int, int]:
    """Return the largest lag of a search, and how many equations a stretch of a record must hold.

    Parameters are those of :func:`select_terms`, of which the others do not matter.
    """
    candidates = _candidates(y_lags, u_lags, degree, even_in_input, inputs_in(u))
    return max_lag(candidates), _linear(candidates)


def select_common_terms(
    records: Sequence[Record | tuple[Signals, Signals]],
    *,
    y_lags: Lags = 3,
    u_lags: InputLags = 3,
    degree: int = 3,
    even_in_input: bool = False,
    search: Refined | None = None,
) -> list[NarxModel]:
    """Select one structure for several systems, each with parameters of its own.

    The search is that of :func:`select_terms`; the error is the mean over the systems of their
    simulated errors, each as a share of its output's mean square.

    Parameters
    ----------
    records
        A :class:`dea.Record` of each system, or its input and output as for :func:`select_terms`.

    Other parameters are those of :func:`select_terms`.

    Returns
    -------
    list of NarxModel
        One for each system, all with the same terms in the same order.

    Raises
    ------
    InputError
        If the records are no list, or there is none, as well as for what :func:`select_terms`
        refuses.
    """
    _check_search(search, Refined)
    if isinstance(records, Record) or not len(records):
        raise _unpaired("it is one" if isinstance(records, Record) else "there is none")
    pairs = [_pair(each, number) for number, each in enumerate(records, start=1)]
    inputs = inputs_in(pairs[0][0])
    candidates = _candidates(y_lags, u_lags, degree, even_in_input, inputs)
    lag, linear = max_lag(candidates), _linear(candidates)
    known = [unpacked(*pairs[0], lag, linear)]
    for u, y in pairs[1:]:
        # Frames of the same names come in one order.
        first = known[0][2] if known[0][2].names_columns_of(u) else None
        known.append(unpacked(u, y, lag, linear, first))
    checked = [as_segments(u, y, lag, linear) for u, y, _ in known]
    scales = [scaling_of(each, not even_in_input) for each in checked]
    systems = [normalised(*each) for each in zip(checked, scales, strict=True)]
    trace, tests = Trace(), [StabilityTest(segments) for segments in systems]
    found = find(candidates, systems, tests, search or Refined(), trace)
    return [
        _model(found.terms, fit, scale, labels, test, trace)
        for fit, scale, test, (_, _, labels) in zip(found.fits, scales, tests, known, strict=True)
    ]


def _pair(system: Any, number: int) -> tuple[Any, Any]:
    """Return input and output of a system, or its record and None."""
    if isinstance(system, Record):
        return system, None
    if not isinstance(system, list | tuple) or len(system) != 2:
        raise _unpaired(f"system {number} is {type(system).__name__}")
    return system[0], system[1]


def _unpaired(problem: str) -> InputError:
    return InputError(
        problem,
        field="records",
        remedy="Give a list, with a record or a pair of signals of each system.",
    )


def _check_search(search: Any, *known: type) -> None:
    if search is not None and not isinstance(search, known):
        each = " or ".join(f"dea.narx.{kind.__name__}()" for kind in known)
        raise InputError(f"{search!r}", field="search", remedy=f"Give {each}")


def _by_least_squares(
    candidates: tuple[Term, ...],
    segments: Sequence[Segment],
    search: Forward | Orthogonal,
    trace: Trace,
) -> tuple[Term, ...]:
    """Return the terms that a search with least-squares parameters finds."""
    most = len(candidates) if search.max_terms is None else search.max_terms
    if isinstance(search, Forward):
        models = CandidateModels(candidates, segments)
        linear = tuple(j for j, term in enumerate(candidates) if term.degree <= 1)
        thresholds = search.add_threshold, search.prune_threshold
        subset = forward_and_prune(models, linear, *thresholds, most, trace)
        error = models([subset])[0].msse
    else:
        steps = Descent(candidates, [segments], trace).orthogonal(most)
        subset, fit = min(steps, key=lambda step: step.fit.error)
        error = fit.error
    if not np.isfinite(error):
        raise every_run_diverges()
    return tuple(candidates[j] for j in subset)


def _model(
    terms: tuple[Term, ...],
    fit: FreeRunFit | LeastSquares,
    scale: Scaling,
    labels: Labels,
    test: StabilityTest,
    trace: Trace,
) -> NarxModel:
    checked = assess(terms, fit.parameters, scale, test)
    if not checked.stable:
        warnings.warn(str(checked), UnstableModel, stacklevel=3)
    return NarxModel(
        terms,
        fit.parameters,
        scale,
        fit.covariance,
        trace.to_dataset(),
        fit.withheld,
        checked,
        labels,
    )


def _candidates(
    y_lags: Lags, u_lags: InputLags, degree: int, even_in_input: bool, inputs: int
) -> tuple[Term, ...]:
    candidates = candidate_terms(y_lags, u_lags, degree, inputs)
    if even_in_input:
        return tuple(
            term
            for term in candidates
            if all(power % 2 == 0 for power in term.input_powers.values())
        )
    return candidates


def _linear(candidates: Sequence[Term]) -> int:
    return sum(term.degree <= 1 for term in candidates)
