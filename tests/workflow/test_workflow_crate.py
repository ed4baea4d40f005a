"""The RO-Crate of a small study, and what a reader can ask it."""

import json
import os
import shutil
import subprocess

import pytest
from copied_project import ROOT
from rocrate.rocrate import ROCrate

pytestmark = pytest.mark.slow
VALIDATOR = ROOT / ".venv-validator/bin/python"


@pytest.fixture(scope="module")
def folder(finished, tmp_path_factory):
    """The crate, written by Snakemake's reporter."""
    folder = tmp_path_factory.mktemp("crate") / "crate"
    reporter = ["--reporter", "crate", "--report-crate-folder", str(folder)]
    run = finished.snakemake(*reporter, "study")
    assert run.returncode == 0, run.stdout + run.stderr
    return folder


@pytest.fixture(scope="module")
def crate(folder):
    return ROCrate(folder)


def action_of(crate, product):
    """The action that made a product."""
    [action] = [
        entity
        for entity in crate.contextual_entities
        if entity.type == "CreateAction"
        and entity.id != "#run"
        and product in [result.id for result in entity["result"]]
    ]
    return action


def test_it_says_which_environment_settings_and_code_made_a_figure(crate, finished):
    action = action_of(crate, "results/figures/fig3.png")
    tool = action["instrument"]
    assert tool["name"] == "figures_responses"
    assert tool["softwareRequirements"].id == "environment.txt"
    assert "src/dea/figures/fig3.py" in [part.id for part in tool["hasPart"]]
    [settings] = [one for one in action["object"] if one.type == "PropertyValue"]
    assert json.loads(settings["value"])["resolution"] == 80
    inputs = {one.id for one in action["object"]} - {settings.id}
    assert inputs == {
        f"results/{actuator}/{dataset}.nc"
        for actuator in ("dea1", "dea2") for dataset in ("record", "gfrf")
    }  # fmt: skip
    assert action["startTime"] <= action["endTime"]


def test_it_holds_every_result_with_its_hash_and_its_action(crate, folder, finished):
    manifest = json.loads((finished.folder / "results/MANIFEST.json").read_text())
    for path, product in manifest["products"].items():
        assert crate.dereference(path)["sha256"] == product["sha256"]
        assert action_of(crate, path)["identifier"] == product["job"]
        assert (folder / path).read_bytes() == (finished.folder / path).read_bytes()


def test_it_holds_every_file_that_it_names(crate, folder):
    for entity in crate.data_entities:
        assert (folder / entity.id).exists(), entity.id


@pytest.mark.campaign
@pytest.mark.skipif(not VALIDATOR.exists(), reason="make crate installs the validator")
def test_it_is_a_provenance_run_crate(folder, tmp_path):
    checked = [str(VALIDATOR), str(ROOT / "workflow/validate_crate.py")]
    # Nobody answers there: validation does without a network.
    offline = os.environ | {"https_proxy": "http://127.0.0.1:9", "http_proxy": "http://127.0.0.1:9"}
    run = subprocess.run([*checked, str(folder)], capture_output=True, text=True, env=offline)
    assert run.returncode == 0, run.stdout
    broken = tmp_path / "broken"
    shutil.copytree(folder, broken)
    metadata = broken / "ro-crate-metadata.json"
    content = json.loads(metadata.read_text())
    for entity in content["@graph"]:
        if entity["@type"] == "ControlAction":
            del entity["instrument"]
    metadata.write_text(json.dumps(content))
    run = subprocess.run([*checked, str(broken)], capture_output=True, text=True, env=offline)
    assert run.returncode == 1
    assert "A ControlAction must reference a HowToStep" in run.stdout
