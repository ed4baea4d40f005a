"""The tutorial runs, and finds what it says."""

import json
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[1] / "docs" / "tutorial.ipynb"
pytestmark = pytest.mark.slow


def code():
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def test_the_tutorial_names_the_effect_that_it_hid(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")
    names = {}
    for cell in code():
        exec(cell, names)
    assert names["score"] > 0.95
    assert names["diagnosis"].verdict.status == "named"
    assert names["diagnosis"].verdict.names == ("dead_zone",)
