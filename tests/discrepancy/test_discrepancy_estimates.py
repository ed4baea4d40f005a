"""In which order the parameters of a named effect are told, and with which intervals."""

from types import SimpleNamespace

import numpy as np
import pytest

from dea.discrepancy.evidence.model_error import ModelError
from dea.discrepancy.fit import Fit
from dea.discrepancy.report.estimates import estimates, uncertainty
from dea.simulation import Parameter


def test_a_parameter_that_may_as_well_be_zero_comes_after_one_that_may_not():
    """And those that do not define the law after both."""
    parameters = (
        Parameter("even", "1", 0.0, 1.0),
        Parameter("cubic", "1", 0.0, 2.0),
        Parameter("width", "1", 1.0, 1.0, shape=True),
        Parameter("time", "s", 1.0, 1.0, log=True),
        Parameter("begun", "1", 1.0, 1.0, at_start=True),
    )
    coordinates = np.array([0.002, 0.15, 2.0, np.log(3.0), 4.0])
    extended = SimpleNamespace(
        effect_slices=[slice(0, 5)],
        attached=[SimpleNamespace(parameters=parameters)],
        free=np.arange(5),
        shapes=np.array([p.shape for p in parameters]),
        at_start=np.array([p.at_start for p in parameters]),
    )
    values = np.array([p.value(x) for p, x in zip(parameters, coordinates, strict=True)])
    fit = SimpleNamespace(extended=extended, coordinates=coordinates, values=values)
    found = estimates(fit, 0, np.array([0.013, 0.02, 1e-4, 0.05, 1e-5]))
    assert list(found) == ["time", "cubic", "even", "begun", "width"]
    assert found["cubic"].value == pytest.approx(0.3)
    assert found["cubic"].low == pytest.approx(0.3 - 1.96 * 0.04)
    assert found["time"].high == pytest.approx(3.0 * np.exp(1.96 * 0.05))


@pytest.mark.parametrize("samples", [500, 5000])
def test_an_interval_holds_a_law_of_another_form_however_long_the_record_is(samples):
    """The other law differs by a twentieth of the effect, all of which passes for its size."""
    rng = np.random.default_rng(3)
    effect = np.repeat(rng.standard_normal(samples // 50), 50)
    effect *= 4.0 / np.sqrt(np.mean(effect**2))
    noise = rng.standard_normal(samples)
    problem = SimpleNamespace(seen=np.ones(samples, bool))
    extended = SimpleNamespace(simulation=SimpleNamespace(accuracy=0.0))
    fitted = Fit(extended, np.array([1.05]), noise, -effect[:, None], 0.0)
    error = ModelError(1.0, 0.0, 0.05 * 4.0, 30.0)
    [deviation] = uncertainty(problem, fitted, np.zeros(1), error).deviation
    assert deviation == pytest.approx(0.05, rel=0.05)
    extended.simulation.accuracy = 0.2
    [stated] = uncertainty(problem, fitted, np.zeros(1), error).deviation
    assert stated == pytest.approx(np.sqrt(2.0) * 0.05, rel=0.05)
    spread = uncertainty(problem, fitted, np.array([0.2]), error)
    assert spread.deviation[0] == pytest.approx(0.2)
    assert spread.covariance[0, 0] == pytest.approx(0.04)
