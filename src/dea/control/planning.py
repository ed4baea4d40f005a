"""The inverse of a model along a reference that is known ahead."""

import numpy as np

from dea.arrays import Array
from dea.control.limits import InputLimits, are_limits
from dea.control.planning_kernels import Equation, improve
from dea.errors import InputError
from dea.narx import NarxModel, padded_lags, rate_of
from dea.tracking import with_constant


class RecedingHorizonInverse:
    """The inputs of the next samples, with which a model follows a reference.

    The inputs minimise the squared errors over the horizon and ``smoothness`` times their squared
    second differences, in the units of the equation. The first is applied and the rest is where the
    next sample begins: one Gauss-Newton step for each sample (real-time iteration: M. Diehl et al.,
    J. Process Control 12 (2002) 577-585). The step knows no limits. After it every input in turn is
    brought within limits and rate, so that a plan that meets them is not the minimum.

    The model is run freely: its past outputs are its own, so that the plan is a feedforward and
    the margins of the feedback beside it hold.

    Parameters
    ----------
    model
        Whose inverse is wanted; a constant is added to it where it has none.
    horizon
        Samples that the plan looks ahead.
    smoothness
        Weight of the second differences. It makes the inverse of a system bounded whose own inverse
        is not.
    lowest, highest, rate
        Of the input, in its units, the last per second.
    sampling_rate
        In Hz. By default that of the model's own record.

    Raises
    ------
    InputError
        If a setting is out of range, or the rate not known or not the model's own.
    """

    def __init__(
        self,
        model: NarxModel,
        *,
        horizon: int,
        smoothness: float,
        lowest: float,
        highest: float,
        rate: float,
        sampling_rate: float | None = None,
    ) -> None:
        limited = are_limits(lowest, highest) and rate > 0.0
        if horizon < 3 or not (0.0 < smoothness < np.inf and limited):
            raise InputError(
                f"a horizon of {horizon}, smoothness {smoothness:g}, inputs from {lowest:g} to"
                f" {highest:g} at {rate:g} per second",
                field="horizon, smoothness, lowest, highest, rate",
                remedy="Take three samples or more, finite limits that rise, positive numbers.",
            )
        self.model, self.horizon, self._smoothness = with_constant(model), horizon, smoothness
        self._scaling = scaling = model.of_one_input("A controller")
        terms = self.model.terms
        self.equation = Equation(
            self.model.parameters,
            padded_lags([term.y_lags for term in terms]),
            padded_lags([term.u_lags for term in terms]),
        )
        self._ends = lowest, highest
        low, high = ((end - scaling.u_offset) / scaling.u_scale for end in self._ends)
        step = rate / rate_of(model.labels, sampling_rate)
        self._limits = InputLimits(low, high, step / scaling.u_scale)
        self._past = max(self.model.max_lag, 2)  # the second differences reach back so far
        self._u, self._y = np.zeros((2, self._past + horizon))

    def rest(self, u: float, y: float) -> None:
        """Begin at a constant input and output.

        Raises
        ------
        InputError
            If the input is outside its limits.
        """
        lowest, highest = self._ends
        if not lowest <= u <= highest:
            raise InputError(
                f"it rests at {u:g}, and inputs go from {lowest:g} to {highest:g}",
                field="u",
                remedy="Begin at an input within the limits.",
            )
        self._u[:] = (u - self._scaling.u_offset) / self._scaling.u_scale
        self._y[:] = (y - self._scaling.y_offset) / self._scaling.y_scale

    def step(self, reference: Array, parameters: Array | None = None) -> float | None:
        """Return the input of this sample, None where the model diverges.

        Parameters
        ----------
        reference
            Output wanted at this sample and the next ones, shape (horizon,).
        parameters
            Of ``model``, shape (terms,), where they are others than its own.

        Raises
        ------
        InputError
            If the reference is of another length, or not finite.
        """
        if reference.shape != (self.horizon,) or not np.isfinite(reference).all():
            raise InputError(
                _described(reference),
                field="reference",
                remedy=f"Give the horizon of {self.horizon} finite numbers.",
            )
        scaling = self._scaling
        bounded = improve(
            self.equation if parameters is None else self.equation._replace(theta=parameters),
            self._y,
            self._u,
            (reference - scaling.y_offset) / scaling.y_scale,
            self._smoothness,
            self._limits,
        )
        return self._restored(float(self._u[self._past])) if bounded else None

    def _restored(self, u: float) -> float:
        """Return an input in its units; at a limit exactly that, which rounding would miss."""
        lowest, highest = self._ends
        if u <= self._limits.lowest:
            return lowest
        if u >= self._limits.highest:
            return highest
        return min(max(u * self._scaling.u_scale + self._scaling.u_offset, lowest), highest)

    def advance(self) -> float:
        """Let the sample become the past; return the output that the model has at it."""
        u, y = self._u, self._y
        output = float(y[self._past] * self._scaling.y_scale + self._scaling.y_offset)
        u[:-1], y[:-1] = u[1:].copy(), y[1:].copy()
        u[-1] = min(max(2.0 * u[-2] - u[-3], self._limits.lowest), self._limits.highest)
        return output

    def shift(self, samples: int, u: float, y: float) -> None:
        """Add to the input and output that lie so many samples back, in their units."""
        self._u[self._past - samples] += u / self._scaling.u_scale
        self._y[self._past - samples] += y / self._scaling.y_scale

    @property
    def past(self) -> int:
        """Samples of the past that the plan depends on."""
        return self._past


def inverse_of(inverse: RecedingHorizonInverse, reference: Array, u: float, y: float) -> Array:
    """Return the inputs with which the inverse's model, at rest at first, follows a reference.

    Parameters
    ----------
    inverse
        It is set to the rest, and then to where the reference ends.
    reference
        Output wanted, shape (samples,); after its end it is held.
    u, y
        Input and output at rest.

    Returns
    -------
    ndarray
        Shape (samples,), in units of the input.

    Raises
    ------
    InputError
        If the model diverges on the way, the reference is empty or not finite, or the rest outside
        the limits.
    """
    if not (reference.ndim == 1 and reference.size and np.isfinite(reference).all()):
        raise InputError(
            _described(reference),
            field="reference",
            remedy="Give the output wanted at each sample.",
        )
    inverse.rest(u, y)
    ahead = np.concatenate([reference, np.full(inverse.horizon, reference[-1])])
    inputs = np.empty(reference.size)
    for k in range(reference.size):
        found = inverse.step(ahead[k : k + inverse.horizon])
        if found is None:
            raise InputError(
                f"the model diverges at sample {k} of the reference",
                field="model",
                remedy="Identify it from a record that reaches as far, or narrow the reference.",
            )
        inputs[k] = found
        inverse.advance()
    return inputs


def _described(signal: Array) -> str:
    return f"it is of shape {signal.shape}, with {np.isfinite(signal).sum()} finite values"
