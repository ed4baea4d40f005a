"""A device that the declared priors exclude, of which nothing else is missing."""

import numpy as np
import pytest
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose
from dea.simulation import prepared
from dea.store import Record
from made_carriage import CARRIAGE

OFFERED = (
    "sensor_nonlinearity", "strain_stiffening", "sensor_lag", "coulomb_friction", "electrode_lag",
    "input_saturation",
)  # fmt: skip
INTERVAL = 0.02


def record_of(name, spreads, noise, distort=lambda y: y):
    """A record of a carriage with one parameter so many spreads from its nominal value."""
    u = np.repeat(np.random.default_rng(4).uniform(-2.0, 2.0, 60), 25)
    device = prepared(CARRIAGE, u, INTERVAL, 1e-4)
    values = device.layout.prior_means
    at = device.layout.names.index(name)
    values[at] *= np.exp(spreads * device.layout.parameters[at].spread)
    y = distort(device.simulate(values, u, INTERVAL)) + noise(u.size)
    return Record.of(u, y, 1.0 / INTERVAL, units=("V", "V")), float(values[at])


def white(size):
    return 2e-3 * np.random.default_rng(5).standard_normal(size)


def coloured(size):
    """Noise whose memory is a fifth of a second, beside white noise."""
    drive = np.random.default_rng(6).standard_normal(size)
    y = np.zeros(size)
    for k in range(1, size):
        y[k] = 0.9 * y[k - 1] + drive[k]
    return 4e-3 * y / y.std() + white(size)


@pytest.mark.parametrize("name", ["natural_frequency", "damping_ratio", "static_gain"])
@pytest.mark.parametrize("spreads", [-5.0, 5.0])
@pytest.mark.parametrize("noise", [white, coloured])
def test_a_device_that_the_priors_exclude_gets_no_name_for_an_effect(name, spreads, noise):
    made, value = record_of(name, spreads, noise)
    found = diagnose(made, CARRIAGE, settings=Settings(effects=OFFERED, budget=SEARCH)).verdict
    assert (found.status, found.names) == ("unknown", ()), found.sentence
    assert list(found.beyond_priors) == [name], found.sentence
    told = found.beyond_priors[name]
    assert told.low < value < told.high
    assert told.high - told.low < 0.5 * value
    assert "the declared priors exclude this device" in found.sentence
    assert name.replace("_", " ") in found.sentence


def test_an_effect_is_named_where_no_values_of_the_parameters_explain_it():
    """The gain is five spreads off, and the reading bends, too: the priors are not all of it."""
    made, _ = record_of("static_gain", 5.0, white, lambda y: y - 0.02 * y**2)
    found = diagnose(made, CARRIAGE, settings=Settings(effects=OFFERED, budget=SEARCH)).verdict
    assert found.beyond_priors == {}
    assert found.names, found.sentence
