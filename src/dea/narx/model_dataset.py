"""A model as labelled data."""

from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from dea.store import Text, each_text, variable

if TYPE_CHECKING:
    from dea.narx.model import NarxModel


def model_dataset(model: "NarxModel", u_units: Text | None, y_units: str | None) -> xr.Dataset:
    """Return what :meth:`dea.NarxModel.to_dataset` does."""
    known = model.labels
    u_units, y_units = u_units or known.u_units, y_units or known.y_units
    of_inputs = ", ".join(dict.fromkeys(each_text(u_units)))
    scaling = {
        name: variable(
            ("input",)[: np.ndim(value)], np.asarray(value), units, f"{what} of the {signal}"
        )
        for (name, value), (signal, what, units) in zip(
            vars(model.scaling).items(),
            [
                (signal, what, units)
                for signal, units in (("input", of_inputs), ("output", y_units))
                for what in ("offset", "scale")
            ],
            strict=True,
        )
    }
    dataset = xr.Dataset(
        {
            "parameter": variable("term", model.parameters, "1", "parameter of the term"),
            **scaling,
        },
        coords={"term": variable("term", list(map(str, model.terms)), "1", "term")},
        attrs={"contract": "model", "equation": str(model), "withheld": model.withheld},
    )
    labels = asdict(known) | {"u_units": u_units, "y_units": y_units}
    dataset.attrs |= {name: value for name, value in labels.items() if value is not None}
    if model.covariance is not None:
        dataset["covariance"] = variable(
            ("term", "term_2"), model.covariance, "1", "covariance of the parameters"
        )
        dataset["standard_error"] = variable(
            "term", model.standard_errors, "1", "standard error of the parameter"
        )
    if model.checked is not None:
        report = model.checked.to_dataset(of_inputs, y_units)
        dataset = dataset.merge(report).assign_attrs(report.attrs)
    return dataset if model.trace is None else dataset.merge(model.trace)
