"""The notebook that hands a model over runs, and code and unit agree with the model."""

import json
import shutil
from pathlib import Path

import fmpy
import pytest

NOTEBOOK = Path(__file__).parents[1] / "docs" / "model_to_fmu.ipynb"
pytestmark = pytest.mark.skipif(
    shutil.which("cc") is None or fmpy.platform != "linux64",
    reason="there is no C compiler cc for 64-bit Linux",
)


def code():
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def test_the_notebook_s_code_and_unit_compute_what_the_model_does():
    names = {}
    for cell in code():
        exec(cell, names)
    assert names["score"] > 0.999
    assert names["problems"] == []
    assert names["c_error"] < 1e-12
    assert names["fmu_error"] < 1e-12
    assert names["inverse_error"] < 0.01
