"""The linear part of a NARX model around its rest, with its derivative by the parameters."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.gfrf.differentiable import Differentiable
from dea.gfrf.expansion import expand
from dea.gfrf.operating_point import rest_slope
from dea.gfrf.response import rests
from dea.narx import NarxModel
from dea.terms import Term


class LinearPart(NamedTuple):
    """Y(t) = sum_k outputs[k - 1] Y(t-k) + sum_k inputs[k] U(t-k), of deviations from the rest.

    ``outputs`` (..., order) and ``inputs`` (..., order + 1) are in output and input units;
    ``outputs_slope`` and ``inputs_slope``, with an axis of the terms in front, are their
    derivatives by the parameters, which move the rest too.
    """

    outputs: Array
    inputs: Array
    outputs_slope: Array
    inputs_slope: Array


def linear_part(
    model: NarxModel,
    *,
    parameters: ArrayLike | None = None,
    operating_point: ArrayLike | None = None,
) -> LinearPart:
    """Return the linear part of a model around its rest at a constant input.

    Parameters are those of :func:`dea.frequency_response`.

    Raises
    ------
    InputError
        If the model does not come to rest at the operating point.
    """
    theta, y0, u0, sets = rests(model, parameters, operating_point)
    count = theta.shape[1]
    each = np.broadcast_to(np.eye(count)[:, None, :], (count, y0.size, count))
    expanded = expand(
        model.terms,
        Differentiable(theta, each),
        Differentiable(y0, rest_slope(model.terms, theta, y0, u0)),
        u0,
    )
    # The terms of a model may number its only input.
    plain = {monomial._replace(inputs=()): value for monomial, value in expanded.items()}
    order = max(model.max_lag, 1)
    scaling = model.of_one_input("The linear part")
    gain = scaling.y_scale / scaling.u_scale

    def of(monomials: list[Term], scale: float) -> tuple[Array, Array]:
        value = np.zeros((y0.size, len(monomials)))
        slope = np.zeros((count, y0.size, len(monomials)))
        for column, monomial in enumerate(monomials):
            if monomial in plain:
                value[:, column] = scale * plain[monomial].value
                slope[:, :, column] = scale * plain[monomial].slope
        return value.reshape(*sets, -1), slope.reshape(count, *sets, -1)

    outputs, outputs_slope = of([Term((k,)) for k in range(1, order + 1)], 1.0)
    inputs, inputs_slope = of([Term((), (k,)) for k in range(order + 1)], gain)
    return LinearPart(outputs, inputs, outputs_slope, inputs_slope)
