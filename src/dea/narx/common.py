"""One structure for several systems beside the own structure of each."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from dea.arrays import Array
from dea.missing import filled
from dea.narx.metrics import nmse
from dea.narx.model import NarxModel
from dea.store import variable


def compare_structures(
    common: Mapping[str, NarxModel],
    own: Sequence[NarxModel],
    tests: Sequence[tuple[Array, Array]],
) -> xr.Dataset:
    """Score models of a common structure and own models on records that they were not fitted to.

    Parameters
    ----------
    common
        By system, all with the same terms, as :func:`dea.select_common_terms` returns them.
    own
        The own model of each system.
    tests
        Input and output of each system in physical units; missing outputs (NaN) are not scored.

    Returns
    -------
    Dataset
        As ``common_model.nc`` holds it; the error of a run that diverges is infinite.
    """
    models = list(common.values())
    errors = np.array(
        [
            [_error(model, u, y) for model, (u, y) in zip(each, tests, strict=True)]
            for each in (own, models)
        ]
    )
    statuses = [[model.stability().status for model in each] for each in (own, models)]
    per_term, per_model = ("system", "term"), ("structure", "system")
    variables = {
        "parameter": (per_term, [each.parameters for each in models], "parameter of the term"),
        "standard_error": (
            per_term,
            [each.standard_errors for each in models],
            "standard error of the parameter",
        ),
        "withheld": (
            ("system",),
            [each.withheld for each in models],
            "why standard errors do not hold; empty where they do",
        ),
        "nmse": (per_model, errors, "SSE/SST in free run on data not used"),
        "stability": (per_model, statuses, "stable, slow or unstable"),
        "terms": (
            per_model,
            [[len(model.terms) for model in each] for each in (own, models)],
            "number of terms",
        ),
    }
    return xr.Dataset(
        {
            name: variable(dims, np.array(values), "1", label)
            for name, (dims, values, label) in variables.items()
        },
        coords={
            name: variable(name, values, "1", name)
            for name, values in (
                ("system", list(common)),
                ("term", [str(term) for term in models[0].terms]),
                ("structure", ["own", "common"]),
            )
        },
        attrs={"contract": "common_model"},
    )


def _error(model: NarxModel, u: Array, y: Array) -> float:
    outputs, seen = filled(y)
    scored = seen & (np.arange(seen.size) >= model.max_lag)
    return nmse(outputs[scored], model.simulate(u, outputs)[scored])
