"""Dry friction: a force that opposes the motion and holds the device still."""

import numpy as np
from numba import float64, njit

from dea.simulation.effects._effect import Effect, Family, Port
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales
from dea.simulation.signatures import FORCE, MEMORY, UPDATE, VECTOR


@njit(float64(float64, float64, float64), cache=True, error_model="numpy")
def _strained(part: float, way: float, elastic: float) -> float:
    """Return the part of its largest deflection that a contact has after a way, in units of it.

    It is elastic up to a part of the largest deflection, and from there creeps towards it. At 1 it
    slips at once, at 0 it is elastic while it is unloaded, and at -1 it is a bristle that always
    creeps.
    """
    if way < 0.0:
        return -_strained(-part, -way, elastic)
    straight = min(max(elastic - part, 0.0), way)
    part, way = part + straight, way - straight
    if way <= 0.0:
        return part
    if elastic >= 1.0:
        return 1.0
    return float(1.0 - (1.0 - part) * np.exp(-way / (1.0 - elastic)))


@njit(float64(float64, float64, VECTOR), cache=True, error_model="numpy")
def _way(z: float, last: float, q: np.ndarray) -> float:
    """Return the way since the last position in largest deflections, none where that is unknown."""
    return 0.0 if np.isnan(last) else float((z - last) / q[1])


@njit(FORCE, cache=True, error_model="numpy")
def force(z: float, w: float, memory: np.ndarray, q: np.ndarray) -> float:
    """Elasto-plastic contact: its deflection is ``memory[0]``, the last position ``memory[1]``.

    A part of it is a film that is sheared instead: it rises with the speed. The largest force grows
    with the place, as the load does.
    """
    part = _strained(memory[0], _way(z, memory[1], q), q[5])
    if q[10] > 0.0:
        part += q[10] * (np.tanh(w / q[11]) - part)
    excess = q[2] / (1.0 + (w / q[3]) ** 2)
    load = 1.0 + q[7] * min(max((z - q[8]) / q[9], -1.5), 1.5)
    return float(-q[0] * load * part * (1.0 + excess) * (1.0 + q[6] * part))


@njit(UPDATE, cache=True, error_model="numpy")
def update(z: float, z_next: float, h: float, memory: np.ndarray, q: np.ndarray) -> None:
    """Deflect the contact, or slip."""
    last = z if np.isnan(memory[1]) else memory[1]
    memory[0] = _strained(memory[0], _way(z_next, last, q), q[5])
    memory[1] = z_next


def memory(q: np.ndarray) -> np.ndarray:
    """Return the deflection at the start, wherever that is."""
    state = np.zeros(MEMORY)
    state[0], state[1] = q[4], np.nan
    return state


def _rate(name: str, spread: float, span: float) -> Parameter:
    """Return a speed that shapes the law, in terms of the ``span`` of the motion."""
    limits = 1e-3 * span, 10.0 * span
    return Parameter(name, "1/s", 0.1 * span, spread, *limits, log=True, shape=True, at_port="rate")


def parameters(scales: Scales) -> tuple[Parameter, ...]:
    """Return the law's parameters.

    These are the force, the deflection before slip, the excess of stiction, Stribeck's rate and the
    deflection at the start; the part of the largest deflection up to which the contact is elastic;
    the asymmetry, by which the friction is larger on the way up and smaller on the way down; the
    growth with the load, by which it is larger at the upper end of the motion than in its middle;
    the part of it that rises with the speed, and the rate by which that has risen.
    """
    span = scales.z_span
    return (
        Parameter("force", "1", 0.05 * span, 1.5, 1e-5, 10.0, log=True, at_port="force"),
        Parameter(
            "slip_deflection",
            "1",
            0.01 * span,
            1.0,
            1e-5 * span,
            0.05 * span,
            log=True,
            shape=True,
            at_port="length",
        ),
        Parameter("stiction_excess", "1", 0.0, 0.5, 0.0, 5.0, shape=True),
        _rate("stribeck_rate", 1.0, span),
        Parameter("start_deflection", "1", 0.0, 0.5, -1.0, 1.0, at_start=True),
        Parameter("elastic_part", "1", 1.0, 0.5, -1.0, 1.0, shape=True),
        Parameter("asymmetry", "1", 0.0, 0.15, -0.5, 0.5, shape=True),
        Parameter("load_growth", "1", 0.0, 0.3 * scales.placed, -0.6, 0.6, shape=True),
        Parameter("middle", "1", scales.z_middle, 0.0),
        Parameter("half_range", "1", 0.5 * span, 0.0),
        Parameter("sheared_part", "1", 0.0, 0.3, 0.0, 1.0, shape=True),
        _rate("shear_rate", 1.5, span),
    )


def starts(scales: Scales) -> tuple[tuple[float, ...], ...]:
    """Return weak to strong friction, with a soft, a hard and a stiff contact, and a sheared film.

    Of a shaft that turns many times, or whose place is not known, the deflection is hardly any part
    of the motion.
    """
    span, middle = scales.z_span, scales.z_middle
    laws = [(part, slip, 0.0) for part in (0.02, 0.08, 0.2) for slip in (0.015, 0.002, 1e-4)]
    laws += [(part, 0.002, 1.0) for part in (0.02, 0.08, 0.2)]
    return tuple(
        (
            part * span, slip * span, 0.0, 0.1 * span, 0.0, 1.0, 0.0, 0.0, middle, 0.5 * span,
            sheared, 0.1 * span,
        )
        for part, slip, sheared in laws
    )  # fmt: skip


EFFECT = Effect(
    name="coulomb_friction",
    port=Port.FORCE,
    family=Family.DISSIPATION,
    symptom="at each reversal the device stands still until the drive has changed enough",
    citation="Dupont et al. (2002), IEEE Transactions on Automatic Control 47:787, elasto-plastic "
    "friction; Canudas de Wit et al. (1995), the same 40:419, bristles; Harris (2001), Rolling "
    "Bearing Analysis, on friction in proportion to the load; Threlfall (1978), Mechanism and "
    "Machine Theory 13:475, on friction that rises with the speed",
    parameters=parameters,
    starts=starts,
    force=force,
    update=update,
    memory=memory,
    needs_position=False,
    opposes_motion=True,
    remembers_motion=True,
    refine=2,
    defining="force",
)
