"""The action of the film's voltage: the same equations, computed beforehand."""

from dataclasses import replace

import numpy as np
import pytest

from dea.simulation import catalogue, load_simulation, measured_scales, prepared
from dea.simulation.devices.dea_membrane import NODES, simulation, stiffness

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


def test_a_film_moves_the_same_with_and_without_it():
    own = load_simulation("dea_membrane")
    t = DT * np.arange(1500)
    u = 2.4 + 0.8 * np.sin(2.0 * t) + 0.5 * np.sin(0.7 * t)
    extended = prepared(own, u, DT, 1e-4)
    values = extended.values(np.zeros(extended.free.size))
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
