"""Generalised frequency response functions and zero-input responses, in physical units."""

from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dea.arrays import Array
from dea.errors import InputError
from dea.gfrf.differentiable import Differentiable
from dea.gfrf.expansion import expand
from dea.gfrf.operating_point import rest_along, rest_slope
from dea.gfrf.probing import probe
from dea.given_numbers import is_count
from dea.narx import NarxModel, rate_of
from dea.store import real_numbers
from dea.terms import input_symbol, static_value

Number = int | np.integer[Any]
Inputs = str | Number | Sequence[str | Number] | None


class Tones(NamedTuple):
    """The tones that a response is to: n frequencies, and the column of the input that each is of.

    ``omega`` are in rad per sample and broadcast.
    """

    omega: Sequence[Array]
    columns: Sequence[int]

    @property
    def shape(self) -> tuple[int, ...]:
        """That of the response."""
        return np.broadcast_shapes(*(w.shape for w in self.omega))


class OperatingPoints(NamedTuple):
    """Where a model with several sets of parameters comes to rest, normalised.

    ``theta`` (sets, terms) are the parameters, ``y0`` (sets,) the outputs at rest and ``u0``
    (inputs,) the constant inputs. The sets were given in the shape ``sets``.
    """

    theta: Array
    y0: Array
    u0: Array
    sets: tuple[int, ...]


def frequency_response(
    model: NarxModel,
    order: int = 1,
    frequencies: ArrayLike | Sequence[ArrayLike] = (),
    sampling_rate: float | None = None,
    *,
    inputs: Inputs = None,
    parameters: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
    allow_missing: bool = False,
) -> NDArray[np.complex128]:
    """Return the symmetric GFRF H_n of a polynomial NARX model around its rest.

    A small input of n tones, u = operating_point + sum_i A_i cos(w_i t), gives the output a line
    at w_1 + ... + w_n, of complex amplitude n! H_n prod_i A_i/2 in the two-sided spectrum. Of
    several inputs each tone is in one of them, and this is the symmetrised cross-kernel:
    H_n^{ij}(f1, f2) = H_n^{ji}(f2, f1), and with one signal on all inputs the sum over all i and j
    is the response to it.

    Parameters
    ----------
    order
        n, 1 or more.
    frequencies
        n arrays in Hz that broadcast like numpy, negative ones allowed; for ``order=1`` the array
        itself will do.
    sampling_rate
        In Hz; by default that of the record which the model comes from.
    inputs
        Where the model has several, the input of each frequency: its name or its number from 1, n
        of them; for ``order=1`` the name itself will do.
    parameters
        Other parameters for the model's terms, shape (..., terms), as a tracker gives them; by
        default the model's own.
    operating_point
        Constant input in physical units around which the response is taken; by default the
        input's offset, a normalised input of zero. Of several inputs, one number for each.
    allow_missing
        Give NaN for parameters that do not settle, in place of the error.

    Returns
    -------
    ndarray
        Complex, shape (..., *frequencies), in output units per the product of the n input units.

    Raises
    ------
    InputError
        If the frequencies do not fit the order, lie above half the sampling rate or do not
        broadcast, if the inputs are not n of the model's, or if the model does not come to rest at
        the operating point.
    """
    tones = tones_of(model, order, frequencies, sampling_rate, inputs)
    theta, y0, u0, sets = rests(model, parameters, operating_point, allow_missing)
    settled = ~np.isnan(y0)
    response = np.full((y0.size, *tones.shape), np.nan, dtype=complex)
    response[settled] = _probed(model, tones, theta[settled], y0[settled], u0)
    return response.reshape((*sets, *tones.shape))


def tones_of(
    model: NarxModel,
    order: int,
    frequencies: ArrayLike | Sequence[ArrayLike],
    sampling_rate: float | None,
    inputs: Inputs = None,
) -> Tones:
    """Return the tones of a response; parameters and errors are of :func:`frequency_response`."""
    omega = _radians(order, frequencies, rate_of(model.labels, sampling_rate))
    return Tones(omega, _columns(model, order, inputs))


def response_and_slope(
    model: NarxModel, tones: Tones, points: OperatingPoints
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return :func:`frequency_response` and its derivative by the model's parameters.

    The rest moves with the parameters, which the derivative allows for.

    Returns
    -------
    response, slope
        Shapes (..., *frequencies) and (terms, ..., *frequencies).
    """
    theta, y0, u0, sets = points
    shape = tones.shape
    settled = ~np.isnan(y0)
    count = len(model.terms)
    each = np.broadcast_to(np.eye(count)[:, None, :], (count, int(settled.sum()), count))
    found = _probed(
        model,
        tones,
        Differentiable(theta[settled], each),
        Differentiable(y0[settled], rest_slope(model.terms, theta[settled], y0[settled], u0)),
        u0,
    )
    response = np.full((y0.size, *shape), np.nan, dtype=complex)
    slope = np.full((count, y0.size, *shape), np.nan, dtype=complex)
    if isinstance(found, Differentiable):
        response[settled], slope[:, settled] = found.value, found.slope
    else:  # without a term of this order the response is zero whatever the parameters are
        response[settled], slope[:, settled] = found, 0.0
    return response.reshape((*sets, *shape)), slope.reshape((count, *sets, *shape))


def _probed(model: NarxModel, tones: Tones, theta: Any, y0: Any, u0: Array) -> Any:
    """Return the response, in physical units, of each set of parameters around its rest.

    ``theta`` (sets, terms), ``y0`` (sets,) and the result are all arrays or all differentiable.
    """
    across = (slice(None), *[None] * len(tones.shape))  # parameter sets lead, frequencies follow
    expanded = expand(model.terms, theta, y0, u0)
    per_set = {term: coefficient[across] for term, coefficient in expanded.items()}
    scales = np.broadcast_to(model.scaling.u_scale, model.inputs).tolist()
    scale = static_value(Counter(tones.columns), scales)
    return probe(per_set, *tones) * (model.scaling.y_scale / scale)


def zero_input_response(
    model: NarxModel,
    *,
    parameters: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
    allow_missing: bool = False,
) -> Array:
    """Return the output y0 at which the model rests when its input is constant.

    y0 solves the static polynomial of the model, (26) with the nonlinear terms. Of several roots
    it is the one that the free run from the output's offset settles to; for varying parameters
    the branch is followed from one set to the next.

    Parameters are those of :func:`frequency_response`.

    Returns
    -------
    ndarray
        Shape (...) of the sets of parameters, in output units; NaN where a set does not settle and
        ``allow_missing`` is given.

    Raises
    ------
    InputError
        If the model does not come to rest, or parameters or operating point do not fit it.
    """
    found = rests(model, parameters, operating_point, allow_missing)
    return model.scaling.restore_output(found.y0).reshape(found.sets)


def _radians(
    order: int, frequencies: ArrayLike | Sequence[ArrayLike], sampling_rate: float
) -> list[Array]:
    if not is_count(order):
        raise InputError(
            f"it is {order!r}",
            field="order",
            remedy="Give a whole number, 1 or more, before the frequencies",
        )
    given = frequencies if isinstance(frequencies, tuple) else (frequencies,)
    if len(given) != order:
        raise InputError(
            f"there are {len(given)} frequency arrays for order {order}"
            if given
            else "there is none",
            field="frequencies",
            remedy="Give an array, not a tuple, of the frequencies"
            if order == 1
            else f"Give a tuple of {order} arrays, one for each frequency of a product",
        )
    arrays = [real_numbers(f, "frequencies") for f in given]
    for f in arrays:
        if not np.isfinite(f).all():
            raise InputError(
                f"one is {f[~np.isfinite(f)].flat[0]}",
                field="frequencies",
                remedy="Give finite numbers in Hz",
            )
        bad = f[~(np.abs(f) <= 0.5 * sampling_rate)]
        if bad.size:
            raise InputError(
                f"{bad.flat[0]:g} Hz is above half the sampling rate of {sampling_rate:g} Hz",
                field="frequencies",
                remedy="Give lower ones; both are in Hz",
            )
    try:
        np.broadcast_shapes(*(f.shape for f in arrays))
    except ValueError:
        raise InputError(
            f"shapes {[f.shape for f in arrays]} do not broadcast",
            field="frequencies",
            remedy="For a map use f1[:, None] and f2[None, :]",
        ) from None
    return [2.0 * np.pi * f / sampling_rate for f in arrays]


def _parameter_sets(
    model: NarxModel, parameters: ArrayLike | None
) -> tuple[Array, tuple[int, ...]]:
    """Return the parameter sets as rows, and the shape that they were given in."""
    theta = real_numbers(model.parameters if parameters is None else parameters, "parameters")
    if theta.shape[-1:] != (len(model.terms),):
        raise InputError(
            f"their shape is {theta.shape}",
            field="parameters",
            remedy=f"The last axis has one entry for each of the {len(model.terms)} terms",
        )
    return theta.reshape(-1, len(model.terms)), theta.shape[:-1]


def _columns(model: NarxModel, order: int, inputs: Inputs) -> tuple[int, ...]:
    """Return the column of the input that each of ``order`` frequencies is of."""
    if inputs is None and model.inputs == 1:
        return (0,) * order
    names = model.labels.inputs
    known = [
        names[k][0] if len(names) == model.inputs else input_symbol(k, model.inputs)
        for k in range(model.inputs)
    ]
    listed = ", ".join(f"{name!r} or {k}" for k, name in enumerate(known, start=1))
    remedy = f"Name one for each frequency: {listed}"
    given = [inputs] if isinstance(inputs, str | int | np.integer) else list(inputs or ())
    if len(given) != order:
        raise InputError(
            f"{len(given)} are named for order {order} of a model with {model.inputs}",
            field="inputs",
            remedy=remedy,
        )
    columns = [_column(each, known) for each in given]
    for each, column in zip(given, columns, strict=True):
        if not 0 <= column < model.inputs:
            raise InputError(f"there is no input {each!r}", field="inputs", remedy=remedy)
    return tuple(columns)


def _column(given: str | Number, known: Sequence[str]) -> int:
    """Return the column of an input by its name or number, negative where there is none."""
    if isinstance(given, str):
        return known.index(given) if given in known else -1
    return int(given) - 1 if isinstance(given, int | np.integer) else -1


def _normalised_input(model: NarxModel, operating_point: ArrayLike | None) -> Array:
    """Return the operating point in the units of the equation, shape (inputs,).

    Raises
    ------
    InputError
        If it is not one finite number for each input.
    """
    if operating_point is None:
        return np.zeros(model.inputs)
    given = np.atleast_1d(real_numbers(operating_point, "operating_point"))
    if given.shape != (model.inputs,):
        raise InputError(
            f"{given.size} numbers for {model.inputs} input{'s' if model.inputs > 1 else ''}",
            field="operating_point",
            remedy="Give one number for each input, in physical units",
        )
    if not np.isfinite(given).all():
        raise InputError(
            f"it is {operating_point}",
            field="operating_point",
            remedy="Give a finite number for each input, in physical units",
        )
    return (given - model.scaling.u_offset) / model.scaling.u_scale


def rests(
    model: NarxModel,
    parameters: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
    allow_missing: bool = False,
) -> OperatingPoints:
    """Return the rests of a model; parameters are those of :func:`frequency_response`.

    Raises
    ------
    InputError
        If the model does not come to rest and ``allow_missing`` is not given, or parameters or
        operating point do not fit it.
    """
    theta, sets = _parameter_sets(model, parameters)
    u0 = _normalised_input(model, operating_point)
    y0 = rest_along(model.terms, theta, u0)
    restless = np.flatnonzero(np.isnan(y0))
    if restless.size and not allow_missing:
        which = f" with parameter set {restless[0]}" if y0.size > 1 else ""
        level = u0 * model.scaling.u_scale + model.scaling.u_offset
        raise InputError(
            f"the model{which} does not settle at a constant input of "
            f"{', '.join(f'{each:g}' for each in level)}",
            field="parameters",
            remedy="It diverges, oscillates or creeps there and has no steady-state response; "
            "take another operating point or a stable model",
        )
    return OperatingPoints(theta, y0, u0, sets)
