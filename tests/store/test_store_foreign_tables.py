"""What foreign files say: times, units, numbers and words, in files written by hand."""

from datetime import datetime, time

import netCDF4
import numpy as np
import openpyxl
import pandas as pd
import pytest
import xarray as xr
from scipy.io import savemat

from dea.errors import InputError
from dea.store import import_record
from dea.store.foreign_files import read_foreign
from dea.store.foreign_files.clock import is_clock, seconds
from dea.store.foreign_files.table import from_columns, name_and_units
from dea.units import SECONDS, plain_units


def read(folder, text, name="mine.csv", encoding="utf-8"):
    (folder / name).write_bytes(text.encode(encoding))
    return read_foreign(folder / name)


# Times


@pytest.mark.parametrize(
    ("text", "clock"),
    [
        ("0:00:01", True), ("123:59:59,25", True), ("23:59:59.", True), ("1234:00:00", False),
        ("12:34", False), ("12:34.5", True), ("12:34:56:7", False), ("x 12:34:56", False),
        ("2024-01-31", True), ("31.12.2023 10:00", True), ("1/2/24T5", True), ("2024.01", False),
        ("12.5", False), ("20240131", False), ("1-2-20245", False), ("12345-01-01", False),
    ],
)  # fmt: skip
def test_what_looks_like_a_time(text, clock):
    assert is_clock(text) is clock


@pytest.mark.parametrize(
    ("stamps", "elapsed"),
    [
        (["01:00:00", "14:00:00"], [0, 13 * 3600]),
        (["22:00:00", "09:59:59", "22:00:00", "09:59:58"], [0, 43199, 86400, 129598]),
        (["12:59:59", "13:00:01", "02:00:00"], [0, 2, -39599]),  # set back by less than half a day
        (["0:01:02,5", "1:02:03.75"], [0, 3661.25]),
        ([None, "10:00:00", " ", "10:00:07", None], [np.nan, 0, np.nan, 7, np.nan]),
        (["2024-01-01"], [0]),
        (["2024-03-31T01:59:59+01:00", "2024-03-31T03:00:01+02:00"], [0, 2]),
        (["2024-03-31T01:59:59,5", None, "2024-03-31T02:00:00"], [0, np.nan, 0.5]),
        ([None, "2024-03-31 02:00", "2024-03-31 02:01"], [np.nan, 0, 60]),
        (["12/01/2024 10:00:00", "01/02/2024 10:00:00"], [0, 20 * 86400]),  # day before month
        (["01/30/2024 10:00:00.5", "02/01/2024 10:00:00.75"], [0, 2 * 86400 + 0.25]),
        (["30/01/2024 10:00:00.5", "01/02/2024 10:00:00.75"], [0, 2 * 86400 + 0.25]),
        (["30.01.2024 10:00:00,25", "30.01.2024 10:00:01,75"], [0, 1.5]),
        (["30.01.2024 10:00", "30.01.2024 10:02"], [0, 120]),
        (["01/31/2024 10:05", "01/31/2024 10:07"], [0, 120]),
        (["31/01/2024 23:59", "01/02/2024 0:01"], [0, 120]),
        (["1/31/2024 11:59 AM", "1/31/2024 12:01 PM"], [0, 120]),
        (["1/31/2024 11:59:59 AM", "1/31/2024 12:00:01 PM"], [0, 2]),
        (["03/04/2024 23:59:59", "03/05/2024 00:00:00"], [0.0, 1.0]),
        (["03/04/2024 23:59:59", "04/04/2024 00:00:01"], [0.0, 2.0]),
        (["03/04/2024 10:00:00"], [0.0]),
        (["start", "2024-01-01", "2024-01-02"], None),
        (["2024-01-01", "2024-01-02", "end"], None),
        (["2024-01-02", "2024-01-01"], None),
        (["", None], None),
        (["10:00:00", "later"], None),
    ],
)
def test_times_are_seconds_since_the_first_entry(stamps, elapsed):
    found = seconds(pd.Series(stamps, dtype=object))
    if elapsed is None:
        assert found is None
    else:
        np.testing.assert_allclose(found, elapsed, rtol=0, atol=1e-6)


def test_dates_of_pandas_are_seconds_too():
    stamps = np.array(["NaT", "2024-01-01T00:00:01", "2024-01-02T00:00:00.5", "NaT"], "M8[ms]")
    dates = pd.Series(stamps)
    np.testing.assert_allclose(seconds(dates), [np.nan, 0.0, 86399.5, np.nan])
    assert from_columns(["when [h]"], [dates]).units == {"when": "s"}


@pytest.mark.parametrize("unit", ["ns", "us", "ms", "s"])
def test_durations_are_seconds_too(unit):
    lasting = np.array([1000, 2000, "NaT", 3000], "m8[ms]").astype(f"m8[{unit}]")
    found = from_columns(["elapsed"], [pd.Series(lasting)])
    np.testing.assert_array_equal(found.columns["elapsed"], [1.0, 2.0, np.nan, 3.0])
    assert (found.units, found.clocks) == ({"elapsed": "s"}, ("elapsed",))


# Units and headings


@pytest.mark.parametrize(
    ("text", "units", "factor"),
    [
        ("s", "s", 1.0), ("sec", "s", 1.0), (" [Seconds] ", "s", 1.0), ("( secs )", "s", 1.0),
        ("seconds since 2024-01-01", "s", 1.0), ("second", "s", 1.0),
        ("days since 2024-01-01", "d", 86400.0), ("hours since 2024-01-01 10:00", "h", 3600.0),
        ("minutes since 2024-01-01", "min", 60.0), ("Milliseconds since 2024-01-01", "ms", 1e-3),
        ("microseconds since 2024-01-01 00:00:00.5", "us", 1e-6), ("day", "d", 86400.0),
        ("nanoseconds since 1970-01-01", "ns", 1e-9), ("cycles since start",) * 2 + (None,),
        ("ms", "ms", 1e-3), ("msec", "ms", 1e-3), ("Milliseconds", "ms", 1e-3),
        ("us", "us", 1e-6), ("µs", "us", 1e-6), ("μs", "us", 1e-6), ("usec", "us", 1e-6),
        ("ns", "ns", 1e-9), ("min", "min", 60.0), ("minutes", "min", 60.0),
        ("h", "h", 3600.0), ("hr", "h", 3600.0), ("hours", "h", 3600.0),
        ("Volt", "V", None), ("volts", "V", None), ("kV", "kV", None), ("µm", "um", None),
        ("[mm]", "mm", None), ("(m/s)^2", "(m/s)^2", None), ("V^(1/2)", "V^(1/2)", None),
        ("μV", "uV", None), ("-", "1", None), ("", "1", None), ("mm", "mm", None),
        ("°C", "degC", None), ("degC", "degC", None), ("Celsius", "degC", None), ("K", "K", None),
    ],
)  # fmt: skip
def test_units_have_one_spelling_and_those_of_time_a_factor(text, units, factor):
    assert plain_units(text) == units
    assert SECONDS.get(units) == factor


@pytest.mark.parametrize(
    ("heading", "parts"),
    [
        (" u ", ("u", None)), ("u [V]", ("u", "V")), ("drive voltage(kV)", ("drive voltage", "kV")),
        ("u []", ("u", "1")), ("[V]", ("[V]", None)), ("y (left) [mm]", ("y (left)", "mm")),
        ("u [V] raw", ("u [V] raw", None)),
    ],
)  # fmt: skip
def test_a_heading_may_end_with_units_in_brackets(heading, parts):
    assert name_and_units(heading) == parts


def columns(**values):
    return from_columns(values.keys(), [pd.Series(each) for each in values.values()])


def test_names_that_units_alone_tell_apart_keep_them():
    found = from_columns(["u [V]", "u [A]", "y [mm]"], [pd.Series([1.0, 2.0])] * 3)
    assert found.units == {"u [V]": "V", "u [A]": "A", "y": "mm"}
    with pytest.raises(InputError, match=r"two columns are called 'y \[mm\]'"):
        from_columns(["u [V]", "y [mm]", "y [mm]"], [pd.Series([1.0, 2.0])] * 3)


def test_units_of_the_heading_count_before_those_below_it_and_a_time_is_in_seconds():
    stamps = pd.Series(["10:00:00", "10:00:01"])
    numbers = pd.Series([1.0, 2.0])
    found = from_columns(
        ["u [V]", "y", "z", "t [h]"], [numbers, numbers, numbers, stamps], ["A", "mm", None, "min"]
    )
    assert found.units == {"u": "V", "y": "mm", "t": "s"}


def test_a_constant_is_one_number_in_the_first_of_several_rows():
    found = columns(
        u=[1.0, 2.0, 3.0], rate=[50.0, np.nan, np.nan], late=[np.nan, 7.0, np.nan], two=[1, 2, None]
    )
    assert found.constants == {"rate": 50.0}
    assert list(found.columns) == ["u", "late", "two"]
    assert columns(u=[1.0, 2.0], rate=[50.0, np.nan]).constants == {"rate": 50.0}
    assert columns(u=[4.0]).constants == {}
    np.testing.assert_array_equal(columns(u=[4.0]).columns["u"], [4.0])


def test_a_column_is_of_numbers_where_more_than_half_of_its_entries_are():
    found = columns(half=["1", "a", "2", "b"], most=["1", "2", "a", None, None])
    assert list(found.columns) == ["most"]
    np.testing.assert_array_equal(found.columns["most"], [1.0, 2.0, np.nan, np.nan, np.nan])
    assert found.words == {"most": "row 3: 'a'"}


def test_the_first_word_among_numbers_is_told_and_marks_of_missing_ones_are_none():
    marks = ["", "NaN", " n/a ", "null", "None", "-", "--", "inf", "-Inf", "NA"]
    numbers = [str(k) for k in range(12)]
    found = columns(u=[*numbers, *marks], y=[*numbers, *marks[:8], " Err ", "Off"])
    assert found.words == {"y": "row 21: 'Err'"}
    assert not np.isfinite(found.columns["u"][12:]).any()


def test_with_a_decimal_comma_a_point_is_no_decimal():
    found = from_columns(["u"], [pd.Series(["1,5", "2", "3,25", "4.5", 6.5])], decimal=",")
    np.testing.assert_array_equal(found.columns["u"], [1.5, 2.0, 3.25, np.nan, 6.5])
    assert found.words == {"u": "row 4: '4.5'"}


def test_columns_without_numbers_are_told_with_what_they_hold():
    found = columns(u=[1.0, 2.0], y=[None, None], half=["1", "a"], state=["ok", "ok"])
    assert found.no_numbers == {
        "y": "nothing", "half": "text (row 2: 'a')", "state": "text (row 1: 'ok')"
    }  # fmt: skip
    found = from_columns(["", "u", "y"], [pd.Series([np.nan, np.nan]), *[pd.Series([1, 2])] * 2])
    assert found.no_numbers == {}
    found = from_columns(["", "", ""], [pd.Series([np.nan, np.nan]), *[pd.Series([1, 2])] * 2])
    assert found.no_numbers == {"column 1": "nothing"}
    days, times = pd.Series(["2024-01-01"] * 2), pd.Series(["10:00:00", "10:00:01"])
    assert from_columns(["day", "time"], [days, times]).no_numbers == {}


def test_variables_that_are_no_vectors_are_told_with_what_they_hold(tmp_path):
    flat = xr.Dataset({"u": ("n", np.ones(3)), "y": (("n", "k"), np.ones((3, 2))), "a": 1.0})
    flat.assign(state=("n", ["ok"] * 3)).to_netcdf(tmp_path / "mine.nc")
    assert read_foreign(tmp_path / "mine.nc").no_numbers == {
        "y": "numbers in 2 dimensions", "state": "text"
    }  # fmt: skip
    cells = np.array([np.ones(3), "a"], dtype=object)
    savemat(tmp_path / "mine.mat", {"u": np.ones(3), "y": np.ones((2, 3, 4)), "c": cells,
                                    "none": [], "title": "mine", "a": 1.0})  # fmt: skip
    assert read_foreign(tmp_path / "mine.mat").no_numbers == {
        "y": "numbers in 3 dimensions", "c": "a cell array", "none": "nothing"
    }  # fmt: skip


def test_a_word_is_refused_only_in_a_column_that_is_used(tmp_path):
    found = columns(u=["1", "2", "x"], y=["1", "2", "3"])
    found.refuse_words(["y"], tmp_path)
    with pytest.raises(InputError, match="column 'u': row 3: 'x' is not a number"):
        found.refuse_words(["y", "u"], tmp_path)


# Text


@pytest.mark.parametrize("separator", ["\t", ";", ",", "|", " "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_a_separator_and_a_decimal_mark_are_told_apart(separator, decimal, tmp_path):
    if separator == decimal:
        return
    rows = [separator.join(f"{v:.3f}".replace(".", decimal) for v in (k / 8, -k, 1e3 * k))
            for k in range(9)]  # fmt: skip
    found = read(tmp_path, "\n".join([separator.join("abc"), *rows]))
    np.testing.assert_array_equal(found.columns["a"], np.arange(9) / 8)
    np.testing.assert_array_equal(found.columns["b"], -np.arange(9.0))
    np.testing.assert_array_equal(found.columns["c"], 1e3 * np.arange(9))


@pytest.mark.parametrize("mark", ["#", "%", "//", "!"])
def test_headings_may_be_the_last_comment_before_the_table(mark, tmp_path):
    lines = [f"{mark} made in 2024", f" {mark}{mark} u, y ", "1,2", f"{mark} pause, here", "3,x4",
             "5,6", "7,8"]  # fmt: skip
    found = read(tmp_path, "\n".join(lines))
    np.testing.assert_array_equal(found.columns["u"], [1.0, 3.0, 5.0, 7.0])
    assert found.words == {"y": "line 5: 'x4'"}


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"]
)
def test_units_are_read_in_any_encoding(encoding, tmp_path):
    found = read(tmp_path, "u [V];y [µm]\n" + "1;2\n" * 4, encoding=encoding)
    assert found.units == {"u": "V", "y": "um"}


@pytest.mark.parametrize("length", [12, 13])
def test_units_below_the_headings_are_no_longer_than_twelve_characters(length, tmp_path):
    long = "m" * length
    found = read(tmp_path, f"u,y\nV,{long}\n" + "1,2\n2,3\n")
    if length == 12:
        assert found.units == {"u": "V", "y": long}
    else:
        assert (found.units, list(found.columns)) == ({}, ["V", long])


def test_a_heading_that_is_missing_is_the_number_of_its_column(tmp_path):
    found = read(tmp_path, "t,,y\n" + "1,2,3\n2,3,4\n")
    assert list(found.columns) == ["t", "column 2", "y"]


def test_numbers_may_begin_late_and_rows_before_them_are_as_wide_as_they_like(tmp_path):
    above = [f"remark {k} of the rig, 1, 2, 3" for k in range(150)]
    rows = [f"{k},{k / 4},{-k}" for k in range(300)]
    found = read(tmp_path, "\n".join([*above, "t,u,y", *rows]))
    assert list(found.columns) == ["t", "u", "y"]
    np.testing.assert_array_equal(found.columns["y"], -np.arange(300.0))


@pytest.mark.parametrize("index", [True, False])
@pytest.mark.parametrize("ending", ["csv", "xlsx"])
@pytest.mark.parametrize("columns", [2, 3, 4])
def test_the_numbers_of_the_columns_are_headings(columns, ending, index, tmp_path):
    """As pandas writes a frame without names."""
    frame = pd.DataFrame(np.arange(5.0)[:, None] / 4 + np.arange(columns) + 0.5)
    write = frame.to_csv if ending == "csv" else frame.to_excel
    write(tmp_path / f"mine.{ending}", index=index)
    found = read_foreign(tmp_path / f"mine.{ending}")
    assert list(found.columns) == ["column 1"] * index + list(map(str, range(columns)))
    np.testing.assert_array_equal(found.columns["1"], 1.5 + np.arange(5.0) / 4)


@pytest.mark.parametrize(
    ("above", "first", "below"),
    [
        ("t,u,y\n", "0,1,2", "1,1.5,2"),
        ("# t,u,y\n", "0,1,2", "1,1.5,2"),
        ("", "0,1", "1,1"),
        ("", "0.0,1.0,2.0", "1,1.5,2"),
        ("", "0,1,3", "1,1.5,3"),
    ],
)
def test_a_first_sample_may_look_like_the_numbers_of_the_columns(above, first, below, tmp_path):
    found = read(tmp_path, f"{above}{first}\n" + f"{below}\n" * 5)
    assert [len(values) for values in found.columns.values()] == [6] * len(first.split(","))


def test_fields_may_be_quoted_and_powers_of_ten_written(tmp_path):
    found = read(tmp_path, '"u, drive","y"\n"1.5e-3", +.5\n-2E2,"3."\n7,8\n')
    np.testing.assert_array_equal(found.columns["u, drive"], [1.5e-3, -200.0, 7.0])
    np.testing.assert_array_equal(found.columns["y"], [0.5, 3.0, 8.0])


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize("notes", [{5: '"note'}, {5: '"note', 6: '"note'}, {5: '"note', 11: '"'}])
@pytest.mark.parametrize("other", [[], ["ok"]])
def test_a_quote_that_would_swallow_rows_is_refused_with_its_line(
    other, notes, separator, tmp_path
):
    rows = [[f"{k}.5", f"{k}", *([notes[k]] if k in notes else other)] for k in range(30)]
    text = "\n".join(map(separator.join, [["u", "y", "note"], *rows]))
    with pytest.raises(
        InputError, match=r"line 7 begins a field with a quote mark that is not clo"
    ):
        read(tmp_path, text)


def test_a_note_of_several_lines_is_one_field(tmp_path):
    note = '"moved by hand,\n3 mm\n\nand ""back"""'
    rows = [f"{k}.5,{k},{note if k % 4 == 0 else 'ok'}" for k in range(9)]
    found = read(tmp_path, "\n".join(["u,y,note", *rows, "9.5,x,ok"]))
    np.testing.assert_array_equal(found.columns["u"], np.arange(10) + 0.5)
    assert found.words == {"y": "line 20: 'x'"}


def test_headings_may_have_several_lines(tmp_path):
    headings = '"Time\n(s)","Drive\nvoltage\n(V)","Position\r\n(mm)"'
    found = read(tmp_path, f'5" film\n{headings}\n' + "1,2,3\n" * 9)
    assert found.units == {"Time": "s", "Drive voltage": "V", "Position": "mm"}
    np.testing.assert_array_equal(found.columns["Position"], [3.0] * 9)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_name_may_hold_a_separator_of_unicode(end, tmp_path):
    lines = ["t,drive\u2028voltage,y\x0c", *["1,2,3"] * 9, "1,x,3"]
    found = read(tmp_path, end.join(lines))
    assert list(found.columns) == ["t", "drive\u2028voltage", "y"]
    assert found.words == {"drive\u2028voltage": "line 11: 'x'"}


def test_powers_of_ten_may_be_those_of_fortran(tmp_path):
    found = read(tmp_path, "u,y\n1.5D-3,1d2\n-2.D0,3\n7,8D+01\n")
    np.testing.assert_array_equal(found.columns["u"], [1.5e-3, -2.0, 7.0])
    np.testing.assert_array_equal(found.columns["y"], [100.0, 3.0, 80.0])
    found = read(tmp_path, "u;y\n1,5D-3;1\n2;3\n", "comma.csv")
    np.testing.assert_array_equal(found.columns["u"], [1.5e-3, 2.0])


def test_a_row_of_too_many_numbers_is_refused_with_its_line(tmp_path):
    text = "t,u,y\n" + "".join(f"{k},{k},{k}\n" for k in range(5)) + "6.00,1,234,0.5\n"
    with pytest.raises(InputError, match="line 7 has 4 fields, and the table 3"):
        read(tmp_path, text)
    found = read(tmp_path, text.replace("1,234", '"1,234"') + "7,1,2,a remark\n", "quoted.csv")
    np.testing.assert_array_equal(found.columns["y"][-2:], [0.5, 2.0])


@pytest.mark.parametrize("blank", [0, 1, 2])
@pytest.mark.parametrize("at", [0, 1, 7, 19])
def test_a_blank_between_spaces_is_refused_with_its_line(at, blank, tmp_path):
    """It would move what stands behind it to the left."""
    rows = [[f"{k / 8:.3f}", f"{k % 5}", f"{-k}"] for k in range(20)]
    rows[at][blank] = ""
    text = "\n".join("".join(f"{field:>10}" for field in row) for row in [["t", "u", "y"], *rows])
    with pytest.raises(InputError, match=f"line {at + 2} has 2 fields, and the table 3. Write nan"):
        read(tmp_path, text)
    rows[at][blank] = "nan"
    text = "\n".join("".join(f"{field:>10}" for field in row) for row in [["t", "u", "y"], *rows])
    assert np.isnan(read(tmp_path, text).columns["tuy"[blank]][at])


def test_between_spaces_a_word_at_the_end_may_be_missing_and_none_within(tmp_path):
    rows = [f"{k}.5 {k} ok" for k in range(9)]
    rows[4] = "4.5 nan"
    found = read(tmp_path, "\n".join(["u y state", *rows, "end of the record"]), "end.txt")
    np.testing.assert_array_equal(found.columns["y"][:6], [0, 1, 2, 3, np.nan, 5])
    rows[0] = "0.5 0 ok but"
    assert read(tmp_path, "\n".join(["u y state", *rows]), "wide.txt").columns["y"][0] == 0.0
    rows = [f"{k}.5 ok {k}" for k in range(9)]
    rows[4] = "4.5 4"
    with pytest.raises(InputError, match="line 6 has 2 fields, and the table 3"):
        read(tmp_path, "\n".join(["u state y", *rows]), "within.txt")


@pytest.mark.parametrize("above", ["t u y\n", "#t u y\n", ""])
@pytest.mark.parametrize("separator", [" ", ","])
@pytest.mark.parametrize("first", [1, 3])
def test_words_behind_the_first_rows_do_not_cost_them(first, separator, above, tmp_path):
    rows = [f"{k}.5 {k} {-k}" + " OK it is" * (k < first or k == 7) for k in range(20)]
    found = read(tmp_path, (above + "\n".join(rows)).replace(" ", separator))
    assert list(found.columns) == (["t", "u", "y"] if above else [f"column {k}" for k in (1, 2, 3)])
    np.testing.assert_array_equal(list(found.columns.values())[2], -np.arange(20.0))


@pytest.mark.parametrize("above", ["t,u,y\n", ""])
@pytest.mark.parametrize("first", ["0,0.5", ",0.5", "10:00:00,0.5"])
def test_numbers_right_above_a_table_that_are_fewer_are_no_headings(first, above, tmp_path):
    rows = "".join(f"{k},{k}.5,{-k}\n" for k in range(1, 9))
    line = 2 if above else 1
    with pytest.raises(InputError, match=rf"line {line} has 2 fields, and the table 3\. Write nan"):
        read(tmp_path, f"{above}{first}\n{rows}")
    for remark in ("50", "Rig 3", "rate,50", "2024-05-27,10:00:00", "x,1,2,OK", "1,2,3,4"):
        found = read(tmp_path, f"{remark}\n{rows}")
        np.testing.assert_array_equal([*found.columns.values()][2], -np.arange(1.0, 9.0))


def test_what_instruments_write_for_no_number_is_none(tmp_path):
    found = read(tmp_path, "u,y\n1,9.91E+37\n2,-9.9E37\n3,4\n")
    np.testing.assert_array_equal(found.columns["y"], [np.nan, np.nan, 4.0])


def test_a_row_is_one_of_the_table_where_more_than_half_of_it_is_numbers_or_missing(tmp_path):
    found = read(tmp_path, "a,b,c,d\n1,,-,x\n1,2,3,x\n4,5,6,y\n")
    np.testing.assert_array_equal(found.columns["a"], [1.0, 1.0, 4.0])
    assert list(found.columns) == ["a", "b", "c"]
    found = read(tmp_path, "a,b,c,d\n1,2,x,y\n1,2,3,x\n4,5,6,y\n7,8,9,y\n")
    np.testing.assert_array_equal(found.columns["a"], [1.0, 4.0, 7.0])


def test_one_number_beside_missing_ones_makes_a_row(tmp_path):
    found = read(tmp_path, "u,y,z\n" + "".join(f"{k},-,-\n" for k in range(4)))
    np.testing.assert_array_equal(found.columns["u"], np.arange(4.0))


@pytest.mark.parametrize("above", [[], ["rig"], ["rig", "Model, X"], ["a, b", "c, d"]])
def test_of_several_comments_the_last_one_holds_the_headings(above, tmp_path):
    lines = [f"# {each}" for each in (*above, "u, y")]
    assert list(read(tmp_path, "\n".join([*lines, "1,2", "3,4"])).columns) == ["u", "y"]


@pytest.mark.parametrize("text", ["", "u\n1\n2\n3\n", "x,y,z,1\n" * 6, "x,-,y\n" * 6])
def test_lines_without_two_numbers_are_no_table(text, tmp_path):
    with pytest.raises(InputError, match="no line of it holds two numbers"):
        read(tmp_path, text)


@pytest.mark.parametrize("decimal", [".", ","])
def test_every_number_may_be_quoted_whatever_marks_its_decimals(decimal, tmp_path):
    rows = [f'"{k / 4:.2f}","{-k:.1f}"'.replace(".", decimal) for k in range(9)]
    found = read(tmp_path, "\n".join(['"u","y"', *rows]))
    np.testing.assert_array_equal(found.columns["u"], np.arange(9) / 4)
    np.testing.assert_array_equal(found.columns["y"], -np.arange(9.0))


@pytest.mark.parametrize("above", ["Film 3,,\n", "Film 3,,\n,,\nOperator,Volta,\n", "Film 3\n"])
@pytest.mark.parametrize("units", ["", "s,V,mm\n", "s,,mm\n"])
def test_a_title_padded_by_a_spreadsheet_is_no_heading(above, units, tmp_path):
    found = read(tmp_path, f"{above}time,u,y\n{units}" + "".join(f"{k},1,2\n" for k in range(5)))
    assert list(found.columns) == ["time", "u", "y"]
    assert found.units.get("y") == ("mm" if units else None)


@pytest.mark.parametrize("above", ["Run 5,2024 A,x\n", "Operator,me,x\nrange,low,high\n"])
@pytest.mark.parametrize("headings", ["Time (s),u (V),y (mm)", "Time [s],u [V],y"])
def test_a_preamble_as_wide_as_the_table_is_no_heading(above, headings, tmp_path):
    found = read(tmp_path, f"{above}{headings}\n" + "".join(f"{k},1,2\n" for k in range(5)))
    assert list(found.columns) == ["Time", "u", "y"]
    assert (found.units["Time"], found.units["u"]) == ("s", "V")


@pytest.mark.parametrize("units", ["s,V (rms),mm", "(s),[V],(mm)"])
def test_brackets_in_a_row_of_units_make_it_no_headings(units, tmp_path):
    found = read(tmp_path, f"t,u,y\n{units}\n" + "".join(f"{k},1,2\n" for k in range(5)))
    assert list(found.columns) == ["t", "u", "y"]
    assert (found.units["t"], found.units["y"]) == ("s", "mm")


@pytest.mark.parametrize("heading", ["u,y,remarks", "u,y,", "u,y"])
@pytest.mark.parametrize("end", [",", ",,"])
def test_a_column_in_which_there_is_nothing_is_none(heading, end, tmp_path):
    found = read(tmp_path, f"{heading}\n" + "".join(f"{k},{-k}{end}\n" for k in range(5)))
    assert list(found.columns) == ["u", "y"]
    np.testing.assert_array_equal(found.columns["y"], -np.arange(5.0))


@pytest.mark.parametrize("heading", ["t{0}u{0}y", "t (s){0}u (V){0}y (mm)", "t{0}u{0}y{0}"])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("empty", [(0, 1), (0, 3), (0, 150), (195, 399), (799, 800)])
def test_an_empty_cell_of_the_last_column_is_a_missing_number(heading, separator, empty, tmp_path):
    y = np.arange(800) / 4
    y[slice(*empty)] = np.nan
    cells = ["" if np.isnan(each) else f"{each}" for each in y]
    rows = [separator.join([f"{k}", f"{-k}.5", cell]) for k, cell in enumerate(cells)]
    found = read(tmp_path, "\n".join([heading.format(separator), *rows]))
    assert found.units == ({"t": "s", "u": "V", "y": "mm"} if "(" in heading else {})
    assert list(found.columns) == ["t", "u", "y"]
    np.testing.assert_array_equal(found.columns["t"], np.arange(800.0))
    np.testing.assert_array_equal(found.columns["y"], y)


@pytest.mark.parametrize(
    ("day", "times"),
    [
        ("2026-11-26", ["23:59:59.5", "00:00:00.25"]),
        ("26.11.2026", ["23:59:59,5", "00:00:00,25"]),
        ("11/26/2026", ["11:59:59.5 PM", "12:00:00.25 AM"]),
        ("11/26/2026", ["11:59:59.5 AM", "12:00:00.25 PM"]),
    ],
)
def test_dates_and_times_of_day_in_two_columns_are_one_time(day, times, tmp_path):
    midnight = times[1].startswith("0") or times[1].endswith("AM")
    days = [day, day.replace("26", "27", 1) if midnight else day]
    if midnight and day.startswith("2026"):
        days[1] = "2026-11-27"
    rows = [f"{d};{t};1;2" for d, t in zip(days, times, strict=True)]
    found = read(tmp_path, "\n".join(["Date;Time;u;y", *rows]))
    assert (list(found.columns), found.clocks) == (["Time", "u", "y"], ("Time",))
    np.testing.assert_allclose(found.columns["Time"], [0.0, 0.75], atol=1e-6)


def test_dates_that_cannot_be_read_leave_the_times_of_day(tmp_path):
    rows = [f"26/Nov/2026;10:00:0{k};1;2" for k in range(3)]
    found = read(tmp_path, "\n".join(["Date;Time;u;y", *rows]))
    np.testing.assert_allclose(found.columns["Time"], [0.0, 1.0, 2.0])


# Other programs


@pytest.mark.parametrize("units", [None, ("s", "volts", None)])
def test_a_spreadsheet_names_a_word_by_its_row(units, tmp_path):
    book = openpyxl.Workbook()
    rows = [["t", "u", "y"], *([units] if units else [])]
    rows += [[0.5, 1, 2], [1.5, 3, "Err"], [2.5, 5, 6], [3.5, 7, 8]]
    for row in rows:
        book.active.append(row)
    book.save(tmp_path / "mine.xlsx")
    found = read_foreign(tmp_path / "mine.xlsx")
    np.testing.assert_array_equal(found.columns["t"], [0.5, 1.5, 2.5, 3.5])
    np.testing.assert_array_equal(found.columns["y"], [2.0, np.nan, 6.0, 8.0])
    assert found.words == {"y": f"row {4 if units else 3}: 'Err'"}
    assert found.units == ({"t": "s", "u": "V", "y": "1"} if units else {})


def test_a_heading_of_a_spreadsheet_may_end_like_a_number(tmp_path):
    book = openpyxl.Workbook()
    for row in (["t", "u", "filter 2.0"], [0.5, 1, 2], [1.5, 3, 4], [2.5, 5, 6]):
        book.active.append(row)
    book.save(tmp_path / "mine.xlsx")
    assert list(read_foreign(tmp_path / "mine.xlsx").columns) == ["t", "u", "filter 2.0"]


def test_a_spreadsheet_of_headings_alone_is_no_table(tmp_path):
    book = openpyxl.Workbook()
    book.active.append(["t", "u"])
    book.save(tmp_path / "mine.xlsx")
    with pytest.raises(InputError, match="no row of it holds numbers"):
        read_foreign(tmp_path / "mine.xlsx")


def test_a_spreadsheet_may_have_titles_and_a_date_beside_the_time(tmp_path):
    book = openpyxl.Workbook()
    day, morning = datetime(2026, 11, 26), time(9, 30, 0)
    for row in (["Film 3"], [], ["Operator", "A. Volta"], ["Date", "Time", "u", "y"],
                [None, None, "V", "mm"], [day, morning, 1.0, 2],
                [day, morning.replace(second=1, microsecond=500_000), 3.0, 4]):  # fmt: skip
        book.active.append(row)
    book.save(tmp_path / "mine.xlsx")
    found = read_foreign(tmp_path / "mine.xlsx")
    assert list(found.columns) == ["Time", "u", "y"]
    np.testing.assert_allclose(found.columns["Time"], [0.0, 1.5])
    np.testing.assert_array_equal(found.columns["y"], [2.0, 4.0])
    assert found.units == {"Time": "s", "u": "V", "y": "mm"}


def test_an_index_with_a_name_is_a_column_of_a_parquet_file(tmp_path, monkeypatch):
    frame = pd.DataFrame({"u": [1.0, 2.0, 4.0]}, index=[0.5, 1.0, 1.5])
    monkeypatch.setattr(pd, "read_parquet", lambda _: frame)
    assert list(read_foreign(tmp_path / "mine.parquet").columns) == ["u"]
    monkeypatch.setattr(pd, "read_parquet", lambda _: frame.rename_axis("t [ms]"))
    found = read_foreign(tmp_path / "mine.parquet")
    np.testing.assert_array_equal(found.columns["t"], [0.5, 1.0, 1.5])
    assert found.units == {"t": "ms"}


def test_netcdf_holds_vectors_and_lone_numbers_and_times_stay_numbers(tmp_path):
    with netCDF4.Dataset(tmp_path / "mine.nc", "w") as file:
        file.createDimension("n", 3)
        file.createDimension("m", 2)
        for name, kind, dimensions, value in (
            ("t", "f8", ("n",), [0.0, 1.0, 2.0]), ("u", "i4", ("n",), [3, 4, 5]),
            ("image", "f8", ("n", "m"), np.zeros((3, 2))), ("rate", "f8", (), 50.0),
        ):  # fmt: skip
            file.createVariable(name, kind, dimensions)[...] = value
        file["t"].units = "seconds since 2024-01-01"
        file["rate"].units = "Hz"
        file.createVariable("who", str, ())[...] = "me"
    found = read_foreign(tmp_path / "mine.nc")
    assert list(found.columns) == ["t", "u"]
    np.testing.assert_array_equal(found.columns["t"], [0.0, 1.0, 2.0])
    assert found.columns["u"].dtype == float
    assert found.units == {"t": "s", "rate": "Hz"}
    assert found.constants == {"rate": 50.0}


@pytest.mark.parametrize("step", ["100ms", "250us", "10s", "1min", "2h", "1D"])
def test_dates_that_are_saved_as_netcdf_are_times_in_their_units(step, tmp_path):
    time = pd.date_range("2024-01-01T10:00", periods=5, freq=step)
    xr.Dataset({"u": ("time", np.arange(5.0))}, {"time": time}).to_netcdf(tmp_path / "mine.nc")
    found = read_foreign(tmp_path / "mine.nc")
    passed = found.columns["time"] * SECONDS[found.units["time"]]
    np.testing.assert_allclose(
        passed - passed[0], pd.Timedelta(step).total_seconds() * np.arange(5), rtol=1e-12
    )


def test_a_matlab_file_holds_rows_columns_matrices_and_structures(tmp_path):
    values = {
        "row": np.array([[1, 2, 3]]), "column": np.array([[4.0], [5.0]]), "Ts": 0.5, "who": "me",
        "tall": np.arange(6.0).reshape(3, 2), "wide": np.arange(6.0).reshape(2, 3),
        "square": np.arange(4.0).reshape(2, 2), "cube": np.zeros((2, 2, 2)),
        "rig": {"deep": {"u": np.array([7.0, 8.0])}, "rate": 50},
    }  # fmt: skip
    savemat(tmp_path / "mine.mat", values)
    found = read_foreign(tmp_path / "mine.mat")
    expected = {
        "row": [1, 2, 3], "column": [4, 5], "tall_1": [0, 2, 4], "tall_2": [1, 3, 5],
        "wide_1": [0, 1, 2], "wide_2": [3, 4, 5], "rig.deep.u": [7, 8],
    }  # fmt: skip
    assert {name: found.columns[name].tolist() for name in expected} == expected
    assert set(found.columns) - set(expected) == {"square_1", "square_2"}
    assert found.constants == {"Ts": 0.5, "rig.rate": 50.0}


def test_a_complex_signal_is_refused_where_it_is_used(tmp_path, recwarn):
    values = {"u": np.arange(3.0), "y": np.arange(3) * 1j, "poles": np.ones((3, 2)) * (1 + 1j),
              "gain": 2.0 + 1j, "Ts": 0.5}  # fmt: skip
    savemat(tmp_path / "mine.mat", values)
    found = read_foreign(tmp_path / "mine.mat")
    assert found.constants == {"Ts": 0.5}
    assert found.complex_numbers == ("y", "poles_1", "poles_2")
    assert np.isnan(found.columns["y"]).all()
    found.refuse_words(["u"], tmp_path)
    described = {"file": "mine.mat", "sampling_interval": 0.5,
                 "input": {"column": "u", "units": "V"},
                 "output": {"column": "y", "units": "mm"}}  # fmt: skip
    with pytest.raises(InputError, match=r"mat: column 'y': it is complex\. Give its real"):
        import_record(described, root=tmp_path)
    assert not recwarn.list


def test_a_heading_of_a_workbook_may_have_several_lines(tmp_path):
    rows = [["t\n(s)", "Drive\nvoltage [V]", "Length"], *([k / 4, float(k), 1.0] for k in range(4))]
    pd.DataFrame(rows).to_excel(tmp_path / "mine.xlsx", header=False, index=False)
    table = read_foreign(tmp_path / "mine.xlsx")
    assert list(table.columns) == ["t", "Drive voltage", "Length"]
    assert table.units == {"t": "s", "Drive voltage": "V"}


def test_a_table_with_units_behind_its_numbers_is_refused_with_the_cause(tmp_path):
    rows = [f"{k / 50:.2f},{k / 7:.2f} V,{k / 9:.4f} mm" for k in range(60)]
    with pytest.raises(InputError, match="in no line of it most fields are numbers"):
        read(tmp_path, "\n".join(["t,u,y", *rows]))


def test_true_and_false_of_a_netcdf_file_are_numbers(tmp_path):
    valve = np.array([True, False, True, True])
    data = {
        "valve": ("n", valve, {"units": 1}),
        "y": ("n", np.arange(4.0), {"units": "mm"}),
        "on": ((), True),
    }
    xr.Dataset(data).to_netcdf(tmp_path / "mine.nc")
    table = read_foreign(tmp_path / "mine.nc")
    np.testing.assert_array_equal(table.columns["valve"], [1.0, 0.0, 1.0, 1.0])
    assert (table.no_numbers, table.constants) == ({}, {"on": 1.0})
    assert table.units == {"valve": "1", "y": "mm"}


def test_a_workbook_may_hold_numbers_as_text_with_a_comma(tmp_path):
    rows = [["t (s)", "u (V)"], ["0,0", 1.5], ["0,25", "2,5"], ["0,5", "-3,5"]]
    pd.DataFrame(rows).to_excel(tmp_path / "mine.xlsx", header=False, index=False)
    columns = read_foreign(tmp_path / "mine.xlsx").columns
    np.testing.assert_array_equal(columns["t"], [0.0, 0.25, 0.5])
    np.testing.assert_array_equal(columns["u"], [1.5, 2.5, -3.5])


@pytest.mark.parametrize(
    ("texts", "numbers"),
    [
        (["5,000", "5,012", "5,031"], None),
        (["-5,000", "12,345", "100,031"], None),
        (["5,000", "0,012", "5,031"], [5.0, 0.012, 5.031]),
        (["5,000", "5,01", "5,031"], [5.0, 5.01, 5.031]),
    ],
)
def test_numbers_of_a_workbook_whose_commas_may_be_marks_of_thousands_are_text(
    texts, numbers, tmp_path
):
    rows = [["t", "u", "y"], *([k / 4, float(k), text] for k, text in enumerate(texts))]
    pd.DataFrame(rows).to_excel(tmp_path / "mine.xlsx", header=False, index=False)
    table = read_foreign(tmp_path / "mine.xlsx")
    assert list(table.columns.get("y", [])) == (numbers or [])
    assert table.no_numbers == ({} if numbers else {"y": f"text (row 2: {texts[0]!r})"})


def test_a_workbook_holds_one_sheet_of_a_record(tmp_path):
    record = [["t (s)", "u (V)"], *([k / 4, float(k)] for k in range(9))]
    sheets = {
        "Info": [["Rig", 3, ""], ["made", datetime(2024, 5, 1), ""], ["range", 0, 10]],
        "Empty": [],
        "Data": record,
    }

    def write():
        with pd.ExcelWriter(tmp_path / "mine.xlsx") as file:
            for name, rows in sheets.items():
                pd.DataFrame(rows).to_excel(file, sheet_name=name, header=False, index=False)

    write()
    np.testing.assert_array_equal(read_foreign(tmp_path / "mine.xlsx").columns["u"], np.arange(9.0))
    sheets["Run 2"] = record[:4]
    write()
    with pytest.raises(
        InputError, match=r"mine\.xlsx: several .*: 'Data', 'Run 2'\. Name the one .*`sheet`"
    ):
        read_foreign(tmp_path / "mine.xlsx")
    assert read_foreign(tmp_path / "mine.xlsx", "Run 2").columns["u"].size == 3
    with pytest.raises(InputError, match=r"no sheet 'data'\. Its sheets are 'Info', .*'Run 2'"):
        read_foreign(tmp_path / "mine.xlsx", "data")
    sheets["Run 2"] = record[:3]
    write()
    assert read_foreign(tmp_path / "mine.xlsx").columns["u"].size == 9


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"d": np.array([np.ones(3), np.ones(3)], dtype=object)}, ", only a cell array 'd'"),
        ({"d": np.array([np.ones(3), "a"], dtype=object), "Ts": 0.5}, ", only a cell array 'd'"),
        ({"Ts": 0.5}, ""),
    ],
)
def test_a_matlab_file_without_vectors_says_what_it_holds(values, told, tmp_path):
    savemat(tmp_path / "mine.mat", values)
    message = rf"mine\.mat: it holds no vectors of numbers{told}\. Save each signal as a variable"
    with pytest.raises(InputError, match=message):
        read_foreign(tmp_path / "mine.mat")


def test_a_complex_variable_of_netcdf_is_no_real_one(tmp_path, monkeypatch):
    dataset = xr.Dataset({"u": ("n", np.arange(3.0)), "y": ("n", 1j * np.ones(3)), "gain": 1j})
    monkeypatch.setattr(xr, "open_dataset", lambda *_, **__: dataset)
    found = read_foreign(tmp_path / "mine.nc")
    assert (found.complex_numbers, found.constants) == (("y",), {})
    assert np.isnan(found.columns["y"]).all()


@pytest.mark.parametrize("ending", ["CSV", "Txt", "dat", "asc", "lvm", "tsv"])
def test_the_ending_may_be_written_in_capitals(ending, tmp_path):
    assert list(read(tmp_path, "u,y\n1,2\n3,4\n", f"mine.{ending}").columns) == ["u", "y"]


def test_a_missing_package_and_a_newer_kind_are_told_with_what_to_do(tmp_path, monkeypatch):
    for error, words, remedy in (
        (ImportError("no", name="fastparquet"), "fastparquet is needed to read .parquet", "pip "),
        (NotImplementedError("HDF"), r"it is a newer kind of .parquet \(HDF\)", "'-v7'"),
        (OSError("torn"), r"cannot be read as .parquet \(torn\)", "Repair it"),
    ):

        def refuse(_, error=error):
            raise error

        monkeypatch.setitem(read_foreign.__globals__["FORMATS"], ".parquet", refuse)
        with pytest.raises(InputError, match=words) as caught:
            read_foreign(tmp_path / "mine.parquet")
        assert remedy in caught.value.remedy
        assert caught.value.file == tmp_path / "mine.parquet"
    with pytest.raises(InputError, match="cannot read a file without an ending"):
        read_foreign(tmp_path / "mine")
