"""The recursive probing method: GFRFs of any order from the polynomial around a rest.

With the input U_t = sum_i e^{j w_i t} of n tones the output contains, for each set S of tones, the
line at sum_{i in S} w_i with the amplitude G(S) = |S|! H_{|S|}(w_i, i in S). A monomial
contributes to that line once for every way of distributing the tones of S over its factors, each
output factor with one or more tones and each input factor with exactly one. Equating both sides of
the model equation line by line gives G(S) from the G of smaller sets, (20)-(31) for every order,
already symmetric.

Of several inputs each tone is in one, and an input factor takes only tones of its own input: G(S)
is then |S|! times the symmetrised cross-kernel of the inputs that the tones are in (Swain and
Billings 2001, International Journal of Control 74:735).
"""

from collections.abc import Iterator, Sequence
from functools import cache
from math import factorial

import numpy as np
from numpy.typing import NDArray

from dea.arrays import Complex
from dea.gfrf.expansion import Polynomial

Factor = tuple[int, int]  # the column of the input, or _OUTPUT, and the lag
_OUTPUT = -1


def probe(
    expanded: Polynomial, omega: Sequence[NDArray[np.float64]], inputs: Sequence[int]
) -> Complex:
    """Return the symmetric n-th order GFRF, n = len(omega), in normalised units.

    Parameters
    ----------
    expanded
        The model around its rest, from :func:`dea.gfrf.expansion.expand`; coefficients that are
        arrays (varying parameters) have trailing axes of length one for the frequencies.
    omega
        One array per tone, in radians per sample, broadcastable against each other.
    inputs
        The column of the input that each tone is in.
    """
    poles = [(term.y_lags[0], c) for term, c in expanded.items() if term.is_delayed_output]
    driving = [
        (
            (
                *zip(term.input_columns, term.u_lags, strict=True),
                *((_OUTPUT, lag) for lag in term.y_lags),
            ),
            c,
        )
        for term, c in expanded.items()
        if not term.is_delayed_output
    ]

    @cache
    def delay(tones: int, lag: int) -> Complex:
        return np.exp(-1j * lag * sum(omega[i] for i in _members(tones)))

    @cache
    def G(tones: int) -> Complex:
        count = tones.bit_count()
        total = np.zeros((), dtype=complex)
        for factors, coefficient in driving:
            if len(factors) <= count:
                dealt = deal(factors, tones)
                if dealt is not None:
                    total = total + coefficient * dealt
        return total / (1.0 - sum(c * delay(tones, lag) for lag, c in poles))

    @cache
    def deal(factors: tuple[Factor, ...], tones: int) -> Complex | None:
        """Sum over the ways of distributing ``tones`` over ``factors``; None if there is none."""
        (signal, lag), rest = factors[0], factors[1:]
        if not rest:
            return taken(signal, lag, tones)
        total = None
        for share in _shares(tones):
            if (tones ^ share).bit_count() < len(rest):
                continue
            first = taken(signal, lag, share)
            others = None if first is None else deal(rest, tones ^ share)
            if first is not None and others is not None:
                total = first * others if total is None else total + first * others
        return total

    def taken(signal: int, lag: int, tones: int) -> Complex | None:
        if signal == _OUTPUT:
            return G(tones) * delay(tones, lag)
        single = tones.bit_count() == 1 and inputs[tones.bit_length() - 1] == signal
        return delay(tones, lag) if single else None

    order = len(omega)
    return G((1 << order) - 1) / factorial(order)


def _members(tones: int) -> Iterator[int]:
    return (i for i in range(tones.bit_length()) if tones >> i & 1)


def _shares(tones: int) -> Iterator[int]:
    """Every proper, non-empty subset of a set of tones, sets being bit masks."""
    share = (tones - 1) & tones
    while share:
        yield share
        share = (share - 1) & tones
