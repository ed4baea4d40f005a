"""Hysteresis that does not depend on rate, with a force or a few as its memory."""

import numpy as np
from numba import njit

from dea.arrays import Array
from dea.plant.force_laws.kernels import remembered_force
from dea.plant.force_laws.kind import Kind


@njit(cache=True, error_model="numpy")
def bouc_wen_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of a spring c[0] at the hysteretic deflection m[0]."""
    force: float = c[0] * m[0]
    return force


@njit(cache=True, error_model="numpy")
def carry_bouc_wen(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry Wen's hysteretic deflection: dz = (1 - |z/Z|^n (b sign(z dy) + 1 - b)) dy.

    Y. K. Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249. c: stiffness, Z, n, b; m: z and latest place.
    Two half steps keep |z| within Z.
    """
    step = 0.5 * (y - m[1])
    for _ in range(2):
        ratio = min(abs(m[0]) / c[1], 1.0) ** c[2]
        m[0] += step * (1.0 - ratio * (c[3] * np.sign(m[0] * step) + 1.0 - c[3]))
    m[1] = y


BOUC_WEN = Kind(bouc_wen_force, carry_bouc_wen)


@njit(cache=True, error_model="numpy")
def carry_duhem(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry Coleman and Hodgdon's force: dF = a |dy| (b (y - y0) - F) + g dy.

    B. D. Coleman and M. L. Hodgdon, Int. J. Eng. Sci. 24 (1986) 897. A loop takes energy where
    g > b. c: a, b, g, y0; m: force and latest place. To first order in a step: what g adds in a
    step does not relax in it.
    """
    step = y - m[1]
    share = -np.expm1(-c[0] * abs(step))
    line = c[1] * (0.5 * (y + m[1]) - c[3])
    m[0] += share * (line - m[0]) + c[2] * step
    m[1] = y


DUHEM = Kind(remembered_force, carry_duhem)


@njit(cache=True, error_model="numpy")
def _langevin(x: float) -> tuple[float, float]:
    """Return Langevin's function coth x - 1/x and its slope."""
    if abs(x) < 0.01:
        return x / 3.0 - x**3 / 45.0, 1.0 / 3.0 - x * x / 15.0
    return 1.0 / np.tanh(x) - 1.0 / x, 1.0 / (x * x) - 1.0 / np.sinh(x) ** 2


@njit(cache=True, error_model="numpy")
def _magnetised(c: Array, m: float, place: float, side: float) -> float:
    """Return the slope dM/dH of Jiles and Atherton's magnetisation at a place."""
    free, slope = _langevin((place - c[5] + c[3] * m) / c[1])
    # A wall that is pinned does not move away from where it would be without pins.
    inner = max((free - m) * side, 0.0) / c[2] + c[4] * slope / c[1]
    value: float = inner / (1.0 - c[3] * inner)
    return value


@njit(cache=True, error_model="numpy")
def magnet_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the attraction of a magnet of force c[0] at the magnetisation m[0]."""
    force: float = -(c[0] * m[0])
    return force


@njit(cache=True, error_model="numpy")
def carry_magnet(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the magnetisation of an iron whose field is the place, by the midpoint rule.

    D. C. Jiles and D. L. Atherton, J. Magn. Magn. Mater. 61 (1986) 48. c: force of saturation,
    lengths of Langevin's function, of the pins and of the mean field, reversible share, place
    without field; m: magnetisation and latest place. It is behind the field, so that a force that
    pushed would add energy; the magnet attracts instead, which takes it.
    """
    step = y - m[1]
    side = np.sign(step)
    half = m[0] + 0.5 * step * _magnetised(c, m[0], m[1], side)
    m[0] += step * _magnetised(c, half, m[1] + 0.5 * step, side)
    m[1] = y


MAGNET = Kind(magnet_force, carry_magnet)


@njit(cache=True, error_model="numpy")
def sliders_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of c[0] springs on sliders; (stiffness, stretch that slides) follow.

    L. Prandtl, Z. Angew. Math. Mech. 8 (1928) 85. m: latest place, then the stretch of every
    spring.
    """
    force = 0.0
    for i in range(int(c[0])):
        force += c[1 + 2 * i] * m[1 + i]
    return force


@njit(cache=True, error_model="numpy")
def carry_sliders(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Stretch every spring until its slider moves."""
    step = y - m[0]
    for i in range(int(c[0])):
        m[1 + i] = min(max(m[1 + i] + step, -c[2 + 2 * i]), c[2 + 2 * i])
    m[0] = y


SLIDERS = Kind(sliders_force, carry_sliders)


@njit(cache=True, error_model="numpy")
def joint_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force that a joint c[0] no longer takes, by the drag m[1] of its slider."""
    force: float = -(c[0] * m[1])
    return force


@njit(cache=True, error_model="numpy")
def carry_joint(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Drag the slider of a joint, which holds until the moment c[1] and slips at a stretch c[2].

    L. Gaul and R. Nitsche, Appl. Mech. Rev. 54 (2001) 93: a spring of stiffness c[0] in series with
    dry friction, here without force at c[3]. m: time, and how far the slider has been dragged, to
    which the force that the joint no longer takes is in proportion.
    """
    m[0] += dt
    if m[0] > c[1]:
        m[1] = min(max(m[1], y - c[3] - c[2]), y - c[3] + c[2])


JOINT = Kind(joint_force, carry_joint)


@njit(cache=True, error_model="numpy")
def _flag_edge(c: Array, d: float, length: float) -> float:
    """Return a spring c[0] that yields at a length, with a share c[2] of its stiffness left."""
    force: float = c[0] * (d if d < length else length + c[2] * (d - length))
    return force


@njit(cache=True, error_model="numpy")
def carry_flag(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry a spring that yields at the length c[1] and returns at 1 - c[3] of it.

    C. Christopoulos et al., Earthq. Eng. Struct. Dyn. 31 (2002) 1131. It is slack below the place
    c[4]. m: force and latest place.
    """
    d, before = max(y - c[4], 0.0), max(m[1] - c[4], 0.0)
    force = m[0] + c[0] * (d - before)
    m[0] = min(max(force, _flag_edge(c, d, (1.0 - c[3]) * c[1])), _flag_edge(c, d, c[1]))
    m[1] = y


FLAG = Kind(remembered_force, carry_flag)


@njit(cache=True, error_model="numpy")
def carry_leaves(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry the force of leaf springs, towards 1 + c[1] (upwards) or 1 - c[1] times a line.

    P. S. Fancher et al., SAE Paper 800905, 1980: exponentially over c[2], by the midpoint of the
    line, of stiffness c[0] from the place c[3] on. m: force and latest place.
    """
    step = y - m[1]
    line = c[0] * max(0.5 * (y + m[1]) - c[3], 0.0) * (1.0 + c[1] * np.sign(step))
    m[0] -= np.expm1(-abs(step) / c[2]) * (line - m[0])
    m[1] = y


LEAVES = Kind(remembered_force, carry_leaves)


@njit(cache=True, error_model="numpy")
def carry_peaks(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry a force that unloads with c[0] and heads for the farthest place on the other side.

    T. Takeda et al., J. Struct. Div. ASCE 96 (1970) 2557. It yields at c[1] from the place c[3],
    with a share c[2] of its stiffness left. m: force, latest place, farthest upwards, downwards.
    """
    side = np.sign(y - m[1])
    way, force, place = abs(y - m[1]), side * m[0], side * (y - c[3])
    if force < 0.0:
        unloaded = min(way, -force / c[0])
        force += c[0] * unloaded
        way -= unloaded
    peak = 2 if side > 0.0 else 3
    far = max(m[peak], c[1])
    if way > 0.0 and place >= far:
        force, m[peak] = c[0] * (c[1] + c[2] * (place - c[1])), place
    elif way > 0.0:
        aim = c[0] * (c[1] + c[2] * (far - c[1]))
        force += way * min((aim - force) / (far - place + way), c[0])
    m[0], m[1] = side * force if side != 0.0 else m[0], y


PEAKS = Kind(remembered_force, carry_peaks)


@njit(cache=True, error_model="numpy")
def endochronic_force(c: Array, m: Array, y: float, v: float) -> float:
    """Return the force of c[0] springs; (stiffness, way over which it fades) pairs follow in ``c``.

    K. C. Valanis, Arch. Mech. 23 (1971) 517. m: latest place, then the force of every spring.
    """
    force = 0.0
    for i in range(int(c[0])):
        force += m[1 + i]
    return force


@njit(cache=True, error_model="numpy")
def carry_endochronic(c: Array, m: Array, y: float, v: float, dt: float) -> None:
    """Carry dF = k dy - F |dy|/l of every spring, exactly for a step one way."""
    step = y - m[0]
    for i in range(int(c[0])):
        limit = c[1 + 2 * i] * c[2 + 2 * i] * np.sign(step)
        m[1 + i] -= np.expm1(-abs(step) / c[2 + 2 * i]) * (limit - m[1 + i])
    m[0] = y


ENDOCHRONIC = Kind(endochronic_force, carry_endochronic)
