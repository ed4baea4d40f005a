"""The inverse of any simulation along a whole reference, known from beginning to end."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.arrays import Array
from dea.control.limits import InputLimits, limited
from dea.errors import InputError

_STEPS = 8  # of Gauss-Newton at most
_SHARES = (1.0, 0.5, 0.25, 0.125)  # of a step, tried in turn until one is better
_ENOUGH = 0.01  # part of its error that a step must remove for another to follow


class InverseInputs(NamedTuple):
    """Inputs, shape (samples,), and the RMS error that the simulation has with them."""

    inputs: Array
    error: float


def whole_inverse(
    simulate: Callable[[Array], Array],
    reference: Array,
    begun: Array,
    *,
    memory: int,
    change: float,
    weight: float,
    limits: InputLimits,
) -> InverseInputs:
    """Return the inputs with which a simulation follows a reference.

    They minimise the squared errors and ``weight`` times their squared second differences. The
    simulation is a black box: its Jacobian is a band, of which every ``memory``-th column is found
    by one run in which the inputs of those samples are changed together (A. Curtis, M. Powell and
    J. Reid, IMA J. Applied Mathematics 13 (1974) 117-119). What it remembers for longer slows the
    Gauss-Newton steps down and does not change where they end. The steps know no limits. After
    each every input in turn is brought within them, so that inputs that meet them are not the
    minimum.

    Parameters
    ----------
    simulate
        Inputs (samples,) to outputs (samples,).
    reference
        Outputs wanted, (samples,); NaN before they begin, in two samples at least.
    begun
        The inputs to begin with. Those of the samples without a reference are kept, the others
        first brought within the limits.
    memory
        Samples for which an input acts on the output.
    change
        Of an input, of which the effect is linear.
    weight
        Of the second differences, in squared units of the output per squared unit of the input.
    limits
        Of the inputs.

    Raises
    ------
    InputError
        If the simulation diverges on the way, an output is wanted from the beginning or none is,
        inputs are not as many, or a setting is out of range.
    """
    _check_settings(memory, change, weight, limits)
    wanted = np.isfinite(reference)
    first = _check_signals(wanted, begun, limits)

    def missing(inputs: Array) -> Array:
        return np.where(wanted, reference - simulate(inputs), 0.0)

    def cost(inputs: Array, error: Array) -> float:
        return float(error @ error + weight * np.sum(np.diff(inputs, 2) ** 2))

    inputs = begun.copy()
    _limit(inputs, first, limits)
    error = missing(inputs)
    if not np.isfinite(error).all():
        raise _diverges(error)
    best = cost(inputs, error)
    for _ in range(_STEPS):
        band = _band(missing, inputs, error, first, memory, change)
        step = _step(band, error[first:], np.diff(inputs, 2)[first - 2 :], weight)
        before = best
        for share in _SHARES:
            tried = inputs.copy()
            tried[first:] += share * step
            _limit(tried, first, limits)
            error_tried = missing(tried)
            # A run that diverges costs NaN, which is not less.
            if cost(tried, error_tried) < best:
                inputs, error, best = tried, error_tried, cost(tried, error_tried)
                break
        if not best < (1.0 - _ENOUGH) * before:
            break
    return InverseInputs(inputs, float(np.sqrt(np.mean(error[wanted] ** 2))))


def _check_settings(memory: int, change: float, weight: float, limits: InputLimits) -> None:
    limits.check()
    for name, value, possible in (
        ("memory", memory, memory >= 1),
        ("change", change, 0.0 < change < np.inf),
        ("weight", weight, 0.0 < weight < np.inf),
    ):
        if not possible:
            raise InputError(f"it is {value:g}", field=name, remedy="Take a positive number.")


def _check_signals(wanted: NDArray[np.bool_], begun: Array, limits: InputLimits) -> int:
    """Return the first sample at which an output is wanted."""
    if wanted.sum() < 2:
        raise InputError(
            "fewer than two outputs are wanted",
            field="reference",
            remedy="Give finite ones, after two samples or more without one (NaN).",
        )
    first = int(np.argmax(wanted))
    if first < 2:
        raise InputError(
            f"an output is wanted from sample {first} on",
            field="reference",
            remedy="Put two samples without one (NaN) before it.",
        )
    if begun.shape != wanted.shape:
        raise InputError(
            f"it has {begun.size} samples, and the reference {wanted.size}",
            field="begun",
            remedy="Give an input for each.",
        )
    kept = begun[:first]
    if not np.all((limits.lowest <= kept) & (kept <= limits.highest)):
        raise InputError(
            f"its inputs before the reference go from {kept.min():g} to {kept.max():g}",
            field="begun",
            remedy=f"Keep them from {limits.lowest:g} to {limits.highest:g}, the limits.",
        )
    return first


def _diverges(error: Array) -> InputError:
    return InputError(
        f"the simulation diverges at sample {int(np.argmin(np.isfinite(error)))} of the reference",
        field="simulation",
        remedy="Correct its parameters, or narrow the reference.",
    )


def _band(
    missing: Callable[[Array], Array], inputs: Array, error: Array, first: int, memory: int,
    change: float,
) -> Array:  # fmt: skip
    """Return what input ``first + j`` adds to the output k samples later, [j, k]."""
    size = inputs.size - first
    band = np.zeros((size, memory))
    for begin in range(memory):
        changed = inputs.copy()
        changed[first + begin :: memory] += change
        effect = np.zeros(-(-size // memory) * memory + memory)
        beside = missing(changed)
        if not np.isfinite(beside).all():
            raise _diverges(beside)
        effect[:size] = ((error - beside) / change)[first:]
        columns = band[begin::memory]
        columns[:] = effect[begin : begin + columns.size].reshape(columns.shape)
    return band


def _step(band: Array, error: Array, curves: Array, weight: float) -> Array:
    """Return the least-squares step; ``curves`` are the second differences of the inputs now."""
    from scipy.linalg import solveh_banded

    size, memory = band.shape
    normal = np.zeros((max(memory, 3), size))  # lower form of solveh_banded
    slope = np.zeros(size)
    for lag in range(min(memory, size)):
        slope[: size - lag] += band[: size - lag, lag] * error[lag:]
        for k in range(memory - lag):
            normal[lag, : size - lag] += band[: size - lag, k + lag] * band[lag:, k]
    normal[0] += weight * np.concatenate([np.full(size - 2, 6.0), [5.0, 1.0]])
    normal[1, :-1] -= weight * np.concatenate([np.full(size - 2, 4.0), [2.0]])
    normal[2, :-2] += weight
    slope -= weight * curves
    slope[:-1] += 2.0 * weight * curves[1:]
    slope[:-2] -= weight * curves[2:]
    step: Array = solveh_banded(normal, slope, lower=True)
    return step


@njit(cache=True)
def _limit(inputs: Array, first: int, limits: InputLimits) -> None:
    for k in range(first, inputs.size):
        inputs[k] = limited(inputs[k], inputs[k - 1], limits)
