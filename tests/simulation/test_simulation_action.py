"""The action of the film's voltage: the same equations, computed beforehand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from dea.simulation import catalogue, load_simulation, measured_scales, prepared
from dea.simulation.devices.dea_membrane import (
    NODES,
    simulation,
    squares_of,
    stiffness,
    suspending,
    work,
)

DT = 0.02


@pytest.mark.parametrize(("low", "high"), [(1.1, 3.7), (0.0, 3.0), (-3.5, 3.5), (2.0, 2.0)])
@pytest.mark.parametrize("count", [50, 4 * NODES])
def test_the_action_is_the_stiffness_at_each_voltage(low, high, count):
    rng = np.random.default_rng(1)
    u, scale = rng.uniform(low, high, count), rng.uniform(0.9, 1.1, count)
    p = simulation.nominal
    found = simulation.action.law(u, scale, p)
    permittivity = simulation.parameter_names.index("permittivity")
    for k in range(0, count, 7):
        own = p.copy()
        own[permittivity] *= scale[k]
        assert found[k] == pytest.approx(stiffness(u[k], own), rel=2e-5)


def test_beyond_pull_in_there_is_no_stiffness():
    u = np.linspace(3.0, 8.0, 2000)
    p = simulation.nominal
    found = simulation.action.law(u, np.ones(u.size), p)
    expected = np.array([stiffness(volts, p) for volts in u])
    np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize("prestretch", [3.0, 3.3, 3.6, 4.0])
def test_the_stretch_is_found_up_to_where_the_film_pulls_in(prestretch):
    """The first stretch at which nothing resists it, by bisection between close points."""
    p = simulation.nominal.copy()
    p[simulation.parameter_names.index("prestretch")] = prestretch
    squares = squares_of(p)
    stretches = np.linspace(1.0, 1.7, 1400)
    for volts in np.linspace(0.4, 5.2, 49):
        resisted = np.array([work(x, volts, p, squares)[0] for x in stretches])
        (below,) = np.nonzero((resisted[:-1] <= 0.0) & (resisted[1:] > 0.0))
        if not below.size:
            assert np.isnan(stiffness(volts, p))
            break
        ends = stretches[below[0]], stretches[below[0] + 1]
        x = brentq(lambda x, u=volts: work(x, u, p, squares)[0], *ends, xtol=1e-12)
        expected = suspending(x, *work(x, volts, p, squares)[1:], p)
        assert stiffness(volts, p) == pytest.approx(expected, rel=1e-5)
    else:
        pytest.fail("the film has not pulled in")


def test_a_film_moves_the_same_with_and_without_it():
    own = load_simulation("dea_membrane")
    t = DT * np.arange(1500)
    u = 2.4 + 0.8 * np.sin(2.0 * t) + 0.5 * np.sin(0.7 * t)
    extended = prepared(own, u, DT, 1e-4)
    values = extended.layout.prior_means
    told = measured_scales(extended, values, _Record(u))
    effect = catalogue()["gain_drift"]
    drifting = extended.attach(effect, told)
    q = np.concatenate([values, effect.starts(told)[0]])
    plain = replace(drifting, simulation=replace(own, action=None))
    found, expected = (each.simulate(q, u, DT) for each in (drifting, plain))
    assert np.abs(found - expected).max() < 1e-5 * np.ptp(expected)


class _Record:
    """A record of the input alone."""

    def __init__(self, u):
        self.u, self.y, self.interval = u, u, DT
