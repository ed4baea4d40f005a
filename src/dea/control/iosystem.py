"""A NARX model as a nonlinear system of python-control."""

from typing import TYPE_CHECKING, Any

import numpy as np

from dea.arrays import Array
from dea.control.c_code import has_feedthrough, input_lags, output_lags
from dea.narx import NarxModel, rate_of

if TYPE_CHECKING:
    from control import NonlinearIOSystem


def to_iosystem(
    model: NarxModel, sampling_rate: float | None = None, *, name: str = "narx"
) -> "NonlinearIOSystem":
    """Return ``model`` as a discrete-time system of python-control, input ``u`` and output ``y``.

    Input and output are in physical units. The states are the past outputs, the latest first, and
    the past inputs after them, in the units of the equation, so that the state zero is the rest at
    the operating point from which :meth:`dea.narx.NarxModel.simulate` begins too. Where the model
    diverges the output is infinite or not a number.

    Parameters
    ----------
    sampling_rate
        In Hz. By default that of the model's own record.
    """
    import control

    rate = rate_of(model.labels, sampling_rate)
    outputs, inputs = output_lags(model), input_lags(model)
    scaling = model.of_one_input("A system of python-control")

    def equation(state: Array, u: float) -> float:
        past_u = (u, *state[outputs:])
        total = 0.0
        for term, parameter in zip(model.terms, model.parameters.tolist(), strict=True):
            monomial = parameter
            for lag in term.y_lags:
                monomial *= state[lag - 1]
            for lag in term.u_lags:
                monomial *= past_u[lag]
            total += monomial
        return total

    def normalised(u: Array) -> float:
        return float((np.ravel(u)[0] - scaling.u_offset) / scaling.u_scale)

    def update(t: float, x: Array, u: Array, params: dict[str, Any]) -> Array:
        now = normalised(u)
        return np.concatenate(
            [[equation(x, now)], x[: outputs - 1], [now], x[outputs : outputs + inputs - 1]]
        )

    def output(t: float, x: Array, u: Array, params: dict[str, Any]) -> float:
        # Without feedthrough the output is asked for before the input is known.
        now = normalised(u) if has_feedthrough(model) else 0.0
        return equation(x, now) * scaling.y_scale + scaling.y_offset

    return control.nlsys(
        update,
        output,
        inputs=["u"],
        outputs=["y"],
        states=[f"y{k}" for k in range(1, outputs + 1)] + [f"u{k}" for k in range(1, inputs + 1)],
        dt=1.0 / rate,
        name=name,
    )
