"""The stage that tries controllers on a virtual actuator: files in, a dataset out."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from dea import store
from dea.configuration.bench import BENCH, read_bench
from dea.configuration.files import read_yaml
from dea.configuration.study import FILE, check_study
from dea.configuration.study import settings as written
from dea.control import ControlScheme, Followed, control_dataset
from dea.control.datasets import _by_minute
from dea.errors import InputError
from dea.figures.control import control as drawn
from dea.narx import estimate, refine
from dea.plant import Rig, read_parameters
from dea.simulation import catalogue, load_simulation, measured_scales, prepared, save_extended
from dea.stages import control as stage
from dea.tables.control import control as tabulated
from dea.terms import Term
from made_datasets import record_of

TERMS = "1", "y(t-1)", "y(t-2)", "u(t-1)", "u(t-2)", "u(t-1)^2", "y(t-1)u(t-1)"
RATE, ACTUATOR = 50.0, "dea2"


def settings(**changes):
    study = written(check_study(read_yaml(FILE, what="the configuration", example=FILE)))
    plant = read_bench(BENCH).actuators[ACTUATOR].model_dump()
    bench = study["bench"] | {"actuator": ACTUATOR, "config": BENCH, "plant": plant | changes}
    short = {"duration": 4.0, "hold": 1.0, "approach": 2.0}
    return {
        "seed": 1, "system": ACTUATOR, "acquisition": study["acquisition"], "bench": bench,
        "control": study["control"] | short,
    }  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A record of the actuator without the link, its model, and the physics' simulations."""
    folder = tmp_path_factory.mktemp("inputs")
    samples = 6000
    levels = np.random.default_rng(3).uniform(1.3, 3.5, samples // 12)
    u = np.interp(np.arange(samples), np.arange(0, samples, 12), levels)
    parameters = read_parameters(Path(BENCH), ACTUATOR)
    counts, measured = Rig(parameters, 1).advance(parameters.output_converter.to_counts(u))
    u = parameters.output_converter.to_values(counts)
    y = parameters.displacement_converter.to_values(measured)
    names = "record", "model", "nominal", "extended"
    paths = {name: folder / name for name in names}
    store.write(record_of(u, y, RATE), paths["record"], title="made")
    refine(estimate(tuple(map(Term.parse, TERMS)), u, y), u, y).save(paths["model"])
    simulation = prepared(load_simulation("dea_membrane"), u, 1 / RATE, 1e-3)
    values = simulation.layout.prior_means
    save_extended(simulation, values, 1 / RATE, paths["nominal"])

    class Sampled:
        interval = 1 / RATE

    Sampled.u, Sampled.y = u, y
    lag = simulation.attach(catalogue()["sensor_lag"], measured_scales(simulation, values, Sampled))
    save_extended(lag, lag.layout.prior_means, 1 / RATE, paths["extended"])
    return paths | {"device": Path("config/devices/virtual_bench.yaml")}


@pytest.mark.slow
def test_a_controller_and_an_inverse_that_is_played_are_kept(files, tmp_path, monkeypatch):
    every = stage._controllers
    driven = "adaptive inverse", "inverse of the physics with effects"
    seen = []

    def two_of_them(*arguments):
        found = every(*arguments)
        seen.extend(found)
        return {name: found[name] for name in driven}

    monkeypatch.setattr(stage, "_controllers", two_of_them)
    stage.control(settings(), control=tmp_path / "control.nc", **files)
    assert len(seen) == 6
    found = store.read(tmp_path / "control.nc", "control")
    assert tuple(found["controller"].values) == driven
    assert set(found["outcome"].values) == {"to the end"}
    assert found["effects"].values.tolist() == ["", "sensor_lag"]
    assert np.isfinite(found["measured"]).all()
    assert found.sizes["time"] == 200
    error = (found["measured"] - found["reference"]).values
    np.testing.assert_allclose(found["rms_error"][:, 0], np.sqrt(np.mean(error**2, axis=1)))
    assert found["rms_error"][0, 0] < 0.05 * found["stroke"]
    assert np.isfinite(found["inverse_error"].values).tolist() == [False, True]


@pytest.mark.parametrize(
    ("seconds", "starts"),
    [(180.0, [0, 60, 120]), (150.0, [0, 60, 90]), (60.02, [0, 0.02]), (45.0, [0])],
)
def test_minutes_count_from_the_beginning_and_the_last_ends_with_the_reference(seconds, starts):
    error = np.random.default_rng(8).standard_normal((2, round(seconds * RATE)))
    minutes = [error[:, round(s * RATE) : round((s + 60) * RATE)] for s in starts]
    expected = np.transpose([np.sqrt(np.mean(part**2, axis=1)) for part in minutes])
    np.testing.assert_allclose(_by_minute(error, RATE), expected)


@pytest.mark.parametrize("rate", [33.33528, 33.335])
def test_a_rate_that_gives_no_whole_number_of_samples_adds_no_minute(rate):
    error = np.ones((1, round(1800 * rate)))
    assert _by_minute(error, rate).shape == (1, 30)


def test_the_first_minute_of_the_table_is_the_one_that_the_figure_draws():
    """An error that grows tells one stretch from another; the reference lasts 90 s."""
    size = round(90 * RATE)
    task = SimpleNamespace(run_in=(50,), reference=np.zeros(50 + size), stroke=100.0)
    design = SimpleNamespace(task=task, sampling_rate=RATE)
    record = xr.Dataset(
        {
            "displacement": ("time", np.r_[np.full(50, 9e9), np.arange(size) / RATE]),
            "voltage": ("time", np.full(50 + size, 2.0)),
            "quality": ("time", np.zeros(50 + size)),
        }
    )
    found = {"PI": Followed(record, task.reference, "to the end", 0, ControlScheme())}
    dataset = control_dataset(found, design, "V", "mm")
    (row,) = tabulated({"dea1": dataset}).exact.to_dict("records")
    for word, axes in zip(("first", "last"), drawn(dataset).axes, strict=False):
        line = next(line for line in axes.lines if line.get_label() == "measured")
        shown = line.get_ydata()
        # The figure ends on the sample of the full minute itself.
        assert row[f"{word} minute (%)"] == pytest.approx(np.sqrt(np.mean(shown**2)), rel=1e-3)


@pytest.mark.slow
def test_an_actuator_that_is_another_than_planned_is_refused(files, tmp_path):
    with pytest.raises(InputError, match="changed since this run was planned"):
        stage.control(settings(film={}), control=tmp_path / "control.nc", **files)
    assert not list(tmp_path.iterdir())
