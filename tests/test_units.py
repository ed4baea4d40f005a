import pytest

from dea.units import power, ratio


@pytest.mark.parametrize(
    ("units", "squared"),
    [("mm", "mm^2"), ("1", "1"), ("ticks/s", "(ticks/s)^2"), ("N m", "(N m)^2"),
     ("mm^2", "(mm^2)^2")],
)  # fmt: skip
def test_a_power_is_of_the_whole_unit(units, squared):
    assert power(units, 2) == squared


@pytest.mark.parametrize(
    ("below", "per"), [("V", "mm/V"), ("1", "mm"), ("V^2", "mm/V^2"), ("V %", "mm/(V %)"),
     ("ticks/s", "mm/(ticks/s)")],
)  # fmt: skip
def test_a_ratio_is_over_the_whole_unit(below, per):
    assert ratio("mm", below) == per
