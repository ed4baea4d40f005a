"""Forces with memory: creep, relaxation and hysteresis."""

import numpy as np
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.force_laws import in_time
from dea.plant.force_laws.hysteresis import BOUC_WEN, DUHEM, FLAG, MAGNET, SLIDERS
from dea.plant.force_laws.in_time import STIFFNESS_COURSE
from dea.plant.force_laws.reversals import MASING, PREISACH
from dea.plant.force_laws.viscoelastic import EYRING, NORTON, QUASI_LINEAR, REPTATION, SPECTRUM
from dea.plant.forces import WIDTH, ForceLaw
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, tuning
from dea.plant.hidden.forms.loops import cracked_concrete, endochronic, leaf_spring
from dea.plant.hidden.forms.relaxation import (
    biphasic_layer,
    fractional_maxwell,
    free_volume,
    swinging_temperature,
)

_TIMES = 0.03 * 10.0 ** (np.arange(18) / 3.0)  # of a spectrum, in band periods: three a decade


def _spectrum(
    stiffnesses: Array, conditions: Conditions, size: float, times: Array = _TIMES
) -> Built:
    """Return the spectrum whose force one band period after a step is ``size`` stiffnesses."""
    at_one = stiffnesses @ np.exp(-1.0 / times)
    stiffnesses = stiffnesses * (size * conditions.stiffness / at_one)
    shares = -np.expm1(-SUBSTEP / (times * conditions.time))
    pairs = np.column_stack([stiffnesses, shares]).ravel()
    constants = np.concatenate([[float(times.size)], pairs])
    return Built(ForceLaw(SPECTRUM, constants, np.full(times.size, conditions.rest)), {})


@tuning("Scott Blair, J. Colloid Sci. 2 (1947) 21: a spring-pot, relaxing as a power of time")
def spring_pot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Relaxation as t^-n, by eighteen elements from 0.03 to 15 000 band periods."""
    return _spectrum(_TIMES ** -rng.uniform(0.1, 0.35), conditions, size)


@tuning("Kohlrausch 1854; Williams and Watts, Trans. Faraday Soc. 66 (1970) 80: exp(-(t/T)^b)")
def stretched_exponential(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Relaxation as a stretched exponential, as the spectrum that fits it best."""
    exponent, middle = rng.uniform(0.4, 0.7), np.exp(rng.uniform(np.log(3.0), np.log(30.0)))
    from scipy.optimize import nnls

    times = 0.02 * 10.0 ** (np.arange(120) / 20.0)
    wanted = np.exp(-((times / middle) ** exponent))
    stiffnesses, _ = nnls(np.exp(-times[:, None] / _TIMES), wanted)
    return _spectrum(stiffnesses, conditions, size)


@tuning("Zener, Elasticity and Anelasticity of Metals (1948): the standard linear solid")
def standard_linear_solid(size: float, conditions: Conditions, rng: Generator) -> Built:
    """One Maxwell element whose force one band period after a step is ``size`` stiffnesses."""
    time = np.exp(rng.uniform(np.log(1.5), np.log(20.0), 1))
    return _spectrum(np.ones(1), conditions, size, time)


@tuning(
    "Norton, The Creep of Steel at High Temperatures (1929): a dashpot's rate a power of stress"
)
def norton_dashpot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring of three ``size`` stiffnesses on a dashpot whose rate is a power of its stretch."""
    length = rng.uniform(0.1, 0.4) * conditions.travel
    time = conditions.time * np.exp(rng.uniform(np.log(1.0), np.log(8.0)))
    constants = [3.0 * size * conditions.stiffness, length / time, length, rng.uniform(2.0, 5.0)]
    return Built(ForceLaw(NORTON, constants, [conditions.rest]), {})


@tuning(
    "Fung, in Biomechanics: Its Foundations and Objectives (1972): quasi-linear viscoelasticity"
)
def quasi_linear(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An exponential spring that relaxes with two times.

    At the top one band period after a step its force is that of ``size`` stiffnesses.
    """
    times = np.array([rng.uniform(0.4, 2.0), rng.uniform(8.0, 40.0)])
    length, far = rng.uniform(0.5, 1.2) * conditions.travel, conditions.top - conditions.rest
    secant = length * np.expm1(far / length) / far
    shares = rng.uniform(0.3, 0.7) * np.array([1.0, -1.0]) + np.array([0.0, 1.0])
    stiffnesses = shares * size * conditions.stiffness / secant / (shares @ np.exp(-1.0 / times))
    pairs = np.column_stack([stiffnesses, -np.expm1(-SUBSTEP / (times * conditions.time))])
    constants = np.concatenate([[2.0, length, conditions.rest], pairs.ravel()])
    return Built(ForceLaw(QUASI_LINEAR, constants), {})


@tuning("Caputo and Mainardi, Pure Appl. Geophys. 91 (1971) 134: the fractional Zener solid")
def fractional_zener(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Relaxation as Mittag-Leffler's function of (t/T)^a, by its spectrum."""
    order, middle = rng.uniform(0.5, 0.75), np.exp(rng.uniform(np.log(0.5), np.log(5.0)))
    spectrum = 1.0 / (np.cosh(order * np.log(_TIMES / middle)) + np.cos(order * np.pi))
    return _spectrum(spectrum, conditions, size)


@tuning("Bergström and Boyce, J. Mech. Phys. Solids 46 (1998) 931: chains that creep ever less")
def bergstrom_boyce(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring on a dashpot whose rate is a power of the spring's stretch over its own."""
    length = rng.uniform(0.1, 0.4) * conditions.travel
    time = conditions.time * np.exp(rng.uniform(np.log(0.2), np.log(2.0)))
    constants = [
        3.0 * size * conditions.stiffness, length / time, length, rng.uniform(2.0, 5.0),
        rng.uniform(0.05, 0.3) * conditions.travel, conditions.rest,
    ]  # fmt: skip
    return Built(ForceLaw(REPTATION, constants, [conditions.rest]), {})


@tuning("Jung and Gweon, Rev. Sci. Instrum. 71 (2000) 1896: creep with the logarithm of time")
def logarithmic_creep(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Relaxation with the logarithm of time: equal elements over two to three decades."""
    first = int(rng.integers(2, 5))
    box = np.zeros(_TIMES.size)
    box[first : first + int(rng.integers(7, 10))] = 1.0
    return _spectrum(box, conditions, size)


@tuning("Eyring, J. Chem. Phys. 4 (1936) 283: a dashpot activated by its stress")
def activated_dashpot(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring of four ``size`` stiffnesses on a dashpot whose rate is a sinh of its stretch."""
    length = rng.uniform(0.08, 0.25) * conditions.travel
    time = conditions.time * np.exp(rng.uniform(np.log(2.0), np.log(10.0)))
    constants = [4.0 * size * conditions.stiffness, length / time, length]
    return Built(ForceLaw(EYRING, constants, [conditions.rest]), {})


def _relaxing(size: float, conditions: Conditions, shape: int, a: float, b: float) -> Built:
    """Return the loss with time of a share of the stiffness, ``size`` at the end."""
    at_end = in_time.course(float(shape), a, b, conditions.duration)
    lost = -size * conditions.stiffness / at_end
    return Built(ForceLaw(STIFFNESS_COURSE, [lost, shape, a, b]), {})


@tuning("Nutting, J. Franklin Inst. 191 (1921) 679: a power of the time under load")
def power_relaxation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes as (1 + t/T)^-n."""
    time = rng.uniform(0.02, 0.1) * conditions.duration
    return _relaxing(size, conditions, in_time.POWER, time, rng.uniform(0.1, 0.5))


@tuning("Tobolsky and Andrews, J. Chem. Phys. 13 (1945) 3: two relaxation times")
def two_times(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes with a short and a long time constant."""
    short, long = rng.uniform(0.03, 0.1), rng.uniform(0.3, 0.8)
    return _relaxing(
        size, conditions, in_time.EXPONENTIALS, *(conditions.duration * np.array([short, long]))
    )


@tuning("Maxwell, Phil. Trans. R. Soc. 157 (1867) 49: one time of relaxation")
def maxwell_relaxation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes exponentially."""
    time = rng.uniform(0.1, 0.6) * conditions.duration
    return _relaxing(size, conditions, in_time.SETTLING, 0.0, time)


@tuning("Hu et al., Appl. Phys. Lett. 96 (2010) 121904: a gel that drains")
def draining_gel(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes with the root of time at first, as a solvent diffuses."""
    time = rng.uniform(0.1, 0.5) * conditions.duration
    return _relaxing(size, conditions, in_time.DRAINING, time, 1.0)


@tuning("Kohlrausch, Ann. Phys. 91 (1854) 179: a stretched exponential of the time")
def stretched_relaxation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes as 1 - exp(-(t/T)^b)."""
    time = rng.uniform(0.1, 0.6) * conditions.duration
    return _relaxing(size, conditions, in_time.STRETCHED, time, rng.uniform(0.5, 0.8))


@tuning("Scanlan and Watson, Trans. Faraday Soc. 54 (1958) 740: a rubber that ages, late at first")
def inhibited_oxidation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Chains are cut at a constant rate after 0.15 to 0.5 of the record, before hardly any."""
    late, time = rng.uniform(0.15, 0.5), rng.uniform(0.15, 0.6)
    return _relaxing(
        size, conditions, in_time.INDUCTION, *(conditions.duration * np.array([late, time]))
    )


@tuning("Kubát, Nature 205 (1965) 378: stress relaxation with the logarithm of time")
def logarithmic_relaxation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes as ln(1 + t/T)."""
    time = rng.uniform(0.003, 0.03) * conditions.duration
    return _relaxing(size, conditions, in_time.LOGARITHM, time, conditions.duration)


@tuning("Peleg, J. Food Sci. 44 (1979) 277: normalised relaxation, t/(T + t)")
def hyperbolic_relaxation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """The prestress relaxes as t/(T + t)."""
    time = rng.uniform(0.08, 0.5) * conditions.duration
    return _relaxing(size, conditions, in_time.PELEG, time, 1.0)


def _reversals(conditions: Conditions) -> Array:
    memory = np.zeros(WIDTH)
    memory[:2] = 1.0, conditions.rest
    memory[-1] = conditions.rest
    return memory


@tuning("Masing, Proc. 2nd Int. Congr. Appl. Mech. (1926) 332, with loops stiffer at the ends")
def masing_loops(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Branches that are hyperbolas of initial stiffness ``size``, by Masing's rule."""
    constants = [
        size * conditions.stiffness, rng.uniform(0.1, 0.4) * conditions.travel,
        conditions.median, rng.uniform(0.8, 2.0) * conditions.travel, 1.0, 0.0,
    ]  # fmt: skip
    return Built(ForceLaw(MASING, constants, _reversals(conditions)), {})


@tuning("Menegotto and Pinto, IABSE Symposium Lisbon (1973) 15: a line that bends into another")
def menegotto_pinto(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Branches of stiffness ``size`` that bend into less steep lines, by Masing's rule."""
    constants = [
        size * conditions.stiffness, rng.uniform(0.15, 0.5) * conditions.travel,
        conditions.median, np.inf, rng.uniform(2.0, 5.0), rng.uniform(0.02, 0.2),
    ]  # fmt: skip
    return Built(ForceLaw(MASING, constants, _reversals(conditions)), {})


@tuning("Ramberg and Osgood, NACA Technical Note 902 (1943): a line and a power, by Masing's rule")
def ramberg_osgood(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Branches of stiffness ``size`` whose path is the force and a power of 3 to 7 of it."""
    constants = [
        size * conditions.stiffness, rng.uniform(0.1, 0.4) * conditions.travel,
        conditions.median, np.inf, rng.uniform(3.0, 7.0), 0.0, 1.0,
    ]  # fmt: skip
    return Built(ForceLaw(MASING, constants, _reversals(conditions)), {})


@tuning("Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249, after Bouc")
def bouc_wen(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Wen's hysteretic deflection on a spring of ``size`` stiffnesses."""
    constants = [
        size * conditions.stiffness, rng.uniform(0.08, 0.35) * conditions.travel,
        rng.uniform(1.2, 3.0), rng.uniform(0.55, 0.95),
    ]  # fmt: skip
    return Built(ForceLaw(BOUC_WEN, constants, [0.0, conditions.rest]), {})


def sliders(stiffnesses: Array, stretches: Array, conditions: Conditions) -> Built:
    """Return springs on sliders, each of which moves at a stretch of its own."""
    pairs = np.column_stack([stiffnesses, stretches]).ravel()
    constants = np.append(float(stretches.size), pairs)
    return Built(ForceLaw(SLIDERS, constants, [conditions.rest]), {})


@tuning(
    "Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989): Prandtl's springs on sliders"
)
def prandtl_sliders(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Six springs of together ``size`` stiffnesses that slide after 0.1 to 0.5 travels."""
    shares = rng.uniform(0.3, 1.0, 6)
    stretches = np.linspace(0.1, rng.uniform(0.3, 0.5), 6) * conditions.travel
    return sliders(size * conditions.stiffness * shares / shares.sum(), stretches, conditions)


@tuning("Christopoulos et al., Earthq. Eng. Struct. Dyn. 31 (2002) 1131: loops shaped as flags")
def flag_loops(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A spring of ``size`` stiffnesses that yields, returns at a lower force and is slack below."""
    constants = [
        size * conditions.stiffness, rng.uniform(0.06, 0.25) * conditions.travel,
        rng.uniform(0.02, 0.2), rng.uniform(0.4, 0.9), conditions.bottom,
    ]  # fmt: skip
    return Built(ForceLaw(FLAG, constants, [0.0, conditions.rest]), {})


@tuning("Segalman, J. Appl. Mech. 72 (2005) 752: Iwan's sliders with the density of a bolted joint")
def bolted_joint(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Springs of ``size`` stiffnesses on sliders, of which many slip at once; then all slip.

    Loops of small swings take energy as a power of 2.2 to 2.7 of the swing.
    """
    order, together = rng.uniform(-0.8, -0.3), rng.uniform(0.0, 0.5)
    constants = [
        size * conditions.stiffness, rng.uniform(0.3, 0.9) * conditions.travel,
        conditions.median, np.inf, 1.0 + order, 1.0 - together, 2.0,
    ]  # fmt: skip
    return Built(ForceLaw(MASING, constants, _reversals(conditions)), {})


@tuning("Jiles and Atherton, J. Magn. Magn. Mater. 61 (1986) 48: walls that pins hold in iron")
def jiles_atherton(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An iron that is magnetised by its place attracts; ``size`` stiffnesses without its pins.

    It begins where it would be without pins.
    """
    shape, pins = rng.uniform(0.1, 0.3), rng.uniform(0.05, 0.2)
    mean_field, reversible = rng.uniform(0.3, 0.8) * shape, rng.uniform(0.05, 0.2)
    middle = rng.uniform(0.3, 0.7)
    field = (conditions.rest - conditions.bottom) / conditions.travel - middle
    force = (3.0 * shape - mean_field) * conditions.device_forces(size)
    lengths = conditions.travel * np.array([shape, pins, mean_field])
    constants = [force, *lengths, reversible, conditions.bottom + middle * conditions.travel]
    start = _without_pins(field / shape, mean_field / shape)
    return Built(ForceLaw(MAGNET, constants, [start, conditions.rest]), {})


def _without_pins(field: float, mean_field: float) -> float:
    """Return the magnetisation that is Langevin's function of the field and its own share."""
    from scipy.optimize import brentq

    def excess(m: float) -> float:
        x = field + mean_field * m
        return m - (1.0 / np.tanh(x) - 1.0 / x if abs(x) > 1e-3 else x / 3.0)

    return float(brentq(excess, -1.0, 1.0))


@tuning("Biorci and Pescetti, Nuovo Cimento 7 (1958) 829: Preisach's model, density a product")
def preisach_product(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Preisach's relays with Lorentzian densities; the whole loop is ``size`` film forces high."""
    width = rng.uniform(0.3, 0.8) * conditions.travel
    middle = conditions.bottom + rng.uniform(0.3, 0.7) * conditions.travel
    height = conditions.device_forces(size)
    return Built(ForceLaw(PREISACH, [height, middle, width], _reversals(conditions)), {})


@tuning("Coleman and Hodgdon, Int. J. Eng. Sci. 24 (1986) 897: a model of Duhem's type")
def coleman_hodgdon(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A force that turns with ``size`` stiffnesses and then follows a less steep line."""
    rate = 1.0 / (rng.uniform(0.15, 0.5) * conditions.travel)
    turning = size * conditions.stiffness
    constants = [rate, rng.uniform(0.0, 0.5) * turning, turning, conditions.rest]
    return Built(ForceLaw(DUHEM, constants, [0.0, conditions.rest]), {})


EFFECTS = (
    EffectKind(
        "viscoelastic_creep", Port.FORCE, 0.005, 1.5, "stiffnesses",
        (spring_pot, stretched_exponential, standard_linear_solid, norton_dashpot, quasi_linear,
         fractional_zener, bergstrom_boyce, logarithmic_creep, activated_dashpot, biphasic_layer,
         free_volume),
    ),
    EffectKind(
        "stress_relaxation", Port.FORCE, 0.001, 0.5, "1",
        (power_relaxation, two_times, maxwell_relaxation, draining_gel, stretched_relaxation,
         inhibited_oxidation, logarithmic_relaxation, hyperbolic_relaxation, fractional_maxwell,
         swinging_temperature),
    ),
    EffectKind(
        "rate_independent_hysteresis", Port.FORCE, 0.005, 4.0, "stiffnesses",
        (masing_loops, menegotto_pinto, bouc_wen, prandtl_sliders, ramberg_osgood,
         flag_loops, bolted_joint, jiles_atherton, preisach_product, coleman_hodgdon, leaf_spring,
         cracked_concrete, endochronic),
    ),
)  # fmt: skip
