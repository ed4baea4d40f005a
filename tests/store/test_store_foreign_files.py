"""Files as instruments and other programs write them."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import savemat

from dea.errors import InputError
from dea.store.foreign_files import read_foreign

T = np.arange(30) * 0.1
U = np.round(np.sin(T), 6)
Y = np.round(np.cos(T), 6)


def table(separator, decimal, *above, end=""):
    rows = [separator.join(f"{v:.6f}" for v in row) for row in zip(T, U, Y, strict=True)]
    return "\n".join([*above, *(row.replace(".", decimal) + end for row in rows), ""])


@pytest.mark.parametrize(
    ("text", "names", "units"),
    [
        (table(",", ".", "t,u,y"), "tuy", {}),
        (table(",", ".", "t,u,y,", end=","), "tuy", {}),
        (table("\t", ".", "t\tu\ty"), "tuy", {}),
        (table("\t", ",", "t\tu\ty"), "tuy", {}),
        (table(";", ",", "t;u;y", "s;V;mm"), "tuy", {"t": "s", "u": "V", "y": "mm"}),
        (
            table(",", ".", "rig 2,,", "time of the sample,u,y", "s,V,mm"),
            ("time of the sample", "u", "y"),
            {"time of the sample": "s", "u": "V", "y": "mm"},
        ),
        (table(";", ",", "t [sec];u [V];y (mm)"), "tuy", {"t": "s", "u": "V", "y": "mm"}),
        (table("  ", ".", "t u y"), "tuy", {}),
        (table(" ", ".", "% measured on a Monday", "% t u y"), "tuy", {}),
        (table(",", ".", "# remark, with comma", "Instrument: X", "", "t,u,y"), "tuy", {}),
        (table(",", "."), ["column 1", "column 2", "column 3"], {}),
        ("\ufeff" + table(",", ".", "t,u,y"), "tuy", {}),
    ],
)
def test_a_text_table_is_read_however_it_is_written(text, names, units, tmp_path):
    file = tmp_path / "mine.txt"
    file.write_text(text, encoding="utf-8")
    found = read_foreign(file)
    assert list(found.columns) == list(names)
    assert found.units == units
    for name, values in zip(names, (T, U, Y), strict=True):
        np.testing.assert_allclose(found.columns[name], values, atol=1e-12)


def test_the_last_field_of_the_units_may_be_empty(tmp_path):
    rows = [f"{i},0;{i},5;OK" for i in range(6)]
    (tmp_path / "mine.csv").write_text("\n".join(["Rig 3", "u;y;state", "V;µm;", *rows]))
    assert read_foreign(tmp_path / "mine.csv").units == {"u": "V", "y": "um"}


@pytest.mark.parametrize(
    ("stamps", "elapsed"),
    [
        (["23:59:59.5", "00:00:00.0", "00:00:00.5"], [0.0, 0.5, 1.0]),
        (["00:01.5", "00:59.75", "01:00.0"], [0.0, 58.25, 58.5]),
        (["59:59,5", "00:00,0", "00:00,5"], [0.0, 0.5, 1.0]),
        (["2024-02-28T23:59:59", "2024-02-29 00:00:00.250", "2024-02-29T00:00:01"], [0, 1.25, 2]),
        (["31.12.2023 23:59:59", "01.01.2024 00:00:00", "01.01.2024 00:00:01"], [0, 1, 2]),
        (["1/31/2024 1:00:00 PM", "1/31/2024 1:00:02 PM", "2/1/2024 1:00:00 PM"], [0, 2, 86400]),
    ],
)
def test_dates_and_times_of_day_are_seconds(stamps, elapsed, tmp_path):
    rows = [f"{stamp};{i}.5;{i}" for i, stamp in enumerate(stamps)]
    (tmp_path / "mine.csv").write_text("\n".join(["when;u;y", *rows]))
    found = read_foreign(tmp_path / "mine.csv")
    np.testing.assert_allclose(found.columns["when"], elapsed)
    assert found.units["when"] == "s"


def test_missing_entries_are_not_numbers_and_text_is_no_column(tmp_path):
    rows = ["t,u,y,state", "0,1,2,OK", "1,,3,OK", "2,4,NaN,bad", "3,5,6,OK"]
    (tmp_path / "mine.csv").write_text("\n".join(rows))
    found = read_foreign(tmp_path / "mine.csv")
    np.testing.assert_array_equal(found.columns["u"], [1, np.nan, 4, 5])
    np.testing.assert_array_equal(found.columns["y"], [2, 3, np.nan, 6])
    assert "state" not in found.columns


def test_a_lone_number_is_a_constant(tmp_path):
    (tmp_path / "mine.csv").write_text('"u","y","Ts",\n1,2,4,\n2,3,,\n3,4,,\n')
    found = read_foreign(tmp_path / "mine.csv")
    assert found.constants == {"Ts": 4.0}
    assert list(found.columns) == ["u", "y"]


def test_matlab_matrices_and_structures_come_apart(tmp_path):
    savemat(tmp_path / "m.mat", {"who": "me", "d": {"uy": np.array([U, Y])}, "Ts": 0.1})
    found = read_foreign(tmp_path / "m.mat")
    np.testing.assert_array_equal(found.columns["d.uy_1"], U)
    np.testing.assert_array_equal(found.columns["d.uy_2"], Y)
    assert found.constants == {"Ts": 0.1}


def test_netcdf_gives_units(tmp_path):
    xr.Dataset({"u": ("t", U, {"units": "volt"})}).to_netcdf(tmp_path / "m.nc")
    assert read_foreign(tmp_path / "m.nc").units == {"u": "V"}


def test_text_beside_the_signals_of_a_netcdf_file_is_left_out(tmp_path):
    names = xr.Dataset({"channel": ("c", ["first", "second"]), "u": ("t", U)})
    names.to_netcdf(tmp_path / "m.nc")
    assert list(read_foreign(tmp_path / "m.nc").columns) == ["u"]


def test_a_spreadsheet_may_have_a_line_of_units(tmp_path):
    frame = pd.DataFrame({"t": ["s", *T], "u": ["V", *U], "y": ["mm", *Y]})
    frame.to_excel(tmp_path / "m.xlsx", index=False)
    found = read_foreign(tmp_path / "m.xlsx")
    np.testing.assert_allclose(found.columns["y"], Y)
    assert found.units == {"t": "s", "u": "V", "y": "mm"}


def test_parquet_is_read_where_its_package_is_installed(tmp_path):
    pytest.importorskip("pyarrow")
    stamps = pd.to_datetime("2024-01-01") + pd.to_timedelta(T, unit="s")
    pd.DataFrame({"t": stamps, "u": U}).to_parquet(tmp_path / "m.parquet")
    found = read_foreign(tmp_path / "m.parquet")
    np.testing.assert_allclose(found.columns["t"], T, atol=1e-9)
    np.testing.assert_array_equal(found.columns["u"], U)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("m.csv", "words alone\nand no number\n", "no line of it holds two numbers"),
        ("m.csv", "u,u\n1,2\n3,4\n", "two columns are called 'u'"),
        ("m.xyz", "", r"cannot read \.xyz"),
    ],
)
def test_a_file_that_is_no_table_is_refused(name, text, message, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_foreign(tmp_path / name)
    assert caught.value.file == tmp_path / name
    assert caught.value.remedy
