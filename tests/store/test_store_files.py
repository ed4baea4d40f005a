import json
import os

import numpy as np
import pytest
import xarray as xr

from dea import store
from dea.errors import InputError
from synced_files import note_synced


def record(samples=100):
    time = np.arange(samples) / 50
    return xr.Dataset(
        {
            "voltage": ("time", 2 + np.sin(time), {"units": "V", "long_name": "voltage"}),
            "displacement": ("time", np.cos(time), {"units": "mm", "long_name": "displacement"}),
            "device_index": ("time", np.arange(samples), {"units": "1", "long_name": "index"}),
            "quality": ("time", np.zeros(samples, np.uint8), {"units": "1", "long_name": "flag"}),
        },
        coords={"time": ("time", time, {"units": "s", "long_name": "time"})},
    )


def test_what_is_written_is_read_back_with_its_provenance(tmp_path):
    source = tmp_path / "source.csv"
    source.write_text("abc")
    path = tmp_path / "record.nc"
    store.write(record(), path, title="A record", inputs={"csv": source}, settings={"b": 1}, seed=7)
    back = store.read(path)
    xr.testing.assert_equal(back, record())
    assert back.attrs["title"] == "A record"
    assert back.attrs["seed"] == "7"
    assert json.loads(back.attrs["settings"]) == {"b": 1}
    # SHA-256 of "abc", FIPS 180-2 appendix B.1
    assert back.attrs["sha256_csv"].startswith("ba7816bf8f01cfea414140de5dae2223")
    assert back["time"].dtype == np.float64


def test_seconds_stay_numbers_however_their_units_are_spelled(tmp_path):
    """A reader that follows the CF conventions would turn them into dates and durations."""
    foreign = record().assign(lag=("time", np.ones(100), {"units": "seconds"}))
    foreign["time"].attrs["units"] = "seconds since 2026-01-01"
    foreign.to_netcdf(tmp_path / "foreign.nc")
    back = store.read(tmp_path / "foreign.nc")
    np.testing.assert_array_equal(back["lag"], 1.0)
    np.testing.assert_array_equal(back["time"], record()["time"])


def test_two_writes_give_the_same_bytes(tmp_path):
    first, second = tmp_path / "a" / "record.nc", tmp_path / "b" / "record.nc"
    for path in (first, second):
        store.write(record(), path, title="A record")
    assert first.read_bytes() == second.read_bytes()


def test_a_broken_contract_writes_nothing(tmp_path):
    with pytest.raises(InputError, match=r"record\.nc: displacement: the variable is missing"):
        store.write(record().drop_vars("displacement"), tmp_path / "record.nc", title="")
    assert not list(tmp_path.iterdir())


def test_a_variable_beside_the_contract_needs_units_too(tmp_path):
    dataset = record(10).assign(temperature=("time", np.zeros(10)))
    with pytest.raises(InputError, match=r"record\.nc: temperature: the variable has no units"):
        store.write(dataset, tmp_path / "record.nc", title="")
    assert not list(tmp_path.iterdir())
    dataset["temperature"].attrs["units"] = "K"
    store.write(dataset, tmp_path / "record.nc", title="")


def test_a_failed_write_leaves_the_old_file_alone(tmp_path):
    path = tmp_path / "result.txt"
    path.write_text("old")

    def interrupted():
        with store.atomic(path) as partial:
            partial.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        interrupted()
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["result.txt"]


def test_a_file_is_on_the_disk_before_it_takes_its_name(tmp_path, monkeypatch):
    """What it was made from may be removed then."""
    done, path, rename = [], tmp_path / "result.txt", os.replace

    def replace(old, new):
        done.append("renamed")
        rename(old, new)

    note_synced(monkeypatch, done)
    monkeypatch.setattr("os.replace", replace)
    with store.atomic(path) as partial:
        partial.write_text("whole")
    assert done == [partial.name, "renamed", tmp_path.name]
    assert path.read_text() == "whole"


def test_wrong_units_and_dimensions_name_file_field_and_remedy(tmp_path):
    wrong = record()
    wrong["voltage"].attrs["units"] = "mV"
    with pytest.raises(InputError, match=r"record\.nc: voltage: its units are 'mV'.*'V'"):
        store.write(wrong, tmp_path / "record.nc", title="")
    with pytest.raises(InputError, match="its dimensions are"):
        store.write(record().rename_dims(time="sample"), tmp_path / "record.nc", title="")


def test_a_damaged_file_is_named(tmp_path):
    """Whatever its library says, of which the next test has more."""
    path, messages = tmp_path / "record.nc", []
    store.write(record(), path, title="A record")
    whole = np.frombuffer(path.read_bytes(), np.uint8)
    for seed in range(40):
        content = whole.copy()
        at = np.random.default_rng(seed).integers(whole.size // 2, whole.size, size=10)
        content[at] ^= 255
        # Each has a path of its own, by which libraries keep files that they opened.
        file = tmp_path / f"{seed}" / "record.nc"
        file.parent.mkdir()
        file.write_bytes(content.tobytes())
        try:
            store.read(file)
        except InputError as error:
            messages.append(str(error))
    assert len(messages) > 20
    assert all("record.nc: cannot be read as NetCDF" in each for each in messages)


@pytest.mark.parametrize("error", [AttributeError, KeyError, UnicodeError, RuntimeError])
def test_whatever_a_library_says_of_a_damaged_file_is_an_input_error(error, tmp_path, monkeypatch):
    store.write(record(), tmp_path / "record.nc", title="A record")

    def load(dataset):
        raise error("damaged")

    monkeypatch.setattr(xr.Dataset, "load", load)
    with pytest.raises(InputError, match=r"record\.nc: cannot be read as NetCDF .*damaged"):
        store.read(tmp_path / "record.nc")


def test_a_file_that_is_no_netcdf_is_named(tmp_path):
    path = tmp_path / "record.nc"
    path.write_text("not NetCDF")
    with pytest.raises(InputError, match="cannot be read as NetCDF"):
        store.read(path)
    with pytest.raises(InputError, match="does not exist"):
        store.read(tmp_path / "absent.nc")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda r: r.isel(time=np.delete(np.arange(100), 40)), r"time: there is a gap of 0\.04 s"),
        (lambda r: r.assign(voltage=r.voltage.where(r.time != r.time[3])), "voltage: 1 of 100"),
        (lambda r: r.assign(voltage=r.voltage.copy(data=np.full(100, 2.0))), "input is constant"),
        (lambda r: r.assign(quality=r.quality.copy(data=np.ones(100))), "100 of 100 samples are f"),
        (
            lambda r: r.assign(device_index=r.device_index.copy(data=np.arange(100) // 2)),
            "sample 0 is followed by 0",
        ),
        (lambda r: r.isel(time=[0]), "holds 1 samples"),
    ],
)
def test_an_unusable_record_is_refused(spoil, message, tmp_path):
    spoilt = spoil(record())
    for name, variable in record().variables.items():
        spoilt[name].attrs.update(variable.attrs)
    with pytest.raises(InputError, match=message):
        store.check_record(spoilt, tmp_path / "record.nc")


@pytest.mark.parametrize("samples", [2, 100])
def test_a_time_that_runs_backwards_is_refused_at_its_first_step(samples, tmp_path):
    backwards = record(samples).isel(time=slice(None, None, -1))
    with pytest.raises(InputError, match=r"time: there is a step of -0\.02 s after sample 0"):
        store.check_record(backwards, tmp_path / "record.nc")


def test_times_that_many_samples_share_are_not_said_to_be_0_s_apart(tmp_path):
    whole = np.floor(record().time.values)
    coarse = record().assign_coords(time=("time", whole, {"units": "s", "long_name": "time"}))
    told = r"time: there is a step of 0 s after sample 0: it does not ascend\. Use a stretch"
    with pytest.raises(InputError, match=told):
        store.check_record(coarse, tmp_path / "record.nc")


def test_a_gap_is_told_from_a_step_of_another_length(tmp_path):
    for late, kind in ((0.0101, "a gap"), (0.0099, "a step"), (-0.005, "a step")):
        time = record().time.values + np.where(np.arange(100) > 40, late, 0.0)
        uneven = record().assign_coords(time=("time", time, {"units": "s", "long_name": "time"}))
        with pytest.raises(InputError, match=f"time: there is {kind} of .* after sample 40"):
            store.check_record(uneven, tmp_path / "record.nc")


@pytest.mark.parametrize("share", [0.9e-3, 1.1e-3])
def test_a_step_may_deviate_by_a_thousandth(share, tmp_path):
    time = record().time.values + np.where(np.arange(100) > 40, 0.02 * share, 0.0)
    uneven = record().assign_coords(time=("time", time, {"units": "s", "long_name": "time"}))
    if share < 1e-3:
        store.check_record(uneven, tmp_path / "record.nc")
    else:
        with pytest.raises(InputError, match="after sample 40"):
            store.check_record(uneven, tmp_path / "record.nc")


def test_signals_are_found_whatever_they_are_called():
    mine = store.signals(record())
    theirs = store.signals(record().rename(voltage="input", displacement="output"))
    np.testing.assert_array_equal(mine.u, theirs.u)
    np.testing.assert_array_equal(mine.y, theirs.y)
    assert mine.sampling_rate == pytest.approx(50)
    assert (mine.u_units, mine.y_units) == ("V", "mm")
