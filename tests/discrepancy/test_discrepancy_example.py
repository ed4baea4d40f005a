"""The worked example of the documentation runs, and finds what was hidden from it."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from dea.discrepancy import Settings, diagnose, signals_of
from dea.errors import InputError
from dea.simulation import load_simulation
from dea.store import Record

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "docs" / "discrepancy.md"
DT = 0.02


EXAMPLE = ROOT / "examples" / "simulation"
CARRIAGE = EXAMPLE / "carriage.py"


def recorded(seconds=80.0, friction=0.0, noise=2e-3, unit="mm"):
    """A carriage with dry friction, by small semi-implicit steps."""
    rng = np.random.default_rng(7)
    n, parts = round(seconds / DT), 40
    f = np.fft.rfftfreq(n, DT)
    spectrum = np.where((f > 0) & (f < 1.0), 1.0, 0.0) * np.exp(2j * np.pi * rng.random(f.size))
    u = np.fft.irfft(spectrum, n)
    u *= 1.5 / np.abs(u).max()
    x, v, h = 0.0, 0.0, DT / parts
    y = np.empty(n)
    for k in range(n):
        y[k] = x
        for _ in range(parts):
            v += h * (420.0 * u[k] - 380.0 * x - 25.0 * v)
            # Dry friction takes away what velocity there is, up to its impulse.
            v -= np.sign(v) * min(abs(v), h * friction)
            x += h * v
    y += noise * rng.standard_normal(n)
    return xr.Dataset(
        {"input": ("time", u, {"units": "V"}), "output": ("time", y, {"units": unit})},
        coords={"time": ("time", np.arange(n) * DT, {"units": "s"})},
    )


def test_the_document_shows_the_simulation_of_the_example():
    text = DOCUMENT.read_text().split("<!-- worked example")[1]
    assert re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1) == CARRIAGE.read_text()


def test_the_record_of_the_example_is_of_a_carriage_with_friction():
    made = recorded(friction=25.0)
    _, u, y = np.loadtxt(EXAMPLE / "carriage.csv", delimiter=",", skiprows=1).T
    np.testing.assert_allclose(u, made.input, atol=1e-5)
    np.testing.assert_allclose(y, made.output, atol=1e-4)


@pytest.mark.slow
def test_the_example_finds_friction_and_leaves_proof():
    found = diagnose(recorded(friction=25.0), CARRIAGE.as_posix())
    assert found.verdict.status == "named", found.verdict.sentence
    assert found.verdict.names == ("coulomb_friction",)
    assert found.verdict.certified["rmse_after"] < 0.2 * found.verdict.certified["rmse_before"]


@pytest.mark.slow
def test_the_example_finds_nothing_where_nothing_is():
    found = diagnose(recorded(), load_simulation(CARRIAGE))
    assert found.verdict.status == "none", found.verdict.sentence


def test_units_must_match():
    with pytest.raises(InputError, match=r"output is in 'cm'.*expects 'mm'"):
        diagnose(recorded(unit="cm"), CARRIAGE.as_posix())


def test_one_unit_may_be_spelt_in_two_ways():
    chamber = load_simulation(ROOT / "config" / "simulations" / "heated_chamber.py")
    u, y = np.zeros(9), np.linspace(20.0, 21.0, 9)
    found = signals_of(Record.of(u, y, 1.0, units=("V", "°C")), chamber)
    np.testing.assert_array_equal(found.y, y)


def test_a_record_must_be_long_enough():
    short = recorded(seconds=2.0).isel(time=slice(50))
    with pytest.raises(InputError, match=r"the split needs .*Settings\(slowest_time"):
        diagnose(short, CARRIAGE.as_posix(), settings=Settings())
