"""Residual correlation tests whose 95 % bands hold at every lag.

After Billings and Voon (1986) and Billings and Zhu (1994): where the model leaves nothing
unexplained, all five correlations stay within their bands. Of several inputs, a sixth is for the
product of each two, which the square of neither holds.
"""

from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np

from dea.arrays import Array
from dea.confidence import DEVIATIONS
from dea.errors import InputError
from dea.given_numbers import is_count
from dea.inputs import by_input, input_count


class Relation(NamedTuple):
    """What a test correlates: the residual, or its power, with the past of a signal."""

    signal: Callable[[Array, Array, Array], Array]  # of residual and the two inputs of a pair
    in_power: bool = False


def _product(u: Array, v: Array) -> Array:
    """Return the product of two inputs about its mean."""
    both: Array = u * v
    return both - np.mean(both)


# Of one input, which is then both of a pair.
TESTS = {
    "phi_ee": Relation(lambda e, u, v: e),
    "phi_eu": Relation(lambda e, u, v: u),
    "phi_e(eu)": Relation(lambda e, u, v: e * u),
    "phi_u2e": Relation(lambda e, u, v: _product(u, u)),
    "phi_u2e2": Relation(lambda e, u, v: _product(u, u), in_power=True),
}
PAIR_TEST = "phi_uue"
RELATIONS = {**TESTS, PAIR_TEST: Relation(lambda e, u, v: _product(u, v))}
_WHITENESS = "phi_ee"


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
    max_lag
        A whole number below that of the samples.

    Returns
    -------
    ndarray
        Shape (tests in the order of :func:`each_test`, max_lag). ``inf`` where the residual is,
        that is where the model diverged; 0 where a signal is constant.

    Raises
    ------
    InputError
        If the residual has no two samples that far apart.
    """
    if not is_count(max_lag) or max_lag >= e.size:
        raise InputError(
            f"it is {max_lag!r} for {e.size} samples",
            field="max_lag",
            remedy="Give a whole number from 1 to below that of the samples.",
        )
    tests = each_test(input_count(u))
    if not np.isfinite(e).all():
        return np.full((len(tests), max_lag), np.inf)
    centred = by_input(u - u.mean(axis=0))
    residual = e - e.mean()
    found = []
    for test, columns in tests.values():
        relation = RELATIONS[test]
        signal = relation.signal(residual, centred[columns[0]], centred[columns[-1]])
        found.append(correlation(residual**2 if relation.in_power else residual, signal, max_lag))
    return np.array(found)


def each_test(inputs: int) -> dict[str, tuple[str, tuple[int, ...]]]:
    """Return test and columns of the inputs by the name under which results list them.

    Of several inputs, each has the tests that it takes part in, and each pair one for its product.
    """
    if inputs == 1:
        return {test: (test, (0,)) for test in TESTS}
    of_each = {
        f"{test}, u{column + 1}": (test, (column,))
        for column in range(inputs)
        for test in TESTS
        if test != _WHITENESS
    }
    of_pairs = {
        f"{PAIR_TEST}, u{i + 1}u{j + 1}": (PAIR_TEST, (i, j))
        for i, j in combinations(range(inputs), 2)
    }
    return {_WHITENESS: (_WHITENESS, (0,)), **of_each, **of_pairs}


def band(samples: int) -> float:
    """Half-width of the 95 % band of a correlation over ``samples`` samples."""
    return float(DEVIATIONS / np.sqrt(samples))


def correlation(a: Array, b: Array, max_lag: int) -> Array:
    """Correlate a signal with the past of another, both about their means, at each lag."""
    a, b = a - a.mean(), b - b.mean()
    scale = np.sqrt(np.sum(a**2) * np.sum(b**2))
    if scale == 0.0:
        return np.zeros(max_lag)
    n = a.size
    return np.array([a[k:] @ b[:-k] / scale * np.sqrt(n / (n - k)) for k in range(1, max_lag + 1)])
