import pytest

from dea.units import power, product, ratio


@pytest.mark.parametrize(
    ("units", "squared"),
    [("mm", "mm^2"), ("1", "1"), ("ticks/s", "(ticks/s)^2"), ("N m", "(N m)^2"),
     ("mm^2", "(mm^2)^2"), ("N·m", "(N·m)^2")],
)  # fmt: skip
def test_a_power_is_of_the_whole_unit(units, squared):
    assert power(units, 2) == squared


@pytest.mark.parametrize(
    ("below", "per"), [("V", "mm/V"), ("1", "mm"), ("V^2", "mm/V^2"), ("V %", "mm/(V %)"),
     ("ticks/s", "mm/(ticks/s)"), ("N·m", "mm/(N·m)"), ("m V/s", "mm/(m V/s)")],
)  # fmt: skip
def test_a_ratio_is_over_the_whole_unit(below, per):
    assert ratio("mm", below) == per


@pytest.mark.parametrize(
    ("above", "below", "found"),
    [
        (["rad/s"], "s", "rad/s^2"),
        (["V"], "s", "V/s"),
        (["1"], "s", "1/s"),
        (["s"], "s", "1"),
        (["m/s", "kg"], "s", "m kg/s^2"),
        (["1", "Pa s"], "s", "Pa"),
        (["m", "N s/m"], "s", "N"),
        (["rad/s^2"], "rad", "1/s^2"),
        (["V/s/s"], "m/s", "V/s/m"),
        (["N"], "mm", "N/mm"),
        (["m^0.5"], "s", "m^0.5/s"),
        (["(ticks/s)^2"], "s", "(ticks/s)^2/s"),
        (["N*m", "N*m"], "1", "N^2 m^2"),
        (["V", "V"], "V*s", "V/s"),
        (["N·m"], "m", "N"),
        (["m/s", "V"], "1", "m V/s"),
        (["V", "%"], "1", "V %"),
        (["a^b"], "s", "a^b/s"),
    ],
)
def test_what_cancels_is_left_out_of_a_product(above, below, found):
    assert product(*above, below=below) == found
