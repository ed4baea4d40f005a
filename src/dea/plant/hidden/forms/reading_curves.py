"""Curves of the reading: saturations of the output and bent sensors."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, tuning
from dea.plant.hidden.forms.gauges import hot_wire, tank_gauge
from dea.plant.hidden.forms.kernels import bent_above, reading_curve, true_at_ends
from dea.plant.hidden.forms.limiters import cubic_clipper, limiting_stages, rippled_limit
from dea.plant.signal_law import SignalLaw


def _read_limit(size: float, conditions: Conditions) -> float:
    return conditions.top - size * conditions.travel


@tuning("Naka and Rushton, J. Physiol. 185 (1966) 536: a receptor that saturates as a hyperbola")
def hyperbolic_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Below a knee the reading is true; above, d becomes d/(1 + d/room)."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.02, 0.08) * conditions.travel
    rail = bent_above(limit - room, lambda d: d / (1.0 + d / room))
    return Built(reading_curve(rail, conditions), {"limit": limit})


@tuning(
    "Gelb and Vander Velde, Multiple-Input Describing Functions (1968): a rail with residual gain"
)
def leaking_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A clipped reading that still grows a little beyond the rail."""
    limit, share = _read_limit(size, conditions), rng.uniform(0.01, 0.05)
    law = reading_curve(lambda y: np.where(y < limit, y, limit + share * (y - limit)), conditions)
    return Built(law, {"limit": limit})


@tuning("Bennett, Bell Syst. Tech. J. 27 (1948) 446: a converter that is overloaded")
def overloaded_converter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A reading that is clipped at the limit, and a little above the bottom."""
    limit = _read_limit(size, conditions)
    floor = conditions.bottom + rng.uniform(0.0, 0.2) * size * conditions.travel
    return Built(reading_curve(lambda y: np.clip(y, floor, limit), conditions), {"limit": limit})


@tuning("Knoll, Radiation Detection and Measurement (2010): a counter that is paralysed")
def paralysed_counter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee d becomes d exp(-d/d0): the reading flattens to a crest near the top."""
    knee = _read_limit(size, conditions)
    crest = rng.uniform(0.7, 1.0) * size * conditions.travel
    counted = bent_above(knee, lambda d: d * np.exp(-d / crest))
    return Built(reading_curve(counted, conditions), {})


@njit(cache=True)
def _recovering(c: Array, m: Array, y: Array) -> None:
    """Clip, and stay at the limit until an integral of the overload is worked off.

    c: limit, rate of recovery (output per second), largest integral; m: the integral.
    """
    limit, rate, most = c
    for k in range(y.shape[0]):
        over = y[k] - limit
        if over > 0.0:
            m[0] = min(m[0] + SUBSTEP * over, most)
        else:
            m[0] = max(m[0] - SUBSTEP * (rate - over), 0.0)
        if over > 0.0 or m[0] > 0.0:
            y[k] = limit


@tuning("Franco, Design with Operational Amplifiers (2015): recovery from an overload")
def overload_recovery(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A clipped reading that stays at the limit for up to 0.05 to 0.25 band periods longer."""
    limit, time = _read_limit(size, conditions), rng.uniform(0.05, 0.25) * conditions.time
    rate = 0.1 * conditions.travel
    constants = [limit, rate, rate * time]
    return Built(SignalLaw(_recovering, constants, output=True), {"limit": limit})


@tuning("Storm et al., IEEE J. Solid-State Circuits 41 (2006) 2095: linear, then logarithmic")
def logarithmic_pixel(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Below a knee the reading is true; above, it grows with the logarithm."""
    knee = _read_limit(size, conditions)
    room = rng.uniform(0.01, 0.04) * conditions.travel
    law = reading_curve(bent_above(knee, lambda d: room * np.log1p(d / room)), conditions)
    return Built(law, {})


@njit(cache=True)
def _blocking(c: Array, m: Array, y: Array) -> None:
    """Clip at c[0]; what is over charges a bias m[0] in c[1] seconds, which decays in c[2]."""
    for k in range(y.shape[0]):
        biased = y[k] - m[0]
        y[k] = min(biased, c[0])
        m[0] += SUBSTEP * ((biased - y[k]) / c[1] - m[0] / c[2])


@tuning("Langford-Smith, Radiotron Designer's Handbook (1953): a grid that blocks after overload")
def blocking_grid(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A clipped reading that is too low for 0.5 to 3 band periods after it was clipped."""
    limit, decay = _read_limit(size, conditions), rng.uniform(0.5, 3.0) * conditions.time
    constants = [limit, decay / rng.uniform(0.15, 0.5), decay]
    return Built(SignalLaw(_blocking, constants, output=True), {"limit": limit})


@tuning("Zölzer, DAFX (2011): exponential distortion, 1 - exp(-x)")
def exponential_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee the reading approaches its limit exponentially."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.03, 0.10) * conditions.travel
    rail = bent_above(limit - room, lambda d: -room * np.expm1(-d / room))
    return Built(reading_curve(rail, conditions), {"limit": limit})


@tuning("Smith, Physical Audio Signal Processing (2010): the arctangent nonlinearity")
def arctangent_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above a knee the reading approaches its limit as an arcus tangent."""
    limit = _read_limit(size, conditions)
    room = rng.uniform(0.02, 0.07) * conditions.travel
    bend = 2.0 * room / np.pi
    rail = bent_above(limit - room, lambda d: bend * np.arctan(d / bend))
    return Built(reading_curve(rail, conditions), {"limit": limit})


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

    return Built(reading_curve(bent, conditions), {})


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

    return Built(reading_curve(rippled, conditions), {})


@tuning("Doebelin, Measurement Systems (2003): a potentiometer with a load across its wiper")
def loaded_potentiometer(size: float, conditions: Conditions, rng: Generator) -> Built:
    """x/(1 + r x(1 - x)), true at both ends; the load may be at either of them."""
    ratio, turned = 5.0 * size, rng.random() < 0.5

    def loaded(y: Array) -> Array:
        place = (y - conditions.bottom) / conditions.travel
        inside = np.clip(place, 0.0, 1.0)
        x = 1.0 - inside if turned else inside
        share = x / (1.0 + ratio * x * (1.0 - x))
        share = 1.0 - share if turned else share
        value: Array = conditions.bottom + conditions.travel * (share + place - inside)
        return value

    return Built(reading_curve(loaded, conditions), {})


@tuning("Doebelin, Measurement Systems (2003): a calibration curve, here of a cable at an angle")
def oblique_cable(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The length of a cable from a point two ``size`` travels beside the line of the motion."""
    beside = 2.0 * size * conditions.travel
    foot = conditions.bottom - rng.uniform(0.0, 0.2) * conditions.travel

    def length(y: Array) -> Array:
        value: Array = np.hypot(y - foot, beside)
        return value

    return Built(true_at_ends(length, conditions), {})


@tuning("Furlani, Permanent Magnet and Electromechanical Devices (2001): a magnet's axial field")
def approached_magnet(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A Hall sensor in the field of a cylindrical magnet, scaled to be true at both ends."""
    radius = conditions.travel * rng.uniform(0.8, 1.2) / size
    length, nearest = rng.uniform(0.5, 1.5) * radius, 0.25 * radius

    def field(y: Array) -> Array:
        z = np.maximum(nearest + conditions.top - y, -2.0 * length)
        value: Array = (z + length) / np.hypot(z + length, radius) - z / np.hypot(z, radius)
        return value

    return Built(true_at_ends(field, conditions), {})


@tuning("Kester, The Data Conversion Handbook (2005): the nonlinearity of a segmented converter")
def segmented_converter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An error that is a straight line in each of five to eight segments of the travel."""
    ends = np.linspace(conditions.bottom, conditions.top, int(rng.integers(6, 10)))
    errors = rng.choice([-1.0, 1.0], ends.size) * rng.uniform(0.3, 1.0, ends.size)
    errors[[0, -1]] = 0.0
    # So small that the reading grows everywhere.
    height = min(0.25 * size * conditions.travel, 0.45 * (ends[1] - ends[0]))
    law = reading_curve(lambda y: y + height * np.interp(y, ends, errors), conditions)
    return Built(law, {})


@tuning("Razavi, Principles of Data Conversion System Design (1995): bits of unequal weight")
def mismatched_bits(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Jumps where one of the four highest bits changes, smaller ones for the lower bits."""
    order = np.arange(4)
    height = 0.2 * min(size, 1.0) * conditions.travel
    wrong = height * rng.choice([-1.0, 1.0], 4) * rng.uniform(0.3, 1.0, 4) / 2.0 ** (0.5 * order)

    def converted(y: Array) -> Array:
        place = np.clip((y - conditions.bottom) / conditions.travel, 0.0, 1.0 - 1e-9)
        bits = np.floor(place[:, None] * 2.0 ** (order + 1)) % 2.0
        value: Array = y + bits @ wrong
        return value

    return Built(reading_curve(converted, conditions), {})


@tuning("Jones, J. Sci. Instrum. 38 (1961) 37: an optical lever, read on a straight scale")
def optical_lever(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The tangent of the turned beam, stretched towards both ends, more to one of them."""
    turn, centre = 0.8 * min(size, 1.25), rng.uniform(-0.3, 0.3)

    def spot(y: Array) -> Array:
        angle = turn * (_place(y, conditions) - centre)
        inside = np.clip(angle, -1.3, 1.3)
        value: Array = np.tan(inside) + angle - inside
        return conditions.median + 0.5 * conditions.travel * value / turn

    return Built(reading_curve(spot, conditions), {})


@tuning("Todd, The Potentiometer Handbook (1975): a track of uneven resistance")
def uneven_track(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A wiper on 30 to 80 pieces of track whose resistances are lognormal, true at both ends."""
    pieces = np.exp(size * rng.standard_normal(int(rng.integers(30, 81))))
    divided = np.concatenate([[0.0], np.cumsum(pieces) / pieces.sum()])
    joints = np.linspace(0.0, 1.0, divided.size)

    def tapped(y: Array) -> Array:
        place = (y - conditions.bottom) / conditions.travel
        error = np.interp(place, joints, divided) - np.clip(place, 0.0, 1.0)
        value: Array = y + conditions.travel * error
        return value

    return Built(reading_curve(tapped, conditions), {})


@tuning(
    "Cook and Hamm, Appl. Opt. 18 (1979) 3230: light that falls with the square of the distance"
)
def light_probe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The light of a target that comes or goes, scaled to be true at both ends.

    At its nearest it is 0.7 to 1.3 travels over ``size`` away.
    """
    nearest, comes = conditions.travel * rng.uniform(0.7, 1.3) / size, rng.random() < 0.5

    def light(y: Array) -> Array:
        away = conditions.top - y if comes else y - conditions.bottom
        value: Array = np.maximum(1.0 + away / nearest, 0.2) ** -2.0
        return value

    return Built(true_at_ends(light, conditions), {})


@tuning("Suzaki and Tachibana, Appl. Opt. 14 (1975) 2809: a knife-edge across a Gaussian beam")
def knife_edge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The light past an edge that moves with the output, scaled to be true at both ends."""
    from scipy.special import erf

    steep, centre = 1.2 * min(size, 1.25), rng.uniform(-0.4, 0.4)
    return Built(
        true_at_ends(lambda y: erf(steep * (_place(y, conditions) - centre)), conditions), {}
    )


@tuning("Doebelin, Measurement Systems (2003): an unbalanced Wheatstone bridge, x/(1 + a x)")
def unbalanced_bridge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A bridge whose reading falls short of (or exceeds) the straight line by a hyperbola."""
    bend = min(size, 0.8) * rng.choice([-0.5, 1.0])

    def bridge(y: Array) -> Array:
        place = (y - conditions.bottom) / conditions.travel
        x = np.clip(place, -0.9, 2.5)
        rest = np.maximum(1.0 + bend * x, 1e-4)  # the largest bend has its pole at 2.5 travels
        value: Array = conditions.bottom + conditions.travel * ((1.0 + bend) * x / rest)
        return value + conditions.travel * (place - x)

    return Built(reading_curve(bridge, conditions), {})


@tuning("Doebelin, Measurement Systems (2003): the angle of a lever that a displacement turns")
def lever_angle(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The arcus tangent of the place, compressed towards both ends, more to one of them."""
    steep = 2.5 * min(size, 1.5)
    centre = rng.uniform(-0.6, 0.6)

    def compressed(y: Array) -> Array:
        x = _place(y, conditions) - centre
        value: Array = conditions.median + 0.5 * conditions.travel * np.arctan(steep * x) / steep
        return value

    return Built(reading_curve(compressed, conditions), {})


@tuning("Steinhart and Hart, Deep-Sea Res. 15 (1968) 497: an exponential element made straight")
def exponential_element(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A thermistor's exponential through the ends of the travel, bent up or down."""
    bend = 2.0 * size * rng.choice([-1.0, 1.0])

    def element(y: Array) -> Array:
        x = np.clip((y - conditions.bottom) / conditions.travel, -1.0, 2.0)
        value: Array = conditions.bottom + conditions.travel * np.expm1(bend * x) / np.expm1(bend)
        return value

    return Built(reading_curve(element, conditions), {})


EFFECTS = (
    EffectKind(
        "output_saturation", Port.OUTPUT, 0.02, 0.7, "1",
        (hyperbolic_rail, leaking_rail, overloaded_converter, paralysed_counter, overload_recovery,
         logarithmic_pixel, blocking_grid, exponential_rail, arctangent_rail, limiting_stages,
         rippled_limit, cubic_clipper),
    ),
    EffectKind(
        "sensor_nonlinearity", Port.OUTPUT, 0.005, 1.5, "1",
        (calibration_polynomial, interpolation_error, loaded_potentiometer, oblique_cable,
         approached_magnet, segmented_converter, mismatched_bits, optical_lever, uneven_track,
         light_probe, knife_edge, unbalanced_bridge, lever_angle, exponential_element,
         hot_wire, tank_gauge),
    ),
)  # fmt: skip
