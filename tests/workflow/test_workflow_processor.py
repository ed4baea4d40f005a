"""The same models and verdict, and nearly the same numbers, on another processor."""

import json

import numpy as np
import pytest
import xarray as xr
from copied_project import Project

pytestmark = pytest.mark.campaign
# Code for the oldest processors of 64 bits, and the linear algebra for them, round otherwise.
OLDEST = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "OPENBLAS_CORETYPE": "Prescott"}
MADE = ["results/dea1/track.nc", "results/dea1/gfrf.nc", "results/discrepancy/dea1/verdict.json"]
EFFECTS = "discrepancy={effects: [viscoelastic_creep, dead_zone, end_stop]}"
# Of the largest value of a variable: a hundred times and more what was seen.
TOLERANCE = {"record": 1e-12, "model": 1e-6, "track": 1e-5, "gfrf": 1e-6}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The folders of the same jobs on this processor and on the oldest."""
    folders = []
    for name, variables in (("here", {}), ("oldest", OLDEST)):
        project = Project(tmp_path_factory.mktemp(name)).copy()
        run = project.snakemake(*MADE, "--config", EFFECTS, **variables)
        assert run.returncode == 0, run.stdout + run.stderr
        folders.append(project.folder / "results")
    return folders


def test_another_processor_computes_otherwise(runs):
    here, oldest = ((folder / "dea1" / "track.nc").read_bytes() for folder in runs)
    assert here != oldest


@pytest.mark.parametrize("name", TOLERANCE)
def test_datasets_agree(runs, name):
    here, oldest = (xr.open_dataset(folder / "dea1" / f"{name}.nc").load() for folder in runs)
    if "term" in here.coords:
        assert here["term"].values.tolist() == oldest["term"].values.tolist()
    for variable in here.variables:
        if variable.startswith("trial"):  # candidates that were tried on the way
            continue
        one, other = here[variable].values, oldest[variable].values
        if one.dtype.kind == "f":
            size = float(np.nanmax(np.abs(one), initial=0.0))
            limit = TOLERANCE[name] * size
            np.testing.assert_allclose(other, one, rtol=0.0, atol=limit, err_msg=variable)
        else:
            np.testing.assert_array_equal(other, one, err_msg=variable)


def test_the_verdict_is_the_same(runs):
    here, oldest = (
        json.loads((folder / "discrepancy/dea1/verdict.json").read_text()) for folder in runs
    )
    for verdict in (here, oldest):
        verdict["effects"] = [effect["name"] for effect in verdict["effects"]]
    assert (here["status"], here["effects"]) == (oldest["status"], oldest["effects"])
