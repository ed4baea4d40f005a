"""Conditions of a made-up device, and what a law does to signals and along paths."""

from itertools import pairwise

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from dea.plant import forces
from dea.plant.film import SUBSTEP
from dea.plant.hidden import EFFECTS
from dea.plant.hidden.effect import Conditions

CONDITIONS = Conditions(
    low=1.0, high=4.0, rest=0.0, bottom=1.0, median=6.0, top=11.0, stiffness=2.0, duration=60.0,
    time=1.0, cycles=30.0, full_cycles=20.0, path=600.0, rate=100.0, power=1.0, force=True,
)  # fmt: skip

# Where an offset or an exponent that is forgotten would show.
OFFSET = CONDITIONS._replace(rest=0.5, power=2.0)
SAMPLES = round(CONDITIONS.duration / SUBSTEP)
TIME = np.arange(SAMPLES) * SUBSTEP


def built(effect, form, size, seed=0, conditions=CONDITIONS):
    """Return the form's law and the values that define it."""
    kind = EFFECTS[effect].form(form)
    return kind.build(size, conditions, np.random.default_rng(seed))


def through(law, signal):
    """Return the signal after a law that acts on signals."""
    changed = np.array(signal, dtype=float)
    law.advance(changed)
    return changed


def resist(law, path, seconds_each=SUBSTEP):
    """Return the force along a path; each point is held for so many seconds."""
    return _along(forces.stack([law]), np.asarray(path, float), round(seconds_each / SUBSTEP))


def held(law, y, seconds):
    """Return the force after each sub-step at a place held from the start."""
    return _along(forces.stack([law]), np.full(round(seconds / SUBSTEP), float(y)), 1)


def integrated(move, start, seconds, **accuracy):
    """Return the states after each sub-step, (states, steps), as another integrator has them."""
    times = np.arange(1, round(seconds / SUBSTEP)) * SUBSTEP
    exact = {"rtol": 1e-9, "atol": 1e-9} | accuracy
    return solve_ivp(move, (0.0, seconds), start, dense_output=True, **exact).sol(times)


@njit(cache=True)
def _along(stacked, path, steps):
    felt, last = np.zeros(path.size), path[0]
    for k in range(path.size):
        v = (path[k] - last) / SUBSTEP
        for _ in range(steps):
            forces.update_memory(stacked, path[k], v, SUBSTEP)
            if steps > 1:
                v = 0.0
        felt[k] = forces.total_force(stacked, path[k], v)
        last = path[k]
    return felt


def at(felt, *times):
    """Return what was felt after each sub-step at some of the times (s)."""
    return np.array([felt[round(time / SUBSTEP) - 1] for time in times])


def slope(values, grid):
    """Return the slope of values over their grid."""
    return np.gradient(values, grid)


def bend(x, y):
    """Return how far y is from a straight line in x, as a share of its range."""
    if not np.isfinite(y).all():
        return np.inf
    return np.abs(y - np.polyval(np.polyfit(x, y, 1), x)).max() / np.ptp(y)


def steady(law, speeds, seconds=0.0):
    """Return the force at each of several speeds, kept for so many seconds."""
    return np.array([_moving(forces.stack([law]), float(v), seconds) for v in speeds])


@njit(cache=True)
def _moving(stacked, speed, seconds):
    for _ in range(round(seconds / SUBSTEP)):
        forces.update_memory(stacked, 0.0, speed, SUBSTEP)
    return forces.total_force(stacked, 0.0, speed)


def sweep(*places, points=400, start=CONDITIONS.rest):
    """Return a path from ``start`` through places, with straight pieces of so many points."""
    ends = [start, *places]
    pieces = [np.linspace(a, b, points, endpoint=False) for a, b in pairwise(ends)]
    return np.concatenate([*pieces, [ends[-1]]])
