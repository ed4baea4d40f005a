"""A NARX model as an estimator of scikit-learn, for its model selection."""

from typing import Any, Self

import numpy as np

try:
    from sklearn.base import BaseEstimator, RegressorMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as missing:
    raise ImportError(
        "dea.sklearn needs scikit-learn. Install it with `pip install scikit-learn`"
    ) from missing

from dea.arrays import Array
from dea.errors import InputError
from dea.narx import SEARCHES, NarxModel, select_terms


class NarxRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Select and simulate a NARX model: rows are samples in the order of time, columns inputs.

    Cross-validate it with :class:`sklearn.model_selection.TimeSeriesSplit`; splits that shuffle
    rows take the order away.

    Parameters
    ----------
    y_lags, u_lags, degree, even_in_input
        As those of :func:`dea.select_terms`.
    search
        ``refined``, ``forward`` or ``orthogonal``; the last is the quickest.

    Attributes
    ----------
    model_
        The :class:`dea.NarxModel` found.
    """

    def __init__(
        self,
        y_lags: int = 3,
        u_lags: int = 3,
        degree: int = 3,
        even_in_input: bool = False,
        search: str = "refined",
    ) -> None:
        self.y_lags = y_lags
        self.u_lags = u_lags
        self.degree = degree
        self.even_in_input = even_in_input
        self.search = search

    def fit(self, X: Any, y: Any) -> Self:
        """Select a model from the inputs ``X``, shape (samples, inputs), and the output ``y``.

        Raises
        ------
        InputError
            As :func:`dea.select_terms`; for a search that there is not.
        """
        inputs, outputs = validate_data(self, X, y, dtype=float, y_numeric=True)
        if self.search not in SEARCHES:
            raise InputError(
                f"there is none called {self.search!r}",
                field="search",
                remedy=f"Choose one of {', '.join(SEARCHES)}",
            )
        self.model_: NarxModel = select_terms(
            inputs,
            outputs,
            y_lags=self.y_lags,
            u_lags=self.u_lags,
            degree=self.degree,
            even_in_input=self.even_in_input,
            search=SEARCHES[self.search](),
        )
        return self

    def predict(self, X: Any) -> Array:
        """Return the free run on the inputs ``X``, shape (samples,).

        It begins as that of :meth:`dea.NarxModel.simulate` does.
        """
        inputs = self._checked(X)
        return self.model_.simulate(inputs)

    def score(self, X: Any, y: Any, sample_weight: None = None) -> float:
        """Return the share of the output's variance that the free run explains (R^2).

        The run starts from the first measured outputs, which are not scored. Samples in the order
        of time have no weights.

        Raises
        ------
        InputError
            If there are weights.
        """
        if sample_weight is not None:
            raise InputError("are not used", field="sample_weight", remedy="Leave them out")
        inputs = self._checked(X)
        return self.model_.score(inputs, np.asarray(y, dtype=float))

    def _checked(self, X: Any) -> Array:
        check_is_fitted(self)
        checked: Array = validate_data(self, X, dtype=float, reset=False)
        return checked
