import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.number_format import number, share, written_out


@given(st.floats(-1e12, 1e12).filter(lambda x: abs(x) > 1e-12))
def test_a_rounded_number_is_within_half_of_its_last_digit(value):
    assert float(number(value)) == pytest.approx(value, rel=5.1e-3)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("fold -1.06e+03 ± 1.5e+02 um", "fold -1060 ± 150 um"),
        ("from 2e+05 to 3.2e+06 and 4e-05", "from 200000 to 3.2e+06 and 4e-05"),
        ("0.3 of gate 10", "0.3 of gate 10"),
    ],
)
def test_numbers_of_up_to_six_digits_are_written_out(text, expected):
    assert written_out(text) == expected


@pytest.mark.parametrize(
    ("value", "low", "high", "text"),
    [(0.724, 0.63, 0.79, "72 % (63 to 79 %)"), (0.9999, 0.9951, 1.0, "over 99 %")],
)
def test_a_share_is_written_in_per_cent_and_never_as_all(value, low, high, text):
    assert share(value, low, high) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.6215, "62 %"), (0.994, "99 %"), (0.996, "over 99 %")]
)
def test_a_share_may_have_no_interval(value, text):
    assert share(value) == text
