"""What `make handover` wrote: the code and the unit compute what the model in the results does."""

import shutil
from pathlib import Path

import fmpy
import numpy as np
import pytest
from test_c_code import compiled
from test_fmu import Slave

from dea import store
from dea.narx import NarxModel

RESULTS = Path(__file__).parents[2] / "results"
UNITS = sorted(RESULTS.glob("*/handover/model.fmu"))
pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(not UNITS, reason="no model has been handed over"),
    pytest.mark.skipif(
        shutil.which("cc") is None or fmpy.platform != "linux64",
        reason="there is no C compiler cc for 64-bit Linux",
    ),
]


@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.parts[-3])
def test_it_answers_the_record_as_the_model_does(unit, tmp_path):
    folder = unit.parents[1]
    model = NarxModel.load(folder / "model.nc")
    signals = store.signals(store.read_record(folder / "record.nc"))
    u, initial = signals.u, signals.y[: model.max_lag]
    scale = model.scaling.y_scale
    code = compiled(model, tmp_path)(u, initial)
    # Of a model that runs away, as one of fixed parameters may, the share counts.
    np.testing.assert_allclose(code, model.simulate(u, initial), rtol=1e-12, atol=1e-12 * scale)
    stretch = u[:20_000]
    found = Slave(unit, tmp_path / "unit").run(stretch)
    np.testing.assert_allclose(found, model.simulate(stretch), rtol=0.0, atol=1e-12 * scale)
