"""A model whose parameters follow a device sample by sample, in constant time and memory."""

from math import isinf, nan
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.control import online_kernels
from dea.errors import InputError
from dea.narx import BOUND, NarxModel, padded_lags, regressor_matrix, simulate
from dea.tracking import (
    check_settings,
    initial_state,
    normalised_signals,
    root_mean_square,
    with_constant,
)


def scale_of_record(model: NarxModel, u: ArrayLike, y: ArrayLike) -> Array:
    """Return the root mean square of each regressor of ``with_constant(model)`` in a record.

    Parameters
    ----------
    u, y
        In physical units, shape (samples,); a missing output is NaN, and filled.

    Raises
    ------
    InputError
        As :meth:`dea.narx.NarxModel.predict`.
    """
    tracked = with_constant(model)
    signals = normalised_signals(tracked, u, y)
    return root_mean_square(regressor_matrix(tracked.terms, signals.u, signals.y))


class OnlineTracker:
    """Recursive least squares (11)-(16) with forgetting and leakage, one sample at a time.

    It is the recursion of ``dea.track_parameters(method="rls")``: given the same scale of the
    regressors it finds the same parameters. A missing output, NaN, leaves the equations that it
    enters out; its place in the past of a prediction is taken by the prediction.

    Parameters
    ----------
    model
        Its parameters are the first estimate, and what the leakage pulls to. A constant is added
        where it has none (:func:`dea.tracking.with_constant`).
    scale
        Root mean square of each regressor of ``with_constant(model)``, shape (terms,): the leakage
        and ``delta`` count for regressors of one. :meth:`of_record` takes it from a record.
    forgetting, leakage, delta
        lambda, alpha and 1/P_0, as of :func:`dea.track_parameters`.

    Raises
    ------
    InputError
        If a setting is outside its range, or the scale not one positive number for each term.
    """

    def __init__(
        self,
        model: NarxModel,
        scale: ArrayLike,
        *,
        forgetting: float = 0.999,
        leakage: float = 1e-4,
        delta: float = 1.0,
    ) -> None:
        check_settings(forgetting, leakage, delta)
        self._model = with_constant(model)
        terms = self._model.terms
        self._scale = np.array(scale, dtype=float)
        if self._scale.shape != (len(terms),) or not np.all(
            np.isfinite(self._scale) & (self._scale > 0.0)
        ):
            raise InputError(
                f"it is {self._scale}",
                field="scale",
                remedy=f"Give a positive number for each of the {len(terms)} terms",
            )
        self._settings = float(forgetting), float(leakage)
        self._target = self._model.parameters * self._scale
        self._state = initial_state(self._target, self._target, delta)
        self._scaling = model.of_one_input("The online tracker")
        self._lags = (
            padded_lags([term.y_lags for term in terms]),
            padded_lags([term.u_lags for term in terms]),
        )
        self._lag = self._model.max_lag
        self._past = np.zeros((3, max(self._lag, 1)))
        self._count = 0

    @classmethod
    def of_record(
        cls,
        model: NarxModel,
        u: ArrayLike,
        y: ArrayLike,
        *,
        forgetting: float = 0.999,
        leakage: float = 1e-4,
        delta: float = 1.0,
    ) -> Self:
        """Return a tracker whose regressors have the scale of this record, in physical units.

        Raises
        ------
        InputError
            As :func:`scale_of_record`.
        """
        return cls(
            model, scale_of_record(model, u, y),
            forgetting=forgetting, leakage=leakage, delta=delta,
        )  # fmt: skip

    @property
    def model(self) -> NarxModel:
        """The model with the parameters of now."""
        return self._model.with_parameters(self.parameters)

    @property
    def parameters(self) -> Array:
        """Estimate after the last sample, in the units of the equation, shape (terms,)."""
        estimate: Array = self._state.theta / self._scale
        return estimate

    @property
    def standard_deviations(self) -> Array:
        """Standard deviations of the parameters, shape (terms,), for white noise."""
        squares, weight = self._state.sums
        if not weight:
            return np.full(self._scale.size, np.nan)
        diagonal = np.einsum("ki,ki->i", self._state.V, self._state.V)
        deviation: Array = np.sqrt(diagonal * squares / weight) / self._scale
        return deviation

    def update(self, u: float, y: float) -> float:
        """Take a sample, in physical units, and return the error of the prediction before it.

        The error is in output units; it is NaN while the past is shorter than the largest lag and
        where a measured value is missing. An output beyond 1e10 in the units of the equation, in
        which every model has diverged, is taken as missing.

        Raises
        ------
        InputError
            If the input is not a finite number, or beyond the same bound, or the output infinite.
        """
        scaling = self._scaling
        given = (u - scaling.u_offset) / scaling.u_scale
        measured = (y - scaling.y_offset) / scaling.y_scale
        if not abs(given) <= BOUND or isinf(y):
            raise InputError(
                f"the sample is u = {u}, y = {y}",
                field="u, y",
                remedy="Inputs are finite, up to 1e10 in the units of the equation, outputs finite"
                " too, or NaN where one is missing.",
            )
        innovation = online_kernels.step(
            *self._state,
            self._past,
            *self._lags,
            self._scale,
            self._target,
            *self._settings,
            given,
            measured if abs(measured) <= BOUND else nan,
            self._count >= self._lag,
        )
        self._count += 1
        return innovation * scaling.y_scale

    def predict(self, u: ArrayLike) -> Array:
        """Return the outputs of the next samples, given their inputs, with the parameters of now.

        Parameters
        ----------
        u
            Inputs of the next k samples in physical units, shape (k,).

        Returns
        -------
        ndarray
            Outputs in physical units, shape (k,): the first is the one-step prediction, the k-th
            the k-step prediction. Infinite from where the model diverges on.

        Raises
        ------
        InputError
            If fewer samples than the largest lag were taken.
        """
        lag, scaling = self._lag, self._model.scaling
        if self._count < lag:
            raise InputError(
                f"{self._count} samples were taken, and the largest lag is {lag}",
                field="tracker",
                remedy="Update it with more samples first.",
            )
        inputs, _, outputs = self._past[:, :lag][:, ::-1]
        ahead = scaling.normalise_input(np.asarray(u, dtype=float))
        run = simulate(self._model.terms, self.parameters, np.concatenate([inputs, ahead]), outputs)
        return scaling.restore_output(run[lag:])
