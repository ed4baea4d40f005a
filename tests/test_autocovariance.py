"""Products of a signal with itself, against their sums."""

import numpy as np
import pytest

from dea.autocovariance import autocovariance


@pytest.mark.parametrize("samples", [2, 7, 64])
def test_it_is_the_sum_of_the_products_that_overlap(samples):
    signal = np.random.default_rng(samples).standard_normal(samples)
    expected = [signal[: samples - lag] @ signal[lag:] for lag in range(samples)]
    assert np.allclose(autocovariance(signal, samples), expected)
    assert autocovariance(signal, 2).size == 2
