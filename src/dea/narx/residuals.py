"""Residual correlation tests whose 95 % bands hold at every lag.

After Billings and Voon (1986) and Billings and Zhu (1994): where the model leaves nothing
unexplained, all five correlations stay within their bands.
"""

from collections.abc import Callable

import numpy as np

from dea.narx.checks import Array, by_input

# Which two signals each test correlates, from residual e and input u; the second is delayed.
TESTS: dict[str, Callable[[Array, Array], tuple[Array, Array]]] = {
    "phi_ee": lambda e, u: (e, e),
    "phi_eu": lambda e, u: (e, u),
    "phi_e(eu)": lambda e, u: (e, e * u),
    "phi_u2e": lambda e, u: (e, u**2 - np.mean(u**2)),
    "phi_u2e2": lambda e, u: (e**2, u**2 - np.mean(u**2)),
}
_WHITENESS = "phi_ee"
_CONFIDENCE = 1.959963984540054  # two-sided 95 % of the normal distribution


def correlation_tests(e: Array, u: Array, max_lag: int) -> Array:
    """Correlate the residual with its own past and that of the input, at lags 1 to ``max_lag``.

    At lag k only n - k products exist. Each coefficient is their mean times sqrt((n - k)/n), so
    that on a white residual its standard deviation is 1/sqrt(n) at every lag, whatever the
    input's colour. With a smooth input neighbouring lags are themselves correlated: they leave
    the band together, 5 % of them on average over records but not in each.

    Parameters
    ----------
    e, u
        Residual and input, shape (samples,); several inputs are the columns of ``u``.

    Returns
    -------
    ndarray
        Shape (tests in the order of :func:`each_test`, max_lag). ``inf`` where the residual is,
        that is where the model diverged; 0 where a signal is constant.
    """
    tests = each_test(u.shape[1] if u.ndim == 2 else 1)
    if not np.isfinite(e).all():
        return np.full((len(tests), max_lag), np.inf)
    centred = by_input(u - u.mean(axis=0))
    residual = e - e.mean()
    return np.array(
        [
            _correlation(*TESTS[test](residual, centred[column]), max_lag)
            for test, column in tests.values()
        ]
    )


def each_test(inputs: int) -> dict[str, tuple[str, int]]:
    """Return test and column of the input by the name under which results list them.

    Of several inputs, each has the tests that it takes part in.
    """
    if inputs == 1:
        return {test: (test, 0) for test in TESTS}
    return {_WHITENESS: (_WHITENESS, 0)} | {
        f"{test}, u{column + 1}": (test, column)
        for column in range(inputs)
        for test in TESTS
        if test != _WHITENESS
    }


def band(samples: int) -> float:
    """Half-width of the 95 % band of a correlation over ``samples`` samples."""
    return float(_CONFIDENCE / np.sqrt(samples))


def _correlation(a: Array, b: Array, max_lag: int) -> Array:
    a, b = a - a.mean(), b - b.mean()
    scale = np.sqrt(np.sum(a**2) * np.sum(b**2))
    if scale == 0.0:
        return np.zeros(max_lag)
    n = a.size
    return np.array([a[k:] @ b[:-k] / scale * np.sqrt(n / (n - k)) for k in range(1, max_lag + 1)])
