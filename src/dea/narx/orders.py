"""Choice of orders: how the error on independent data falls with dynamic and polynomial order."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from dea.errors import InputError
from dea.missing import filled
from dea.narx.candidate_terms import linear_terms
from dea.narx.checks import as_record
from dea.narx.estimation import estimate
from dea.narx.labels import Signals, inputs_in
from dea.narx.metrics import fpe, nmse
from dea.narx.model import NarxModel
from dea.narx.selection import select_terms
from dea.store import Record, variable
from dea.units import power


def linear_model(
    u: Signals | Record | Sequence[Record], y: Signals | None, order: int
) -> NarxModel:
    """Return the linear model with a constant and ``order`` lags of output and input.

    Its parameters are the least-squares estimate (4), as published.
    """
    return estimate(linear_terms(order, order, inputs_in(u)), u, y)


def compare_orders(
    u: Signals | Record | Sequence[Record],
    y: Signals | None,
    u_test: ArrayLike,
    y_test: ArrayLike,
    *,
    dynamic: int = 5,
    polynomial: int = 5,
    lags: int = 2,
    y_units: str = "1",
    **selection: Any,
) -> xr.Dataset:
    """Compare linear models of rising dynamic order and models of rising polynomial order.

    Parameters
    ----------
    u, y
        Records to identify from, as for :func:`dea.narx.select_terms`; beside a
        :class:`dea.Record`, ``y`` is None.
    u_test, y_test
        Independent record on which every model is simulated freely from its first outputs;
        missing outputs (NaN) are not scored.
    dynamic, polynomial
        Highest orders; all from 1 are tried.
    lags
        Dynamic order of the models of rising polynomial order.
    y_units
        Units of the output, for those of the final prediction error.
    selection
        Further arguments of :func:`dea.narx.select_terms`, ``search`` for instance.

    Returns
    -------
    Dataset
        As ``orders.nc`` holds it; an order whose model diverges has infinite errors.

    Raises
    ------
    InputError
        If an order is below 1, or a record is refused by :func:`dea.narx.select_terms`.
    """
    for field, given in (("dynamic", dynamic), ("polynomial", polynomial), ("lags", lags)):
        if given < 1:
            raise InputError(f"it is {given}", field=field, remedy="Orders begin at 1.")
    inputs, measured = as_record(u_test, y_test, max(dynamic, lags), 2, missing=True)
    outputs, seen = filled(measured)

    def nonlinear(order: int) -> NarxModel:
        return select_terms(u, y, y_lags=lags, u_lags=lags, degree=order, **selection)

    kinds: dict[str, tuple[int, Callable[[int], NarxModel]]] = {
        "dynamic": (dynamic, lambda order: linear_model(u, y, order)),
        "polynomial": (polynomial, nonlinear),
    }
    dataset = xr.Dataset()
    for kind, (highest, identify) in kinds.items():
        dimension = f"{kind}_order"
        orders = np.arange(1, highest + 1)
        models = [identify(int(order)) for order in orders]
        # All are scored on the samples after the largest lag of any, so that errors are comparable.
        start = max(model.max_lag for model in models)
        scored = seen & (np.arange(seen.size) >= start)
        pairs = [(outputs[scored], each.simulate(inputs, outputs)[scored]) for each in models]
        sizes = [len(model.terms) for model in models]
        columns = {
            "nmse": ([nmse(*pair) for pair in pairs], "1", "SSE/SST in free run"),
            "fpe": (
                [fpe(*pair, size) for pair, size in zip(pairs, sizes, strict=True)],
                power(y_units, 2),
                "final prediction error in free run",
            ),
            "terms": (sizes, "1", "number of terms"),
        }
        dataset[dimension] = variable(dimension, orders, "1", f"{kind} order")
        for name, (values, units, label) in columns.items():
            dataset[f"{kind}_{name}"] = variable(dimension, np.array(values), units, label)
    return dataset
