"""The virtual actuators against the measured ones, and their stability at every voltage."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from benchmarks import calibration
from dea.narx import load_published
from dea.plant.film import rest
from dea.plant.parameters import read_parameters
from dea.plant.small_signal import hold

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "config" / "bench.yaml"
ACTUATORS = list(yaml.safe_load(BENCH.read_text())["actuators"])
MODELS = load_published(ROOT / "config" / "published_models.yaml")
MEASURED = [name for name in ACTUATORS if name.upper() in MODELS]


@pytest.fixture(scope="module")
def measured():
    return {name.lower(): calibration.published(model, 50.0) for name, model in MODELS.items()}


def test_each_of_the_six_has_a_measured_counterpart():
    assert {"dea1", "dea2", "dea3", "dea4", "dea5", "dea6"} <= set(MEASURED)


@pytest.mark.slow
@pytest.mark.parametrize("actuator", MEASURED)
def test_an_actuator_answers_as_the_measured_one(measured, actuator):
    made = calibration.virtual(read_parameters(BENCH, actuator))
    gain, phase, curvature = made.misses(measured[actuator])
    assert gain <= 0.04
    assert phase <= 4.0
    assert curvature <= 0.25


def test_the_published_models_give_the_known_responses(measured):
    """Of the first actuator, computed elsewhere from the printed coefficients."""
    first = measured["dea1"]
    np.testing.assert_allclose(first.gain, [1.0, 1.0, 0.99, 0.93, 0.79], atol=0.006)
    np.testing.assert_allclose(first.phase, [-1, -3, -5, -13, -20], atol=0.6)
    np.testing.assert_allclose(first.curvature, [1.01, 1.0, 0.85, 0.64], atol=0.006)


@pytest.mark.parametrize("actuator", ACTUATORS)
@pytest.mark.parametrize("before", [0.0, 900.0])
def test_no_voltage_of_the_study_pulls_a_film_in(actuator, before):
    """The highest, held for two minutes, when the film is fresh and when it has crept."""
    parameters = read_parameters(BENCH, actuator)
    film, gain = parameters.film, parameters.amplifier.gain
    state = rest(film, parameters.rest)
    assert hold(film, state, gain * 2.425, before)
    assert hold(film, state, gain * 3.75, 120.0)
