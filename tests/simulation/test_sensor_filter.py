"""The known low-pass of a sensor, against the same filter behind a run in fine steps."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lsim

from dea.errors import InputError
from dea.simulation import (
    ExtendedSimulation,
    Parameter,
    SensorFilter,
    Simulation,
    State,
    load_simulation,
)

DT, FINE = 0.02, 50


def follow(x, u, p, dx):
    dx[0] = p[0] * (u - x[0])


def follow_in_part(x, u, p):
    return x[0] + p[1] * u


def follower(rate, part, **how):
    """Return a device of first order whose output's rate, and in part itself, jumps."""
    return Simulation(
        name="follower",
        input_unit="V",
        output_unit="V",
        states=(State("level", "V", 0.0),),
        parameters=(
            Parameter("rate", "1/s", rate, 0.0),
            Parameter("part", "1", part, 0.0),
        ),
        derivative=follow,
        output=follow_in_part,
        drive="rate",
        force_ports=(),
        **how,
    )


def reading(simulation, u, interval, substeps=1):
    extended = ExtendedSimulation(simulation, substeps=substeps)
    return extended.simulate(extended.layout.prior_means, u, interval)


def behind(simulation, u, interval, through):
    """Return the reading at each sample of the output in fine steps behind the filter."""
    held = np.repeat(u, FINE)
    output = reading(replace(simulation, sensor_filter=None), held, interval / FINE)
    cutoff = 2.0 * np.pi * through.cutoff
    t = interval / FINE * np.arange(held.size)
    system = butter(through.order, cutoff, analog=True)
    return output[0] + lsim(system, output - output[0], t)[1][::FINE]


@pytest.mark.parametrize("interval", [DT, 0.1])
@pytest.mark.parametrize(("cutoff", "order"), [(15.0, 2), (3.0, 1), (8.0, 4)])
@pytest.mark.parametrize("rate", [2.0, 10.0, 40.0])
def test_a_simulation_is_read_through_its_filter(rate, cutoff, order, interval):
    through = SensorFilter(cutoff, order)
    u = np.random.default_rng(2).standard_normal(150)
    simulation = follower(rate, 0.0, sensor_filter=through)
    found = reading(simulation, u, interval, substeps=16)
    expected = behind(simulation, u, interval, through)
    assert np.std(found - expected) < 2e-3 * np.std(expected)


def test_an_output_that_jumps_with_the_input_is_filtered_in_steps():
    u = np.random.default_rng(3).standard_normal(150)
    through = SensorFilter(5.0)
    simulation = follower(4.0, 0.5, sensor_filter=through)
    found, expected = reading(simulation, u, DT, 16), behind(simulation, u, DT, through)
    assert np.std(found - expected) < 1e-2 * np.std(expected)


def test_it_is_at_rest_before_a_motion_that_begins_with_a_rate():
    found = reading(follower(5.0, 0.0, sensor_filter=SensorFilter(15.0)), np.ones(20), DT)
    assert found[0] == 0.0
    assert (np.diff(found) > 0.0).all()


@pytest.mark.parametrize("through", [SensorFilter(0.0), SensorFilter(np.inf), SensorFilter(5.0, 0)])
def test_a_filter_that_is_none_is_refused(through):
    with pytest.raises(InputError, match="sensor_filter"):
        replace(load_simulation("electric_drive"), sensor_filter=through)
