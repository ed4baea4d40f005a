"""Laws that map a signal value by value: dead zones, saturations and bent sensors."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from dea.plant.array import Array
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import curve
from dea.plant.signal_law import SignalLaw

Curve = Callable[[Array], Array]


def _softplus(x: Array) -> Array:
    value: Array = np.logaddexp(0.0, x)
    return value


def _commanded(function: Curve, conditions: Conditions) -> SignalLaw:
    """Tabulate from 0 V to twice the highest command."""
    return curve(function, 0.0, 2.0 * conditions.high)


def _read(function: Curve, conditions: Conditions) -> SignalLaw:
    """Tabulate from four travels below the plain range of readings to four above."""
    reach = 4.0 * conditions.travel
    return curve(function, conditions.bottom - reach, conditions.top + reach, output=True)


def _threshold(size: float, conditions: Conditions) -> tuple[float, float]:
    """Return the threshold and the gain above it that leaves the highest command unchanged."""
    threshold = conditions.low + size * conditions.span
    return threshold, conditions.high / (conditions.high - threshold)


@tuning("Tao and Kokotović, IEEE Trans. Autom. Control 39 (1994) 59, with a rounded knee")
def rounded_threshold(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A threshold whose knee is a softplus."""
    threshold, gain = _threshold(size, conditions)
    knee = rng.uniform(0.01, 0.04) * conditions.high
    law = _commanded(lambda u: gain * knee * _softplus((u - threshold) / knee), conditions)
    return Built(law, {"threshold": threshold})


@tuning("Merritt, Hydraulic Control Systems (1967), overlapped spool with leakage")
def overlapped_valve(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A little flow leaks within the overlap; beyond it the orifice opens in full."""
    threshold, _ = _threshold(size, conditions)
    leak = rng.uniform(0.02, 0.08)
    leaked = leak * threshold
    gain = (conditions.high - leaked) / (conditions.high - threshold)

    def flow(u: Array) -> Array:
        value: Array = np.where(u < threshold, leak * u, leaked + gain * (u - threshold))
        return value

    return Built(_commanded(flow, conditions), {"threshold": threshold})


@reporting("Banwell and Jayakumar, Electron. Lett. 36 (2000) 291: a diode in series with a load")
def diode_drop(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The load's voltage v solves v + n ln(1 + v/s) = u, by Lambert's function."""
    from scipy.special import lambertw

    threshold, _ = _threshold(size, conditions)
    knee = threshold / rng.uniform(5.0, 9.0)
    small = conditions.high * np.exp(-threshold / knee)

    def load(u: Array) -> Array:
        # (v + s)/n e^((v + s)/n) = s/n e^((u + s)/n)
        exponent = np.log(small / knee) + (u + small) / knee
        large = exponent > 500.0
        solved = np.real(lambertw(np.exp(np.where(large, 0.0, exponent))))
        asymptote = exponent - np.log(np.maximum(exponent, 1.0))
        value: Array = knee * np.where(large, asymptote, solved) - small
        return value

    top = float(load(np.array([conditions.high]))[0])
    law = _commanded(lambda u: np.maximum(load(u), 0.0) * conditions.high / top, conditions)
    return Built(law, {})


@reporting("Sedra and Smith, Microelectronic Circuits (2004): a square-law stage above threshold")
def square_law_foot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Nothing below the threshold, a parabola above it that becomes a straight line."""
    threshold, _ = _threshold(size, conditions)
    foot = rng.uniform(0.15, 0.4) * (conditions.high - threshold)

    def drawn(u: Array) -> Array:
        over = np.maximum(u - threshold, 0.0)
        value: Array = np.where(over < foot, over * over / (2.0 * foot), over - 0.5 * foot)
        return value

    top = float(drawn(np.array([conditions.high]))[0])
    law = _commanded(lambda u: drawn(u) * conditions.high / top, conditions)
    return Built(law, {"threshold": threshold})


def _ceiling(size: float, conditions: Conditions) -> float:
    return conditions.high - size * conditions.span


@tuning("Schetzen's overdrive in Zölzer, DAFX (2011): a parabola between line and limit")
def parabolic_shoulder(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A straight line, a parabola over the shoulder, then constant."""
    limit = _ceiling(size, conditions)
    width = rng.uniform(0.05, 0.2) * limit

    def clipped(u: Array) -> Array:
        x = np.clip(u - (limit - width), 0.0, 2.0 * width)
        value: Array = np.minimum(u, limit - width) + x - x * x / (4.0 * width)
        return value

    return Built(_commanded(clipped, conditions), {"limit": limit})


@tuning("Gelb and Vander Velde, Multiple-Input Describing Functions (1968): two gains")
def residual_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above the limit a small share of the gain remains."""
    limit, share = _ceiling(size, conditions), rng.uniform(0.02, 0.12)
    law = _commanded(lambda u: np.where(u < limit, u, limit + share * (u - limit)), conditions)
    return Built(law, {"limit": limit})


@reporting("Baum, IRE Trans. Inf. Theory 3 (1957) 193: the smooth limiter of an error integral")
def error_integral(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A straight line up to a knee, and an error integral from there to the limit."""
    from scipy.special import erf

    limit = _ceiling(size, conditions)
    knee = limit * rng.uniform(0.75, 0.92)
    room = limit - knee

    def limited(u: Array) -> Array:
        over = np.maximum(u - knee, 0.0) / room
        value: Array = np.minimum(u, knee) + room * erf(0.5 * np.sqrt(np.pi) * over)
        return value

    return Built(_commanded(limited, conditions), {"limit": limit})


@reporting("Saleh, IEEE Trans. Commun. 29 (1981) 1715: a tube that saturates and falls again")
def falling_tube(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Linear to a knee, then Saleh's quotient x/(1 + x²/4): its crest lies at x = 2."""
    knee = conditions.high - 2.0 * size * conditions.span
    knee = max(knee, 0.35 * conditions.high)
    room = rng.uniform(0.25, 0.45) * (conditions.high - knee) / 0.5

    def tube(u: Array) -> Array:
        x = np.maximum(u - knee, 0.0) / room
        value: Array = np.minimum(u, knee) + room * x / (1.0 + 0.25 * x * x)
        return value

    return Built(_commanded(tube, conditions), {})


def _read_limit(size: float, conditions: Conditions) -> float:
    return conditions.top - size * conditions.travel


@tuning("Naka and Rushton, J. Physiol. 185 (1966) 536: a receptor that saturates as a hyperbola")
def hyperbolic_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Below a knee the reading is true; above, d becomes d/(1 + d/room)."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.02, 0.08) * conditions.travel

    def rail(y: Array) -> Array:
        over = np.maximum(y - (limit - room), 0.0)
        value: Array = np.minimum(y, limit - room) + over / (1.0 + over / room)
        return value

    return Built(_read(rail, conditions), {"limit": limit})


@tuning(
    "Gelb and Vander Velde, Multiple-Input Describing Functions (1968): a rail with residual gain"
)
def leaking_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A clipped reading that still grows a little beyond the rail."""
    limit, share = _read_limit(size, conditions), rng.uniform(0.01, 0.05)
    law = _read(lambda y: np.where(y < limit, y, limit + share * (y - limit)), conditions)
    return Built(law, {"limit": limit})


@reporting("Zölzer, DAFX (2011): exponential distortion, 1 - exp(-x)")
def exponential_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee the reading approaches its limit exponentially."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.03, 0.10) * conditions.travel
    knee = limit - room

    def rail(y: Array) -> Array:
        over = np.maximum(y - knee, 0.0)
        value: Array = np.minimum(y, knee) - room * np.expm1(-over / room)
        return value

    return Built(_read(rail, conditions), {"limit": limit})


@reporting("Smith, Physical Audio Signal Processing (2010): the arctangent nonlinearity")
def arctangent_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee the reading approaches its limit as an arcus tangent."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.02, 0.07) * conditions.travel
    knee = limit - room

    def rail(y: Array) -> Array:
        over = np.maximum(y - knee, 0.0)
        bend = 2.0 * room / np.pi
        value: Array = np.minimum(y, knee) + bend * np.arctan(over / bend)
        return value

    return Built(_read(rail, conditions), {"limit": limit})


def _place(y: Array, conditions: Conditions) -> Array:
    """Return -1 at the bottom of the travel and 1 at its top."""
    value: Array = 2.0 * (y - conditions.bottom) / conditions.travel - 1.0
    return value


@tuning("Fraden, Handbook of Modern Sensors (2016): a calibration polynomial of third degree")
def calibration_polynomial(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An error of Legendre's second and third polynomials, kept straight beyond the travel."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    height = 0.5 * size * conditions.travel

    def bent(y: Array) -> Array:
        x = np.clip(_place(y, conditions), -1.5, 1.5)
        second, third = 0.5 * (3.0 * x**2 - 1.0), 0.5 * (5.0 * x**3 - 3.0 * x)
        value: Array = y + height * (np.cos(angle) * second + 0.4 * np.sin(angle) * third)
        return value

    return Built(_read(bent, conditions), {})


@tuning("Heydemann, Appl. Opt. 20 (1981) 3382: the periodic error of an interferometer or encoder")
def interpolation_error(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A first and a second harmonic of the place within a period of the scale."""
    height = 0.25 * size * conditions.travel
    period = rng.uniform(0.45, 0.9) * conditions.travel
    phase, second = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.0, 0.4)

    def rippled(y: Array) -> Array:
        angle = 2.0 * np.pi * y / period + phase
        value: Array = y + height * (np.sin(angle) + second * np.sin(2.0 * angle))
        return value

    return Built(_read(rippled, conditions), {})


@reporting("Doebelin, Measurement Systems (2003): an unbalanced Wheatstone bridge, x/(1 + a x)")
def unbalanced_bridge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A bridge whose reading falls short of (or exceeds) the straight line by a hyperbola."""
    bend = min(size, 0.8) * rng.choice([-0.5, 1.0])

    def bridge(y: Array) -> Array:
        x = np.clip((y - conditions.bottom) / conditions.travel, -0.9, 2.5)
        outside = (y - conditions.bottom) / conditions.travel - x
        value: Array = conditions.bottom + conditions.travel * ((1.0 + bend) * x / (1.0 + bend * x))
        return value + conditions.travel * outside

    return Built(_read(bridge, conditions), {})


@reporting("Doebelin, Measurement Systems (2003): the angle of a lever that a displacement turns")
def lever_angle(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The arcus tangent of the place, compressed towards both ends, more to one of them."""
    steep = 2.5 * min(size, 1.5)
    centre = rng.uniform(-0.6, 0.6)

    def compressed(y: Array) -> Array:
        x = _place(y, conditions) - centre
        value: Array = conditions.median + 0.5 * conditions.travel * np.arctan(steep * x) / steep
        return value

    return Built(_read(compressed, conditions), {})


@reporting("Steinhart and Hart, Deep-Sea Res. 15 (1968) 497: an exponential element made straight")
def exponential_element(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A thermistor's exponential through the ends of the travel, bent up or down."""
    bend = 2.0 * size * rng.choice([-1.0, 1.0])

    def element(y: Array) -> Array:
        x = np.clip((y - conditions.bottom) / conditions.travel, -1.0, 2.0)
        value: Array = conditions.bottom + conditions.travel * np.expm1(bend * x) / np.expm1(bend)
        return value

    return Built(_read(element, conditions), {})


EFFECTS = (
    EffectKind(
        "dead_zone", Port.INPUT, 0.04, 0.5, "1",
        (rounded_threshold, overlapped_valve, diode_drop, square_law_foot),
    ),
    EffectKind(
        "input_saturation", Port.INPUT, 0.02, 0.45, "1",
        (parabolic_shoulder, residual_gain, error_integral, falling_tube),
    ),
    EffectKind(
        "output_saturation", Port.OUTPUT, 0.02, 0.7, "1",
        (hyperbolic_rail, leaking_rail, exponential_rail, arctangent_rail),
    ),
    EffectKind(
        "sensor_nonlinearity", Port.OUTPUT, 0.005, 1.5, "1",
        (calibration_polynomial, interpolation_error, unbalanced_bridge, lever_angle,
         exponential_element),
    ),
)  # fmt: skip
