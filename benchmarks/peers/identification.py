"""Run in the peers' environment: select terms on the record of argv[1], print JSON."""

import contextlib
import json
import sys
import time
import warnings

import numpy as np
from fastcan.narx import make_narx
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS, MetaMSS
from sysidentpy.parameter_estimation import LeastSquares


def timed(fit):
    start = time.process_time()
    result = fit()
    return result, time.process_time() - start


def main():
    warnings.simplefilter("ignore")
    data = np.load(sys.argv[1])
    u, y, u_test, y_test = (data[name][:, None] for name in ("u", "y", "u_test", "y_test"))
    settings = {
        "xlag": [1, 2, 3], "ylag": [1, 2, 3], "estimator": LeastSquares(),
        "basis_function": Polynomial(degree=3),
    }  # fmt: skip
    results = {}
    meta = MetaMSS(norm=-2, maxiter=30, n_agents=10, random_state=1, **settings)
    # The number of terms is the least of its information criterion among up to 15.
    frols = FROLS(order_selection=True, n_info_values=15, info_criteria="bic", **settings)
    for name, model in (("MetaMSS", meta), ("FROLS", frols)):
        _, seconds = timed(lambda model=model: model.fit(X=u, y=y))
        run = model.predict(X=u_test, y=y_test[:3]).ravel().tolist()
        results[name] = {"seconds": seconds, "terms": len(model.final_model), "run": run}
    terms = results["FROLS"]["terms"]

    def fastcan():
        model = make_narx(
            X=u, y=y, n_terms_to_select=terms, max_delay=3, poly_degree=3, verbose=0
        )  # fmt: skip
        return model.fit(u, y)

    model, seconds = timed(fastcan)
    run = model.predict(u_test, y_init=y_test[:3]).ravel().tolist()
    results["fastcan"] = {"seconds": seconds, "terms": terms, "run": run}
    runs = [timed(lambda: meta.predict(X=u_test, y=y_test[:3]))[1] for _ in range(3)]
    results["simulation"] = min(runs)
    return results


if __name__ == "__main__":
    with contextlib.redirect_stdout(sys.stderr):  # packages report their progress
        found = main()
    print(json.dumps(found))
