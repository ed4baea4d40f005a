"""Run in the peers' environment: select terms on a record, print JSON.

The arguments are the file of the record and how often each fit is timed; the shortest time counts.
"""

import contextlib
import json
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from fastcan.narx import make_narx, make_poly_ids, make_time_shift_ids
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS, MetaMSS
from sysidentpy.parameter_estimation import LeastSquares

LAGS, DEGREE = 3, 3
MOST = 15  # terms among which the information criterion of FROLS decides


def timed(task: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """Return what a task returns, and the shortest of its times in s of the processor."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = task()
        times.append(time.process_time() - start)
    return result, min(times)


def main(file: str, repeats: int) -> dict[str, Any]:
    """Return seconds, numbers of terms and of candidates, and the free run, of each peer.

    Of MetaMSS also its equation, and the seconds of its free run.
    """
    warnings.simplefilter("ignore")
    data = np.load(file)
    u, y, u_test, y_test = (data[name][:, None] for name in ("u", "y", "u_test", "y_test"))
    lags = list(range(1, LAGS + 1))

    def settings() -> dict[str, Any]:
        return {
            "xlag": lags, "ylag": lags, "estimator": LeastSquares(),
            "basis_function": Polynomial(degree=DEGREE),
        }  # fmt: skip

    def meta() -> Any:
        search = MetaMSS(norm=-2, maxiter=30, n_agents=10, random_state=1, **settings())
        return search.fit(X=u, y=y)

    def frols() -> Any:
        search = FROLS(order_selection=True, n_info_values=MOST, info_criteria="bic", **settings())
        return search.fit(X=u, y=y)

    results, models = {}, {}
    for name, fit in (("MetaMSS", meta), ("FROLS", frols)):
        model, seconds = timed(fit, repeats)
        models[name] = model
        results[name] = {
            "seconds": seconds,
            "terms": len(model.final_model),
            "candidates": len(model.regressor_code),
            "run": model.predict(X=u_test, y=y_test[:LAGS]).ravel().tolist(),
        }
    terms = results["FROLS"]["terms"]
    at_once = [False]  # whether u(t) itself is a candidate, as it is by default

    def fastcan() -> Any:
        model = make_narx(
            X=u, y=y, n_terms_to_select=terms, max_delay=LAGS, poly_degree=DEGREE,
            include_zero_delay=at_once, verbose=0,
        )  # fmt: skip
        return model.fit(u, y)

    model, seconds = timed(fastcan, repeats)
    factors = make_time_shift_ids(2, LAGS, [*at_once, False])
    results["fastcan"] = {
        "seconds": seconds,
        "terms": len(model.coef_) + 1,  # its constant is a term that is always there
        "candidates": len(make_poly_ids(len(factors), DEGREE)) + 1,
        "run": model.predict(u_test, y_init=y_test[:LAGS]).ravel().tolist(),
    }
    assert not np.any(model.delay_ids_ == 0)
    chosen = models["MetaMSS"]
    _, seconds = timed(lambda: chosen.predict(X=u_test, y=y_test[:LAGS]), repeats)
    results["simulation"] = {
        "seconds": seconds,
        # A factor is 1000 times its signal, 1 of the output and 2 of the input, and its lag.
        "equation": [[int(code) for code in term if code] for term in chosen.final_model],
        "parameters": chosen.theta.ravel().tolist(),
    }
    return results


if __name__ == "__main__":
    with contextlib.redirect_stdout(sys.stderr):  # packages report their progress
        found = main(sys.argv[1], int(sys.argv[2]))
    print(json.dumps(found))
