"""The judge of the bands of virtual actuators (``make coverage-film`` runs a campaign of it)."""

import numpy as np
import pytest
from benchmarks.coverage import film
from benchmarks.coverage.film import BENCH, LINES, PERIOD, RATE, judge, truth

from dea.plant import Rig, read_parameters
from dea.plant.film import rest
from dea.plant.small_signal import hold, responses


@pytest.mark.parametrize("actuator", ["dea1", "dea2"])
def test_probed_responses_of_a_film_at_rest_are_those_of_its_equations(actuator):
    """The equations are linearised; the instruments add a delay, and a part in 500."""
    parameters, bias = read_parameters(BENCH, actuator), 2.4
    output, gain = parameters.output_converter, parameters.amplifier.gain
    rig = Rig(parameters, 1)
    rig.respond(output.to_counts(np.full(round(300 * RATE), bias)))
    found = truth(rig, output.to_counts, output.to_values, bias).first
    state = rest(parameters.film, parameters.rest)
    assert hold(parameters.film, state, gain * bias, 300.0)
    f = LINES / PERIOD
    expected = 1e3 * gain * responses(parameters.film, state, gain * bias, f).first
    np.testing.assert_allclose(np.abs(found / expected), 1.0, atol=4e-3)
    delay = -np.angle(found / expected) / (2.0 * np.pi * f)
    np.testing.assert_allclose(delay, delay[-1], atol=4e-3)
    assert 1.0 / RATE < delay[-1] < 1.5 / RATE


@pytest.mark.slow
def test_every_quantity_of_a_record_is_judged():
    found = judge("dea1", 0, 2)
    assert found.withheld == ""
    sizes = {name: each.size for name, each in found.inside.items()}
    instants = len(film.SHARES)
    assert sizes == {
        "H1 gain": instants * len(LINES), "H1 phase": instants * len(LINES),
        "H2 gain": instants * len(film.PAIRS), "H2 phase": instants * len(film.PAIRS),
    }  # fmt: skip
    assert all(np.isin(each, (0.0, 1.0)).all() for each in found.inside.values())
