"""From a file to a case file that the study accepts."""

import os
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.io import savemat
from scipy.signal import lfilter

import dea
from dea import store
from dea.configuration.case import check_case
from dea.configuration.files import read_yaml
from dea.configuration.study import check_study
from dea.errors import InputError
from dea.intake import Answers, UnansweredError, infer_case
from dea.stages.intake import main
from user_simulation import write_simulation

ROOT = Path(__file__).parents[2]
N, RATE = 600, 20.0


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "config" / "cases").mkdir(parents=True)
    for part in ("devices", "config.yaml", "bench.yaml"):
        os.symlink(ROOT / "config" / part, tmp_path / "config" / part)
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(0)
    t = np.arange(N) / RATE + rng.uniform(-0.002, 0.002, N)
    u = np.convolve(rng.standard_normal(N), np.ones(8) / 8, "same")
    y = np.convolve(u, 0.7 ** np.arange(1, 30))[:N]
    table = pd.DataFrame({"t (s)": t, "u (V)": u, "y (mm)": y}).drop(index=range(300, 310))
    table.to_csv(tmp_path / "mine.csv", index=False)
    return tmp_path


@pytest.mark.parametrize("mark", [-999.0, 9999.0])
def test_a_number_that_marks_missing_outputs_is_refused(folder, mark, capsys):
    table = pd.read_csv("mine.csv")
    table.loc[[100, 101], "y (mm)"] = mark
    table.to_csv("mine.csv", index=False)
    assert main(["mine.csv"]) == 2
    said = capsys.readouterr().err
    assert f"line 102: 2 entries are {mark:g}, far from all others" in said
    assert "mine.csv: column 'y'" in said
    assert "Empty these entries: they then count as missing" in said
    table.loc[[100, 101], "y (mm)"] = np.nan
    table.to_csv("mine.csv", index=False)
    assert main(["mine.csv"]) == 0


@pytest.mark.parametrize("low", [-1.2, 0.0])
def test_an_output_that_rests_or_is_held_by_a_limit_holds_no_mark(folder, low):
    table = pd.read_csv("mine.csv")
    table["y (mm)"] = table["y (mm)"].clip(low, None)
    table.to_csv("mine.csv", index=False)
    assert main(["mine.csv"]) == 0


def test_the_case_is_one_that_the_study_accepts_and_its_records_can_be_imported(folder, capsys):
    assert main(["mine.csv"]) == 0
    assert capsys.readouterr().out == "mine\n"
    file = folder / "config" / "cases" / "mine.yaml"
    assert "# a missing stretch of 0.5" in file.read_text()
    assert "# Times are in s, lags in samples, frequencies in shares of" in file.read_text()
    content = yaml.safe_load(file.read_text())
    study = check_study(read_yaml("config/config.yaml", what="", example=""))
    case = check_case(content, study, file)
    record = store.signals(store.import_record(content["record"]))
    assert record.u.size == N
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(record.y)), range(300, 310))
    held_out = store.signals(store.import_record(content["test_records"]["held_out"]))
    assert case.identification.start == 0.0, "whatever segment suits the study's own records"
    seen = round(case.identification.length * RATE)
    assert held_out.u.size + seen <= N
    np.testing.assert_allclose(held_out.u[:-1], record.u[-held_out.u.size : -1], atol=0.05)


@pytest.mark.parametrize("kind", ["whole", "begins late", "averaged", "jitter"])
def test_no_row_is_in_training_and_in_test(folder, kind):
    """Each row that changes what is trained on lies before those that are tested on."""
    rng = np.random.default_rng(5)
    rows, rate = (6000, 1000.0) if kind == "averaged" else (900, 10.0)
    t = np.arange(rows) / rate
    pole = 0.99 if kind == "averaged" else 0.6
    u = lfilter([1 - pole], [1, -pole], np.repeat(rng.standard_normal(rows // 3), 3))
    table = pd.DataFrame({"t (s)": t, "y (mm)": lfilter([0, 1 - pole], [1, -pole], u), "u (V)": u})
    if kind == "begins late":
        table.loc[:249, "y (mm)"] = np.nan
    if kind == "jitter":
        table["t (s)"] += rng.uniform(-0.04, 0.04, rows)
    table.to_csv("rows.csv", index=False)
    content = infer_case(Path("rows.csv"), Answers()).content
    seen = content["identification"]["length"]
    first, end = content["test_records"]["held_out"]["rows"]
    assert end == rows
    assert ("resample" in content["record"]) == (kind != "whole")

    def trained_on():
        record = store.signals(store.import_record(content["record"]))
        return record.y[: round(seen * record.sampling_rate)]

    before = trained_on()
    table.loc[first:, "y (mm)"] += 1.0
    table.to_csv("rows.csv", index=False)
    np.testing.assert_array_equal(trained_on(), before)
    # And none is left out between the two for nothing.
    table.loc[first - 3 :, "y (mm)"] += 1.0
    table.to_csv("rows.csv", index=False)
    assert not np.array_equal(trained_on(), before, equal_nan=True)


def test_a_record_for_a_simulation_keeps_the_input_that_a_threshold_acted_on(folder):
    """A slow device behind a dead zone, whose mean input is not what the dead zone passed on."""
    rng = np.random.default_rng(6)
    rows, rate, pole = 6000, 1000.0, 0.99
    u = 5 * lfilter([1 - pole], [1, -pole], np.repeat(rng.standard_normal(rows // 3), 3))
    passed = np.sign(u) * np.maximum(np.abs(u) - 0.5, 0.0)
    y = lfilter([0, 1 - pole], [1, -pole], passed)
    times = np.arange(rows) / rate
    pd.DataFrame({"t (s)": times, "y (mm)": y, "u (V)": u}).to_csv("rows.csv", index=False)
    assert "resample" in infer_case(Path("rows.csv"), Answers()).content["record"]
    found = infer_case(Path("rows.csv"), Answers(), simulation="mine.py")
    record = store.signals(store.import_record(found.content["record"]))
    np.testing.assert_allclose(record.u, u)
    assert any("every sample is kept for the simulation" in line for line in found.inferred)


def test_each_sheet_of_a_workbook_is_a_case_of_its_own(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.columns = ["t (s)", "volts", "place"]
    with pd.ExcelWriter("lab.xlsx") as file:
        (2.0 * table).to_excel(file, sheet_name="Run 1", index=False)
        table.to_excel(file, sheet_name="Run 2", index=False)
    assert main(["lab.xlsx"]) == 2
    told = capsys.readouterr().err
    assert "lab.xlsx: several of its sheets" in told
    assert '`make case FILE=lab.xlsx "SHEET=Run 1"`' in told
    answers = ["--input", "volts:V", "--output", "place:mm"]
    assert main(["lab.xlsx", "--sheet", "Run 2", *answers]) == 0
    assert capsys.readouterr().out == "lab_Run_2\n"
    case = folder / "config" / "cases" / "lab_Run_2.yaml"
    content = yaml.safe_load(case.read_text())
    assert content["record"]["sheet"] == "Run 2"
    assert content["title"] == "lab: Run 2"
    y = store.signals(store.import_record(content["record"])).y
    assert np.nanmax(y) == pytest.approx(table["place"].max(), rel=0.1)
    assert main(["lab.xlsx", "--sheet", "Run 2"]) == 0, "its columns are not asked again"
    assert main(["lab.xlsx", "--sheet", "Run 1", *answers, "--name", "lab_Run_2"]) == 2
    assert "it is there already, for lab.xlsx, sheet 'Run 2'" in capsys.readouterr().err
    columns = content["record"] | {"file": None}
    del columns["file"]
    assert dea.Record.read("lab.xlsx", **columns).y.size == y.size
    assert main(["mine.csv", "--sheet", "Run 2"]) == 2
    assert "mine.csv: it has no sheets, and 'Run 2' is named" in capsys.readouterr().err


def test_a_coarse_clock_is_told_with_the_rate(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.insert(0, "clock", [f"12:00:{k // 20:02d}" for k in range(len(table))])
    table.drop(columns="t (s)").to_csv("coarse.csv", index=False)
    assert main(["coarse.csv"]) == 2
    said = capsys.readouterr().err
    assert "time: 20 samples are at 0 s" in said
    assert "Give the samples per second instead: RATE=20" in said


@pytest.mark.parametrize("rows", [78, 110, 240])
def test_the_rate_of_a_coarse_clock_is_not_that_of_its_first_second(folder, capsys, rows):
    """Fifty samples a second of seconds since 1970, of which the first was under way."""
    table = pd.read_csv("mine.csv").iloc[:rows]
    table["t (s)"] = 1_700_000_000 + (np.arange(rows) + 22) // 50
    table.to_csv("coarse.csv", index=False)
    assert main(["coarse.csv"]) == 2
    assert "28 samples are at 1700000000 s" in (said := capsys.readouterr().err)
    assert said.endswith("RATE=50\n")


@pytest.mark.parametrize("rate", [75, 128])
def test_rounded_times_are_told_with_the_rate_that_makes_the_record_whole(folder, capsys, rate):
    table = pd.read_csv("mine.csv")
    table["t (s)"] = np.floor(100 * np.arange(len(table)) / rate + 1e-9) / 100
    table.loc[[20, 50], "y (mm)"] = np.nan
    table.to_csv("rounded.csv", index=False)
    assert main(["rounded.csv"]) == 2
    said = capsys.readouterr().err
    assert f"time: times of {rate} samples a second are rounded to 0.01 s. Give" in said
    assert said.endswith(f"RATE={rate}\n")
    assert main(["rounded.csv", "--rate", str(rate)]) == 0
    record = store.signals(store.import_record(described(folder, "rounded")))
    assert np.flatnonzero(np.isnan(record.y)).tolist() == [20, 50]


def test_a_sensor_that_is_read_slowly_is_told_and_its_samples_are_averaged(folder, capsys):
    table = pd.read_csv("mine.csv")
    table["y (mm)"] = table["y (mm)"].to_numpy()[np.arange(len(table)) // 5 * 5]
    table.to_csv("slow.csv", index=False)
    assert main(["slow.csv"]) == 0
    said = capsys.readouterr().err
    assert "the output holds each value for 5 samples: its sensor is read at" in said
    assert "5 samples are averaged into one" in said
    assert described(folder, "slow")["resample"] == 5 * 0.05


def test_text_among_the_numbers_is_named(folder, capsys):
    lines = (folder / "mine.csv").read_text().splitlines()
    lines[499] = lines[499].rpartition(",")[0] + ",Fehler"
    (folder / "mine.csv").write_text("\n".join(lines))
    assert main(["mine.csv"]) == 2
    assert "mine.csv: column 'y': line 500: 'Fehler' is not a number" in capsys.readouterr().err


def test_what_was_answered_before_is_not_asked_again(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.columns = ["t", "volts", "place"]
    table.to_csv("plain.csv", index=False)
    assert main(["plain.csv"]) == 2
    answers = ["--input", "volts:V", "--output", "place:mm"]
    assert main(["plain.csv", *answers]) == 0
    file = folder / "config" / "cases" / "plain.yaml"
    before = yaml.safe_load(file.read_text())
    write_simulation(folder / "mine.py")
    assert main(["plain.csv", "--simulation", "mine.py", "--goal", "diagnose"]) == 0
    after = yaml.safe_load(file.read_text())
    assert after["record"] == before["record"]
    assert after["simulation"] == "mine.py"
    # Another file of that name is asked about, and so is the first one without its case.
    capsys.readouterr()
    other = folder / "other"
    other.mkdir()
    table.to_csv(other / "plain.csv", index=False)
    assert main(["other/plain.csv"]) == 2
    assert main(["plain.csv", "--input", "volts:V", "--name", "another"]) == 2
    assert capsys.readouterr().err.count("Answer with") == 2
    assert main(["plain.csv", "--input", "volts:V"]) == 0, "its case says which is the output"


def described(folder, name):
    return yaml.safe_load((folder / "config" / "cases" / f"{name}.yaml").read_text())["record"]


def test_an_answer_outlasts_what_the_names_would_tell(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.columns = ["t", "u (V)", "y (mm)"]
    table.insert(3, "y2", -table["y (mm)"])
    table.to_csv("two_out.csv", index=False)
    assert main(["two_out.csv", "--output", "y2:mm", "--time", "t:ms"]) == 0
    before = described(folder, "two_out")
    write_simulation(folder / "mine.py")
    capsys.readouterr()
    assert main(["two_out.csv", "--simulation", "mine.py", "--goal", "diagnose"]) == 0
    told = capsys.readouterr().err
    assert "time: column 't', in ms, kept from the case\n" in told
    assert "output: column 'y2', kept from the case\n" in told
    after = described(folder, "two_out")
    assert [after[role] for role in ("time", "output")] == [
        {"column": "t", "units": "ms"},
        {"column": "y2", "units": "mm"},
    ]
    assert after["input"] == before["input"]
    assert main(["two_out.csv", "--output", "y"]) == 0
    assert described(folder, "two_out")["output"]["column"] == "y"
    assert described(folder, "two_out")["time"]["units"] == "ms"


def test_what_a_case_says_of_a_column_holds_while_the_file_has_it(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.columns = ["t (s)", "left", "right"]
    table.to_csv("plain.csv", index=False)
    assert main(["plain.csv", "--input", "left:V", "--output", "right:mm"]) == 0
    # The other way round, of which one half is enough.
    assert main(["plain.csv", "--input", "right:V"]) == 2
    assert "OUTPUT=COLUMN" not in capsys.readouterr().err
    assert main(["plain.csv", "--input", "right:V", "--output", "left:mm"]) == 0
    table.columns = ["t (s)", "left (um)", "right"]
    table.to_csv("plain.csv", index=False)
    assert main(["plain.csv"]) == 0
    assert described(folder, "plain")["output"] == {"column": "left", "units": "um"}
    table.columns = ["t (s)", "place", "right"]
    table.to_csv("plain.csv", index=False)
    assert main(["plain.csv"]) == 2
    assert "INPUT=right:V OUTPUT=place:UNITS" in capsys.readouterr().err


def test_a_rate_outlasts_the_column_of_times(folder, capsys):
    assert main(["mine.csv", "--rate", "100"]) == 0
    assert main(["mine.csv"]) == 0
    told = "time: 100 samples per second, kept from the case; column 't' is not used"
    assert told in capsys.readouterr().err
    assert described(folder, "mine")["sampling_interval"] == 0.01
    assert main(["mine.csv", "--time", "t"]) == 0
    assert described(folder, "mine")["time"] == {"column": "t", "units": "s"}
    assert "sampling_interval" not in described(folder, "mine")


def test_the_simulation_of_a_case_outlasts_the_next_identification(folder, capsys):
    path = write_simulation(folder / "mine.py")
    assert main(["mine.csv", "--simulation", path.name, "--goal", "diagnose"]) == 0
    file = folder / "config" / "cases" / "mine.yaml"
    before = yaml.safe_load(file.read_text())
    assert main(["mine.csv"]) == 0
    assert "the simulation of this case, mine.py, is kept" in capsys.readouterr().err
    assert yaml.safe_load(file.read_text()) == before
    path.unlink()
    assert main(["mine.csv"]) == 2
    assert "or delete config/cases/mine.yaml" in capsys.readouterr().err


def test_an_edited_case_whose_samples_are_averaged_is_not_diagnosed_so(folder, capsys):
    """Thresholds act on samples, not on their means."""
    rate, rows = 1000.0, 6000
    lag = [0.01], [1.0, -0.99]
    u = lfilter(*lag, np.random.default_rng(6).standard_normal(rows))
    times = np.arange(rows) / rate
    slow = pd.DataFrame({"t (s)": times, "u (V)": u, "y (mm)": lfilter(*lag, u)})
    slow.to_csv("slow.csv", index=False)
    main(["slow.csv"])
    file = folder / "config" / "cases" / "slow.yaml"
    file.write_text(file.read_text().replace("degree: 3", "degree: 2"))
    write_simulation(folder / "mine.py")
    assert main(["slow.csv", "--simulation", "mine.py", "--goal", "diagnose"]) == 2
    assert "and delete `resample`: then `make diagnose NAME=slow`" in capsys.readouterr().err


def test_an_edited_case_is_never_written_over(folder, capsys):
    main(["mine.csv"])
    assert main(["mine.csv", "--rate", "20"]) == 0, "what intake wrote itself it may write again"
    file = folder / "config" / "cases" / "mine.yaml"
    edited = file.read_text().replace("degree: 3", "degree: 2")
    file.write_text(edited)
    assert main(["mine.csv"]) == 2
    assert "edited by a person" in capsys.readouterr().err
    assert file.read_text() == edited
    write_simulation(folder / "mine.py")
    assert main(["mine.csv", "--simulation", "mine.py", "--goal", "diagnose"]) == 2
    advised = "Write `simulation: mine.py` into it: then `make diagnose NAME=mine`"
    assert advised in capsys.readouterr().err
    assert file.read_text() == edited


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["absent.csv"], "absent.csv: it does not exist"),
        (["config"], "config: it is no file"),
        (
            ["mine.csv", "--simulation", "lines.py"],
            "lines.py: it cannot be run (ValueError: a b). See docs/discrepancy.md",
        ),
        (
            ["mine.csv", "--simulation", "exit.py"],
            "exit.py: it cannot be run (SystemExit: 3). See docs/discrepancy.md",
        ),
        (["mine.csv", "--name", "dea1"], "'dea1' is an actuator's name"),
        (["mine.csv", "--name", "tables"], "NAME: 'tables' is the name of a folder of results/"),
        (["mine.csv", "--name", "provenance"], "NAME: 'provenance' is the name of a folder"),
        (
            ["run{x}.csv"],
            "config/cases/run_x.yaml: record.file: 'run{x}.csv' has braces, which the workflow"
            " takes for wildcards. Rename the file",
        ),
        (["mine.csv", "--rate", "0"], "RATE: it is '0'. Give samples per second"),
        (["mine.csv", "--rate", "50Hz"], "RATE: it is '50Hz'. Give samples per second"),
        (["mine.csv", "--rate", "nan"], "RATE: it is 'nan'"),
        (["--name", "mime"], "none called 'mime'"),
        (["mine.csv", "--simulation", "mime.py"], "SIMULATION: there is no file 'mime.py'. Name"),
        (["mine.csv", "--simulation", "typo.py"], "typo.py: derivative: numba cannot compile it"),
        (["mine.csv", "--simulation", "volt.py"], "volt.py: output: the record's output is in 'm"),
        (
            ["--name", "dea7", "--goal", "handover"],
            "none called 'dea7'. Did you mean 'dea6'? Known",
        ),
        (["--result", "results/dea7/model.nc"], "results/dea7/model.nc: there is none called"),
        (["--result", "results/discrepancy/mime/verdict.json"], "there is none called 'mime'"),
    ],
)
def test_a_mistake_writes_nothing(folder, capsys, arguments, message):
    write_simulation(folder / "typo.py", slope="p[0] * (dampng * u - x[0])")
    shutil.copy("mine.csv", "run{x}.csv")
    (folder / "lines.py").write_text("raise ValueError('a\\nb')")
    (folder / "exit.py").write_text("import sys\nsys.exit(3)")
    volt = write_simulation(folder / "volt.py")
    volt.write_text(volt.read_text().replace('output_unit="mm"', 'output_unit="V"'))
    assert main(arguments) == 2
    assert message in capsys.readouterr().err
    assert not list((folder / "config" / "cases").iterdir())


def test_a_name_is_checked_with_the_nearest_one(folder, capsys):
    (folder / "config/cases/.#mine.yaml").symlink_to("nobody@nowhere")
    main(["mine.csv"])
    assert main(["--name", "mime"]) == 2
    said = capsys.readouterr().err
    assert "Did you mean 'mine'?" in said
    assert said.endswith("Known: mine\n")
    assert main(["--name", "dea1", "--goal", "diagnose"]) == 0


@pytest.mark.parametrize("file", ["results/dea1/model.nc", "results/tables/table1.csv"])
def test_a_result_of_what_is_known_is_let_through(folder, capsys, file):
    assert main(["--result", file]) == 0
    assert capsys.readouterr().out == ""


def test_the_simulation_of_a_named_case_is_checked(folder, capsys):
    main(["mine.csv"])
    named = ["--name", "mine", "--goal", "diagnose"]
    assert main(named) == 2
    assert "config/cases/mine.yaml: simulation: it names no simulation. Name" in (
        capsys.readouterr().err
    )
    path = write_simulation(folder / "mine.py")
    assert main(["mine.csv", "--simulation", path.name]) == 0
    assert main(named) == 0
    path.unlink()
    assert main(named) == 2
    said = capsys.readouterr().err
    assert "config/cases/mine.yaml: simulation: there is no file 'mine.py'" in said
    assert "or delete config/cases/mine.yaml" in said


def test_what_a_simulation_prints_is_no_name_of_a_case(folder, capsys):
    path = write_simulation(folder / "mine.py")
    path.write_text(f"print('loaded')\n{path.read_text()}")
    assert main(["mine.csv", "--simulation", "mine.py"]) == 0
    assert capsys.readouterr().out == "mine\n"


def test_numbers_that_are_too_large_are_told_with_their_column(folder, capsys, recwarn):
    table = pd.read_csv("mine.csv")
    table["y (mm)"] *= 1e300
    table.to_csv("large.csv", index=False)
    assert main(["large.csv"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: large.csv: y: sample 0 is ")
    assert said.count("\n") == 1
    assert not recwarn.list
    assert not list((folder / "config" / "cases").iterdir())


@pytest.mark.parametrize(
    ("entry", "holds"), [("", "nothing"), ("1'0.123", 'text (line 2: "1\'0.123")')]
)
def test_no_column_stands_in_for_one_without_numbers(entry, holds, folder):
    rows = [f"{k / 50},{k % 7},{entry},{k % 5}" for k in range(300)]
    file = folder / "dead.csv"
    file.write_text("\n".join(["t (s),u (V),y (mm),temperature (degC)", *rows]))
    with pytest.raises(UnansweredError, match="which column is the output") as caught:
        infer_case(file, Answers())
    assert caught.value.command == "make case INPUT=u:V OUTPUT=COLUMN"
    assert caught.value.columns.splitlines()[-1].split(maxsplit=2) == ["y", "-", holds]
    with pytest.raises(
        InputError, match=r"OUTPUT: column 'y' holds (nothing|text .*)\. Its columns"
    ):
        infer_case(file, Answers(output="y"))
    found = infer_case(file, Answers(output="temperature")).content
    assert found["record"]["output"] == {"column": "temperature", "units": "degC"}


@pytest.mark.parametrize("other", ["measured", "temperature"])
def test_a_name_that_a_column_without_numbers_carries_too_is_asked_about(other, folder):
    rows = [f"{k / 50},{k % 7},,{k % 5}" for k in range(300)]
    file = folder / "dead.csv"
    for dead, asked in (("y", True), ("note", other != "measured")):
        file.write_text("\n".join([f"t (s),u (V),{dead},{other} (mm)", *rows]))
        if asked:
            with pytest.raises(UnansweredError, match="which column is the output"):
                infer_case(file, Answers())
        else:
            assert infer_case(file, Answers()).content["record"]["output"]["column"] == other


@pytest.mark.parametrize("rows", [(300,), (20, 300, 301)])
def test_an_output_far_from_all_others_is_told_with_its_line(rows, folder, capsys):
    table = pd.read_csv("mine.csv")
    table.loc[list(rows), "y (mm)"] = -1e26
    table.to_csv("over.csv", index=False)
    assert main(["over.csv"]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: over.csv: column 'y': line {rows[0] + 2}: -1e+26 is 1e+08 ")
    assert said.count("\n") == 1


def test_outputs_that_decay_by_any_factor_are_not_far_from_others(folder):
    table = pd.read_csv("mine.csv")
    table["y (mm)"] = np.exp(-np.arange(len(table)) / 8.0)
    table.to_csv("decay.csv", index=False)
    infer_case(Path("decay.csv"), Answers())


def test_a_short_record_is_refused_with_what_it_needs(folder):
    (folder / "short.csv").write_text("t (s),u (V),y (mm)\n" + "".join(
        f"{i},{np.sin(i)},{np.cos(i)}\n" for i in range(30)
    ))  # fmt: skip
    with pytest.raises(InputError, match="Record at least 60"):
        infer_case(folder / "short.csv", Answers())


def test_records_that_were_joined_are_not_taken_for_one(folder, capsys):
    table = pd.read_csv("mine.csv")
    pd.concat([table, table]).to_csv("joined.csv", index=False)
    assert main(["joined.csv"]) == 2
    said = capsys.readouterr().err
    assert "'t'" in said
    assert "falls back: sample 590 is at" in said
    assert main(["joined.csv", "--rate", "20"]) == 0
    assert "# time: column 't' falls back" in (folder / "config/cases/joined.yaml").read_text()


def test_a_record_of_two_rates_is_not_taken_for_one_of_jitter(folder, capsys):
    t = np.concatenate([np.arange(300) / 50, 6.0 + np.arange(600) / 5])
    u = np.random.default_rng(0).standard_normal(t.size)
    pd.DataFrame({"t (s)": t, "u (V)": u, "y (mm)": np.cumsum(u)}).to_csv("two.csv", index=False)
    assert main(["two.csv"]) == 2
    assert "its samples are 0.02 to 0.2 s apart" in capsys.readouterr().err


def test_one_time_that_stands_twice_is_named(folder, capsys):
    table = pd.read_csv("mine.csv")
    table.loc[400, "t (s)"] = table.loc[399, "t (s)"]
    table.to_csv("twice.csv", index=False)
    assert main(["twice.csv"]) == 2
    said = capsys.readouterr().err
    assert "sample 400 is at" in said
    assert "coarser" not in said
    assert "Delete one of them, or give the samples per second, RATE=…, in place" in said


def test_signals_of_different_length_are_named(folder, capsys):
    rng = np.random.default_rng(0)
    savemat("two.mat", {"u": rng.standard_normal(1800), "y": rng.standard_normal(900)})
    assert main(["two.mat", "--input", "u:V", "--output", "y:mm", "--rate", "20"]) == 2
    assert "its columns differ in length: 'y' has 900, 'u' has 1800" in capsys.readouterr().err


def test_an_infinite_reading_is_a_missing_one(folder):
    table = pd.read_csv("mine.csv")
    y = table["y (mm)"].to_numpy(copy=True)
    y[400] = np.inf
    columns = {"t": table["t (s)"].to_numpy(), "u": table["u (V)"].to_numpy(), "y": y}
    savemat("inf.mat", columns)
    assert main(["inf.mat", "--input", "u:V", "--output", "y:mm", "--time", "t:s"]) == 0
    described = yaml.safe_load((folder / "config/cases/inf.yaml").read_text())["record"]
    record = store.import_record(described)
    missing = np.flatnonzero(np.isnan(record["output"].values)).tolist()
    assert missing == [*range(300, 310), 410]  # the rows that the table lacks, and that one


def test_another_file_of_the_same_name_replaces_no_case(folder, capsys):
    (folder / "other").mkdir()
    pd.read_csv("mine.csv").to_csv("other/mine.csv", index=False)
    assert main(["mine.csv"]) == 0
    before = (folder / "config/cases/mine.yaml").read_bytes()
    assert main(["other/mine.csv"]) == 2
    assert "it is there already, for mine.csv" in capsys.readouterr().err
    assert (folder / "config/cases/mine.yaml").read_bytes() == before
    assert main(["mine.csv"]) == 0


def test_dates_are_the_time_wherever_and_whatever_their_column_is(folder, capsys):
    table = pd.read_csv("mine.csv").drop(columns="t (s)")
    stamps = pd.Timestamp("2024-05-27 10:00") + pd.to_timedelta(np.arange(len(table)) / RATE, "s")
    table.insert(0, "n", np.arange(len(table)))
    table.insert(1, "Datum", stamps.strftime("%Y-%m-%d %H:%M:%S.%f"))
    table.to_csv("dated.csv", index=False)
    assert main(["dated.csv"]) == 0
    assert "# time: column 'Datum', in s" in (folder / "config/cases/dated.yaml").read_text()
