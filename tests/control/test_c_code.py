"""Generated C code: compiled by the system's compiler and compared with the free run."""

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from dea.control import c_identifier, to_c
from dea.errors import InputError
from dea.narx import NarxModel, Scaling, Stability
from published_plants import published_plants

COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler cc")
STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-O2"]
PLANTS = published_plants()
SCALING = Scaling(u_offset=2.4, u_scale=1.3, y_offset=-0.2, y_scale=0.7)

# What a program does with the code: one call for each sample.
DRIVER = """
#include "model.h"

void run(int count, int measured, const double *u, double *y)
{
    model_state state;
    int t;

    model_reset(&state);
    for (t = 0; t < count; t++) {
        if (t < measured) {
            model_observe(&state, u[t], y[t]);
        } else {
            y[t] = model_step(&state, u[t]);
        }
    }
}
"""


def compiled(model, folder):
    """Return a function that runs the compiled code from initial outputs on."""
    to_c(model, 50.0).write(folder / "model.h", folder / "model.c")
    (folder / "driver.c").write_text(DRIVER)
    files = ["model.c", "driver.c", "-o", "model.so"]
    subprocess.run([COMPILER, *STRICT, "-fPIC", "-shared", *files], cwd=folder, check=True)
    library = ctypes.CDLL(str(folder / "model.so"))
    pointer = np.ctypeslib.ndpointer(dtype=float, flags="C_CONTIGUOUS")
    library.run.argtypes = [ctypes.c_int, ctypes.c_int, pointer, pointer]
    library.run.restype = None

    def run(u, initial):
        y = np.concatenate([initial, np.zeros(u.size - len(initial))])
        library.run(u.size, len(initial), u, y)
        return y

    return run


def test_code_that_cannot_be_written_whole_leaves_what_was_there(tmp_path, monkeypatch):
    files = header, source = tmp_path / "model.h", tmp_path / "model.c"
    code = to_c(NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 1.0}), 50.0)
    code.write(header, source)
    before = [file.read_text() for file in files]

    def full(path, text, encoding):
        path.write_bytes(text[:10].encode(encoding))
        raise OSError("No space left on device")

    monkeypatch.setattr("pathlib.Path.write_text", full)
    with pytest.raises(OSError, match="No space left"):
        code.write(header, source)
    assert [file.read_text() for file in files] == before
    assert sorted(tmp_path.iterdir()) == sorted(files)


@needs_compiler
@pytest.mark.parametrize("name", PLANTS)
def test_half_an_hour_agrees_with_the_free_run(name, tmp_path):
    u = np.random.default_rng(17).uniform(-0.9, 0.9, 90_000)
    u = np.convolve(u, np.ones(5) / 5, mode="same")
    plant = PLANTS[name]
    model = NarxModel(plant.terms, plant.parameters, SCALING)
    inputs = SCALING.restore_input(u)
    initial = [-0.2, -0.19, -0.21]
    found = compiled(model, tmp_path)(inputs, initial)
    expected = model.simulate(inputs, initial)
    assert np.ptp(expected) > 0.05
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)


@needs_compiler
@pytest.mark.parametrize(
    "terms",
    [
        {"y(t-1)": 0.5, "u(t)": 0.25, "y(t-2)u(t-4)^2": 0.1, "u(t)^2u(t-1)": -0.05},
        {"1": 0.125, "u(t-2)^3": 2.0},
        {"1": 3.0},
        {"u(t)": 1e-30},
    ],
    ids=["feedthrough", "no feedback", "constant", "tiny"],
)
def test_every_kind_of_term_is_written(terms, tmp_path):
    model = NarxModel.from_terms(terms)
    u = np.random.default_rng(3).uniform(-1, 1, 50)
    initial = [0.1] * model.max_lag
    expected = model.simulate(u, initial)
    np.testing.assert_allclose(compiled(model, tmp_path)(u, initial), expected, rtol=1e-14)


@needs_compiler
@pytest.mark.parametrize("missing", [np.nan, np.inf, -np.inf, 1e300])
def test_the_prediction_stands_in_for_a_measurement_that_is_missing(missing, tmp_path):
    model = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.25})
    u = np.array([1.0, -2.0, 3.0, 4.0, 0.5, 0.0])
    found = compiled(model, tmp_path)(u, [0.1, missing, 0.3, missing, missing])
    predicted = 0.5 * (0.5 * 0.3 + 0.25 * 3.0) + 0.25 * 4.0
    assert found[5] == pytest.approx(0.5 * predicted + 0.25 * 0.5, rel=1e-14)


@needs_compiler
def test_a_diverging_run_is_infinite_from_the_same_sample_on(tmp_path):
    model = NarxModel.from_terms({"y(t-1)": 1.5, "y(t-1)^3": 0.5, "u(t-1)": 1.0})
    u = np.ones(60)
    expected = model.simulate(u)
    found = compiled(model, tmp_path)(u, [0.0])
    assert 3 < np.count_nonzero(np.isfinite(expected)) < 60
    np.testing.assert_array_equal(np.isinf(found), np.isinf(expected))


def test_constants_have_the_digits_that_determine_them():
    model = NarxModel.from_terms({"y(t-1)": 1.0 / 3.0, "u(t-1)": -2.0, "1": 1e300})
    source = to_c(model, 50.0).source
    table = re.search(r"theta\[3\] = \{(.*?)\};", source, re.DOTALL).group(1)
    values = [float(line.split(",")[0]) for line in table.strip().splitlines()]
    assert values == [1.0 / 3.0, -2.0, 1e300]


def test_neither_allocation_nor_recursion_nor_a_library_call():
    code = "".join(to_c(PLANTS["DEA2"], 50.0, name="dea2"))
    calls = set(re.findall(r"(\w+)\(", re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)))
    own = {"dea2_reset", "dea2_output", "dea2_step", "dea2_observe", "keep", "equation", "in_range"}
    assert calls - {"if", "for", "U", "define"} <= own


@pytest.mark.parametrize("name", ["", "2fast", "a-b", "a" * 32, "a b"])
def test_a_name_that_c_does_not_allow_is_refused(name):
    with pytest.raises(InputError, match="no name in C"):
        to_c(PLANTS["DEA1"], 50.0, name=name)


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_a_rate_that_is_not_positive_is_refused(rate):
    with pytest.raises(InputError, match="sampling_rate"):
        to_c(PLANTS["DEA1"], rate)


@pytest.mark.parametrize("name", ["dea1", "silver-box", "3tanks", "Ölfilm", "_x", "a" * 40])
def test_every_system_has_a_name_in_c(name):
    assert (
        f"{c_identifier(name)}_step" in to_c(PLANTS["DEA1"], 50.0, name=c_identifier(name)).source
    )


@pytest.mark.parametrize("status", ["stable", "slow", "unstable"])
def test_the_header_says_whether_the_model_is_stable(status):
    said = "Stability on inputs like those of the record that it was selected from"
    assert f" * {said}: not tested.\n" in to_c(PLANTS["DEA1"], 50.0).header
    checked = Stability(
        inputs=np.array([0.0]), outputs=np.array([0.0]),
        poles=np.array([{"stable": 0.9, "slow": 0.999, "unstable": 1.1}[status]]),
        holds=(1, 1), runs=(1, 1), surrogates=(1, 1), samples=100,
    )  # fmt: skip
    assert f" * {said}: {status}.\n" in to_c(replace(PLANTS["DEA1"], checked=checked), 50.0).header
