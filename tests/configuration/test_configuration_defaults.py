"""A default of the config is that of the library, which also works without a config."""

import inspect
from dataclasses import asdict, fields
from pathlib import Path

import pytest
import yaml

from dea.acquisition import AcquisitionSettings
from dea.configuration import acquisition, device, discrepancy, excitation, resolution
from dea.discrepancy import Settings
from dea.excitation import KINDS as DESIGNS
from dea.modbus import Register, Serial, parse_device
from dea.resolution import Options

ROOT = Path(__file__).parents[2]
KINDS = {
    "gaussian": excitation.Gaussian,
    "bursts": excitation.Bursts,
    "multisine": excitation.Multisine,
    "staircase": excitation.Staircase,
    "binary": excitation.Binary,
    "triangle": excitation.Triangle,
}


def defaults(model):
    """Return the keys of a section that have a default."""
    return {name: f.default for name, f in model.model_fields.items() if not f.is_required()}


@pytest.mark.parametrize("kind", DESIGNS)
def test_a_kind_of_excitation_has_the_keys_and_defaults_of_its_function(kind):
    own = {
        name: parameter.default
        for name, parameter in inspect.signature(DESIGNS[kind]).parameters.items()
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY
    }
    assert defaults(KINDS[kind]) == own


def test_an_acquisition_has_the_keys_of_the_config():
    """Pacing is for tests alone, which need not wait."""
    known = {field.name for field in fields(AcquisitionSettings)} - {"paced"}
    assert known == set(acquisition.Acquisition.model_fields)
    assert defaults(acquisition.Acquisition).items() <= asdict(AcquisitionSettings()).items()


def test_a_register_and_a_line_have_the_defaults_of_their_description():
    found = parse_device(
        {
            "name": "module",
            "framing": "serial",
            "serial": {"port": "/dev/ttyS0"},
            "unit_id": 1,
            "sampling_rate": 50,
            "registers": {"spare": {"address": 1}},
        }
    )
    assert found["spare"] == Register(name="spare", address=1)
    assert found.serial == Serial(port="/dev/ttyS0")
    assert defaults(device.Serial).keys() == {field.name for field in fields(Serial)} - {"port"}


@pytest.mark.parametrize(("name", "model"), [("rules", "Rules"), ("budget", "Budget")])
def test_the_diagnosis_has_the_numbers_of_the_config(name, model):
    shipped = yaml.safe_load((ROOT / "config/config.yaml").read_text())["discrepancy"][name]
    configured = defaults(getattr(discrepancy, model)) | shipped
    assert asdict(getattr(Settings(), name)).items() == configured.items()


def test_a_resolution_has_the_defaults_of_the_library():
    own = defaults(resolution.Resolution)
    library = asdict(Options())
    shared = own.keys() & library.keys()
    assert shared == {"records", "duration", "level", "another"}
    assert {name: own[name] for name in shared} == {name: library[name] for name in shared}


def test_a_multisine_may_play_its_first_line_alone_over_one_period():
    """49 times the rounded 1/49 is below one."""
    line = {"kind": "multisine", "low": 0.0, "high": 1.0, "band": 1 / 49, "period": 49.0}
    assert excitation.Multisine(duration=49.0, **line).band * 49.0 < 1.0
