"""What ``verdict.json`` holds of a diagnosis."""

from dataclasses import replace

import numpy as np
import pytest
from small_search import SEARCH

from dea.discrepancy import Settings, diagnose, read_verdict
from dea.simulation import prepared
from dea.store import Record
from made_carriage import CARRIAGE


@pytest.fixture(scope="module")
def bent():
    """The diagnosis of a linear device whose reading is a parabola of its output."""
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(-2.0, 2.0, 60), 25)
    extended = prepared(CARRIAGE, u, 0.02, 1e-4)
    y = extended.simulate(extended.layout.prior_means, u, 0.02)
    reading = y - 0.3 * (y - y.min()) * (y.max() - y) / np.ptp(y)
    made = Record.of(u, reading + 2e-3 * rng.standard_normal(u.size), 50.0, units=("V", "V"))
    settings = Settings(effects=("sensor_nonlinearity",), budget=SEARCH)
    return diagnose(made, CARRIAGE, settings=settings)


def test_a_law_that_is_too_poor_is_stored(bent, tmp_path):
    assert (bent.verdict.status, bent.verdict.law_too_poor) == ("named", False)
    block = replace(bent.certificate.block, after=1.31 * bent.floor)
    poor = replace(bent, certificate=replace(bent.certificate, block=block))
    poor.verdict.write(tmp_path / "verdict.json")
    assert read_verdict(tmp_path / "verdict.json").law_too_poor is True
    assert poor.verdict.sentence.startswith("Probably `sensor_nonlinearity` (")


def test_how_predictable_the_rest_is_is_stored(bent, tmp_path):
    unexplained = replace(bent.unexplained, ratio=0.7)
    replace(bent, unexplained=unexplained).verdict.write(tmp_path / "verdict.json")
    verdict = read_verdict(tmp_path / "verdict.json")
    assert verdict.predictable == pytest.approx(0.3)
    assert " removes 30 % of the error that the answer leaves, " in verdict.remarks[0]
    assert verdict.sentence.endswith(" ".join(verdict.remarks))
