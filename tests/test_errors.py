import ast
from pathlib import Path

import pytest

from dea.errors import InputError

ROOT = Path(__file__).parents[1]


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


@pytest.mark.parametrize("folder", ["src", "benchmarks"])
def test_every_input_error_says_what_to_do(folder):
    without = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "InputError"
        if "remedy" not in {keyword.arg for keyword in node.keywords}
    ]
    assert without == []


def test_an_error_may_be_told_at_another_place():
    error = InputError("it is 3", field="length", remedy="Give more.")
    assert str(error.at(file="a.yaml")) == "a.yaml: length: it is 3. Give more"
    assert str(error.at(field="part.length", remedy="Give 4.")) == "part.length: it is 3. Give 4"
    assert str(error.at()) == str(error)
