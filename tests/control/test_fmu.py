"""Functional mock-up units: checked by FMPy's validator and simulated by FMPy."""

import ctypes
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from dea.control import write_fmu
from dea.errors import InputError
from dea.narx import NarxModel, Scaling
from published_plants import published_plants

PLANTS = published_plants()
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=-0.2, y_scale=0.7)
RATE = 50.0
VERSIONS = "2.0", "3.0"
EXCHANGE = {
    "fmi2EnterEventMode", "fmi2NewDiscreteStates", "fmi2EnterContinuousTimeMode",
    "fmi2CompletedIntegratorStep", "fmi2SetTime", "fmi2SetContinuousStates", "fmi2GetDerivatives",
    "fmi2GetEventIndicators", "fmi2GetContinuousStates", "fmi2GetNominalsOfContinuousStates",
}  # fmt: skip
FEEDTHROUGH = {"y(t-1)": 0.5, "u(t)": 0.25, "u(t)u(t-2)": 0.1}

pytestmark = pytest.mark.skipif(
    shutil.which("cc") is None or fmpy.platform != "linux64",
    reason="there is no C compiler cc for 64-bit Linux",
)


def scaled(name):
    plant = PLANTS[name]
    return NarxModel(plant.terms, plant.parameters, SCALING)


def random_input(count):
    return SCALING.restore_input(np.random.default_rng(5).uniform(-0.5, 0.5, count))


class Slave:
    """A unit that is stepped by hand."""

    def __init__(self, path, folder):
        self.description = fmpy.read_model_description(path)
        fmpy.extract(path, unzipdir=folder)
        self.newer = self.description.fmiVersion == "3.0"
        self.fmu = (FMU3Slave if self.newer else FMU2Slave)(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        self.fmu.instantiate()
        self.set, self.get = (
            (self.fmu.setFloat64, self.fmu.getFloat64)
            if self.newer
            else (self.fmu.setReal, self.fmu.getReal)
        )
        if not self.newer:
            self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def run(self, u, period=1 / RATE):
        y = []
        for value in u:
            self.set([0], [value])
            y += self.get([1])
            self.fmu.doStep(0.0, period)
        return np.array(y)


@pytest.fixture(params=VERSIONS)
def opened(tmp_path, request):
    slaves = []

    def open_unit(model):
        path = tmp_path / f"{len(slaves)}.fmu"
        write_fmu(model, path, RATE, version=request.param)
        slaves.append(Slave(path, tmp_path / f"unit{len(slaves)}"))
        return slaves[-1]

    yield open_unit
    for slave in slaves:
        slave.fmu.freeInstance()


@pytest.mark.parametrize(
    ("name", "version"), [*((name, "2.0") for name in PLANTS), ("DEA1", "3.0")]
)
def test_fmpy_finds_it_valid_and_simulates_the_free_run(name, version, tmp_path):
    model, path = scaled(name), tmp_path / "plant.fmu"
    write_fmu(model, path, RATE, name=name.lower(), u_units="V", y_units="mm", version=version)
    assert fmpy.read_model_description(path).fmiVersion == version
    assert validate_fmu(str(path)) == []
    u = random_input(1500)
    signals = np.zeros(u.size, dtype=[("time", float), ("u", float)])
    signals["time"], signals["u"] = np.arange(u.size) / RATE, u
    found = fmpy.simulate_fmu(
        path, stop_time=signals["time"][-1], input=signals, output=["u", "y"], output_interval=0.02
    )
    # FMPy reads the output at the end of a step, before it sets the next input.
    np.testing.assert_allclose(found["y"], model.simulate(u), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_simulator_that_reads_before_it_sets_sees_the_input_of_the_step(version, tmp_path):
    """Of y = 0.5 y(t-1) + 0.25 u(t) + 0.1 u(t) u(t-2), with u(t-1) in the place of u(t)."""
    model, path = NarxModel.from_terms(FEEDTHROUGH, scaling=SCALING), tmp_path / "plant.fmu"
    write_fmu(model, path, RATE, u_units="V", y_units="mm", version=version)
    u = random_input(300)
    signals = np.zeros(u.size, dtype=[("time", float), ("u", float)])
    signals["time"], signals["u"] = np.arange(u.size) / RATE, u
    found = fmpy.simulate_fmu(
        path, stop_time=signals["time"][-1], input=signals, output=["y"], output_interval=0.02
    )
    inputs = np.concatenate([[0.0, 0.0], SCALING.normalise_input(u)])
    outputs, read = [0.0], []
    for t in range(2, inputs.size):
        held = inputs[t - 1] if read else inputs[t]
        read.append(0.5 * outputs[-1] + 0.25 * held + 0.1 * held * inputs[t - 2])
        outputs.append(0.5 * outputs[-1] + 0.25 * inputs[t] + 0.1 * inputs[t] * inputs[t - 2])
    expected = SCALING.restore_output(np.array(read))
    np.testing.assert_allclose(found["y"], expected, rtol=0.0, atol=1e-12)
    assert np.abs(expected - model.simulate(u)).max() > 0.05


def test_half_an_hour_stepped_by_hand(opened):
    model, u = scaled("DEA2"), random_input(90_000)
    found = opened(model).run(u)
    np.testing.assert_allclose(found, model.simulate(u), rtol=0.0, atol=1e-12)


def test_an_input_that_reaches_the_output_at_once(opened):
    model, u = NarxModel.from_terms(FEEDTHROUGH, scaling=SCALING), random_input(200)
    slave = opened(model)
    np.testing.assert_allclose(slave.run(u), model.simulate(u), rtol=0.0, atol=1e-13)
    assert [v.name for v in slave.description.outputs[0].dependencies] == ["u"]


def test_a_step_of_several_periods_holds_the_input(opened):
    model, u = scaled("DEA6"), random_input(60)
    found = opened(model).run(u, period=4 / RATE)
    np.testing.assert_allclose(found, model.simulate(np.repeat(u, 4))[::4], rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("length", [0.0, 0.01, 0.03, -0.02])
def test_a_step_that_is_no_whole_number_of_periods_is_an_error(length, opened):
    slave = opened(scaled("DEA1"))
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.fmu.doStep(0.0, length)


# Steps of no whole number of periods, too many for any counter, and none.
STEPS = """
#include "unit.h"

int main(void)
{
    const double lengths[] = {1e300, 1e10, -1e300, HUGE_VAL, -HUGE_VAL, NAN, 0.0};
    running unit;
    size_t i;

    start(&unit);
    for (i = 0U; i < sizeof(lengths) / sizeof(lengths[0]); i++) {
        if (pass(&unit, lengths[i]) == NULL) {
            return 1;
        }
    }
    return (pass(&unit, 40.0 * FMU_PERIOD) == NULL) ? 0 : 2;
}
"""


def test_steps_that_no_counter_holds_are_refused_before_they_are_counted(tmp_path):
    write_fmu(scaled("DEA1"), tmp_path / "plant.fmu", RATE, compiler=None)
    with zipfile.ZipFile(tmp_path / "plant.fmu") as archive:
        archive.extractall(tmp_path)
    sources = tmp_path / "sources"
    (sources / "steps.c").write_text(STEPS)
    checked = ["-std=c99", "-fsanitize=undefined,float-cast-overflow", "-fno-sanitize-recover=all"]
    command = ["cc", *checked, "steps.c", "model.c", "-lm", "-o", "steps"]
    subprocess.run(command, cwd=sources, check=True)
    subprocess.run(["./steps"], cwd=sources, check=True, timeout=10)


def test_a_diverging_model_stops_the_simulator(opened):
    slave = opened(NarxModel.from_terms({"y(t-1)": 1.5, "y(t-1)^3": 0.5, "u(t-1)": 1.0}))
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.run(np.ones(60))


@pytest.mark.parametrize("at_once", [False, True])
def test_divergence_is_told_by_the_step_whose_output_it_is(opened, at_once):
    """y doubles from 1 on, and 2^33 is the last that is below 10^10."""
    terms = {"y(t-1)": 2.0, "u(t-1)": 1.0} | ({"u(t)": 1e-12} if at_once else {})
    slave = opened(NarxModel.from_terms(terms))
    slave.set([0], [1.0])
    slave.fmu.doStep(0.0, 1 / RATE)
    slave.set([0], [0.0])
    for _ in range(33):
        slave.fmu.doStep(0.0, 1 / RATE)
    assert slave.get([1]) == [pytest.approx(2.0**33)]
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.fmu.doStep(0.0, 1 / RATE)


def test_states_are_kept_and_restored_also_as_bytes(opened):
    model, u = scaled("DEA3"), random_input(80)
    slave, other = opened(model), opened(model)
    slave.run(u[:30])
    kept = slave.fmu.getFMUState()
    first = slave.run(u[30:])
    slave.fmu.setFMUState(kept)
    np.testing.assert_array_equal(slave.run(u[30:]), first)
    if slave.newer:
        moved = other.fmu.deserializeFMUState(slave.fmu.serializeFMUState(kept))
    else:
        moved = other.fmu.deSerializeFMUstate(slave.fmu.serializeFMUstate(kept))
    other.fmu.setFMUState(moved)
    np.testing.assert_array_equal(other.run(u[30:]), first)
    slave.fmu.freeFMUState(kept)
    other.fmu.freeFMUState(moved)
    slave.fmu.reset()
    np.testing.assert_allclose(slave.run(u), model.simulate(u), rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("version", VERSIONS)
def test_the_wrapper_agrees_with_the_headers_of_the_standard(version, tmp_path):
    write_fmu(scaled("DEA1"), tmp_path / "plant.fmu", RATE, version=version)
    wrapper = f"fmi{version[0]}"
    with zipfile.ZipFile(tmp_path / "plant.fmu") as archive:
        archive.extractall(tmp_path)
    sources = tmp_path / "sources"
    (sources / f"{wrapper}.h").write_text(f'#include "{wrapper}Functions.h"\n')
    standard = Path(fmpy.__file__).with_name("c-code")
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    if version == "3.0":  # what the unit refuses does not look at its arguments
        strict.append("-Wno-unused-parameter")
    command = ["cc", *strict, f"-I{standard}", "-shared", "-fPIC", "model.c", f"{wrapper}.c"]
    subprocess.run([*command, "-o", "unit.so"], cwd=sources, check=True)
    declared = re.findall(
        rf"_Export \w+\s+({wrapper}\w+);", (standard / f"{wrapper}Functions.h").read_text()
    )
    library = ctypes.CDLL(str(sources / "unit.so"))
    missing = {name for name in declared if not hasattr(library, name)}
    # FMI 2.0 lets a slave leave out what is for model exchange.
    assert missing <= EXCHANGE if version == "2.0" else not missing
    assert len(declared) > 40


@pytest.mark.parametrize("version", VERSIONS)
def test_units_with_prefixes_link_into_one_program(version, tmp_path):
    """By the macro that the standard's own headers take the prefix from."""
    wrapper, objects = f"fmi{version[0]}", []
    for name in ("left", "right"):
        write_fmu(scaled("DEA1"), tmp_path / "plant.fmu", RATE, name=name, version=version)
        with zipfile.ZipFile(tmp_path / "plant.fmu") as archive:
            archive.extractall(tmp_path / name)
        prefix = f"-D{wrapper.upper()}_FUNCTION_PREFIX={name}_"
        command = ["cc", "-std=c99", "-Wall", "-Werror", "-fPIC", prefix, "-c"]
        sources = tmp_path / name / "sources"
        subprocess.run([*command, "model.c", f"{wrapper}.c"], cwd=sources, check=True)
        objects += [str(sources / f"{part}.o") for part in ("model", wrapper)]
    subprocess.run(["cc", "-shared", *objects, "-o", "both.so"], cwd=tmp_path, check=True)
    both = ctypes.CDLL(str(tmp_path / "both.so"))
    standard = Path(fmpy.__file__).with_name("c-code") / f"{wrapper}Functions.h"
    declared = re.findall(rf"_Export \w+\s+({wrapper}\w+);", standard.read_text())
    for name in ("left", "right"):
        exported = {each for each in declared if hasattr(both, f"{name}_{each}")}
        assert set(declared) - exported <= EXCHANGE
    assert not [each for each in declared if hasattr(both, each)]


def test_a_unit_of_3_refuses_what_it_has_not(tmp_path):
    write_fmu(scaled("DEA1"), tmp_path / "plant.fmu", RATE, version="3.0")
    slave = Slave(tmp_path / "plant.fmu", tmp_path / "unit")
    slave.run([2.0, 2.5])
    slave.fmu.doStep(1.0, 0.04)
    assert slave.get([2]) == [pytest.approx(1.04)]
    for refused in (
        lambda: slave.fmu.getInt32([0]),
        lambda: slave.set([1], [0.0]),
        lambda: slave.get([3]),
        slave.fmu.enterEventMode,
    ):
        with pytest.raises(fmpy.fmi1.FMICallException):
            refused()
    slave.fmu.freeInstance()


def test_an_unknown_version_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"no unit of FMI 1\.0"):
        write_fmu(scaled("DEA1"), tmp_path / "plant.fmu", RATE, version="1.0")


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["unit", "identity", "fmi2", "fmi3", "model", "Unit", "FMI3"])
def test_a_name_of_the_wrappers_own_files_is_as_good_as_any(name, version, tmp_path):
    path = tmp_path / "plant.fmu"
    write_fmu(scaled("DEA1"), path, RATE, name=name, version=version)
    assert validate_fmu(str(path)) == []


@pytest.mark.parametrize("version", VERSIONS)
def test_the_same_model_gives_the_same_bytes(version, tmp_path):
    for name in ("a", "b"):
        write_fmu(scaled("DEA4"), tmp_path / name, RATE, version=version)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


@pytest.mark.parametrize(
    "said",
    ["stdlib.h: no such file", "In file included\\nm.c:1: error: stdlib.h: no such file\\n^"],
)
def test_what_the_compiler_says_is_told_and_nothing_is_written(said, tmp_path):
    compiler = tmp_path / "cc"
    compiler.write_text(f"#!/bin/sh\nprintf '{said}' >&2\nexit 1\n")
    compiler.chmod(0o755)
    with pytest.raises(
        InputError, match=r"compile it: (m.* error: )?stdlib\.h: no such file.*libc6-dev"
    ):
        write_fmu(scaled("DEA4"), tmp_path / "a.fmu", RATE, compiler=str(compiler))
    assert not (tmp_path / "a.fmu").exists()


def test_without_a_compiler_it_says_what_to_do_and_writes_nothing(tmp_path):
    with pytest.raises(InputError, match="no C compiler 'no-such-cc'"):
        write_fmu(scaled("DEA4"), tmp_path / "a.fmu", RATE, compiler="no-such-cc")
    assert not list(tmp_path.iterdir())
    for version in VERSIONS:
        write_fmu(scaled("DEA4"), tmp_path / "a.fmu", RATE, compiler=None, version=version)
        with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
            assert not [name for name in archive.namelist() if name.startswith("binaries")]
        assert validate_fmu(str(tmp_path / "a.fmu")) == []
