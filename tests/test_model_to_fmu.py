"""The notebook that hands a model over runs, and code and unit agree with the model."""

import shutil

import fmpy
import pytest

from notebooks import run

pytestmark = pytest.mark.skipif(
    shutil.which("cc") is None or fmpy.platform != "linux64",
    reason="there is no C compiler cc for 64-bit Linux",
)


def test_the_notebook_s_code_and_unit_compute_what_the_model_does():
    names = run("model_to_fmu")
    assert names["score"] > 0.999
    assert names["problems"] == []
    assert names["c_error"] < 1e-12
    assert names["fmu_error"] < 1e-12
    assert names["inverse_error"] < 0.01
