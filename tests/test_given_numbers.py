from fractions import Fraction

import numpy as np
import pytest

from dea.given_numbers import is_count, is_positive


@pytest.mark.parametrize("value", [1, 7, np.int64(1), np.uint8(3)])
def test_a_count_is_whole_and_at_least_one(value):
    assert is_count(value)


@pytest.mark.parametrize("value", [0, -1, np.int64(0), 1.0, np.float64(2.0), "1", None, [1]])
def test_others_are_no_counts(value):
    assert not is_count(value)


@pytest.mark.parametrize(("value", "holds"), [(3, True), (np.int32(2), False), (-1, False)])
def test_a_count_has_the_least_value_that_is_asked_for(value, holds):
    assert is_count(value, 3) is holds


@pytest.mark.parametrize("value", [1, 0.5, np.float32(0.1), np.int64(4), Fraction(1, 3)])
def test_a_positive_number_is_of_any_real_type(value):
    assert is_positive(value)


@pytest.mark.parametrize("value", [0, 0.0, -1.0, np.inf, np.nan, "1", None, 1j, [1.0]])
def test_others_are_no_positive_numbers(value):
    assert not is_positive(value)
