import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.number_format import number


@given(st.floats(-1e12, 1e12).filter(lambda x: abs(x) > 1e-12))
def test_a_rounded_number_is_within_half_of_its_last_digit(value):
    assert float(number(value)) == pytest.approx(value, rel=5.1e-3)
