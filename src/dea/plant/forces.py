"""Forces on a moving mass besides its own device's, evaluated inside the equation of motion.

A force law is a kind, a row of constants and a row of memory. Its force depends on displacement
and velocity at constant memory, so that it can be evaluated within a Runge-Kutta step; its memory
is updated once per sub-step. Forces are in N, positive where they oppose a growing displacement;
a rotating device has torques and angles in their place.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from dea.arrays import Array
from dea.plant.array import Values
from dea.plant.force_laws.contact import (
    air_cushion,
    carry_creeping,
    cone_stop,
    creeping_stop,
    dented_stop,
    disc_stop,
    hertz_stop,
    padded_stop,
    rubber_stop,
    stepped_stop,
    wedge_stop,
)
from dea.plant.force_laws.damage import (
    carry_filler,
    carry_strain_work,
    carry_swings,
    count_reversals,
    crack_loss,
    cycle_damage,
    filler_loss,
    miner_loss,
    pseudo_elastic_loss,
    two_damages,
    work_damage,
)
from dea.plant.force_laws.damping import (
    drag_force,
    pumped_force,
    tapered_force,
)
from dea.plant.force_laws.elastic import (
    cable_force,
    chain_force,
    conical_force,
    demiray_force,
    fibre_force,
    fung_force,
    gent_force,
    guided_force,
    nested_force,
    power_force,
    snap_force,
    toe_force,
    worm_force,
)
from dea.plant.force_laws.friction import (
    ageing_friction,
    bearing_friction,
    belt_friction,
    bristle_force,
    carry_age,
    carry_bonds,
    carry_bristle,
    carry_dahl,
    carry_heat,
    composite_friction,
    fading_friction,
    lorentzian_friction,
    running_in_friction,
    stribeck_friction,
    uneven_friction,
)
from dea.plant.force_laws.hysteresis import (
    carry_bouc_wen,
    carry_duhem,
    carry_endochronic,
    carry_flag,
    carry_joint,
    carry_leaves,
    carry_magnet,
    carry_peaks,
    carry_sliders,
    endochronic_force,
    masing_force,
    note_reversals,
    preisach_force,
    sliders_force,
)
from dea.plant.force_laws.in_time import (
    carry_reduced_time,
    carry_relaxing,
    dashpot_in_time,
    force_in_time,
    pulse_train,
    stiffness_in_time,
)
from dea.plant.force_laws.mode import (
    carry_column,
    carry_mode,
    carry_rubbing,
    carry_series,
    carry_three_elements,
    carry_twins,
    column_force,
    mode_force,
    rubbing_force,
    series_force,
    three_elements_force,
    twin_force,
)
from dea.plant.force_laws.viscoelastic import (
    carry_eyring,
    carry_free_volume,
    carry_norton,
    carry_quasi_linear,
    carry_reptation,
    carry_spectrum,
    free_volume_force,
    quasi_linear_force,
    spectrum_force,
)

WIDTH = 64  # length of a row of constants or memory

(
    SPECTRUM,
    EYRING,
    MASING,
    PREISACH,
    BOUC_WEN,
    DUHEM,
    LUGRE,
    DAHL,
    STRIBECK,
    COMPOSITE,
    FUNG,
    GENT,
    CHAIN,
    POWER,
    CYCLES,
    PSEUDO_ELASTIC,
    WORK,
    MODE,
    HERTZ,
    PADDED,
    RUBBER,
    CUSHION,
    STIFFNESS_COURSE,
    FORCE_COURSE,
    PULSES,
    SNAP_THROUGH,
    SLIDERS,
    NORTON,
    QUASI_LINEAR,
    AGEING,
    BEARING,
    FIBRES,
    CABLES,
    DEMIRAY,
    CRACK,
    COLUMN,
    TWINS,
    STEPPED,
    DISC,
    DRAG,
    PUMPED,
    TOE,
    LORENTZIAN,
    SERIES,
    CONE,
    REPTATION,
    FLAG,
    RUNNING_IN,
    CONICAL,
    MINER,
    DENTED,
    MAGNET,
    BELT,
    UNEVEN,
    TWO_DAMAGES,
    GUIDED,
    DASHPOT_COURSE,
    JOINT,
    FREE_VOLUME,
    RELAXING,
    REDUCED_TIME,
    LEAVES,
    PEAKS,
    BONDS,
    FADING,
    NESTED,
    WORM,
    FILLER,
    RUBBING,
    THREE_ELEMENTS,
    WEDGES,
    CREEPING,
    TAPERED,
    ENDOCHRONIC,
) = range(74)


class Forces(NamedTuple):
    """Several laws: kinds of shape (laws,), constants and memory of shape (laws, WIDTH)."""

    kind: NDArray[np.int64]
    constants: Array
    memory: Array


class ForceLaw(NamedTuple):
    """One law: its kind, and the beginnings of its rows of constants and memory; the rest is 0."""

    kind: int
    constants: Values
    memory: Values = ()


def stack(laws: list[ForceLaw]) -> Forces:
    """Return the laws as the arrays that the equation of motion takes."""
    constants, memory = np.zeros((len(laws), WIDTH)), np.zeros((len(laws), WIDTH))
    for row, law in enumerate(laws):
        constants[row, : len(law.constants)] = law.constants
        memory[row, : len(law.memory)] = law.memory
    return Forces(np.array([law.kind for law in laws], dtype=np.int64), constants, memory)


@njit(cache=True, error_model="numpy")
def total_force(forces: Forces, y: float, v: float) -> float:
    """Return the sum of all forces, in N, at displacement ``y`` (m) and velocity ``v`` (m/s)."""
    total = 0.0
    for row in range(forces.kind.shape[0]):
        kind, c, m = forces.kind[row], forces.constants[row], forces.memory[row]
        if kind == SPECTRUM:
            total += spectrum_force(c, m, y)
        elif kind in (EYRING, NORTON, REPTATION):
            total += c[0] * (y - m[0])
        elif kind == MASING:
            total += masing_force(c, m, y)
        elif kind == PREISACH:
            total += preisach_force(c, m, y)
        elif kind == BOUC_WEN:
            total += c[0] * m[0]
        elif kind in (DUHEM, DAHL, FLAG, LEAVES, PEAKS, BONDS):
            total += m[0]
        elif kind == LUGRE:
            total += bristle_force(c, m, v)
        elif kind == STRIBECK:
            total += stribeck_friction(c, v)
        elif kind == COMPOSITE:
            total += composite_friction(c, v)
        elif kind == FUNG:
            total += fung_force(c, y)
        elif kind == GENT:
            total += gent_force(c, y)
        elif kind == CHAIN:
            total += chain_force(c, y)
        elif kind == POWER:
            total += power_force(c, y)
        elif kind == CYCLES:
            total -= c[0] * y * cycle_damage(c, m)
        elif kind == PSEUDO_ELASTIC:
            total -= c[0] * y * pseudo_elastic_loss(c, m, y)
        elif kind == WORK:
            total -= c[0] * y * work_damage(c, m)
        elif kind == MODE:
            total += mode_force(c, m, y, v)
        elif kind == HERTZ:
            total += hertz_stop(c, y, v)
        elif kind == PADDED:
            total += padded_stop(c, y, v)
        elif kind == RUBBER:
            total += rubber_stop(c, y)
        elif kind == CUSHION:
            total += air_cushion(c, y)
        elif kind == STIFFNESS_COURSE:
            total += stiffness_in_time(c, m, y)
        elif kind == FORCE_COURSE:
            total += force_in_time(c, m)
        elif kind == PULSES:
            total += pulse_train(c, m)
        elif kind == SNAP_THROUGH:
            total += snap_force(c, y)
        elif kind == SLIDERS:
            total += sliders_force(c, m)
        elif kind == QUASI_LINEAR:
            total += quasi_linear_force(c, m, y)
        elif kind == AGEING:
            total += ageing_friction(c, m, v)
        elif kind == BEARING:
            total += bearing_friction(c, y, v)
        elif kind == FIBRES:
            total += fibre_force(c, y)
        elif kind == CABLES:
            total += cable_force(c, y)
        elif kind == DEMIRAY:
            total += demiray_force(c, y)
        elif kind == CRACK:
            total -= c[0] * y * crack_loss(c, m)
        elif kind == COLUMN:
            total += column_force(c, m, y, v)
        elif kind == TWINS:
            total += twin_force(c, m, y, v)
        elif kind == STEPPED:
            total += stepped_stop(c, y)
        elif kind == DISC:
            total += disc_stop(c, y)
        elif kind == DRAG:
            total += drag_force(c, v)
        elif kind == PUMPED:
            total += pumped_force(c, m, y)
        elif kind == TOE:
            total += toe_force(c, y)
        elif kind == LORENTZIAN:
            total += lorentzian_friction(c, v)
        elif kind == SERIES:
            total += series_force(c, m, y, v)
        elif kind == CONE:
            total += cone_stop(c, y)
        elif kind == RUNNING_IN:
            total += running_in_friction(c, m, v)
        elif kind == CONICAL:
            total += conical_force(c, y)
        elif kind == MINER:
            total -= c[0] * y * miner_loss(c, m)
        elif kind == DENTED:
            total += dented_stop(c, m, y)
        elif kind == MAGNET:
            total -= c[0] * m[0]
        elif kind == BELT:
            total += belt_friction(c, y, v)
        elif kind == UNEVEN:
            total += uneven_friction(c, y, v)
        elif kind == TWO_DAMAGES:
            total -= c[0] * y * two_damages(c, m)
        elif kind == GUIDED:
            total += guided_force(c, y)
        elif kind == DASHPOT_COURSE:
            total += dashpot_in_time(c, m, v)
        elif kind == JOINT:
            total -= c[0] * m[1]
        elif kind == FREE_VOLUME:
            total += free_volume_force(c, m, y)
        elif kind in (RELAXING, REDUCED_TIME):
            total -= c[0] * y * m[1]
        elif kind == FADING:
            total += fading_friction(c, m, v)
        elif kind == NESTED:
            total += nested_force(c, y)
        elif kind == WORM:
            total += worm_force(c, y)
        elif kind == FILLER:
            total -= c[0] * y * filler_loss(c, m)
        elif kind == RUBBING:
            total += rubbing_force(c, m, y, v)
        elif kind == THREE_ELEMENTS:
            total += three_elements_force(c, m, y)
        elif kind == WEDGES:
            total += wedge_stop(c, m, y)
        elif kind == CREEPING:
            total += creeping_stop(c, m, y)
        elif kind == TAPERED:
            total += tapered_force(c, y, v)
        elif kind == ENDOCHRONIC:
            total += endochronic_force(c, m)
    return total


@njit(cache=True, error_model="numpy")
def update_memory(forces: Forces, y: float, v: float, dt: float) -> None:
    """Carry every law's memory over ``dt`` seconds; ``y`` and ``v`` are the values at their end."""
    for row in range(forces.kind.shape[0]):
        kind, c, m = forces.kind[row], forces.constants[row], forces.memory[row]
        if kind == SPECTRUM:
            carry_spectrum(c, m, y)
        elif kind == EYRING:
            carry_eyring(c, m, y, dt)
        elif kind in (MASING, PREISACH):
            note_reversals(m, y)
        elif kind == BOUC_WEN:
            carry_bouc_wen(c, m, y)
        elif kind == DUHEM:
            carry_duhem(c, m, y)
        elif kind == LUGRE:
            carry_bristle(c, m, v, dt)
        elif kind == DAHL:
            carry_dahl(c, m, y)
        elif kind == CYCLES:
            count_reversals(c, m, y)
        elif kind == PSEUDO_ELASTIC:
            m[0] = max(m[0], 0.5 * c[0] * y * y)
        elif kind == WORK:
            m[0] += c[0] * abs((y - c[3]) * v) * dt
        elif kind == MODE:
            carry_mode(c, m, y, v, dt)
        elif kind in (STIFFNESS_COURSE, FORCE_COURSE, DASHPOT_COURSE, PULSES, PUMPED):
            m[0] += dt
        elif kind == SLIDERS:
            carry_sliders(c, m, y)
        elif kind == NORTON:
            carry_norton(c, m, y, dt)
        elif kind == QUASI_LINEAR:
            carry_quasi_linear(c, m, y)
        elif kind == AGEING:
            carry_age(c, m, v, dt)
        elif kind == CRACK:
            carry_swings(c, m, y, 0.0)
        elif kind == COLUMN:
            carry_column(c, m, y, v, dt)
        elif kind == TWINS:
            carry_twins(c, m, y, v, dt)
        elif kind == SERIES:
            carry_series(c, m, y, v, dt)
        elif kind == REPTATION:
            carry_reptation(c, m, y, dt)
        elif kind == FLAG:
            carry_flag(c, m, y)
        elif kind == RUNNING_IN:
            m[0] += abs(v) * dt
        elif kind == MINER:
            carry_swings(c, m, y, c[3])
        elif kind == DENTED:
            m[0] = max(m[0], y - c[1])
        elif kind == MAGNET:
            carry_magnet(c, m, y)
        elif kind == TWO_DAMAGES:
            carry_strain_work(c, m, y)
        elif kind == JOINT:
            carry_joint(c, m, y, dt)
        elif kind == FREE_VOLUME:
            carry_free_volume(c, m, y)
        elif kind == RELAXING:
            carry_relaxing(c, m, dt)
        elif kind == REDUCED_TIME:
            carry_reduced_time(c, m, dt)
        elif kind == LEAVES:
            carry_leaves(c, m, y)
        elif kind == PEAKS:
            carry_peaks(c, m, y)
        elif kind == BONDS:
            carry_bonds(c, m, y)
        elif kind == FADING:
            carry_heat(c, m, v, dt)
        elif kind == FILLER:
            carry_filler(c, m, v, dt)
        elif kind == RUBBING:
            carry_rubbing(c, m, y, v, dt)
        elif kind == THREE_ELEMENTS:
            carry_three_elements(c, m, y, v, dt)
        elif kind == WEDGES:
            m[0], m[1] = wedge_stop(c, m, y), y
        elif kind == CREEPING:
            carry_creeping(c, m, y)
        elif kind == ENDOCHRONIC:
            carry_endochronic(c, m, y)
