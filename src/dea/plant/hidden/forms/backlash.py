"""Backlash: what is read follows the output with play between two flanks."""

from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import between
from dea.plant.signal_law import SignalLaw

_FLANK_POINTS = 8001
_STRIDE = 0.05  # of the quickest time of a shaft, in its internal steps


@njit(cache=True)
def _pushed(c: Array, m: Array, y: Array) -> None:
    """Stay where the flanks have pushed it; c: low, step, and tables of both flanks over y.

    m: whether started, and the place; before the start, the place as a share of the gap.
    """
    points = (c.shape[0] - 2) // 2
    for k in range(y.shape[0]):
        below = between(c[2 : 2 + points], c[0], c[1], y[k])
        above = between(c[2 + points :], c[0], c[1], y[k])
        if m[0] == 0.0:
            m[0], m[1] = 1.0, below + m[1] * (above - below)
        m[1] = min(max(m[1], below), above)
        y[k] = m[1]


def _between_flanks(
    below: Callable[[Array], Array],
    above: Callable[[Array], Array],
    conditions: Conditions,
    rng: Generator,
) -> SignalLaw:
    """Return the play between two flanks over the output, from anywhere in the gap on."""
    reach = 4.0 * conditions.travel
    places = np.linspace(conditions.bottom - reach, conditions.top + reach, _FLANK_POINTS)
    start = [places[0], places[1] - places[0]]
    constants = np.concatenate([start, below(places), above(places)])
    return SignalLaw(_pushed, constants, [0.0, rng.uniform()], output=True)


@tuning("Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989): the play of a dry follower")
def dry_follower(size: float, conditions: Conditions, rng: Generator) -> Built:
    """What is read stays where it was pushed to, by flanks that are ``size`` travels apart."""
    gap = size * conditions.travel
    law = _between_flanks(lambda y: y - 0.5 * gap, lambda y: y + 0.5 * gap, conditions, rng)
    return Built(law, {"gap": gap})


@njit(cache=True)
def _coasting(c: Array, m: Array, y: Array) -> None:
    """Coast between rigid flanks, half a gap c[0] off, with a speed that decays in c[1] seconds.

    m: whether started, place (before the start its share of the gap) and speed.
    """
    half, time = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0] + (2.0 * m[1] - 1.0) * half
    left = -np.expm1(-SUBSTEP / time)
    for k in range(y.shape[0]):
        free = m[1] + time * left * m[2]
        place = min(max(free, y[k] - half), y[k] + half)
        # It lands without a bounce, and has the speed of the flank that it is at.
        m[2] = m[2] * (1.0 - left) if place == free else (place - m[1]) / SUBSTEP
        m[1] = place
        y[k] = place


@tuning("Gelb and Vander Velde, Multiple-Input Describing Functions (1968): a load that coasts")
def coasting_load(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A load that goes on across a gap of ``size`` travels, and lands on the other flank.

    Drag stops it within 0.02 to 0.3 band periods.
    """
    gap = size * conditions.travel
    time = conditions.time * np.exp(rng.uniform(np.log(0.02), np.log(0.3)))
    law = SignalLaw(_coasting, [0.5 * gap, time], [0.0, rng.uniform(), 0.0], output=True)
    return Built(law, {"gap": gap})


@tuning("Vörös, Automatica 46 (2010) 369: flanks of unequal slopes")
def unequal_slopes(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A follower whose gain is larger one way than the other, with ``size`` travels on average.

    The gap grows from one end of the travel to the other by 0.6 to 1.6 of its mean.
    """
    half, growth = 0.5 * size * conditions.travel, rng.uniform(0.3, 0.8) * rng.choice([-1.0, 1.0])
    middle = 0.5 * (conditions.bottom + conditions.top)

    def off(y: Array) -> Array:
        place = np.clip(2.0 * (y - middle) / conditions.travel, -1.0, 1.0)
        value: Array = half * (1.0 + growth * place)
        return value

    return Built(_between_flanks(lambda y: y - off(y), lambda y: y + off(y), conditions, rng), {})


@njit(cache=True)
def _dragged(c: Array, m: Array, y: Array) -> None:
    """Follow at a rate in proportion to what is beyond half a gap, exactly at a held output.

    c: half the gap, and what a sub-step leaves of what is beyond; m: as of a dry follower.
    """
    half, kept = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0] + (2.0 * m[1] - 1.0) * half
    for k in range(y.shape[0]):
        away = y[k] - m[1]
        beyond = away - min(max(away, -half), half)
        m[1] += (1.0 - kept) * beyond
        y[k] = m[1]


@tuning("Nordin and Gutman, Automatica 38 (2002) 1633: a spring with a dead zone, here on drag")
def dead_zone_spring(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A viscous load behind a spring with a dead zone of ``size`` travels.

    At a speed of one travel in a band period the spring gives way by 0.05 to 0.25 of the gap.
    """
    gap = size * conditions.travel
    time = rng.uniform(0.05, 0.25) * size * conditions.time
    constants = [0.5 * gap, np.exp(-SUBSTEP / time)]
    return Built(SignalLaw(_dragged, constants, [0.0, rng.uniform()], output=True), {"gap": gap})


@njit(cache=True)
def _taken_up(c: Array, m: Array, y: Array) -> None:
    """Creep across the gap to one flank: c: half the gap, the way in a sub-step; m: as above."""
    half, way = c
    if m[0] == 0.0:
        m[0], m[1] = 1.0, y[0] + (2.0 * m[1] - 1.0) * half
    for k in range(y.shape[0]):
        m[1] = min(max(m[1] + way, y[k] - half), y[k] + half)
        y[k] = m[1]


@tuning("Michalec, Precision Gearing: Theory and Practice (1966): a weak spring takes up the play")
def weak_preload(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring closes a gap of ``size`` travels to one side, slowly because of drag.

    It takes what is read there at 0.02 to 0.2 of the mean speed.
    """
    gap = size * conditions.travel
    speed = conditions.speed * np.exp(rng.uniform(np.log(0.02), np.log(0.2)))
    constants = [0.5 * gap, SUBSTEP * speed * rng.choice([-1.0, 1.0])]
    return Built(SignalLaw(_taken_up, constants, [0.0, rng.uniform()], output=True), {"gap": gap})


@tuning("Litvin and Fuentes, Gear Geometry and Applied Theory (2004): gears that are eccentric")
def eccentric_gears(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gap of ``size`` travels on average that is wide and narrow in turn as the gears turn.

    It changes by 0.3 to 0.7 of its mean, once in 0.6 to 1.5 travels.
    """
    half, depth = 0.5 * size * conditions.travel, rng.uniform(0.3, 0.7)
    turn, phase = rng.uniform(0.6, 1.5) * conditions.travel, rng.uniform(0.0, 2.0 * np.pi)

    def off(y: Array) -> Array:
        angle = 2.0 * np.pi * (y - conditions.bottom) / turn + phase
        value: Array = half * (1.0 + depth * np.sin(angle))
        return value

    return Built(_between_flanks(lambda y: y - off(y), lambda y: y + off(y), conditions, rng), {})


@njit(cache=True)
def _twisted(c: Array, m: Array, y: Array) -> None:
    """A load behind a damped shaft with a gap, whose twist goes on where it is in the gap.

    c: half the gap, stiffness, damping and drag over the load's inertia, internal steps per
    sub-step; m: whether started, place (before the start its share of the gap), speed, place
    within the gap, and last output.
    """
    half, stiffness, damping, drag, steps = c[0], c[1], c[2], c[3], int(c[4])
    if m[0] == 0.0:
        m[3] = (1.0 - 2.0 * m[1]) * half
        m[0], m[1], m[4] = 1.0, y[0] - m[3], y[0]
    dt = SUBSTEP / steps
    for k in range(y.shape[0]):
        rate = (y[k] - m[4]) / SUBSTEP
        for i in range(steps):
            twist = m[4] + rate * dt * i - m[1] - m[3]
            turn = rate - m[2]
            # Its own rate is one without a moment; a flank that it is pressed to stops it.
            moved = turn + stiffness / damping * twist
            if (m[3] >= half and moved > 0.0) or (m[3] <= -half and moved < 0.0):
                moved = 0.0
            moment = stiffness * twist + damping * (turn - moved)
            m[2] += dt * (moment - drag * m[2])
            m[1] += dt * m[2]
            m[3] = min(max(m[3] + dt * moved, -half), half)
        m[4] = y[k]
        y[k] = m[1]


@tuning(
    "Nordin, Galić and Gutman, Int. J. Adapt. Control Signal Process. 11 (1997) 49: damped shaft"
)
def damped_shaft(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A load with inertia and drag behind a shaft with damping and a gap of ``size`` travels.

    Drag stops it within 0.02 to 0.15 band periods, and twists the shaft by 0.05 to 0.2 of the gap
    at a speed of one travel in a band period; without drag the shaft's damping would be 0.2 to 0.8
    of the critical one.
    """
    gap = size * conditions.travel
    drag = 1.0 / (conditions.time * np.exp(rng.uniform(np.log(0.02), np.log(0.15))))
    stiffness = drag / (rng.uniform(0.05, 0.2) * size * conditions.time)
    damping = 2.0 * rng.uniform(0.2, 0.8) * np.sqrt(stiffness)
    quickest = max(stiffness / damping, np.sqrt(stiffness), damping + drag)
    steps = max(np.ceil(SUBSTEP * quickest / _STRIDE), 1.0)
    constants = [0.5 * gap, stiffness, damping, drag, steps]
    memory = [0.0, rng.uniform(), 0.0, 0.0, 0.0]
    return Built(SignalLaw(_twisted, constants, memory, output=True), {"gap": gap})


@tuning("Archard, J. Appl. Phys. 24 (1953) 981: wear by every pass, here of a screw's middle")
def worn_screw(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gap that is ``size`` travels where a screw is worn most, and 0.1 to 0.5 of it elsewhere.

    The worn piece is bell-shaped, within 0.15 to 0.35 travels of a place near the middle; the
    flanks share the wear unequally.
    """
    gap, unworn = size * conditions.travel, rng.uniform(0.1, 0.5)
    place = conditions.bottom + rng.uniform(0.35, 0.65) * conditions.travel
    width, share = rng.uniform(0.15, 0.35) * conditions.travel, rng.uniform()

    def worn(y: Array) -> Array:
        value: Array = (1.0 - unworn) * gap * np.exp(-0.5 * ((y - place) / width) ** 2)
        return value

    new = 0.5 * unworn * gap
    law = _between_flanks(
        lambda y: y - new - share * worn(y), lambda y: y + new + (1.0 - share) * worn(y),
        conditions, rng,
    )  # fmt: skip
    return Built(law, {})


@njit(cache=True)
def _rattling(c: Array, m: Array, y: Array) -> None:
    """Coast between flanks, half a gap c[0] off, and bounce with the restitution c[2].

    c[1]: what a sub-step leaves of the speed; m: whether started, place (before the start its share
    of the gap), speed and last output.
    """
    half, kept, bounce = c
    if m[0] == 0.0:
        m[0], m[1], m[3] = 1.0, y[0] + (2.0 * m[1] - 1.0) * half, y[0]
    for k in range(y.shape[0]):
        speed = (y[k] - m[3]) / SUBSTEP
        m[2] *= kept
        free = m[1] + SUBSTEP * m[2]
        m[1] = min(max(free, y[k] - half), y[k] + half)
        if (free > m[1] and m[2] > speed) or (free < m[1] and m[2] < speed):
            m[2] = speed - bounce * (m[2] - speed)
        m[3] = y[k]
        y[k] = m[1]


@reporting("Dubowsky and Freudenstein, J. Eng. Ind. 93 (1971) 305: a joint whose flanks are hit")
def rattling_joint(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A load that bounces between flanks ``size`` travels apart, with a restitution of 0.3 to 0.7.

    Drag stops it within 0.03 to 0.3 band periods.
    """
    gap = size * conditions.travel
    time = conditions.time * np.exp(rng.uniform(np.log(0.03), np.log(0.3)))
    constants = [0.5 * gap, np.exp(-SUBSTEP / time), rng.uniform(0.3, 0.7)]
    memory = [0.0, rng.uniform(), 0.0, 0.0]
    return Built(SignalLaw(_rattling, constants, memory, output=True), {"gap": gap})


@njit(cache=True)
def _closed(left: float, film: float, way: float) -> float:
    """Return what is left of a clearance that an output closes by ``way``, with grease in it.

    The clearance g falls by g³/(g³ + film³) of the way: g - film³/(2g²) falls by all of it.
    """
    cube = 0.5 * film**3
    wanted = left - cube / left**2 - way
    g = np.sqrt(cube / (left - wanted))
    for _ in range(40):  # Newton's rule, from below
        change = (g - cube / g**2 - wanted) / (1.0 + 2.0 * cube / g**3)
        g -= change
        if abs(change) < 1e-12 * left:
            break
    value: float = g
    return value


@njit(cache=True)
def _greased(c: Array, m: Array, y: Array) -> None:
    """Follow what grease presses, half a gap c[0]; c[1]: the film that takes half of the way.

    m: whether started, place within the gap (before the start its share), and last output.
    """
    half, film = c
    if m[0] == 0.0:
        m[0], m[1], m[2] = 1.0, (2.0 * m[1] - 1.0) * 0.9 * half, y[0]
    for k in range(y.shape[0]):
        way = y[k] - m[2]
        side = np.sign(way)
        if side != 0.0:
            m[1] = side * (half - _closed(half - side * m[1], film, abs(way)))
        m[2] = y[k]
        y[k] -= m[1]


@reporting("Hamrock, Fundamentals of Fluid Film Lubrication (1994): a joint full of grease")
def greased_joint(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A gap of ``size`` travels whose grease moves a viscous load before the flank touches.

    A film of 0.6 to 1.2 of half the gap takes half of the way; grease that is let go does not pull.
    """
    half = 0.5 * size * conditions.travel
    constants = [half, rng.uniform(0.6, 1.2) * half]
    return Built(SignalLaw(_greased, constants, [0.0, rng.uniform(), 0.0], output=True), {})


EFFECTS = (
    EffectKind(
        "backlash", Port.OUTPUT, 0.003, 0.25, "1",
        (dry_follower, coasting_load, unequal_slopes, dead_zone_spring, weak_preload,
         eccentric_gears, damped_shaft, worn_screw, rattling_joint, greased_joint),
    ),
)  # fmt: skip
