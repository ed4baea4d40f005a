"""Charge that leaks or is trapped: what a sustained voltage loses."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import parallel
from dea.plant.signal_law import SignalLaw

SPACE_CHARGE, POOLE_FRENKEL, SCHOTTKY, HOPPING, TUNNELLING, CORONA = range(6)


@njit(cache=True)
def _trapped(c: Array, m: Array, u: Array) -> None:
    """A trapped charge screens the field: conduction fills the traps, and they empty again.

    m is the screening voltage, which approaches ``size`` times the voltage at the ceiling, by a
    law of conduction c[3] with steepness c[4] relative to the field at the ceiling c[2].
    """
    size, time, ceiling, law, steep = c
    for k in range(u.shape[0]):
        field = max(u[k] - m[0], 0.0)
        x = field / ceiling
        current = x
        if law == SPACE_CHARGE:
            current = x * x
        elif law == POOLE_FRENKEL:
            current = x * np.exp(steep * (np.sqrt(x) - 1.0))
        elif law == SCHOTTKY:
            current = np.expm1(steep * np.sqrt(x)) / np.expm1(steep)
        elif law == HOPPING:
            current = np.sinh(steep * x) / np.sinh(steep)
        elif law == TUNNELLING:
            current = x * x * np.exp(steep * (1.0 - 1.0 / max(x, 1e-3)))
        elif law == CORONA:
            current = x * max(x - steep, 0.0) / (1.0 - steep)
        m[0] += SUBSTEP / time * (size * ceiling * current - m[0])
        u[k] = field


def _trap(size: float, conditions: Conditions, rng: Generator, law: int, steep: float) -> Built:
    time = conditions.time * np.exp(rng.uniform(np.log(1.0), np.log(8.0)))
    constants = [size, time, conditions.high, law, steep]
    return Built(SignalLaw(_trapped, constants), {})


@tuning("Lampert and Mark, Current Injection in Solids (1970): the square law of space charge")
def space_charge(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled by a current that grows with the square of the field."""
    return _trap(size, conditions, rng, SPACE_CHARGE, 0.0)


@tuning("Simmons, J. Phys. D 4 (1971) 613: Schottky emission at the electrode")
def schottky_emission(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled by a current exponential in the root of the field."""
    return _trap(size, conditions, rng, SCHOTTKY, rng.uniform(3.0, 6.0))


@tuning("Mott and Davis, Electronic Processes in Non-Crystalline Materials (1979): hopping")
def hopping(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled by a current that is a hyperbolic sine of the field."""
    return _trap(size, conditions, rng, HOPPING, rng.uniform(2.0, 5.0))


@tuning("Fowler and Nordheim, Proc. R. Soc. A 119 (1928) 173: tunnelling out of the electrode")
def tunnelling(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled by a current E² exp(-b/E) of the field."""
    return _trap(size, conditions, rng, TUNNELLING, rng.uniform(0.7, 2.5))


@tuning("Townsend, Phil. Mag. 28 (1914) 83: a corona, which begins at a voltage")
def corona(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled above 0.3 to 0.6 of the ceiling alone, by a current E (E - E0) of the field."""
    return _trap(size, conditions, rng, CORONA, rng.uniform(0.3, 0.6))


@tuning("Wagner, Arch. Elektrotech. 2 (1914) 371: charge that gathers at interfaces")
def interfacial_polarisation(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Two linear polarisations, their times five to twenty-five times apart."""
    short = conditions.time * rng.uniform(0.4, 2.0)
    times, share = np.array([short, short * rng.uniform(5.0, 25.0)]), rng.uniform(0.3, 0.7)
    weights = -size * np.array([share, 1.0 - share])
    return Built(parallel(1.0, weights, times, settled=False), {})


@njit(cache=True)
def _captured(c: Array, m: Array, u: Array) -> None:
    """Capture in proportion to field and empty traps, and emit; m: the screening voltage.

    c: voltage of all traps, rate of capture over that of emission, time of emission, ceiling.
    """
    whole, ratio, time, ceiling = c
    for k in range(u.shape[0]):
        field = max(u[k] - m[0], 0.0)
        m[0] += SUBSTEP / time * (ratio * field / ceiling * (whole - m[0]) - m[0])
        u[k] = field


@tuning("Shockley and Read, Phys. Rev. 87 (1952) 835: traps that capture and emit")
def filling_traps(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps that fill the faster the stronger the field, and that can be full."""
    ratio = rng.uniform(1.0, 5.0)
    time = conditions.time * np.exp(rng.uniform(np.log(2.0), np.log(16.0)))
    constants = [size * conditions.high * (1.0 + ratio) / ratio, ratio, time, conditions.high]
    return Built(SignalLaw(_captured, constants), {})


@tuning("Frenkel, Phys. Rev. 54 (1938) 647: conduction out of traps that the field lowers")
def poole_frenkel(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Traps filled by a current proportional to the field times an exponential of its root."""
    return _trap(size, conditions, rng, POOLE_FRENKEL, rng.uniform(1.5, 4.0))


@tuning("Jonscher, J. Phys. D 32 (1999) R57: the Curie and von Schweidler law, t^-n")
def curie_von_schweidler(size: float, conditions: Conditions, rng: Generator) -> Built:
    """An absorption current that falls as a power of time, as a spectrum from 0.3 to 300 s."""
    exponent = rng.uniform(0.6, 0.95)
    times = conditions.time * 0.3 * 10.0 ** np.linspace(0.0, 3.0, 10)
    weights = times ** (1.0 - exponent)
    weights *= -size / weights.sum()
    return Built(parallel(1.0, weights, times, settled=False), {})


@njit(cache=True)
def _recombined(c: Array, m: Array, u: Array) -> None:
    """Ions that the field frees and that meet in pairs; m: their number, which screens the field.

    c: screening voltage of one, share of a sub-step, ceiling.
    """
    for k in range(u.shape[0]):
        field = max(u[k] - c[0] * m[0], 0.0)
        m[0] += c[1] * (field / c[2] - m[0] * m[0])
        u[k] = field


@reporting("Langevin, Ann. Chim. Phys. 28 (1903) 433: ions that meet in pairs")
def recombining_ions(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Ions that come in proportion to the field, and go with the square of their number."""
    time = conditions.time * np.exp(rng.uniform(np.log(1.0), np.log(8.0)))
    constants = [size * conditions.high, SUBSTEP / time, conditions.high]
    return Built(SignalLaw(_recombined, constants), {})


@reporting(
    "Ho, Raistrick and Huggins, J. Electrochem. Soc. 127 (1980) 343: ions that diffuse into a layer"
)
def intercalating_ions(size: float, conditions: Conditions, rng: Generator) -> Built:
    """What a layer with a closed back has taken up: with the root of time, and then to an end.

    The slowest of its twelve times is 2 to 20 band periods.
    """
    slowest = conditions.time * np.exp(rng.uniform(np.log(2.0), np.log(20.0)))
    shares = (2.0 * np.arange(12) + 1.0) ** -2
    return Built(parallel(1.0, -size * shares / shares.sum(), slowest * shares, settled=False), {})


EFFECTS = (
    EffectKind(
        "charge_leakage", Port.INPUT, 0.005, 0.7, "1",
        (space_charge, schottky_emission, hopping, tunnelling, corona,
         interfacial_polarisation, filling_traps, poole_frenkel, curie_von_schweidler,
         recombining_ions, intercalating_ions),
    ),
)  # fmt: skip
