"""The judge of the bands of virtual actuators (``make coverage-film`` runs a campaign of it)."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.coverage import film
from benchmarks.coverage.film import BENCH, LINES, PERIOD, RATE, judge, truth
from dea.plant import Rig, read_parameters
from dea.plant.converter import Converter
from dea.plant.film import Y, rest
from dea.plant.small_signal import hold, responses


def on_a_count(converter, volts):
    return float(converter.to_values(converter.to_counts(np.array([volts])))[0])


@pytest.mark.parametrize("actuator", ["dea1", "dea2"])
def test_probed_responses_do_not_depend_on_the_steps_of_the_converter(actuator):
    """Tones of 87 steps beside those of 1300; what rounding is even in the tones would bias H2."""
    parameters, found = read_parameters(BENCH, actuator), []
    bias = on_a_count(parameters.output_converter, 2.4644)
    for output in (parameters.output_converter, Converter(bias - 0.5, bias + 0.5)):
        nearest = on_a_count(output, bias)
        rig = Rig(replace(parameters, output_converter=output), 1)
        rig.respond(output.to_counts(np.full(round(60 * RATE), nearest)))
        found.append(truth(rig, output, nearest))
    for coarse, fine in zip(*found, strict=True):
        np.testing.assert_allclose(coarse, fine, rtol=4e-3)


def held(actuator):
    """A rig that has been held at a voltage for five minutes, and the same state by its equations.

    The voltage lies on a count of the output converter. The equations are integrated with the ball
    at equilibrium, in steps of their own.
    """
    parameters = read_parameters(BENCH, actuator)
    output = parameters.output_converter
    bias = on_a_count(output, 2.4)
    rig = Rig(parameters, 1)
    rig.respond(output.to_counts(np.full(round(300 * RATE), bias)))
    state = rest(parameters.film, parameters.rest)
    assert hold(parameters.film, state, parameters.amplifier.gain * bias, 300.0)
    return parameters, bias, rig, state


@pytest.mark.parametrize("actuator", ["dea1", "dea2"])
def test_probed_responses_of_a_film_at_rest_are_those_of_its_equations(actuator):
    """The equations are linearised; the instruments add a delay, and a part in 500."""
    parameters, bias, rig, state = held(actuator)
    gain, f = parameters.amplifier.gain, LINES / PERIOD
    found = truth(rig, parameters.output_converter, bias).first
    expected = 1e3 * gain * responses(parameters.film, state, gain * bias, f).first
    np.testing.assert_allclose(np.abs(found / expected), 1.0, atol=4e-3)
    delay = -np.angle(found / expected) / (2.0 * np.pi * f)
    np.testing.assert_allclose(delay, delay[-1], atol=4e-3)
    assert 1.0 / RATE < delay[-1] < 1.5 / RATE


@pytest.mark.parametrize("actuator", ["dea1", "dea2"])
def test_the_probed_rest_is_that_of_the_equations(actuator):
    parameters, bias, rig, state = held(actuator)
    found = truth(rig, parameters.output_converter, bias).rest
    assert found == pytest.approx(1e3 * state.scalars[Y], abs=2e-4)


@pytest.mark.slow
def test_every_quantity_of_a_record_is_judged():
    found = judge("dea1", 0, 2)
    assert found.withheld == ""
    sizes = {name: each.size for name, each in found.inside.items()}
    instants = len(film.SHARES)
    assert sizes == {
        "H1 gain": instants * len(LINES), "H1 phase": instants * len(LINES),
        "H2 gain": instants * len(film.PAIRS), "H2 phase": instants * len(film.PAIRS),
        "rest": instants, "free run": film.INSTANTS,
    }  # fmt: skip
    assert all(np.isin(each, (0.0, 1.0)).all() for each in found.inside.values())
