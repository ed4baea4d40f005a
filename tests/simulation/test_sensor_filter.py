"""The known low-pass of a sensor, against the same filter in fine steps."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.signal import butter, lsim

from dea.errors import InputError
from dea.simulation import ExtendedSimulation, SensorFilter, load_simulation

DT = 0.02


@pytest.mark.parametrize(("cutoff", "order"), [(15.0, 2), (3.0, 1), (8.0, 4)])
def test_the_reading_is_that_behind_a_butterworth_filter(cutoff, order):
    rng = np.random.default_rng(2)
    t = DT * np.arange(200)
    y = np.concatenate([np.full(50, 1.3), 1.3 + rng.standard_normal(150).cumsum()])
    rate = np.concatenate([np.zeros(50), 20.0 * rng.standard_normal(150)])
    found = SensorFilter(cutoff, order).read(y, rate, DT)
    fine = np.linspace(0.0, t[-1], 199 * 200 + 1)
    system = butter(order, 2.0 * np.pi * cutoff, analog=True)
    expected = 1.3 + lsim(system, CubicHermiteSpline(t, y, rate)(fine) - 1.3, fine)[1][::200]
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_a_simulation_is_read_through_its_filter():
    plain = replace(load_simulation("electric_drive"), sensor_filter=None, lead_in=0.5)
    read = replace(plain, sensor_filter=SensorFilter(4.0))
    u = np.sign(np.sin(3.0 * DT * np.arange(200)))
    extended = ExtendedSimulation(plain)
    values = extended.values(np.zeros(extended.free.size))
    output = extended.simulate(values, np.concatenate([np.full(25, u[0]), u]), DT)
    found = ExtendedSimulation(read).simulate(values, u, DT)
    assert np.abs(found - output[25:]).max() > 0.01 * np.ptp(found)
    assert found[0] == pytest.approx(output[25], rel=1.0)


@pytest.mark.parametrize("through", [SensorFilter(0.0), SensorFilter(5.0, 0)])
def test_a_filter_that_is_none_is_refused(through):
    with pytest.raises(InputError, match="sensor_filter"):
        replace(load_simulation("electric_drive"), sensor_filter=through)
