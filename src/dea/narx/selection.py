"""Term selection by simulated error reduction."""

from collections.abc import Callable, Sequence

import numpy as np

from dea.errors import InputError
from dea.narx.candidate_models import CandidateModels, Subset
from dea.narx.candidate_terms import candidate_terms
from dea.narx.estimation import (
    Signals,
    as_segments,
    least_squares,
    normalised,
    reason_to_withhold,
    scaling_of,
)
from dea.narx.exchange import Exchange
from dea.narx.model import NarxModel
from dea.narx.refinement import fit_free_runs
from dea.narx.scaling import Scaling
from dea.narx.trace import Trace, Tried, gain
from dea.terms import max_lag


def select_terms(
    u: Signals,
    y: Signals,
    *,
    y_lags: int | Sequence[int] = 3,
    u_lags: int | Sequence[int] = 3,
    degree: int = 3,
    even_in_input: bool = False,
    add_threshold: float = 1e-5,
    prune_threshold: float = 1e-5,
    refine: bool = True,
    rounds: int = 50,
    max_terms: int | None = None,
    scaling: Scaling | None = None,
) -> NarxModel:
    """Select the terms of a NARX model by how well it simulates.

    Starts from the linear basis and adds, one at a time, the term with the *largest* simulated
    error reduction ratio SERR (5)-(9), then removes terms by the same ratio. Every candidate model
    is re-estimated by least squares (4) and simulated freely over the whole record; an unstable one
    has an infinite error. With ``refine``, the structure is then improved by adding, dropping and
    exchanging terms while their parameters minimise the simulated error itself; models that leave
    the measured range by far on the time-reversed inputs of the records are rejected.

    Parameters
    ----------
    u, y
        Measured input and output in physical units, shape (samples,), or equally long lists of
        such records, which share one model.
    y_lags, u_lags
        Largest lag of output and input, or the lags themselves (input lags may include 0).
    degree
        Largest polynomial order.
    even_in_input
        Consider only terms with an even number of inputs, for a system whose response to the
        negated input is the same: measured by a sensor without a sign, or driven by a stress
        proportional to V^2. The input is then scaled about zero.
    add_threshold
        SERR below which no term is added; also the cost of a term while refining. SERR is a
        share of the mean square of the normalised output.
    prune_threshold
        Terms are removed while the removal raises the error by less than this, as SERR.
    refine
        False gives the forward selection and pruning alone, with least-squares parameters.
    rounds
        Largest number of accepted steps of the refining search; 0 refines the parameters alone.
    max_terms
        The model has at most this many terms; pruning goes on until it does.
    scaling
        By default mean and half-range of the records; ``Scaling()`` takes them as they are.

    Returns
    -------
    NarxModel
        With covariance, scaling and the trace of all candidate models.

    Raises
    ------
    InputError
        If the records are not usable or too short, or if no stable model is found.
    """
    candidates = candidate_terms(y_lags, u_lags, degree)
    if even_in_input:
        candidates = tuple(term for term in candidates if len(term.u_lags) % 2 == 0)
    linear = tuple(j for j, term in enumerate(candidates) if term.degree <= 1)
    records = as_segments(u, y, max_lag(candidates), len(linear))
    scale = scaling_of(records, not even_in_input) if scaling is None else scaling
    segments = normalised(records, scale)
    models, trace = CandidateModels(candidates, segments), Trace()
    most = len(candidates) if max_terms is None else max_terms
    if most < 1:
        raise InputError(f"it is {most}", field="max_terms", remedy="Allow at least one term.")
    subset = forward_and_prune(models, linear, add_threshold, prune_threshold, most, trace)
    theta = models([subset])[0].parameters
    if refine:
        exchange = Exchange(candidates, segments, models.power, add_threshold)
        subset, theta = exchange.search(subset, theta, rounds, most, trace)
    terms = tuple(candidates[j] for j in subset)
    if refine:
        theta, covariance, error = fit_free_runs(terms, theta, segments)
        withheld = ""
    else:
        _, covariance = least_squares(terms, segments)
        withheld = reason_to_withhold(terms, theta, segments)
        error = models([subset])[0].msse
    if not np.isfinite(error):
        raise InputError(
            "every model of these terms diverges in free run",
            field="y_lags, u_lags, degree",
            remedy="Allow other lags or a lower degree, or use a longer record.",
        )
    return NarxModel(terms, theta, scale, covariance, trace.to_dataset(), withheld)


def forward_and_prune(
    models: CandidateModels,
    basis: Subset,
    add_threshold: float,
    prune_threshold: float,
    most: int,
    trace: Trace,
) -> Subset:
    """Add the term of largest SERR, then remove the term of least, while that pays."""
    names = [str(term) for term in models.candidates]
    error = models([basis])[0].msse
    # SERR of the basis (9) is its error itself, not a reduction.
    trace.add("basis", 0, [Tried("linear basis", error, error / models.power)], 0, "added")

    def grow(subset: Subset) -> dict[str, Subset]:
        free = [j for j in range(len(names)) if j not in subset] if len(subset) < most else []
        return {names[j]: tuple(sorted((*subset, j))) for j in free}

    def shrink(subset: Subset) -> dict[str, Subset]:
        removable = subset if len(subset) > 1 else ()
        return {names[j]: tuple(i for i in subset if i != j) for j in removable}

    grown = _descend(models, basis, grow, lambda _: add_threshold, trace, ("forward", "added"))

    def least_gain(subset: Subset) -> float:
        return -prune_threshold if len(subset) <= most else -np.inf

    return _descend(models, grown, shrink, least_gain, trace, ("pruning", "pruned"))


def _descend(
    models: CandidateModels,
    subset: Subset,
    moves: Callable[[Subset], dict[str, Subset]],
    least_gain: Callable[[Subset], float],
    trace: Trace,
    labels: tuple[str, str],
) -> Subset:
    """Take the move of least simulated error while its SERR (5) is at least ``least_gain``."""
    phase, status = labels
    error, step = models([subset])[0].msse, 0
    while options := moves(subset):
        step += 1
        errors = [outcome.msse for outcome in models(options.values())]
        gains = [gain(error, after, models.power) for after in errors]
        best = int(np.argmin(errors))
        accepted = gains[best] >= least_gain(subset)
        tried = [Tried(*each) for each in zip(options, errors, gains, strict=True)]
        trace.add(phase, step, tried, best if accepted else None, status)
        if not accepted:
            break
        subset, error = list(options.values())[best], errors[best]
    return subset
