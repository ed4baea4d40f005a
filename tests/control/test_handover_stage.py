"""The stage that writes a model for others: files in, files out."""

import shutil

import fmpy
import numpy as np
import pytest

from dea import store
from dea.narx import NarxModel, Scaling
from dea.stages.handover import handover
from made_datasets import record_of

MODEL = NarxModel.from_terms(
    {"y(t-1)": 0.9, "u(t-1)": 0.05, "y(t-1)u(t-2)": 0.02},
    scaling=Scaling(u_offset=2.4, u_scale=1.3, y_offset=0.7, y_scale=0.4),
)


@pytest.mark.skipif(
    shutil.which("cc") is None or fmpy.platform != "linux64",
    reason="there is no C compiler cc for 64-bit Linux",
)
def test_the_unit_has_rate_units_and_name_of_the_record(tmp_path):
    samples = 700  # as many times as make the rate of rounded times differ from 50 Hz
    u = 2.4 + np.sin(np.arange(samples))
    paths = {name: tmp_path / f"{name}.nc" for name in ("record", "model")}
    store.write(record_of(u, MODEL.simulate(u), 50.0), paths["record"], title="made")
    MODEL.save(paths["model"])
    made = {
        "header": tmp_path / "model.h", "source": tmp_path / "model.c", "unit": tmp_path / "m.fmu"
    }  # fmt: skip
    handover({"system": "film-1"}, **paths, **made)
    assert "film_1_step" in made["header"].read_text()
    assert "film_1_step" in made["source"].read_text()
    description = fmpy.read_model_description(made["unit"])
    assert description.modelName == "film_1"
    assert description.defaultExperiment.stepSize == "0.02"
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert units == {"u": "V", "y": "mm"}
