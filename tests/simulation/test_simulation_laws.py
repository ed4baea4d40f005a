import numpy as np
import pytest

from dea.simulation.effects._laws import limited
from dea.simulation.effects.input_saturation import law


@pytest.mark.parametrize("sharpness", [1.0, 8.0, 200.0])
def test_a_limit_of_zero_is_where_smaller_and_smaller_limits_lead(sharpness):
    assert limited(1.0, 0.0, sharpness) == 0.0
    assert limited(1.0, 1e-9, sharpness) == pytest.approx(0.0, abs=1e-8)


def test_an_input_may_be_cut_off_on_its_negative_side():
    shaped = law(np.array([-2.0, -0.5, 0.0, 0.5]), np.array([1.0, 200.0, 0.0, 0.0]), 0.02)
    np.testing.assert_allclose(shaped, [0.0, 0.0, 0.0, 0.5], atol=1e-9)
