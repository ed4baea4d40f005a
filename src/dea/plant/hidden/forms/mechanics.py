"""Forces of stiffening, softening and a second mass."""

from math import gamma

import numpy as np
from numpy.random import Generator

from dea.plant.force_laws import damage, mode
from dea.plant.force_laws.damage import CRACK, CYCLES, MINER, PSEUDO_ELASTIC, TWO_DAMAGES, WORK
from dea.plant.force_laws.elastic import (
    CABLES,
    CHAIN,
    CONICAL,
    DEMIRAY,
    FIBRES,
    FUNG,
    GENT,
    GUIDED,
    POWER,
    TOE,
)
from dea.plant.force_laws.kind import Kind
from dea.plant.force_laws.mode import COLUMN, MODE, SERIES, TWINS
from dea.plant.forces import ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, tuning
from dea.plant.hidden.forms.structures import (
    breaking_strands,
    filler_network,
    nested_springs,
    rubbing_absorber,
    three_elements,
    two_phases,
    worm_like_chain,
)


def _static(kind: Kind, constants: list[float]) -> Built:
    return Built(ForceLaw(kind, constants), {})


@tuning("Fung, Biomechanics (1981): an exponential of the stretch")
def fung(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that is exponential, at the top ``size`` times the largest device force."""
    length = rng.uniform(0.2, 0.5) * conditions.travel
    reach = conditions.travel / length
    force = conditions.device_forces(size) / (np.exp(reach) - 1.0 - reach)
    return _static(FUNG, [force, length, conditions.bottom])


@tuning("Ogden, Proc. R. Soc. A 326 (1972) 565: a power of the stretch")
def ogden_term(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that is a power of 3.5 to 6, at the top ``size`` times the largest device force."""
    force = conditions.device_forces(size)
    return _static(POWER, [force, rng.uniform(3.5, 6.0), conditions.bottom, conditions.travel])


@tuning("Demiray, J. Biomech. 5 (1972) 309: an energy exponential in the squared stretch")
def demiray(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force x (exp(x²) - 1), at the top ``size`` times the largest device force."""
    length = rng.uniform(0.5, 1.0) * conditions.travel
    x = conditions.travel / length
    force = conditions.device_forces(size) / (x * np.expm1(x * x))
    return _static(DEMIRAY, [force, length, conditions.bottom])


@tuning("Lanir, J. Biomech. 16 (1983) 1: wavy fibres that become taut one after the other")
def recruited_fibres(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Fibres that are straight at places with a Gaussian distribution; then they are linear."""
    mean = conditions.bottom + rng.uniform(0.5, 0.75) * conditions.travel
    width = rng.uniform(0.06, 0.2) * conditions.travel
    whole = FIBRES.static([1.0, mean, width], conditions.top)
    stiffness = conditions.device_forces(size) / whole
    return _static(FIBRES, [stiffness, mean, width])


@tuning("Irvine, Cable Structures (1981): cables across the motion")
def taut_cables(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that begins as a cube and ends as a line, of half spans of 0.5 to 1.2 travels."""
    span = rng.uniform(0.5, 1.2)
    stiffness = size * conditions.stiffness / (1.0 - span / np.hypot(1.0, span))
    return _static(CABLES, [stiffness, span * conditions.travel, conditions.bottom])


@tuning("Weiss et al., Comput. Methods Appl. Mech. Eng. 135 (1996) 107: a toe, then a line")
def tendon_toe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An exponential up to 0.5 to 0.8 of the travel, and from there its tangent."""
    end, steep = rng.uniform(0.5, 0.8), rng.uniform(4.0, 7.0)
    top = np.expm1(steep) + (1.0 / end - 1.0) * steep * np.exp(steep)
    force, toe = conditions.device_forces(size) / top, end * conditions.travel
    return _static(TOE, [force, toe / steep, conditions.bottom, toe])


@tuning("Rodriguez et al., J. Mech. Des. 128 (2006) 1352: a conical spring, solid coil by coil")
def conical_spring(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that begins when the widest coil is solid; at the top 0.5 to 0.8 of the rest are."""
    narrow = rng.uniform(0.3, 0.6)
    begun, solid = 0.25 * (1.0 - narrow**4), 1.0 - narrow
    length = conditions.travel / (begun + rng.uniform(0.5, 0.8) * (solid - begun))
    whole = CONICAL.static([1.0, length, conditions.bottom, narrow], conditions.top)
    force = conditions.device_forces(size) / whole
    return _static(CONICAL, [force, length, conditions.bottom, narrow])


@tuning("Den Hartog, Mechanical Vibrations (1956): a leaf spring that a curved guide shortens")
def guided_leaf(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A leaf that begins to lie against its guide within the first third of the travel.

    At the top it is bent 1.3 to 1.45 times as far as where it begins; at 1.5 times it lies whole.
    """
    touched = conditions.bottom + rng.uniform(0.0, 0.3) * conditions.travel
    beyond = rng.uniform(0.3, 0.45)
    length = (conditions.top - touched) / beyond
    force = conditions.device_forces(size) / ((1.0 - 2.0 * beyond) ** -0.5 - 1.0 - beyond)
    return _static(GUIDED, [force, length, touched])


@tuning("Gent, Rubber Chem. Technol. 69 (1996) 59: limited extensibility")
def gent(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that rises without bound at 1.15 to 1.5 travels."""
    limit = rng.uniform(1.15, 1.5)
    force = size * conditions.stiffness * (1.0 / limit) / (1.0 / (1.0 - limit**-2) - 1.0)
    return _static(GENT, [force * limit, limit * conditions.travel, conditions.bottom])


@tuning("Arruda and Boyce, J. Mech. Phys. Solids 41 (1993) 389, Cohen's inverse Langevin")
def langevin_chain(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The force of chains that are stretched out at 1.1 to 1.4 travels."""
    limit = rng.uniform(1.1, 1.4)
    x = 1.0 / limit
    full = limit * (x * (3.0 - x * x) / (1.0 - x * x) / 3.0 - x)
    return _static(
        CHAIN,
        [size * conditions.stiffness / full, limit * conditions.travel, conditions.bottom],
    )


def _cycling(
    size: float, conditions: Conditions, shape: int, exponent: float, *others: float
) -> Built:
    constants = [
        conditions.stiffness, size, max(conditions.full_cycles, 1.0), exponent,
        0.1 * conditions.travel, conditions.travel, float(shape), *others,
    ]  # fmt: skip
    return Built(ForceLaw(CYCLES, constants), {})


@tuning("Basquin, Proc. ASTM 10 (1910) 625: a power of the number of cycles")
def power_of_cycles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost grows with the number of cycles to the power 0.25 to 0.6."""
    return _cycling(size, conditions, damage.POWER, rng.uniform(0.25, 0.6))


@tuning("Ogden and Roxburgh, Proc. R. Soc. A 455 (1999) 2861: Mullins' effect")
def ogden_roxburgh(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Below its largest past stroke the film is softer by up to a share ``size``."""
    most = 0.5 * conditions.stiffness * conditions.top**2
    constants = [
        conditions.stiffness, min(size, 0.9), rng.uniform(0.05, 0.3) * most,
        rng.uniform(0.05, 0.3),
    ]  # fmt: skip
    return Built(ForceLaw(PSEUDO_ELASTIC, constants), {})


@tuning("Lemaitre and Chaboche, Mechanics of Solid Materials (1990): softening that saturates")
def saturating_cycles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost approaches its end exponentially with the number of cycles."""
    return _cycling(size, conditions, damage.SATURATING, rng.uniform(2.0, 6.0))


@tuning("Paris and Erdogan, J. Basic Eng. 85 (1963) 528: a crack that grows ever faster")
def paris_crack(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A crack that grows three- to eightfold with a power of 2.5 to 4 of the swing."""
    order, cycles = rng.uniform(2.5, 4.0), max(conditions.cycles, 2.0)
    # Of swings with a Rayleigh distribution, as a band of noise has; never more than all in full.
    swing = conditions.path / (2.0 * cycles * conditions.travel)
    mean = (swing / np.sqrt(0.25 * np.pi)) ** order * gamma(1.0 + 0.5 * order)
    constants = [
        conditions.stiffness, size, cycles * min(mean, 1.0), rng.uniform(3.0, 8.0),
        0.1 * conditions.travel, conditions.travel, order,
    ]  # fmt: skip
    return Built(ForceLaw(CRACK, constants), {})


@tuning("Mao and Mahadevan, Compos. Struct. 58 (2002) 405: a quick, a steady and a last stage")
def three_stages(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost is a sum of a power of 0.2 to 0.4 and one of 4 to 8 of the cycles."""
    first, share, last = rng.uniform(0.2, 0.4), rng.uniform(0.3, 0.7), rng.uniform(4.0, 8.0)
    return _cycling(size, conditions, damage.STAGES, first, share, last)


@tuning("Miner, J. Appl. Mech. 12 (1945) A159: a sum over cycles, here above an endurance limit")
def endurance_limit(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A loss by a power of 3 to 6 of each swing; swings below 0.15 to 0.35 travels do nothing."""
    from scipy.special import gammaincc

    order, limit = rng.uniform(3.0, 6.0), rng.uniform(0.15, 0.35)
    cycles = max(conditions.cycles, 2.0)
    # As for a crack, of the swings above the limit.
    scale = conditions.path / (2.0 * cycles * conditions.travel) / np.sqrt(0.25 * np.pi)
    half = 1.0 + 0.5 * order
    mean = scale**order * gamma(half) * gammaincc(half, (limit / scale) ** 2)
    constants = [
        conditions.stiffness, size, cycles * min(mean, 1.0), limit,
        0.1 * conditions.travel, conditions.travel, order,
    ]  # fmt: skip
    return Built(ForceLaw(MINER, constants), {})


@tuning("Miehe, Eur. J. Mech. A/Solids 14 (1995) 697: damage by the largest stroke and by all")
def two_damages(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A part of the loss comes with each new largest stroke, the rest with the work of all."""
    most = 0.5 * conditions.stiffness * (conditions.top - conditions.rest) ** 2
    whole = 0.5 * conditions.stiffness * conditions.path * conditions.travel
    early, late = rng.uniform(0.3, 1.0) * most, rng.uniform(0.3, 1.0) * whole
    share = rng.uniform(0.3, 0.7)
    constants = [
        conditions.stiffness, share * size / -np.expm1(-most / early), early,
        (1.0 - share) * size / -np.expm1(-whole / late), late, conditions.rest,
    ]  # fmt: skip
    return Built(ForceLaw(TWO_DAMAGES, constants), {})


@tuning("Lemaitre, J. Eng. Mater. Technol. 107 (1985) 83: damage driven by work")
def damage_by_work(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost is a hyperbola of the work done on the film."""
    whole = conditions.stiffness * conditions.path * conditions.travel * 0.5
    work = rng.uniform(0.1, 0.6) * whole
    constants = [conditions.stiffness, size, work, conditions.rest]
    return Built(ForceLaw(WORK, constants), {})


@tuning("Derham and Thomas, Rubber Chem. Technol. 50 (1977) 397: the logarithm of the cycles")
def logarithm_of_cycles(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The stiffness lost grows with the logarithm of the number of cycles."""
    return _cycling(size, conditions, damage.LOGARITHM, 0.0)


def _attached(
    size: float, conditions: Conditions, frequency: float, damping: float
) -> tuple[float, float, float]:
    """Return mass, spring and dashpot of a second mass on a spring of ``size`` stiffnesses."""
    angular, spring = 2.0 * np.pi * frequency, size * conditions.stiffness
    mass = spring / angular**2
    return mass, spring, 2.0 * damping * mass * angular


def _second(
    size: float, conditions: Conditions, rng: Generator, shape: float, to_ground: float
) -> Built:
    """Return a second mass at 0.6 to 2 times the band, on a spring of ``size`` stiffnesses."""
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    mass, spring, dashpot = _attached(size, conditions, frequency, rng.uniform(0.03, 0.12))
    length = rng.uniform(1.0, 3.0) * conditions.travel
    constants = [mass, spring, dashpot * (1.0 - to_ground), dashpot * to_ground, length, shape]
    law = ForceLaw(MODE, constants, [conditions.rest])
    return Built(law, {"frequency": frequency})


@tuning("Den Hartog, Mechanical Vibrations (1956): an attached mass, here on a hardening spring")
def hardening_absorber(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a hardening spring, damped against the first."""
    return _second(size, conditions, rng, mode.HARDENING, 0.0)


@tuning("Rivin, Stiffness and Damping in Mechanical Design (1999): a mass damped against both")
def shared_damping(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass whose damping is shared between the first mass and the ground."""
    return _second(size, conditions, rng, mode.HARDENING, rng.uniform(0.3, 0.7))


@tuning("Sakai et al., Proc. Int. Conf. Highrise Buildings (1989) 926: a tuned column of liquid")
def liquid_column(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a linear spring, damped by the square of the speed besides."""
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    mass, spring, dashpot = _attached(size, conditions, frequency, rng.uniform(0.02, 0.06))
    # As a dashpot of so many times the critical one at an amplitude of 0.3 travels.
    share = rng.uniform(0.1, 0.4)
    drag = 2.0 * share * mass * 3.0 * np.pi / (8.0 * 0.3 * conditions.travel)
    law = ForceLaw(COLUMN, [mass, spring, dashpot, drag], [conditions.rest])
    return Built(law, {"frequency": frequency})


@tuning("Igusa and Xu, J. Sound Vib. 175 (1994) 491: several tuned masses")
def twin_masses(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Two masses on linear springs; the second is weaker and 1.3 to 1.8 times as quick."""
    frequency = rng.uniform(0.6, 1.6) / conditions.time
    second = frequency * rng.uniform(1.3, 1.8)
    first = _attached(size, conditions, frequency, rng.uniform(0.02, 0.06))
    weaker, damping = size * rng.uniform(0.3, 0.6), rng.uniform(0.02, 0.06)
    other = _attached(weaker, conditions, second, damping)
    memory = [conditions.rest, 0.0, conditions.rest]
    return Built(ForceLaw(TWINS, [*first, *other], memory), {"frequency": frequency})


@tuning("Zuo, J. Vib. Acoust. 131 (2009) 031003: tuned masses in series")
def masses_in_series(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A mass that carries a second one of 0.1 to 0.5 of it; the lower frequency is as of others."""
    frequency = rng.uniform(0.6, 1.6) / conditions.time
    share, pace = rng.uniform(0.1, 0.5), rng.uniform(0.8, 1.6)
    # Squares of the angular frequencies over that of the first mass alone on its spring.
    half = 0.5 * (1.0 + pace * (1.0 + share))
    lower = half - np.sqrt(half * half - pace)
    damping = rng.uniform(0.02, 0.06)
    mass, spring, dashpot = _attached(size, conditions, frequency / np.sqrt(lower), damping)
    carried = share * mass, share * pace * spring
    between = 2.0 * rng.uniform(0.02, 0.06) * np.sqrt(carried[0] * carried[1])
    constants = [mass, spring, dashpot, *carried, between]
    law = ForceLaw(SERIES, constants, [conditions.rest, 0.0, conditions.rest])
    return Built(law, {"frequency": frequency})


@tuning("Chu and Shen, AIAA J. 30 (1992) 2512: a bilinear spring, as a crack that breathes")
def breathing_crack(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a spring 1.5 to 4 times as stiff on one side as on the other."""
    frequency = rng.uniform(0.6, 2.0) / conditions.time
    root = rng.uniform(np.sqrt(1.5), 2.0) ** rng.choice([-1.0, 1.0])
    # Half a period on either side.
    ahead = 0.5 * frequency * (1.0 + root) / root
    mass, spring, dashpot = _attached(size, conditions, ahead, rng.uniform(0.03, 0.12))
    constants = [mass, spring, dashpot, 0.0, root**2, mode.BILINEAR]
    law = ForceLaw(MODE, constants, [conditions.rest])
    return Built(law, {"frequency": frequency})


@tuning("Ren, J. Sound Vib. 245 (2001) 762: an absorber damped to the ground")
def grounded_damper(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass on a hardening spring, damped against the ground."""
    return _second(size, conditions, rng, mode.HARDENING, 1.0)


@tuning("Ibrahim, Liquid Sloshing Dynamics (2005): a pendulum, softer at large angles")
def sloshing_pendulum(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A second mass that swings as a pendulum."""
    return _second(size, conditions, rng, mode.PENDULUM, 0.0)


EFFECTS = (
    EffectKind(
        "strain_stiffening", Port.FORCE, 0.01, 20.0, "device forces",
        (fung, ogden_term, demiray, recruited_fibres, taut_cables, tendon_toe,
         conical_spring, guided_leaf, gent, langevin_chain, nested_springs, worm_like_chain),
    ),
    EffectKind(
        "cyclic_softening", Port.FORCE, 0.002, 0.8, "1",
        (power_of_cycles, ogden_roxburgh, saturating_cycles, paris_crack, three_stages,
         endurance_limit, two_damages, damage_by_work, logarithm_of_cycles, filler_network,
         breaking_strands, two_phases),
    ),
    EffectKind(
        "second_mode", Port.FORCE, 0.002, 2.0, "stiffnesses",
        (hardening_absorber, shared_damping, liquid_column, twin_masses, masses_in_series,
         breathing_crack, grounded_damper, sloshing_pendulum, rubbing_absorber, three_elements),
    ),
)  # fmt: skip
