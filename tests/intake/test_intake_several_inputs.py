"""A file with two inputs becomes a case, and its record has both."""

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.signal import lfilter

from dea import store
from dea.configuration.case import check_case
from dea.configuration.files import read_yaml
from dea.configuration.study import check_study
from dea.errors import InputError
from dea.intake.dynamics import linear_dynamics
from dea.intake.settings import infer_settings
from dea.stages.intake import main

ROOT = Path(__file__).parents[2]
N, RATE = 500, 10.0


def made(delays=(1, 1)):
    rng = np.random.default_rng(3)
    u = np.stack([np.convolve(each, np.ones(4) / 4, "same") for each in rng.normal(size=(2, N))], 1)
    y = np.zeros(N)
    for t in range(10, N):
        y[t] = 0.8 * y[t - 1] + 0.4 * u[t - delays[0], 0] - 0.3 * u[t - delays[1], 1]
    return u, y + rng.normal(0.0, 1e-3, N)


def test_each_input_has_its_own_delay():
    found = linear_dynamics(*made((1, 6)))
    assert [lags[0] for lags in found.u_lags] == [1, 6]
    assert found.error < 0.05


def of(u, y):
    return store.Record.of(u, y, RATE, units=(("V",) * u.shape[1], "K"))


@pytest.mark.parametrize("inputs", [2, 3, 4])
def test_the_shortest_record_allows_a_model_and_a_shorter_one_is_refused(inputs):
    rng = np.random.default_rng(4)
    u = rng.normal(size=(18 * (inputs + 2), inputs))
    y = lfilter([0.0, 1.0], [1.0, -0.5], u.sum(axis=1))
    assert infer_settings(of(u, y)).sections["identification"]["degree"] == 1
    with pytest.raises(InputError, match=f"{len(u) - 1} samples of {inputs} inputs") as refused:
        infer_settings(of(u[:-1], y[:-1]))
    assert f"Record at least {len(u)}" in refused.value.remedy


def test_a_stretch_too_short_for_two_inputs_is_refused():
    u, y = made()
    y[45:300:40] = np.nan
    with pytest.raises(InputError, match="longest part without a missing sample"):
        infer_settings(of(u[:120], y[:120]))


def stepped(first):
    """A record of two heaters, the second of which rests before sample ``first``."""
    u, _ = made()
    u[:first, 1] = 3.0
    return of(u, lfilter([0.0, 0.2], [1.0, -0.8], u.sum(axis=1)))


def test_an_input_that_first_moves_late_is_kept():
    sections = infer_settings(stepped(round(0.5 * N))).sections
    assert sections["identification"]["length"] * RATE == pytest.approx(2 * N / 3, abs=1)


def test_an_input_that_rests_where_models_come_from_is_named_with_the_part():
    with pytest.raises(InputError, match=r"is constant at 3 from 0 to 33.3 s, the part") as refused:
        infer_settings(stepped(round(0.7 * N)))
    assert "Leave it out, or cut" in refused.value.remedy


def test_a_file_with_two_inputs_becomes_a_case(tmp_path, monkeypatch, capsys):
    (tmp_path / "config" / "cases").mkdir(parents=True)
    for part in ("devices", "config.yaml", "bench.yaml"):
        os.symlink(ROOT / "config" / part, tmp_path / "config" / part)
    monkeypatch.chdir(tmp_path)
    u, y = made((1, 4))
    jitter = np.random.default_rng(1).uniform(-1e-3, 1e-3, N)
    columns = {"t (s)": np.arange(N) / RATE + jitter, "a": u[:, 0], "b": u[:, 1], "y (K)": y}
    pd.DataFrame(columns).to_csv("mine.csv", index=False)
    assert main(["mine.csv"]) == 2
    assert "INPUT=A:UNITS,B:UNITS" in capsys.readouterr().err
    assert main(["mine.csv", "--input", "a:V,b:%", "--output", "y"]) == 0
    said = capsys.readouterr().err
    assert "the inputs hold their power" in said
    file = Path("config/cases/mine.yaml")
    content = yaml.safe_load(file.read_text())
    case = check_case(
        content, check_study(read_yaml("config/config.yaml", what="", example="")), file
    )
    assert [column.column for column in case.record.driving] == ["a", "b"]
    assert [lags[0] for lags in case.identification.u_lags] == [1, 4]
    record = store.signals(store.import_record(content["record"]))
    assert record.u.shape == (N, 2)
    assert record.inputs == [("a", "V"), ("b", "%")]
    np.testing.assert_allclose(record.u, u, atol=0.05)
    assert main(["mine.csv"]) == 0
    assert "input: columns 'a', 'b', kept from the case" in capsys.readouterr().err
    assert yaml.safe_load(file.read_text()) == content


def test_a_simulation_to_diagnose_goes_into_the_case(tmp_path, monkeypatch):
    (tmp_path / "config" / "cases").mkdir(parents=True)
    for part in ("devices", "config.yaml", "bench.yaml"):
        os.symlink(ROOT / "config" / part, tmp_path / "config" / part)
    monkeypatch.chdir(tmp_path)
    u, y = made()
    columns = {"t (s)": np.arange(N) / RATE, "a": u[:, 0], "b": u[:, 1], "y (degC)": y}
    pd.DataFrame(columns).to_csv("mine.csv", index=False)
    answers = ["--input", "a:%,b:%", "--output", "y", "--simulation", "two_heaters"]
    assert main(["mine.csv", *answers]) == 0
    case = yaml.safe_load(Path("config/cases/mine.yaml").read_text())
    assert case["simulation"] == "two_heaters"
    assert [column["column"] for column in case["record"]["inputs"]] == ["a", "b"]
