"""Single samples far from their neighbours, told from noise, steps and quantised readings."""

import numpy as np
import pytest
from scipy.signal import lfilter

from dea.discrepancy.evidence.outliers import count_outliers

RNG = np.random.default_rng(4)
NOISE = RNG.standard_normal(20000)
STEPS = np.repeat(RNG.uniform(-500.0, 500.0, 200), 100)
BACKGROUNDS = {
    "white": NOISE,
    "a random walk": np.cumsum(NOISE),
    "resonant": lfilter([1.0], [1.0, -1.8, 0.95], NOISE),
    "steps": NOISE + STEPS,
    "quantised": np.round(0.2 * NOISE),
    "nearly at rest": np.round(0.1 * NOISE + np.sin(1e-3 * np.arange(NOISE.size))),
}
ALL = np.ones(NOISE.size, bool)


@pytest.mark.parametrize("background", BACKGROUNDS)
def test_outliers_are_counted_and_nothing_else(background):
    residual = BACKGROUNDS[background].copy()
    quantised = np.sqrt(1 / 12) * np.all(residual == np.round(residual))
    assert count_outliers(residual, ALL, quantised) == 0
    scatter = np.std(residual - np.convolve(residual, [0.5, 0.0, 0.5], "same"))
    at = np.arange(150, 19000, 1000)  # between the steps
    residual[at] += np.where(at % 2000 > 1000, -20.0, 20.0) * max(scatter, 1.0)
    assert count_outliers(residual, ALL, quantised) == at.size
    there = ALL.copy()
    there[at[0]] = there[at[1] + 1] = False
    assert count_outliers(residual, there, quantised) == at.size - 2
    assert count_outliers(residual, ALL, 1e6) == 0


def test_too_few_samples_hold_none():
    for size in range(5):
        assert count_outliers(NOISE[:size], ALL[:size], 1.0) == 0
