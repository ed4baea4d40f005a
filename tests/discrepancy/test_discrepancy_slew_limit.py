"""A limit of the rate, and a lag of the input that such a law can follow without any limit."""

import numpy as np
import pytest
from scipy.signal import lfilter
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose
from dea.simulation import prepared
from dea.store import Record
from made_carriage import CARRIAGE

OFFERED = "slew_limit", "sensor_nonlinearity", "strain_stiffening"
INTERVAL, PARTS, SIZE = 0.02, 20, 1500


def two_stages(u):
    """Two resistances and capacities in series, whose times are 0.12 and 0.1 s."""
    h = INTERVAL / PARTS
    for time in (0.12, 0.1):
        decay = np.exp(-h / time)
        u = lfilter([1.0 - decay], [1.0, -decay], u, zi=[decay * u[0]])[0]
    return u


def limited(u):
    """A rate of at most 8 V/s."""
    most = 8.0 * INTERVAL / PARTS
    reached, now = np.empty_like(u), u[0]
    for k, asked in enumerate(u):
        now += min(max(asked - now, -most), most)
        reached[k] = now
    return reached


@pytest.mark.parametrize(("path", "names"), [(two_stages, ()), (limited, ("slew_limit",))])
def test_a_rate_that_is_never_reached_is_no_limit(path, names):
    """No law of a lag is offered that could be named instead."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-2.0, 2.0, SIZE // 25), 25)
    fine = np.repeat(u, PARTS)
    device = prepared(CARRIAGE, fine, INTERVAL / PARTS, 1e-6)
    y = device.simulate(device.layout.prior_means, path(fine), INTERVAL / PARTS)
    noisy = y[::PARTS] + 2e-3 * rng.standard_normal(u.size)
    made = Record.of(u, noisy, 1.0 / INTERVAL, units=("V", "V"))
    found = diagnose(made, CARRIAGE, settings=Settings(effects=OFFERED, budget=SEARCH)).verdict
    assert found.names == names, found.sentence
