"""Force laws against their publications, with constants that all differ; several at a time.

The forms that hidden effects give them are tested by themselves.
"""

from itertools import pairwise

import numpy as np
import pytest
from made_conditions import CONDITIONS, built
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.special import erf
from scipy.stats import norm

from dea.plant.force_laws import damage, in_time, mode
from dea.plant.force_laws.contact import CUSHION, DISC, HERTZ, PADDED, RUBBER, STEPPED
from dea.plant.force_laws.damage import CRACK, CYCLES, PSEUDO_ELASTIC, WORK
from dea.plant.force_laws.damping import DRAG, PUMPED
from dea.plant.force_laws.elastic import (
    CABLES,
    CHAIN,
    CONICAL,
    DEMIRAY,
    FIBRES,
    FUNG,
    GENT,
    POWER,
    SNAP_THROUGH,
)
from dea.plant.force_laws.friction import (
    AGEING,
    BEARING,
    COMPOSITE,
    DAHL,
    STRIBECK,
    bristle_force,
    carry_bristle,
)
from dea.plant.force_laws.hysteresis import BOUC_WEN, DUHEM, SLIDERS
from dea.plant.force_laws.in_time import FORCE_COURSE, PULSES, STIFFNESS_COURSE
from dea.plant.force_laws.mode import COLUMN, MODE, TWINS
from dea.plant.force_laws.reversals import MASING, PREISACH
from dea.plant.force_laws.viscoelastic import EYRING, QUASI_LINEAR, SPECTRUM
from dea.plant.forces import WIDTH, ForceLaw, stack, total_force, update_memory


def force(kind, constants, y=0.0, v=0.0, memory=()):
    """Return the force of one law with a memory."""
    return total_force(stack([ForceLaw(kind, constants, memory)]), y, v)


def carried(kind, constants, memory, path, dt=1e-3):
    """Return a law's force and memory after each step along a path."""
    law = stack([ForceLaw(kind, constants, memory)])
    felt, kept, last = [], [], path[0]
    for y in path:
        update_memory(law, y, (y - last) / dt, dt)
        felt.append(total_force(law, y, (y - last) / dt))
        kept.append(law.memory[0].copy())
        last = y
    return np.array(felt), np.array(kept)


def tangent(curve, d, end):
    """Return a curve that goes on in a straight line beyond an end."""
    slope = (curve(end + 1e-6) - curve(end - 1e-6)) / 2e-6
    return curve(d) if d < end else curve(end) + slope * (d - end)


def bent_disc(d):
    """Almen and László's (1936) disc of height 0.5 and thickness 0.8, of initial stiffness 3."""
    return 3.0 * d * ((0.5 - d) * (0.5 - d / 2) + 0.8**2) / (0.5**2 + 0.8**2)


# Kind, constants, and the force at a distance d > 0 from the place 0.4.
PLACED = {
    "Fung 1981": (
        FUNG, [2.0, 0.7, 0.4], lambda d: 2.0 * (np.exp(d / 0.7) - 1 - d / 0.7)
    ),
    "Gent 1996, energy -k L²/2 ln(1 - d²/L²)": (
        GENT, [3.0, 1.5, 0.4],
        lambda d: tangent(lambda x: 3.0 * x / (1 - (x / 1.5) ** 2) - 3.0 * x, d, 0.99 * 1.5),
    ),
    "Cohen 1991": (
        CHAIN, [3.0, 1.5, 0.4],
        lambda d: (lambda x: 1.5 * (x * (3 - x**2) / (1 - x**2) - 3 * x))(min(d / 1.5, 0.99)),
    ),
    "Ogden 1972": (POWER, [3.0, 2.5, 0.4, 1.5], lambda d: 3.0 * (d / 1.5) ** 2.5),
    "Demiray 1972": (
        DEMIRAY, [3.0, 0.7, 0.4], lambda d: 3.0 * d / 0.7 * (np.exp((d / 0.7) ** 2) - 1)
    ),
    "Irvine 1981, energy k/2 (way longer)²": (
        CABLES, [3.0, 0.7, 0.4],
        lambda d: 3.0 * (np.hypot(d, 0.7) - 0.7) * d / np.hypot(d, 0.7),
    ),
    "Lindley 1974": (
        RUBBER, [3.0, 0.4, 0.2], lambda d: 3.0 * 0.2 * (np.exp(min(d / 0.2, 30.0)) - 1)
    ),
    "adiabatic cushion, exponent 1.4": (
        CUSHION, [3.0, 0.4, 1.5],
        lambda d: tangent(lambda x: 3.0 * 1.5 / 1.4 * ((1 - x / 1.5) ** -1.4 - 1), d, 0.95 * 1.5),
    ),
    "Shaw and Holmes 1983": (
        STEPPED, [3.0, 0.4, 0.5, 7.0],
        lambda d: 3.0 * d if d < 0.5 else 3.0 * 0.5 + 7.0 * (d - 0.5),
    ),
    "Almen and László 1936": (
        DISC, [3.0, 0.4, 0.5, 0.8, 7.0],
        lambda d: bent_disc(min(d, 0.5)) + 7.0 * max(d - 0.5, 0.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PLACED)
@pytest.mark.parametrize("d", [1e-3, 0.1, 0.45, 0.9, 1.45, 1.6, 2.5, 6.5])
def test_a_force_of_the_place_is_as_published(name, d):
    kind, constants, published = PLACED[name]
    assert force(kind, constants, 0.4) == pytest.approx(0.0, abs=1e-12)
    if kind != FUNG:
        assert force(kind, constants, 0.4 - d) == 0.0
    if kind == DEMIRAY:
        d = min(d, 4.0)  # beyond six lengths it does not grow
        assert force(kind, constants, 9.0) == force(kind, constants, 0.4 + 6.0 * 0.7 + 1e-9)
    assert force(kind, constants, 0.4 + d) == pytest.approx(published(d), rel=1e-7)


@pytest.mark.parametrize("y", [-2.0, 0.3, 0.8, 2.5])
def test_recruited_fibres_and_a_buckled_strip_are_as_published(y):
    """Fibres one by one (Lanir 1983); a sine under a Gaussian that falls where the strip snaps."""
    taut = quad(lambda w: (y - w) * norm.pdf(w, 0.8, 0.3), -3.0, y, points=[0.8])[0]
    found = force(FIBRES, [3.0, 0.8, 0.3], y)
    assert found == pytest.approx(3.0 * taut, rel=1e-6, abs=1e-9)
    place = (y - 0.4) / 1.7
    strip = -3.0 * np.sin(2 * np.pi * place) * np.exp(-(place**2))
    assert force(SNAP_THROUGH, [3.0, 0.4, 1.7], y) == pytest.approx(strip)


@pytest.mark.parametrize("v", [-3.0, -0.05, 0.02, 0.8])
def test_a_force_of_the_speed_is_as_published(v):
    regular = v / np.sqrt(v**2 + 0.03**2)
    # Tustin's exponential (Armstrong-Hélouvry et al. 1994).
    stribeck = (2.0 + (3.5 - 2.0) * np.exp(-abs(v) / 0.4)) * regular
    assert force(STRIBECK, [2.0, 3.5, 0.4, 0.03], v=v) == pytest.approx(stribeck)
    # Makkar et al. (2005), uneven.
    even = 0.7 * (np.tanh(9.0 * v) - np.tanh(2.0 * v)) + 1.5 * np.tanh(5.0 * v)
    composite = even * (1 + 0.2 * np.tanh(5.0 * v))
    found = force(COMPOSITE, [0.7, 9.0, 2.0, 1.5, 5.0, 0.2], v=v)
    assert found == pytest.approx(composite)
    # Dieterich (1979): the logarithm of the age.
    ageing = 2.0 * (1 + 0.3 * np.log(1 + 7.0 / 0.5)) * regular
    found = force(AGEING, [2.0, 0.3, 0.5, 11.0, 0.03], v=v, memory=[7.0])
    assert found == pytest.approx(ageing)
    # A load that grows with the place, and never pulls.
    for y, load in ((1.4, 2.0 + 0.6 * (1.4 - 0.5)), (-5.0, 0.0)):
        found = force(BEARING, [2.0, 0.6, 0.5, 0.03], y, v)
        assert found == pytest.approx(load * regular)
    # Morison et al. (1950).
    assert force(DRAG, [3.0], v=v) == pytest.approx(np.sign(v) * 3.0 * v**2)
    # Hunt and Crossley (1975), Goldsmith (1960): neither pulls.
    hertz = max(3.0 * 0.2**1.5 * (1 + 0.7 * v), 0.0)
    assert force(HERTZ, [3.0, 0.4, 0.7], 0.6, v) == pytest.approx(hertz)
    padded = max(3.0 * 0.2 + 0.7 * v, 0.0)
    assert force(PADDED, [3.0, 0.4, 0.7], 0.6, v) == pytest.approx(padded)
    assert force(PADDED, [3.0, 0.4, 0.7], 0.39, v) == 0.0
    # Mathieu's stiffness (Nayfeh and Mook 1979).
    pumped = 3.0 * (v - 0.4) * np.sin(2 * np.pi * 1.7 * 0.9 + 0.6)
    found = force(PUMPED, [3.0, 0.4, 1.7, 0.6], y=v, memory=[0.9])
    assert found == pytest.approx(pumped)


@pytest.mark.parametrize("t", [0.0, 0.3, 1.9, 8.0])
def test_a_course_of_time_is_as_published(t):
    a, b = 0.7, 2.2
    published = {
        in_time.POWER: 1 - (1 + t / a) ** -b,
        in_time.EXPONENTIALS: 1 - (np.exp(-t / a) + np.exp(-t / b)) / 2,
        in_time.LOGARITHM: np.log(1 + t / a) / np.log(1 + b / a),
        in_time.PELEG: t / (a + t),
        in_time.SIGMOID: (1 + np.tanh((t - a) / (2 * b))) / 2,
        in_time.SETTLING: 1 - np.exp(-(t - a) / b) if t > a else 0.0,
        # Hu et al. (2010), a sphere.
        in_time.DRAINING: (
            1 - 0.491 * np.exp(-0.908 * np.sqrt(t / a)) - 0.509 * np.exp(-1.679 * t / a)
        ),
        in_time.RAMP: np.interp(t, [a, a + b], [0.0, 1.0]),
    }  # fmt: skip
    for shape, share in published.items():
        stiffness = force(STIFFNESS_COURSE, [3.0, shape, a, b], 0.8, memory=[t])
        assert stiffness == pytest.approx(3.0 * 0.8 * share, abs=1e-12)
        alone = force(FORCE_COURSE, [3.0, shape, a, b], 0.8, memory=[t])
        assert alone == pytest.approx(3.0 * share, abs=1e-12)
    bell = np.exp(4.0 * (np.cos(2 * np.pi * 1.3 * t + 0.6) - 1))
    found = force(PULSES, [3.0, 1.3, 0.6, 4.0, 0.25], memory=[t])
    assert found == pytest.approx(3.0 * (bell - 0.25))


def lost(kind, constants, y=0.8, memory=()):
    """Return the share of the stiffness 3 that is lost."""
    return -force(kind, [3.0, *constants], y, memory=memory) / (3.0 * y)


def test_a_share_of_the_stiffness_is_lost_as_published():
    for cycles in (1.0, 4.0, 9.0):
        published = {
            (damage.POWER, 0.4): (cycles / 9.0) ** 0.4,
            (damage.LOGARITHM, 0.0): np.log(1 + 20 * cycles / 9.0) / np.log(21),
            (damage.SATURATING, 3.0): (1 - np.exp(-3 * cycles / 9.0)) / (1 - np.exp(-3)),
        }
        for (shape, exponent), share in published.items():
            found = lost(CYCLES, [0.2, 9.0, exponent, 0.1, 1.0, shape], memory=[cycles])
            assert found == pytest.approx(0.2 * share)
    # No law takes more than nine tenths.
    assert lost(CYCLES, [0.2, 9.0, 1.0, 0.1, 1.0, 0.0], memory=[99.0]) == pytest.approx(0.9)
    # Ogden and Roxburgh (1999), of a spring: W = k y²/2.
    most, work = 5.0, 1.5 * 0.8**2
    mullins = 0.2 * erf((most - work) / (0.7 + 0.15 * most))
    found = lost(PSEUDO_ELASTIC, [0.2, 0.7, 0.15], memory=[most])
    assert found == pytest.approx(mullins)
    assert lost(PSEUDO_ELASTIC, [0.2, 0.7, 0.15], 2.0) == pytest.approx(0.0)
    found = lost(WORK, [0.2, 6.0, 0.5], memory=[4.0])
    assert found == pytest.approx(0.2 * 4.0 / (4.0 + 6.0))


def test_a_crack_s_length_solves_paris_equation():
    """da/dN is a power of the length; after the cycles expected it goes on at the rate then."""
    growth, order, cycles = 4.0, 3.4, 9.0
    q = 0.5 * order - 1.0
    pace = (1.0 - growth**-q) / q / cycles  # so that a = 4 after 9 cycles
    solved = solve_ivp(
        lambda n, a: pace * a ** (0.5 * order), (0.0, cycles), [1.0], rtol=1e-10, dense_output=True
    )
    assert solved.y[0, -1] == pytest.approx(growth, rel=1e-6)
    for n in (2.0, 5.0, 9.0, 12.0):
        length = solved.sol(min(n, cycles))[0]
        length += max(n - cycles, 0.0) * pace * growth ** (0.5 * order)
        memory = [0.0, 0.0, 0.0, 0.0, n]
        found = lost(CRACK, [0.2, cycles, growth, 0.1, 1.0, order], memory=memory)
        assert found == pytest.approx(0.2 * (length - 1) / (growth - 1), rel=1e-6)
    memory = [0.0, 0.0, 0.0, 0.0, 99.0]
    found = lost(CRACK, [0.2, cycles, growth, 0.1, 1.0, order], memory=memory)
    assert found == pytest.approx(0.9)


def test_swings_are_counted_by_their_share_and_small_ones_not_at_all():
    ends = [0.3, -0.9, 1.5, 1.42, 1.9, 0.4, 6.4, 6.2]
    path = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(ends)])
    shares = np.array([1.2, 2.8, 1.5, 4.0]) / 4.0  # of a full swing of 4; the last is longer
    kept = carried(CYCLES, [3.0, 0.2, 9.0, 0.5, 0.1, 4.0, damage.POWER], (), path)[1]
    assert kept[-1, 0] == pytest.approx(0.5 * shares.sum())
    constants = [3.0, 0.2, 9.0, 4.0, 0.1, 4.0, 2.5]
    kept = carried(CRACK, constants, (), path)[1]
    assert kept[-1, 4] == pytest.approx(0.5 * (shares**2.5).sum())


def test_work_and_the_largest_energy_are_kept():
    path = np.sin(np.linspace(0.0, 7.0, 4000))
    kept = carried(WORK, [3.0, 0.2, 6.0, 0.5], (), path)[1]
    work = np.abs(3.0 * (path[1:] - 0.5) * np.diff(path)).sum()
    assert kept[-1, 0] == pytest.approx(work)
    kept = carried(PSEUDO_ELASTIC, [3.0, 0.2, 0.7, 0.15], (), path)[1]
    assert kept[-1, 0] == pytest.approx(1.5, rel=1e-5)


SWINGS = np.concatenate([[0.2], *(np.linspace(a, b, 4001)[1:] for a, b in
                                  ((0.2, 2.0), (2.0, -1.0), (-1.0, 0.5)))])  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "constants", "rate", "factor"),
    [
        # dF/dy, dz/dy by the direction s: Dahl (1968), Coleman and Hodgdon (1986), Wen (1976).
        (DAHL, [2.0, 5.0], lambda f, y, s: 5.0 * (1 - f * s / 2.0), 1.0),
        (DUHEM, [0.8, 1.5, 4.0, 0.3],
         lambda f, y, s: 0.8 * s * (1.5 * (y - 0.3) - f) + 4.0, 1.0),
        (BOUC_WEN, [3.0, 0.6, 1.7, 0.8],
         lambda z, y, s: 1 - (abs(z) / 0.6) ** 1.7 * (0.8 * np.sign(z * s) + 0.2), 3.0),
    ],
    ids=["Dahl", "Coleman and Hodgdon", "Wen"],
)  # fmt: skip
def test_a_force_of_duhem_s_type_solves_its_equation(kind, constants, rate, factor):
    felt, _ = carried(kind, constants, [0.0, 0.2], SWINGS)
    state, expected = 0.0, []
    for start, end in ((0.2, 2.0), (2.0, -1.0), (-1.0, 0.5)):
        s = np.sign(end - start)
        solved = solve_ivp(lambda y, f, s=s: rate(f, y, s), (start, end), [state], rtol=1e-9)
        state = solved.y[0, -1]
        expected.append(factor * state)
    np.testing.assert_allclose(felt[4000::4000], expected, rtol=2e-3)


def test_loops_are_sums_of_branches_from_reversal_to_reversal():
    """Masing's rule (1926) for Menegotto and Pinto's branch (1973), stiffer away from a place."""
    c = [3.0, 0.8, 0.4, 2.5, 1.6, 0.15]
    memory = np.zeros(WIDTH)
    memory[:2], memory[-1] = (1.0, 0.2), 0.2

    def branch(start, end):
        length = abs(end - start)
        bent = 0.15 + 0.85 / (1 + (length / 0.8) ** 1.6) ** (1 / 1.6)
        stiffer = 1 + ((0.5 * (start + end) - 0.4) / 2.5) ** 2
        return np.sign(end - start) * 3.0 * length * bent * stiffer

    def everett(start, end):
        difference = np.arctan((end - 0.4) / 2.5) - np.arctan((start - 0.4) / 2.5)
        return -np.sign(difference) * 0.5 * 3.0 * difference**2

    for kind, constants, rule in (
        (MASING, c, branch), (PREISACH, [3.0, 0.4, 2.5], everett)
    ):  # fmt: skip
        felt, _ = carried(kind, constants, memory, SWINGS)
        virgin = [0.5 * rule(0.4 - y, y) for y in (1.1, 2.0)]  # of one from its mirror image
        assert felt[[2000, 4000]] == pytest.approx(virgin)
        assert felt[8000] == pytest.approx(virgin[1] + rule(2.0, -1.0))
        assert felt[12_000] == pytest.approx(virgin[1] + rule(2.0, -1.0) + rule(-1.0, 0.5))


def dominant(path):
    """Return what a path leaves in memory: its farthest place, the farthest from that since, ..."""
    kept, left = [path[0]], path
    while (farthest := np.argmax(np.abs(left - kept[-1]))) < left.size - 1:
        kept.append(left[farthest])
        left = left[farthest:]
    return kept


def test_the_reversals_in_memory_are_the_dominant_ones():
    path = np.cumsum(np.random.default_rng(1).standard_normal(300))
    memory = np.zeros(WIDTH)
    memory[:2], memory[-1] = (1.0, path[0]), path[0]
    kept = carried(MASING, [3.0, 0.8, 0.4, 2.5, 1.6, 0.15], memory, path)[1]
    for n in range(1, path.size + 1):
        wanted = dominant(path[:n])
        assert kept[n - 1, 0] == len(wanted)
        assert kept[n - 1, 1 : 1 + len(wanted)].tolist() == wanted


def test_more_reversals_than_fit_leave_the_outer_ones_as_they_are():
    shrinking = 3.0 * 0.97 ** np.arange(200) * (-1.0) ** np.arange(200)
    memory = np.zeros(WIDTH)
    memory[0] = 1.0
    law = ForceLaw(MASING, [3.0, 0.8, 0.4, 2.5, 1.6, 0.15], memory)
    stacked = stack([law, law])
    for y in shrinking:
        update_memory(stacked, y, 0.0, 1e-3)
    outer = round(stacked.memory[0, 0])
    assert 50 < outer < WIDTH - 1
    np.testing.assert_array_equal(stacked.memory[0, 2 : 1 + outer], shrinking[: outer - 1])
    np.testing.assert_array_equal(stacked.memory[0], stacked.memory[1])


def test_contacts_age_with_time_and_are_renewed_by_slip():
    """Dieterich (1979): a' = 1 - |v| a/L ends at L/|v|."""
    law = stack([ForceLaw(AGEING, [2.0, 0.3, 0.5, 0.6, 0.03], [0.4])])
    solved = solve_ivp(lambda t, a: 1 - 2.0 * a / 0.6, (0.0, 0.25), [0.4], rtol=1e-9)
    for _ in range(250):
        update_memory(law, 0.0, -2.0, 1e-3)
    assert law.memory[0, 0] == pytest.approx(solved.y[0, -1], rel=2e-3)


MASSES = {
    # Force of the second mass at relative place x and speed w, and its own dashpot and mass.
    "hardening": (
        MODE, [0.3, 40.0, 0.5, 0.9, 0.7, mode.HARDENING],
        [(lambda x, w: 40.0 * x * (1 + (x / 0.7) ** 2) + 0.5 * w, 0.9, 0.3)],
    ),
    "pendulum": (
        MODE, [0.3, 40.0, 0.5, 0.9, 0.7, mode.PENDULUM],
        [(lambda x, w: 40.0 * 0.7 * np.sin(x / 0.7) + 0.5 * w, 0.9, 0.3)],
    ),
    "column": (
        COLUMN, [0.3, 40.0, 0.5, 0.8],
        [(lambda x, w: 40.0 * x + 0.5 * w + 0.8 * w * abs(w), 0.0, 0.3)],
    ),
    "twins": (
        TWINS, [0.3, 40.0, 0.5, 0.2, 70.0, 0.8],
        [(lambda x, w: 40.0 * x + 0.5 * w, 0.0, 0.3), (lambda x, w: 70.0 * x + 0.8 * w, 0.0, 0.2)],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MASSES)
def test_second_masses_move_as_newton_says(name):
    kind, constants, masses = MASSES[name]
    law, dt = stack([ForceLaw(kind, constants)]), 2e-5
    place, speed = (lambda t: 0.6 * np.sin(9.0 * t)), (lambda t: 5.4 * np.cos(9.0 * t))

    def newton(t, m):
        out = []
        for (pull, dashpot, mass), (x, w) in zip(masses, m.reshape(-1, 2), strict=True):
            out += [w, (pull(place(t) - x, speed(t) - w) - dashpot * w) / mass]
        return out

    moved = solve_ivp(newton, (0.0, 0.4), np.zeros(2 * len(masses)), rtol=1e-8).y[:, -1]
    for k in range(1, 20_001):
        update_memory(law, place(k * dt), speed(k * dt), dt)
    np.testing.assert_allclose(law.memory[0, : moved.size], moved, rtol=2e-3, atol=5e-4)
    pulls = [
        pull(place(0.4) - x, speed(0.4) - w)
        for (pull, _, _), (x, w) in zip(masses, moved.reshape(-1, 2), strict=True)
    ]
    assert total_force(law, place(0.4), speed(0.4)) == pytest.approx(sum(pulls), rel=5e-3)


def test_springs_relax_on_dashpots_and_slide():
    # Maxwell elements that relax 0.2 and 0.05 of their stretch in a step.
    felt, _ = carried(SPECTRUM, [2.0, 3.0, 0.2, 7.0, 0.05], (), np.full(5, 0.8))
    left = np.arange(1, 6)
    np.testing.assert_allclose(felt, 0.8 * (3.0 * 0.8**left + 7.0 * 0.95**left))
    # Fung (1972): the exponential response to the stretch relaxes.
    response = 0.7 * (np.exp((0.8 - 0.3) / 0.7) - 1)
    constants = [2.0, 0.7, 0.3, 3.0, 0.2, 7.0, 0.05]
    felt, _ = carried(QUASI_LINEAR, constants, (), np.full(5, 0.8))
    np.testing.assert_allclose(felt, response * (3.0 * 0.8**left + 7.0 * 0.95**left))
    # Prandtl (1928): springs 1.5 and 7 slide at stretches of 0.5 and 0.9.
    felt, _ = carried(SLIDERS, [2.0, 1.5, 0.5, 7.0, 0.9], [0.2], SWINGS)
    expected = [1.5 * 0.5 + 7 * 0.9, -1.5 * 0.5 - 7 * 0.9, 1.5 * 0.5 + 7 * 0.6]
    np.testing.assert_allclose(felt[4000::4000], expected)
    assert felt[1000] == pytest.approx((1.5 + 7) * 0.45)


def test_the_forces_of_several_laws_add():
    laws = [
        built("strain_stiffening", "fung", 0.3)[0],
        built("viscoelastic_creep", "spring_pot", 0.3)[0],
    ]
    y = 1.1 * CONDITIONS.top
    together, alone = stack(laws), [stack([law]) for law in laws]
    for stacked in (together, *alone):
        update_memory(stacked, y, 0.0, 1e-3)
    single = [total_force(stacked, y, 0.0) for stacked in alone]
    assert np.count_nonzero(single) == len(laws)
    assert total_force(together, y, 0.0) == pytest.approx(sum(single), rel=1e-12)


def test_the_force_of_a_flowing_dashpot_is_that_of_the_spring_before_it():
    law = ForceLaw(EYRING, np.array([300.0]), np.array([2e-4]))
    assert total_force(stack([law]), 5e-4, 0.0) == pytest.approx(300.0 * 3e-4)


@pytest.mark.parametrize("v", [0.02, -0.5])
def test_bristles_are_springs_at_first_and_slide_with_stribecks_force(v):
    """Canudas de Wit et al. (1995): s0 z for small motions, F_c + (F_s - F_c) exp(-(v/v_s)^2)."""
    stiffness, damping, coulomb, stiction, speed = constants = np.array([1e4, 30.0, 2.0, 3.5, 0.1])
    memory = np.zeros(1)
    assert bristle_force(constants, memory, 0.0, v) == pytest.approx(damping * v)
    carry_bristle(constants, memory, 0.0, v, 1e-7)
    assert memory[0] == pytest.approx(1e-7 * v, rel=1e-3)
    for _ in range(2000):
        carry_bristle(constants, memory, 0.0, v, 1e-3)
    sliding = coulomb + (stiction - coulomb) * np.exp(-((v / speed) ** 2))
    assert bristle_force(constants, memory, 0.0, v) == pytest.approx(np.sign(v) * sliding)
    assert memory[0] == pytest.approx(np.sign(v) * sliding / stiffness)


@pytest.mark.parametrize("narrowest", [0.3, 0.6])
def test_a_conical_spring_goes_on_straight_where_nearly_all_of_it_is_solid(narrowest):
    """Coils wider than x are solid at the force x^-3 and the depth 1 - 3x/4 - q^4/(4x^3)."""
    c = np.array([2.0, 0.5, 0.1, narrowest])
    begun = 0.25 * (1.0 - narrowest**4)
    end = begun + 0.95 * (1.0 - narrowest - begun)

    def added(d):
        x = brentq(lambda x: 1.0 - 0.75 * x - 0.25 * narrowest**4 / x**3 - d, narrowest, 1.0)
        return x**-3 - d / begun

    def force(d):
        return CONICAL.static(c, c[2] + c[1] * d) / c[0]

    for share in (0.1, 0.5, 0.9):
        d = begun + share * (end - begun)
        assert force(d) == pytest.approx(added(d), rel=1e-9)
    slope = (added(end) - added(end - 1e-6)) / 1e-6
    assert force(end + 0.1) == pytest.approx(added(end) + 0.1 * slope, rel=1e-4)
