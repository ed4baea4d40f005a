import pytest

from dea.errors import InputError


@pytest.mark.parametrize("break_", ["\n", "\r\n", "\n\n  ", "\u2028"])
def test_a_message_is_one_line_whatever_it_is_made_of(break_):
    error = InputError(
        f"cannot be read: 'a  b'{break_}Expected c{break_}",
        file=f"my{break_}file",
        field=f"x{break_}y",
        remedy=f"Give d{break_}or e",
    )
    assert str(error) == "my file: x y: cannot be read: 'a  b' Expected c. Give d or e"
    assert error.problem == "cannot be read: 'a  b' Expected c"
    assert error.remedy == "Give d or e"
