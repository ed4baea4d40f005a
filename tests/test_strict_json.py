"""What JSON has no numbers for."""

import json
from math import inf, nan

import pytest

from dea.store import Sources
from dea.strict_json import as_json, from_json


def test_every_number_comes_back_from_json_that_any_reader_takes():
    content = {"low": -inf, "high": inf, "values": [1.5, nan, "text"], "none": None}

    def refuse(constant):
        raise AssertionError(constant)

    text = as_json(content, 1)
    json.loads(text, parse_constant=refuse)
    found = from_json(text)
    assert found["values"][1] != found["values"][1]
    found["values"][1] = content["values"][1] = None
    assert found == content


def test_text_that_is_no_json_is_refused():
    with pytest.raises(ValueError, match="Expecting"):
        from_json("{")


def test_figures_and_tables_read_such_numbers(tmp_path):
    folder = tmp_path / "dea1"
    folder.mkdir()
    file = folder / "verdict.json"
    file.write_text(text := as_json({"certified": {"rmse_after": inf}}, 1))
    assert '"Infinity"' in text
    assert Sources([file]).document("verdict") == {"certified": {"rmse_after": inf}}
