"""Whether a residual still holds what a model could explain: joint tests, and their verdict.

The correlations of :mod:`dea.narx.residuals` are one number per lag, and with a smooth input
neighbouring lags say the same. Here each test is one regression on all lags together. A residual is
first made white by an autoregression, so that drift and coloured noise, which no input explains, do
not pass for an effect of the input (Box and Jenkins 1970, chapter 11, on prewhitening).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dea.arrays import Array
from dea.autoregression import fit_autoregression, innovations
from dea.inputs import by_input, input_count
from dea.narx.residuals import PAIR_TEST, RELATIONS, correlation, each_test
from dea.number_format import written_out

SIGNIFICANCE = 0.05  # of all tests of a system together
_PRINCIPAL = 1e-3  # of the largest singular value; what is below is the collinearity of lags


# What each test finds past values of, by the names of the inputs, and the same without an article.
_MEANINGS = {
    "phi_eu": "{0}",
    "phi_e(eu)": "the product of residual and {short[0]}",
    "phi_u2e": "the square of {0}",
    "phi_u2e2": "the square of {0}, in the residual's power",
    PAIR_TEST: "the product of {short[0]} and {short[1]}",
}


class JointTests(NamedTuple):
    """What each test finds, in the order of :func:`dea.narx.residuals.each_test`, shape (tests,).

    ``p_value``: how often a residual without that relation gives as much. ``explained``: the share
    of the whitened residual's power (of its squares' variance in the last test) that all lags
    explain, less what chance does; for the first test, what its own past explains.
    ``correlation``: of the two signals that are tested, shape (tests, lags); without a relation
    95 % are within :func:`dea.narx.residuals.band` of the residual's samples.
    """

    p_value: Array
    explained: Array
    correlation: Array


def joint_tests(e: Array, u: Array, max_lag: int) -> JointTests:
    """Test the residual against its own past and that of the input, all lags of a test together.

    Parameters
    ----------
    e, u
        Residual and input, shape (samples,); several inputs are the columns of ``u``.
    max_lag
        Lags 1 to this.

    Returns
    -------
    JointTests
        Of a residual that is not finite, p-values of 0, everything explained and infinite
        correlations; of a constant one, p-values of 1, nothing explained and no correlation.
    """
    _, *tests = each_test(input_count(u)).values()
    count = 1 + len(tests)
    if not np.isfinite(e).all():
        return JointTests(np.zeros(count), np.ones(count), np.full((count, max_lag), np.inf))
    residual, inputs = e - e.mean(), by_input(u - u.mean(axis=0))
    if not residual.any():
        return JointTests(np.ones(count), np.zeros(count), np.zeros((count, max_lag)))
    colour = fit_autoregression([residual])
    white = innovations(colour, residual)
    shown = [correlation(residual, residual, max_lag)]
    found = [_portmanteau(residual, max_lag, 1.0 - float(white.var() / residual.var()))]
    for name, columns in tests:
        relation = RELATIONS[name]
        instrument = relation.signal(residual, inputs[columns[0]], inputs[columns[-1]])
        target = white**2 if relation.in_power else white
        if not relation.in_power:  # squares of a white residual are not coloured by its filter
            instrument = innovations(colour, instrument)
        instrument = instrument[-target.size :]
        found.append(_regression(target, instrument, max_lag))
        # The filter has taken the first samples: the band is still that of all.
        kept = np.sqrt(target.size / residual.size)
        shown.append(kept * correlation(target, instrument, max_lag))
    p_value, explained = np.array(found).T
    return JointTests(p_value, explained, np.array(shown))


def verdict(
    p_value: Array,
    explained: Array,
    rms: float,
    spread: float,
    units: str,
    inputs: Sequence[str] = ("the input",),
) -> str:
    """Say in words what the joint tests of a model find.

    Parameters
    ----------
    p_value, explained
        As :func:`joint_tests`, over all windows, shape (windows, tests).
    rms, spread
        Root mean square of the residual, and standard deviation of the output, in ``units``.
    inputs
        What each input is called.
    """
    if not np.isfinite(rms):
        return "The free run diverges; there is no residual to test."
    size = (
        f"The residual is {_two_digits(rms)} {units},"
        f" {_two_digits(100 * rms / spread)} % of the output's spread"
    )
    count = p_value.size
    white = count * p_value[:, 0].min() > SIGNIFICANCE
    colour = "white" if white else "coloured"
    joint = np.minimum(count * p_value.min(axis=0), 1.0)[1:]
    short = [name.removeprefix("the ") for name in inputs]
    _, *tests = each_test(len(inputs)).values()
    meanings = [
        _MEANINGS[test].format(*(inputs[k] for k in columns), short=[short[k] for k in columns])
        for test, columns in tests
    ]
    shown = [
        f"{meaning} ({_two_digits(100 * share)} %)"
        for meaning, p, share in zip(meanings, joint, explained.max(axis=0)[1:], strict=True)
        if p < SIGNIFICANCE
    ]
    if not shown:
        return (
            f"{size}; it is {colour}, and past inputs explain nothing of it"
            f" (p {_below(joint.min())})."
        )
    *first, final = shown
    what = f"{', '.join(first)} and {final}" if first else final
    return (
        f"{size}; it is {colour}, and past values of {what} still explain part of its"
        f" innovations (p {_below(joint.min())})."
    )


def _two_digits(value: float) -> str:
    return written_out(f"{value:.2g}")


def _below(p: float) -> str:
    return f"= {p:.2g}" if p >= 1e-3 else "< 0.001"


def _portmanteau(e: Array, max_lag: int, explained: float) -> tuple[float, float]:
    """Ljung and Box's test (1978) that a residual is white."""
    from scipy.special import chdtrc

    n = e.size
    lags = np.arange(1, max_lag + 1)
    correlation = np.array([e[k:] @ e[:-k] for k in lags]) / (e @ e)
    statistic = n * (n + 2) * np.sum(correlation**2 / (n - lags))
    return float(chdtrc(max_lag, statistic)), max(explained, 0.0)


def _regression(target: Array, instrument: Array, max_lag: int) -> tuple[float, float]:
    """F test of a target on the principal components of all lags of an instrument."""
    from scipy.special import fdtrc

    rows = target.size - max_lag
    lagged = np.column_stack(
        [instrument[max_lag - k : target.size - k] for k in range(1, max_lag + 1)]
    )
    lagged -= lagged.mean(axis=0)
    wanted = target[max_lag:] - target[max_lag:].mean()
    components, size, _ = np.linalg.svd(lagged, full_matrices=False)
    kept = components[:, size > _PRINCIPAL * max(size[0], np.finfo(float).tiny)]
    total, count = float(wanted @ wanted), kept.shape[1]
    freedom = rows - count - 1
    if total == 0.0 or count == 0 or freedom < 1:
        return 1.0, 0.0
    share = float(np.sum((kept.T @ wanted) ** 2)) / total
    statistic = (share / count) / ((1.0 - share) / freedom)
    adjusted = 1.0 - (1.0 - share) * (rows - 1) / freedom
    return float(fdtrc(count, freedom, statistic)), max(adjusted, 0.0)
