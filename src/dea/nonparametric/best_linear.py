"""The best linear approximation by the robust method, from arrays of periods.

Pintelon and Schoukens, System Identification (2nd ed., Wiley 2012), section 4.3.1: of what differs
between the responses of a system to several multisines, what differs between periods of one of them
is noise, and what differs between realisations of the phases is noise and nonlinear distortion.
"""

from numbers import Real
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.special import fdtri, stdtrit

from dea.arrays import Array, Complex
from dea.confidence import LEVEL
from dea.errors import InputError
from dea.given_numbers import is_count
from dea.nonparametric.periods import Periods

Lines = NDArray[np.int64]

_SHOWN = 1e-6  # part of the noise that must show in the differences between periods
# RMS of what differs between the periods of an input, as a part of how it moves: noise that it is
# measured with stays below; if the period given is wrong, the periods differ altogether.
_REPEATED = 0.5


class BestLinear(NamedTuple):
    """The response at the excited lines, and what the output holds besides.

    Variances are those of a complex number, E|x - E x|^2.
    """

    lines: Lines  # (lines,) excited harmonics of the period
    response: Complex  # (lines,) in output units per input unit
    noise: Array  # (lines,) variance of the response by noise
    total: Array  # (lines,) variance of the response by noise and nonlinear distortion
    realisations: int
    input: Complex  # (realisations, harmonics) two-sided Fourier coefficients, from harmonic 0 on
    output: Complex  # (realisations, harmonics) without drift
    output_noise: Array  # (realisations, harmonics) variance of output by noise, NaN if unknown

    @property
    def distortion(self) -> Array:
        """Variance of the response to one realisation by nonlinear distortion, (lines,)."""
        return np.maximum(self.total - self.noise, 0.0) * self.realisations

    @property
    def detection(self) -> Lines:
        """The harmonics from 1 to the highest line that are not excited."""
        return np.setdiff1d(np.arange(1, self.lines[-1] + 1), self.lines)

    def radius(self) -> Array:
        """Radius of the 95 % disc around the response, (lines,)."""
        quantile = fdtri(2, 2 * (self.realisations - 1), LEVEL)
        return np.asarray(np.sqrt(quantile * self.total))

    def half_width(self) -> Array:
        """Half-width of the 95 % interval of the real or imaginary part, (lines,).

        Along the response it is that of the gain, across it that of gain times phase.
        """
        quantile = stdtrit(2 * (self.realisations - 1), 0.5 + 0.5 * LEVEL)
        return np.asarray(quantile * np.sqrt(0.5 * self.total))


def best_linear(periods: Periods, drift: int = 3, excited_above: float = 0.01) -> BestLinear:
    """Estimate the best linear approximation of the system between input and output.

    Parameters
    ----------
    periods
        Steady-state periods; all realisations excite the same lines.
    drift
        Order of the polynomial in time that the output of each realisation is freed of, together
        with its period; 0 where the output does not drift.
    excited_above
        Share of the strongest line's input amplitude above which a line is excited. Noise,
        quantisation and distortion of the input have to stay below it. A weaker line of the
        multisine counts as not excited, and the output there as distortion.

    Raises
    ------
    InputError
        If the input does not repeat from period to period, the realisations do not excite the same
        lines or none, the drift is not an order, or ``excited_above`` no share.
    """
    if not (isinstance(excited_above, Real) and 0.0 < float(excited_above) < 1.0):
        raise InputError(
            f"it is {excited_above!r}", field="excited_above", remedy="Give a share between 0 and 1"
        )
    if not is_count(drift, 0):
        raise InputError(
            f"it is {drift!r}", field="drift", remedy="Give the order of a polynomial, 0 or more"
        )
    u, y = periods.u, periods.y
    _require_repeated(u)
    samples = u.shape[-1]
    spectrum_u = np.fft.rfft(u.mean(axis=1)) / samples
    amplitude = np.abs(spectrum_u)
    amplitude[:, 0] = 0.0
    excited = amplitude > excited_above * amplitude.max()
    if not (excited == excited[0]).all():
        raise InputError(
            "the realisations excite different lines",
            field="realisation",
            remedy="Change the phases of the multisine alone from one to the next, or excited_above"
            " where the weakest lines come near it",
        )
    lines = np.flatnonzero(excited[0])
    if not lines.size:
        raise InputError(
            "it is constant within its periods",
            field="input",
            remedy="Record multisines, and number their samples",
        )
    spectra = np.fft.rfft(np.stack([without_drift(each, drift) for each in y])) / samples
    output = spectra.mean(axis=1)
    told, of_mean = _noise_shares(y.shape[1], samples, drift)
    output_noise = np.var(spectra, axis=1, ddof=1) / told * of_mean
    gains = output[:, lines] / spectrum_u[:, lines]
    count = gains.shape[0]
    noise = np.mean(output_noise[:, lines] / amplitude[:, lines] ** 2, axis=0) / count
    total = np.var(gains, axis=0, ddof=1) / count
    return BestLinear(
        lines, gains.mean(axis=0), noise, total, count, spectrum_u, output, output_noise
    )


def _require_repeated(u: Array) -> None:
    """Refuse an input, shape (realisations, periods, samples), whose periods are not alike."""
    differing = np.std(u - u.mean(axis=1, keepdims=True), axis=(1, 2))
    moving = np.std(u, axis=(1, 2))
    (apart,) = np.nonzero(differing > _REPEATED * moving)
    if apart.size:
        part = differing[apart[0]] / moving[apart[0]]
        raise InputError(
            f"the input of realisation {apart[0] + 1} does not repeat with it: between periods"
            f" {100 * part:.0f} % of its motion differs",
            field="period",
            remedy="Give the period of the multisines in s, and number steady-state periods alone",
        )


def without_drift(y: Array, order: int) -> Array:
    """Return the periods ``y``, shape (periods, samples), less a polynomial of ``order`` in time.

    The polynomial is fitted, by least squares, to what differs between the periods, so that it
    takes nothing of what they share.
    """
    if order == 0:
        return y
    basis = _polynomials(y.shape[0], y.shape[1], order)
    coefficients = np.linalg.lstsq(
        (basis - basis.mean(axis=0)).reshape(-1, order), (y - y.mean(axis=0)).ravel(), rcond=None
    )[0]
    return np.asarray(y - basis @ coefficients)


def _polynomials(periods: int, samples: int, order: int) -> Array:
    """Return Legendre polynomials over all periods, shape (periods, samples, order)."""
    time = np.linspace(-1.0, 1.0, periods * samples)
    basis = np.asarray(legendre.legvander(time, order)[:, 1:], dtype=np.float64)
    return basis.reshape(periods, samples, order)


def _noise_shares(periods: int, samples: int, order: int) -> tuple[Array, Array]:
    """Return what the drift that is estimated makes of white noise at each harmonic.

    The first is the part of its variance that the differences between periods still show, since
    the drift follows them, NaN where it follows them altogether; the second the variance of the
    mean of the periods, to which the error of the drift adds, over that of one.
    """
    if order == 0:
        return np.ones(1), np.full(1, 1.0 / periods)
    basis = _polynomials(periods, samples, order)
    mean = basis.mean(axis=0)
    U, sizes, V = np.linalg.svd((basis - mean).reshape(-1, order), full_matrices=False)
    free = sizes > 1e-10 * sizes[0]
    followed = np.fft.rfft(U[:, free].reshape(periods, samples, -1), axis=1)
    told = 1.0 - np.sum(np.abs(followed) ** 2, axis=(0, 2)) / ((periods - 1) * samples)
    told = np.where(told > _SHOWN, told, np.nan)
    error = np.fft.rfft(mean @ V[free].T / sizes[free], axis=0)
    return told, 1.0 / periods + np.sum(np.abs(error) ** 2, axis=1) / samples
