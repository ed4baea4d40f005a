from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import savemat

from dea import store
from dea.errors import InputError

CASE = Path("config/cases/mine.yaml")
TIME = np.arange(20) * 0.5
U = np.sin(TIME)
Y = np.cos(TIME)


def case(file, **changes):
    settings = {
        "file": file,
        "sampling_interval": 0.5,
        "input": {"column": "u", "units": "V", "name": "pump voltage"},
        "output": {"column": "y", "units": "mm"},
    }
    return {**settings, **changes}


def write_csv(folder):
    rows = "\n".join(f"{a!r},{b!r}," for a, b in zip(U.tolist(), Y.tolist(), strict=True))
    (folder / "mine.csv").write_text(f'"u","y",\n{rows}\n')


def write_netcdf(folder):
    xr.Dataset({"u": ("t", U, {"units": "V"}), "y": ("t", Y, {"units": "mm"})}).to_netcdf(
        folder / "mine.nc"
    )


def write_matlab(folder):
    savemat(folder / "mine.mat", {"u": U[:, None], "y": Y[:, None]})


@pytest.mark.parametrize(
    ("write", "file"),
    [(write_csv, "mine.csv"), (write_netcdf, "mine.nc"), (write_matlab, "mine.mat")],
)
def test_the_same_record_comes_from_any_format(write, file, tmp_path):
    write(tmp_path)
    record = store.import_record(case(file), CASE, tmp_path)
    np.testing.assert_array_equal(record["input"], U)
    np.testing.assert_array_equal(record["output"], Y)
    np.testing.assert_array_equal(record["time"], TIME)
    assert record["input"].attrs == {"units": "V", "long_name": "pump voltage"}


def test_rows_cut_the_record(tmp_path):
    write_csv(tmp_path)
    record = store.import_record(case("mine.csv", rows=[5, 15]), CASE, tmp_path)
    np.testing.assert_array_equal(record["output"], Y[5:15])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"file": "absent.csv"}, r"record\.file: the record .* does not exist"),
        ({"file": ""}, r"record\.file: the record .* is no file"),
        ({"rows": [5, 5]}, r"record\.rows: rows 5 to 5 of .*mine\.csv, which has 20\. Give the"),
        ({"rows": [5, 21]}, r"record\.rows: rows 5 to 21 of .* at least two, from 0 to 20"),
        ({"rows": [-21, 15]}, r"record\.rows: rows -21 to 15 of"),
        ({"rows": [19, -1]}, r"record\.rows: rows 19 to -1 of"),
        ({"resample": 100}, r"record\.resample: .*mine\.csv: on times 100 s .* holds 0 samples"),
        ({"file": "mine.doc"}, r"record\.file: .*cannot read \.doc"),
        ({"input": {"column": "v", "units": "V"}}, r"record\.input\.column: .* no column 'v'"),
        (
            {"output": {"column": "y", "units": "m"}, "file": "mine.nc"},
            "has 'y' in 'mm', not in 'm'",
        ),
        ({"time": {"column": "u", "units": "V"}}, r"record\.time\.units: its units are 'V'"),
        (
            {"file": "text.csv"},
            r"text\.csv has text \(line 3: 'x'\) in column 'u'\. .* its columns of numbers are y",
        ),
        ({"file": "empty.csv"}, r"empty\.csv: no line of it holds two numbers"),
        ({"file": "text.nc"}, r"text\.nc: cannot be read as \.nc"),
        ({"file": "text.mat"}, r"text\.mat: cannot be read as \.mat"),
    ],
)
def test_a_wrong_case_names_file_field_and_remedy(changes, message, tmp_path):
    write_csv(tmp_path)
    write_netcdf(tmp_path)
    for name in ("mine.doc", "empty.csv"):
        (tmp_path / name).write_text("")
    for name in ("text.csv", "text.nc", "text.mat"):
        (tmp_path / name).write_text("u,y\n1,2\nx,3\n")
    with pytest.raises(InputError, match=message) as caught:
        store.import_record(case(**{"file": "mine.csv"} | changes), CASE, tmp_path)
    assert str(caught.value).startswith(f"{CASE}: ")
    assert "\n" not in str(caught.value)


def test_rows_may_count_from_the_end_and_end_with_the_table(tmp_path):
    write_csv(tmp_path)
    for rows, part in (([-20, 20], slice(0, 20)), ([5, -1], slice(5, 19))):
        record = store.import_record(case("mine.csv", rows=rows), CASE, tmp_path)
        np.testing.assert_array_equal(record["output"], Y[part])


def test_a_message_names_a_file_without_a_case_once(tmp_path):
    write_netcdf(tmp_path)
    wrong = NAMED | {"output": {"column": "y", "units": "kg"}}
    with pytest.raises(InputError, match="it has 'y' in 'mm', not in 'kg'") as caught:
        store.read_record(tmp_path / "mine.nc", **wrong)
    assert str(caught.value).count("mine.nc") == 1


NAMED = {
    "sampling_interval": 0.5,
    "input": {"column": "u", "units": "V", "name": "pump voltage"},
    "output": {"column": "y", "units": "mm"},
}


@pytest.mark.parametrize(
    ("write", "file"),
    [(write_csv, "mine.csv"), (write_netcdf, "mine.nc"), (write_matlab, "mine.mat")],
)
def test_a_file_whose_columns_are_named_is_read_as_a_case_reads_it(write, file, tmp_path):
    write(tmp_path)
    record = store.read_record(tmp_path / file, **NAMED)
    xr.testing.assert_equal(record, store.import_record(case(file), CASE, tmp_path))


def test_a_missing_value_is_flagged_where_it_is_asked_for(tmp_path):
    write_csv(tmp_path)
    lines = (tmp_path / "mine.csv").read_text().splitlines()
    lines[4] = lines[4].split(",")[0] + ",,"
    (tmp_path / "mine.csv").write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"1 of 20 .* the first sample 3\. Give `resample` 0\.5 "):
        store.Record.read(tmp_path / "mine.csv", **NAMED)
    record = store.Record.read(tmp_path / "mine.csv", **NAMED, resample=0.5)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(record.y)), [3])
    np.testing.assert_array_equal(record.u, U)


@pytest.mark.parametrize("rows", [None, [3, 18]])
def test_an_input_is_read_as_it_stands_beside_a_missing_output(rows, tmp_path):
    lines = [f"{0.5 * k},{(7 * k) % 5},{k if k not in (6, 7, 12) else ''}" for k in range(20)]
    (tmp_path / "mine.csv").write_text("\n".join(["t,u,y", *lines]))
    described = case("mine.csv", sampling_interval=None, time={"column": "t", "units": "s"})
    record = store.import_record(described | {"resample": 0.5, "rows": rows}, root=tmp_path)
    part = np.arange(20)[slice(*(rows or [None]))]
    np.testing.assert_array_equal(record["input"], (7 * part) % 5)
    np.testing.assert_array_equal(record["quality"], np.isin(part, [6, 7, 12]))


def test_a_record_whose_first_time_is_missing_begins_with_the_next_one(tmp_path):
    rows = ["t,u,y", ",0,0", *(f"{0.5 * k},{k},{-k}" for k in range(10, 20))]
    (tmp_path / "mine.csv").write_text("\n".join(rows))
    described = case("mine.csv", sampling_interval=None, time={"column": "t", "units": "s"})
    with pytest.raises(InputError, match=r"1 of 11 samples .* Give `resample` 0\.5"):
        store.import_record(described, root=tmp_path)
    record = store.import_record(described | {"resample": 0.5}, root=tmp_path)
    np.testing.assert_array_equal(record["time"], 0.5 * np.arange(10))
    np.testing.assert_array_equal(record["output"], -np.arange(10.0, 20.0))


def timed(folder, time):
    rows = [f"{t!r},{k % 3},{k % 5}" for k, t in enumerate(np.asarray(time).tolist())]
    (folder / "mine.csv").write_text("\n".join(["t,u,y", *rows]))
    columns = {name: value for name, value in NAMED.items() if name != "sampling_interval"}
    return columns | {"time": {"column": "t", "units": "s"}}


@pytest.mark.parametrize("resampled", [{}, {"resample": 0.5}])
def test_what_is_told_to_do_about_times_that_fall_back_can_be_done(resampled, tmp_path):
    columns = timed(tmp_path, [*(0.5 * np.arange(12)), *(0.5 * np.arange(8))]) | resampled
    told = r"time: sample 12 is at 0 s, the one before it at 5\.5 s\. Sort the record, or give its"
    told += " `sampling_interval` in place of the time column"
    with pytest.raises(InputError, match=told) as caught:
        store.Record.read(tmp_path / "mine.csv", **columns)
    assert caught.value.file == tmp_path / "mine.csv"
    del columns["time"]
    record = store.Record.read(tmp_path / "mine.csv", **columns, sampling_interval=0.5)
    assert record.y.size == 20


@pytest.mark.parametrize("resampled", [{}, {"resample": 0.01}])
@pytest.mark.parametrize(
    ("rate", "interval"), [(75, "0.01333333333"), (150, "0.006666666667"), (125, "0.008")]
)
def test_rounded_times_are_told_with_the_interval_that_can_be_given(
    rate, interval, resampled, tmp_path
):
    columns = timed(tmp_path, np.round(1.7e9 + np.arange(600) / rate, 2))
    told = rf"time: times of .* are rounded to 0\.01 s\. Give `sampling_interval` {interval} \(s\)"
    with pytest.raises(InputError, match=told):
        store.Record.read(tmp_path / "mine.csv", **columns | resampled)
    del columns["time"]
    record = store.Record.read(tmp_path / "mine.csv", **columns, sampling_interval=float(interval))
    assert record.sampling_rate == pytest.approx(rate)


def test_rounded_times_may_be_interpolated_to_their_own_rate(tmp_path):
    columns = timed(tmp_path, np.floor(100 * np.arange(600) / 75) / 100)
    record = store.Record.read(tmp_path / "mine.csv", **columns, resample=1 / 75)
    assert record.left_out == 0


@pytest.mark.parametrize("resampled", [{}, {"resample": 0.5}])
def test_a_time_that_stands_twice_is_told_as_one(resampled, tmp_path):
    time = 0.5 * np.arange(20)
    time[7] = time[6]
    told = r"sample 7 is at 3 s, the one before it at 3 s\. Delete one of them, or give"
    with pytest.raises(InputError, match=told):
        store.Record.read(tmp_path / "mine.csv", **timed(tmp_path, time), **resampled)


def with_times(folder, time, heading="t (s)"):
    rows = [f"{t!r},{k % 3},{k % 5}" for k, t in enumerate(np.asarray(time, float).tolist())]
    (folder / "mine.csv").write_text("\n".join([f"{heading},u,y", *rows]))
    return folder / "mine.csv"


STEPS = np.arange(400)
JITTER = np.random.default_rng(0).uniform(-0.2, 0.2, 400)
LATE = STEPS + np.where(STEPS % 60 == 30, 0.9, 0.0)  # some are stamped late, none is missing
GAP = STEPS + np.where(STEPS > 250, 3, 0)


@pytest.mark.parametrize(
    ("time", "heading", "told"),
    [
        (0.02 * STEPS, "t (s)", r"it is 0\.5 s, and column 't' says 0\.02 s\. Correct it, or give"),
        (20.0 * STEPS, "t_ms", r"and column 't_ms' says 0\.02 s\. Correct"),
        (20.0 * STEPS, "t", r"and column 't' has steps of 20\. Correct"),
        (STEPS // 50, "t (s)", r"and column 't' says 0\.02 s"),
        (np.floor(100 * STEPS / 75) / 100, "t (s)", r"and column 't' says 0\.01333 s"),
        (
            0.5 * GAP,
            "t (s)",
            r"column 't' has a gap of 2 s after sample 250\. Give time=\{'column'",
        ),
        (
            500 * GAP,
            "t",
            r"gap of 2 s .* Give time=\{'column': 't', 'units': 'ms'\}.*resample=0\.5",
        ),
        (0.5 * (GAP + JITTER), "t (s)", r"has a gap of .* after sample 250"),
    ],
)
def test_an_interval_that_the_times_contradict_is_refused(time, heading, told, tmp_path):
    file = with_times(tmp_path, time, heading)
    with pytest.raises(InputError, match=rf"sampling_interval: .*{told}") as caught:
        store.Record.read(file, **NAMED)
    assert caught.value.file == file


@pytest.mark.parametrize(
    ("time", "heading"),
    [
        (0.5 * STEPS, "t (s)"),
        (0.497 * STEPS, "t (s)"),
        (500 * STEPS, "t"),
        (STEPS, "t"),  # counts samples
        (STEPS // 2, "t (s)"),
        (0.5 * (STEPS + JITTER), "t (s)"),
        (0.5 * LATE, "t (s)"),
        (0.02 * (STEPS % 300), "t (s)"),  # falls back
        (0.02 * np.maximum(STEPS, 7), "t (s)"),  # stands still
        (0.02 * STEPS, "T film"),
    ],
)
def test_an_interval_that_the_times_allow_is_taken(time, heading, tmp_path):
    record = store.Record.read(with_times(tmp_path, time, heading), **NAMED)
    assert record.sampling_rate == pytest.approx(2.0)


def test_a_gap_outside_the_rows_that_are_read_is_none(tmp_path):
    file = with_times(tmp_path, 0.5 * GAP)
    assert store.Record.read(file, **NAMED, rows=[251, -1]).y.size == 148


def test_what_is_told_to_do_about_a_gap_flags_it(tmp_path):
    columns = {name: value for name, value in NAMED.items() if name != "sampling_interval"}
    columns["time"] = {"column": "t", "units": "s"}
    record = store.Record.read(with_times(tmp_path, 0.5 * GAP), **columns, resample=0.5)
    assert np.flatnonzero(np.isnan(record.y)).tolist() == [251, 252, 253]


def test_an_infinite_value_is_a_missing_one_where_it_is_asked_for(tmp_path):
    y = Y.copy()
    y[3] = np.inf
    savemat(tmp_path / "mine.mat", {"u": U, "y": y})
    with pytest.raises(InputError, match=r"Give `resample` 0\.5 "):
        store.Record.read(tmp_path / "mine.mat", **NAMED)
    record = store.Record.read(tmp_path / "mine.mat", **NAMED, resample=0.5)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(record.y)), [3])


@pytest.mark.parametrize("mark", [".", ","])
def test_text_among_the_numbers_is_named_with_its_line(mark, tmp_path):
    rows = [f"{a:.4f};{b:.4f};ok;{b:.4f}".replace(".", mark) for a, b in zip(U, Y, strict=True)]
    rows[10] = rows[10].split(";")[0] + ";Fehler;ok;0"
    (tmp_path / "mine.csv").write_text("\n".join(["# made today", "", "u;y;state;z", *rows]))
    message = r"mine\.csv: column 'y': line 14: 'Fehler' is not a number\. Correct that entry"
    with pytest.raises(InputError, match=message):
        store.Record.read(tmp_path / "mine.csv", **NAMED)
    other = NAMED | {"output": {"column": "z", "units": "mm"}}
    assert store.read_record(tmp_path / "mine.csv", **other).sizes["time"] == 20


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        ("1.499,00", r"line 2: '1\.499,00' with a mark of thousands"),
        ("1'499", 'line 2: "1\'499" with a mark of thousands'),
        ("low", "line 2: 'low'"),
    ],
)
def test_a_column_of_text_is_said_to_be_there(entry, told, tmp_path):
    rows = [f"{k // 2},{5 * (k % 2)};{k % 3};{entry}" for k in range(20)]
    (tmp_path / "mine.csv").write_text("\n".join(["t;u;y", *rows]))
    with pytest.raises(InputError, match=rf"column: it has text \({told}\) in column 'y'\. Write"):
        store.Record.read(tmp_path / "mine.csv", **NAMED)


def test_a_number_with_a_mark_of_thousands_among_others_is_told_as_one(tmp_path):
    rows = [f"{k % 3};{1.5 * k:.1f}".replace(".", ",") for k in range(20)]
    rows[12] = "1;1.499,0"
    (tmp_path / "mine.csv").write_text("\n".join(["u;y", *rows]))
    told = r"column 'y': line 14: '1\.499,0' with a mark of thousands is not a number"
    with pytest.raises(InputError, match=told):
        store.Record.read(tmp_path / "mine.csv", **NAMED)


def test_a_single_number_is_no_column(tmp_path):
    savemat(tmp_path / "mine.mat", {"u": U, "y": 1.5})
    with pytest.raises(InputError, match=r"it has a single number in column 'y'\."):
        store.Record.read(tmp_path / "mine.mat", **NAMED)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"imputs": NAMED["input"]}, "imputs: unknown"),
        ({"input": None}, "input: missing. Give a mapping with the keys column, units"),
        ({"input": {"column": "u"}}, r"input\.units: missing. Give text: units"),
        ({"time": {"column": "u", "units": "s"}}, "time: both of time and sampling_interval given"),
        ({"output": {"column": "z", "units": "mm"}}, r"output\.column: .* no column 'z'"),
        ({"output": {"column": "u", "units": "V"}}, "output: column 'u' is input and output"),
    ],
)
def test_columns_named_wrongly_are_refused(changes, message, tmp_path):
    write_csv(tmp_path)
    with pytest.raises(InputError, match=message) as caught:
        store.read_record(tmp_path / "mine.csv", **NAMED | changes)
    assert "mine.csv" in str(caught.value)
    assert caught.value.remedy


def test_a_file_that_does_not_say_its_columns_tells_how_to(tmp_path):
    write_csv(tmp_path)
    with pytest.raises(InputError, match=r"Name them: read_record\(path, sampling_interval="):
        store.read_record(tmp_path / "mine.csv")
    with pytest.raises(
        InputError, match=r"output: missing\. Give a mapping with the keys column, units"
    ):
        store.read_record(tmp_path / "mine.csv", sampling_interval=0.5, input=NAMED["input"])


def test_a_record_of_the_study_needs_no_names(tmp_path):
    write_csv(tmp_path)
    record = store.read_record(tmp_path / "mine.csv", **NAMED)
    store.write(record, tmp_path / "record.nc", title="a record")
    xr.testing.assert_equal(store.read_record(tmp_path / "record.nc"), record)


def test_a_record_may_have_several_inputs(tmp_path):
    rows = np.column_stack([U, Y, U + Y])
    np.savetxt(tmp_path / "mine.csv", rows, delimiter=",", header="u,v,y", comments="")
    several = case("mine.csv")
    first = several.pop("input")
    several |= {"inputs": [first, {"column": "v", "units": "mm", "name": "again"}]}
    record = store.import_record(several, CASE, tmp_path)
    np.testing.assert_array_equal(record["input_1"], U)
    np.testing.assert_array_equal(record["input_2"], Y)
    signals = store.signals(record)
    assert signals.u_names == ("pump voltage", "again")
    assert signals.u_units == ("V", "mm")
    np.testing.assert_array_equal(signals.u, np.column_stack([U, Y]))
    np.testing.assert_array_equal(signals.part(1.0, 3.0).u, signals.u[2:6])
    for ends in ((3.0, 1.0), (1e3, 2e3)):
        with pytest.raises(InputError, match=r"first, last: no sample lies .* the record goes"):
            signals.part(*ends)
    np.testing.assert_array_equal(signals.part(8.0, 10.0).u, signals.part(8.0).u)
    with pytest.raises(InputError, match=r"last: the record ends at 9\.5 s, before 12 s"):
        signals.part(8.0, 12.0)
    several["inputs"][1]["column"] = "z"
    with pytest.raises(InputError, match=r"record\.inputs\[1\]\.column: .* no column 'z'"):
        store.import_record(several, CASE, tmp_path)


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ([{"column": "u", "units": "V"}], "at least 2"),
        ([{"column": "u", "units": "V"}] * 2, "inputs: a column is named twice"),
        ([{"column": c, "units": "V", "name": "drive"} for c in "uy"], "two have the same name"),
        (None, "input: missing"),
    ],
)
def test_inputs_named_wrongly_are_refused(inputs, message, tmp_path):
    write_csv(tmp_path)
    settings = {name: value for name, value in case("mine.csv").items() if name != "input"}
    with pytest.raises(InputError, match=message):
        store.import_record(settings | ({"inputs": inputs} if inputs else {}), CASE, tmp_path)
    both = [{"column": "u", "units": "V"}, {"column": "y", "units": "mm"}]
    with pytest.raises(InputError, match="both input and inputs given"):
        store.import_record(case("mine.csv", inputs=both), CASE, tmp_path)


def test_a_record_whose_inputs_all_rest_is_refused(tmp_path):
    for moving in (True, False):
        second = np.sin(TIME) if moving else np.ones(20)
        rows = np.column_stack([np.ones(20), second, Y])
        np.savetxt(tmp_path / "two.csv", rows, delimiter=",", header="a,b,y", comments="")
        settings = case("two.csv") | {
            "inputs": [{"column": "a", "units": "V"}, {"column": "b", "units": "V"}]
        }
        del settings["input"]
        if moving:
            assert store.import_record(settings, CASE, tmp_path)["input_2"].max() > 0.9
        else:
            with pytest.raises(InputError, match="the input is constant at 1 V"):
                store.import_record(settings, CASE, tmp_path)


def test_columns_of_a_frame_are_inputs_with_their_names():
    frame = pd.DataFrame({"left": U, "right": Y})
    record = store.Record.of(frame, Y, 2.0, units=("V", "mm"))
    assert record.inputs == [("left", "V"), ("right", "V")]
    assert store.Record.of(frame.to_numpy(), Y, 2.0).u_names == ("input 1", "input 2")
    assert store.Record.of(frame[["left"]], Y, 2.0).inputs == [("left", "1")]
    with pytest.raises(InputError, match="A drawing is of records with one input"):
        record.unit_of_one_input("A drawing")
    with pytest.raises(InputError, match="a name of its own"):
        store.Record.of(frame, Y, 2.0, names=("drive", "position"))
    for u in (frame.to_numpy()[:-1], frame.to_numpy()[None]):
        with pytest.raises(InputError, match="several inputs are the columns of u"):
            store.Record.of(u, Y, 2.0)
