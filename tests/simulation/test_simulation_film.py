"""The film whose stretch is a state, against the film that is in balance at once."""

import numpy as np
import pytest

from dea.simulation import load_simulation, prepared
from dea.simulation.devices.dea_membrane import GRAVITY, stiffness

DT = 0.02


def at_nominal(name, u):
    extended = prepared(load_simulation(name), u, DT, 1e-5)
    return extended.simulate(extended.values(np.zeros(extended.free.size)), u, DT)


@pytest.mark.parametrize("volts", [0.0, 1.5, 3.0, 3.6])
def test_it_settles_where_the_film_is_in_balance(volts):
    p = load_simulation("dea_membrane").nominal
    settled = at_nominal("dea_film", np.full(200, volts))[-1]
    assert settled == pytest.approx(1e3 * p[0] * GRAVITY / stiffness(volts, p), rel=1e-5)


def test_slowly_it_moves_as_the_film_that_is_in_balance():
    t = DT * np.arange(1000)
    u = 2.4 + 0.9 * np.sin(0.5 * t)
    found, expected = at_nominal("dea_film", u), at_nominal("dea_membrane", u)
    assert np.abs(found - expected).max() < 0.02 * np.ptp(expected)


def test_it_runs_away_beyond_pull_in():
    u = np.concatenate([np.full(100, 2.0), np.full(500, 8.0)])
    film = load_simulation("dea_film")
    extended = prepared(film, u[:100], DT, 1e-5)
    y = extended.simulate(extended.values(np.zeros(extended.free.size)), u, DT)
    assert np.isfinite(y[:100]).all()
    assert np.isnan(y[-1])
