"""Curves of the command: dead zones and saturations of the input."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import bent_above, command_curve
from dea.plant.hidden.forms.limiters import overmodulated_bridge, programme_limiter
from dea.plant.signal_law import SignalLaw


def _softplus(x: Array) -> Array:
    value: Array = np.logaddexp(0.0, x)
    return value


def _threshold(size: float, conditions: Conditions) -> tuple[float, float]:
    """Return the threshold and the gain above it that leaves the highest command unchanged."""
    threshold = conditions.low + size * conditions.span
    return threshold, conditions.high / (conditions.high - threshold)


@tuning("Tao and Kokotović, IEEE Trans. Autom. Control 39 (1994) 59, with a rounded knee")
def rounded_threshold(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A threshold whose knee is a softplus."""
    threshold, gain = _threshold(size, conditions)
    knee = rng.uniform(0.01, 0.04) * conditions.high
    law = command_curve(lambda u: gain * knee * _softplus((u - threshold) / knee), conditions)
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

    return Built(command_curve(flow, conditions), {"threshold": threshold})


@tuning("Herschel and Bulkley, Kolloid-Z. 39 (1926) 291: flow above a yield stress, as a power")
def yield_stress(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Nothing below the threshold, above it a power of what is over, larger with ``size``."""
    threshold, gain = _threshold(size, conditions)
    power, room = 1.0 + size * rng.uniform(0.5, 2.0), conditions.high - threshold

    def flow(u: Array) -> Array:
        value: Array = gain * room * (np.maximum(u - threshold, 0.0) / room) ** power
        return value

    return Built(command_curve(flow, conditions), {"threshold": threshold})


@tuning("Gelb and Vander Velde, Multiple-Input Describing Functions (1968): a line with a jump")
def jumping_threshold(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Nothing below the threshold; at it the output jumps to 0.3 to 0.8 times the command."""
    threshold, _ = _threshold(size, conditions)
    jump = rng.uniform(0.3, 0.8) * threshold
    gain = (conditions.high - jump) / (conditions.high - threshold)
    law = command_curve(
        lambda u: np.where(u < threshold, 0.0, jump + gain * (u - threshold)), conditions
    )
    return Built(law, {"threshold": threshold})


@tuning("McCloy and Martin, Control of Fluid Power (1980): a relief valve that cracks open")
def cracking_valve(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Nothing below the threshold, above it a lift in proportion, times the root of a pressure.

    Of the pressure at the highest command 0.5 to 0.8 are constant, the rest is the command's.
    """
    threshold, gain = _threshold(size, conditions)
    constant = rng.uniform(0.5, 0.8)

    def flow(u: Array) -> Array:
        pressure = constant + (1.0 - constant) * u / conditions.high
        value: Array = gain * np.maximum(u - threshold, 0.0) * np.sqrt(pressure)
        return value

    return Built(command_curve(flow, conditions), {"threshold": threshold})


@njit(cache=True)
def _glow_lamp(c: Array, m: Array, u: Array) -> None:
    """Pass nothing until c[0], then c[2] times what exceeds c[1] until that is gone; m: lit."""
    for k in range(u.shape[0]):
        m[0] = 1.0 if u[k] > (c[1] if m[0] == 1.0 else c[0]) else 0.0
        u[k] = c[2] * (u[k] - c[1]) if m[0] == 1.0 else 0.0


@tuning("Pearson and Anson, Proc. Phys. Soc. 34 (1922) 204: a neon lamp that strikes and goes out")
def glow_lamp(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A lamp in series strikes at the threshold and then takes 0.5 to 0.85 of it, until it dies."""
    strike, _ = _threshold(size, conditions)
    burning = rng.uniform(0.5, 0.85) * strike
    constants = [strike, burning, conditions.high / (conditions.high - burning)]
    return Built(SignalLaw(_glow_lamp, constants), {})


@tuning("Banwell and Jayakumar, Electron. Lett. 36 (2000) 291: a diode in series with a load")
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
    law = command_curve(lambda u: np.maximum(load(u), 0.0) * conditions.high / top, conditions)
    return Built(law, {})


@tuning("Sedra and Smith, Microelectronic Circuits (2004): a square-law stage above threshold")
def square_law_foot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Nothing below the threshold, a parabola above it that becomes a straight line."""
    threshold, _ = _threshold(size, conditions)
    foot = rng.uniform(0.15, 0.4) * (conditions.high - threshold)

    def drawn(u: Array) -> Array:
        over = np.maximum(u - threshold, 0.0)
        value: Array = np.where(over < foot, over * over / (2.0 * foot), over - 0.5 * foot)
        return value

    top = float(drawn(np.array([conditions.high]))[0])
    law = command_curve(lambda u: drawn(u) * conditions.high / top, conditions)
    return Built(law, {"threshold": threshold})


@reporting("Stepanoff, Centrifugal and Axial Flow Pumps (1957): a pump against a static head")
def static_head(size: float, conditions: Conditions, rng: Generator) -> Built:
    """No flow q until the speed u holds the head of the threshold; above it u² - b u q - q² does.

    The droop b is 0.1 to 0.5, so that the flow rises at once and then ever less.
    """
    threshold, _ = _threshold(size, conditions)
    droop = rng.uniform(0.1, 0.5)

    def flow(u: Array) -> Array:
        excess = np.maximum(u * u - threshold * threshold, 0.0)
        value: Array = 0.5 * (np.sqrt((droop * u) ** 2 + 4.0 * excess) - droop * u)
        return value

    top = float(flow(np.array([conditions.high]))[0])
    law = command_curve(lambda u: flow(u) * conditions.high / top, conditions)
    return Built(law, {"threshold": threshold})


@njit(cache=True)
def _gelled(c: Array, m: Array, u: Array) -> None:
    """Pass c[4] times what exceeds a yield stress from c[0] to c[0] + c[1]; m: share that is gel.

    In a sub-step c[2] of what is broken gels, and c[3] times the flow of the gel breaks.
    """
    for k in range(u.shape[0]):
        u[k] = c[4] * max(u[k] - c[0] - c[1] * m[0], 0.0)
        m[0] += c[2] * (1.0 - m[0]) - c[3] * u[k] * m[0]


@tuning("Moore, Trans. Br. Ceram. Soc. 58 (1959) 470: a paste that gels at rest and thins in flow")
def gelling_paste(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A threshold that falls to 0.5 to 0.8 while there is flow, and comes back at rest.

    It gels within 1 to 4 band periods, and the largest flow breaks it ten times as fast.
    """
    threshold, _ = _threshold(size, conditions)
    least = threshold * rng.uniform(0.5, 0.8)
    gelled = SUBSTEP / (conditions.time * rng.uniform(1.0, 4.0))
    constants = [
        least, threshold - least, gelled, 10.0 * gelled / conditions.high,
        conditions.high / (conditions.high - least),
    ]  # fmt: skip
    return Built(SignalLaw(_gelled, constants, [1.0]), {})


@reporting("Buckingham, Proc. ASTM 21 (1921) 1154: a paste in a pipe, whose middle moves as a plug")
def paste_in_pipe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """No flow until the wall yields at the threshold; above it u (1 - 4/3 x + 1/3 x⁴).

    x is the threshold over the command, and the radius of the plug over that of the pipe.
    """
    threshold, _ = _threshold(size, conditions)

    def flow(u: Array) -> Array:
        plug = threshold / np.maximum(u, threshold)
        value: Array = u * (1.0 - plug) ** 2 * (3.0 + 2.0 * plug + plug**2) / 3.0
        return value

    top = float(flow(np.array([conditions.high]))[0])
    law = command_curve(lambda u: flow(u) * conditions.high / top, conditions)
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

    return Built(command_curve(clipped, conditions), {"limit": limit})


@tuning("Gelb and Vander Velde, Multiple-Input Describing Functions (1968): two gains")
def residual_gain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above the limit a small share of the gain remains."""
    limit, share = _ceiling(size, conditions), rng.uniform(0.02, 0.12)
    law = command_curve(lambda u: np.where(u < limit, u, limit + share * (u - limit)), conditions)
    return Built(law, {"limit": limit})


@tuning("Rapp, Proc. 2nd European Conf. Satellite Commun. (1991) 179: a solid-state amplifier")
def solid_state_amplifier(size: float, conditions: Conditions, rng: Generator) -> Built:
    """u/(1 + (u/limit)^2p)^(1/2p): curved over the whole range, without a knee."""
    limit, order = _ceiling(size, conditions), 2.0 * rng.uniform(2.0, 6.0)

    def amplified(u: Array) -> Array:
        value: Array = u / (1.0 + (np.maximum(u, 0.0) / limit) ** order) ** (1.0 / order)
        return value

    return Built(command_curve(amplified, conditions), {"limit": limit})


@njit(cache=True)
def _sagging(c: Array, m: Array, u: Array) -> None:
    """Clip at a rail that falls with the load; m holds whether started and the mean load."""
    rail, sag, share = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, min(u[0], rail / (1.0 + sag))
    for k in range(u.shape[0]):
        u[k] = min(u[k], rail - sag * m[1])
        m[1] += share * (u[k] - m[1])


@tuning("Horowitz and Hill, The Art of Electronics (2015): an unregulated supply that sags")
def sagging_rail(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A rail that sags to its limit under a lasting load and recovers in between."""
    limit, sag = _ceiling(size, conditions), rng.uniform(0.1, 0.4)
    time = conditions.time * rng.uniform(0.5, 4.0)
    constants = [limit * (1.0 + sag), sag, -np.expm1(-SUBSTEP / time)]
    return Built(SignalLaw(_sagging, constants, [0.0, 0.0]), {})


@tuning("Giannoulis et al., J. Audio Eng. Soc. 60 (2012) 399: a compressor with a soft knee")
def peak_limiter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Above the limit a root of order four to ten; between logarithms the knee is a parabola."""
    limit, ratio = _ceiling(size, conditions), rng.uniform(4.0, 10.0)
    width = rng.uniform(0.04, 0.2)

    def compressed(u: Array) -> Array:
        over = np.log(np.maximum(u, 1e-9) / limit)
        inside = np.clip(over + 0.5 * width, 0.0, width)
        bent = inside * inside / (2.0 * width) + np.maximum(over - 0.5 * width, 0.0)
        value: Array = u * np.exp((1.0 / ratio - 1.0) * bent)
        return value

    return Built(command_curve(compressed, conditions), {"limit": limit})


@tuning("Brauer, IEEE Trans. Magn. 11 (1975) 81: a core whose field grows exponentially")
def magnetic_core(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The induction v solves v (1 + exp(b (v²/limit² - 1)) - exp(-b)) = u."""
    limit, steep = _ceiling(size, conditions), rng.uniform(5.0, 12.0)
    induced = np.linspace(0.0, 2.0 * limit, 20_001)
    needed = induced * (1.0 + np.exp(steep * ((induced / limit) ** 2 - 1.0)) - np.exp(-steep))

    def magnetised(u: Array) -> Array:
        value: Array = np.interp(u, needed, induced)
        return value

    return Built(command_curve(magnetised, conditions), {"limit": limit})


@njit(cache=True)
def _stored_charge(c: Array, m: Array, u: Array) -> None:
    """Clip at c[0] while a charge m[0] is left, which the overdrive leaves and loses in c[1]."""
    for k in range(u.shape[0]):
        m[0] = max(m[0] + SUBSTEP * (u[k] - c[0] - m[0] / c[1]), 0.0)
        if m[0] > 0.0:
            u[k] = c[0]


@tuning("Moll, Proc. IRE 42 (1954) 1773: a saturated transistor, which stores a charge")
def stored_charge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A limit that is left when the overdrive's charge is gone, of 0.05 to 0.4 band periods."""
    limit, time = _ceiling(size, conditions), rng.uniform(0.05, 0.4) * conditions.time
    return Built(SignalLaw(_stored_charge, [limit, time]), {"limit": limit})


@tuning("Baum, IRE Trans. Inf. Theory 3 (1957) 193: the smooth limiter of an error integral")
def error_integral(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A straight line up to a knee, and an error integral from there to the limit."""
    from scipy.special import erf

    limit = _ceiling(size, conditions)
    knee = limit * rng.uniform(0.75, 0.92)
    room = limit - knee
    limited = bent_above(knee, lambda d: room * erf(0.5 * np.sqrt(np.pi) * (d / room)))
    return Built(command_curve(limited, conditions), {"limit": limit})


@tuning("Saleh, IEEE Trans. Commun. 29 (1981) 1715: a tube that saturates and falls again")
def falling_tube(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Linear to a knee, then Saleh's quotient x/(1 + x²/4) with its crest, of 1 at x = 2.

    The crest lies as far below the range as the limit of others; the largest command is at x of
    2.2 to 3.
    """
    last = rng.uniform(2.2, 3.0)
    room = size * conditions.span / (last - 1.0)
    knee = conditions.high - last * room

    def quotient(over: Array) -> Array:
        x = over / room
        value: Array = room * x / (1.0 + 0.25 * x * x)
        return value

    return Built(command_curve(bent_above(knee, quotient), conditions), {})


EFFECTS = (
    EffectKind(
        "dead_zone", Port.INPUT, 0.04, 0.5, "1",
        (rounded_threshold, overlapped_valve, yield_stress, jumping_threshold, cracking_valve,
         glow_lamp, diode_drop, square_law_foot, static_head, gelling_paste, paste_in_pipe),
    ),
    EffectKind(
        "input_saturation", Port.INPUT, 0.02, 0.45, "1",
        (parabolic_shoulder, residual_gain, solid_state_amplifier, sagging_rail, peak_limiter,
         magnetic_core, stored_charge, error_integral, falling_tube, overmodulated_bridge,
         programme_limiter),
    ),
)  # fmt: skip
