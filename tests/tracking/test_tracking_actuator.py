"""The whole chain against the truth that only the bench knows: an actuator's small-signal gain."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from dea.excitation import Span, gaussian
from dea.gfrf import frequency_response
from dea.narx import Refined, select_terms
from dea.plant import Rig
from dea.plant.converter import Converter
from dea.seeds import generator
from dea.tracking import track_parameters, with_constant

CONFIG = Path(__file__).parents[2] / "config"
BENCH = CONFIG / "bench.yaml"
STUDY = yaml.safe_load((CONFIG / "config.yaml").read_text())
RATE, MINUTES, MIDDLE, TONE, AMPLITUDE = 50.0, 10, 2.425, 0.3, 0.05
SAMPLES = round(60 * MINUTES * RATE)


def displacement(volts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Drive dea1, freshly mounted; return applied volts and millimetres."""
    command, reading = Converter(0.0, 15.0), Converter(0.0, 10.0)
    applied, measured = Rig.from_config(BENCH, "dea1", 1).advance(command.to_counts(volts))
    return command.to_values(applied), reading.to_values(measured)


def small_signal_response(at: np.ndarray) -> np.ndarray:
    """The difference that the sign of a small tone makes, over the minute around ``at``."""
    time = np.arange(SAMPLES) / RATE
    tone = AMPLITUDE * np.cos(2.0 * np.pi * TONE * time)
    difference = displacement(MIDDLE + tone)[1] - displacement(MIDDLE - tone)[1]
    analysed = difference * np.exp(-2j * np.pi * TONE * time) / AMPLITUDE
    return np.array([analysed[i - 1500 : i + 1500].mean() for i in at])


@pytest.mark.slow
def test_the_tracked_response_is_that_of_the_actuator():
    u, y = displacement(gaussian(Span(generator(1, "truth"), SAMPLES, RATE, 1.1, 3.75)))
    search = Refined(threshold=STUDY["identification"]["threshold"])
    model = select_terms(u[:5000], y[:5000], y_lags=3, u_lags=3, degree=3, search=search)
    track = track_parameters(model, u, y, method=STUDY["gfrf"]["tracker"], sampling_rate=RATE)
    at = np.arange(6000, SAMPLES, 6000)
    found = frequency_response(
        with_constant(model), 1, TONE, RATE,
        parameters=track["parameter"].values[at], operating_point=MIDDLE,
    )  # fmt: skip
    truth = small_signal_response(at)
    # The film creeps further under the excitation than under a constant middle voltage.
    np.testing.assert_allclose(np.abs(found), np.abs(truth), rtol=0.05)
    np.testing.assert_allclose(np.angle(found), np.angle(truth), atol=0.01)
    growth, true_growth = (np.abs(H[-1] / H[0]) for H in (found, truth))
    assert true_growth > 1.05
    np.testing.assert_allclose(growth, true_growth, rtol=0.02)
