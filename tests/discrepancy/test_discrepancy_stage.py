"""What is wrong with a case is said before anything is written, with its name and the remedy."""

import numpy as np
import pytest
import xarray as xr

from dea import store
from dea.errors import InputError
from dea.stages.diagnose import diagnose
from user_simulation import PORTS, SLOPE, write_simulation

DT = 0.02
OUTPUTS = ("localisation", "candidates", "verdict", "nominal", "extended", "certificate")


def settings(simulation):
    return {
        "seed": 1,
        "system": "my_case",
        "simulation": str(simulation),
        "split": {},
        "discrepancy": {
            "effects": [], "warm_up": 0.0, "budget": {}, "rules": {}
        },
    }  # fmt: skip


def write_record(path, samples=2000, unit="mm"):
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(0.0, 1.0, samples // 20 + 1), 20)[:samples]
    y_attributes = {"units": unit, "long_name": "level"}
    record = xr.Dataset(
        {
            "input": ("time", u, {"units": "V", "long_name": "voltage"}),
            "output": ("time", u + 1.0, y_attributes),
        },
        coords={"time": ("time", np.arange(samples) * DT, {"units": "s", "long_name": "time"})},
        attrs={"contract": "imported_record"},
    )
    store.write(record, path, title="Mine")
    return path


def run(folder, samples=2000, unit="mm", slope=SLOPE, ports=PORTS, further=(), tests=()):
    write_simulation(folder / "mine.py", slope, ports)
    diagnose(
        settings(folder / "mine.py"),
        record=write_record(folder / "record.nc", samples, unit),
        further=list(further),
        tests=list(tests),
        threads=1,
        **{name: folder / "out" / name for name in OUTPUTS},
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"samples": 60}, ["the split needs", "Record longer"]),
        ({"unit": "cm"}, ["output is in 'cm'", "Convert the record"]),
        ({"slope": "40.0 * x[0] + p[1] * u"}, ["runs away at its nominal", "nominal values"]),
        ({"slope": "1.0 * x[0] + p[1] * u"}, ["its output moves by", "sign of the term"]),
        ({"slope": "p[0] * (u - x[0])"}, ["does not depend on 'gain'", "Multiply the input by it"]),
        ({"slope": "p[1] * u / x[0]"}, ["derivative of level is not a number", "Check"]),
        ({"slope": "p[1] * u - x[1]"}, ["not declared", "There is 1 state and"]),
        ({"ports": PORTS.replace('drive="gain", ', "")}, ["drive", "worked example"]),
        ({"ports": PORTS.replace('"gain"', '"power"')}, ["drive names 'power'", "rate, gain"]),
        ({"ports": PORTS.replace('("level",', '("speed",')}, ["names 'speed'", "level"]),
        ({"ports": "**absent"}, ["absent", "worked example"]),
    ],
)
def test_what_is_wrong_is_said_before_anything_is_written(change, words, tmp_path):
    with pytest.raises(InputError) as error:
        run(tmp_path, **change)
    said = str(error.value)
    for word in [*words, "case my_case"]:
        assert word in said
    assert error.value.file
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("part", ["further", "tests"])
def test_an_error_names_the_file_of_the_record_that_it_is_in(part, tmp_path):
    good = write_record(tmp_path / "second.nc")
    bad = write_record(tmp_path / "third.nc", unit="cm")
    with pytest.raises(InputError, match=r"output is in 'cm'") as error:
        run(tmp_path, **{part: [good, bad]})
    assert error.value.file == bad
    within = {"further": "record 3", "tests": "test_records.third"}
    assert error.value.field == f"{within[part]}.output"
