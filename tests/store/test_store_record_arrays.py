"""Records made of arrays, parts of them, and what makes a record of a file unusable."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from dea.errors import InputError
from dea.store import Record, check_record, flag_counts, signals
from dea.store.record import input_names
from dea.store.records import input_variables

FILE = Path("record.nc")
U = np.array([1.0, 3.0, 2.0, 5.0, 4.0, 6.0])
Y = np.array([0.5, np.nan, 0.25, 0.75, 1.0, 0.0])


# From arrays


@pytest.mark.parametrize("rate", [1e-3, 0.5, 1.0, 610.35])
def test_the_time_of_a_sample_is_its_number_over_any_positive_rate(rate):
    record = Record.of(U, Y, rate)
    np.testing.assert_allclose(record.time, np.arange(6) / rate)
    np.testing.assert_array_equal(record.u, U)
    np.testing.assert_array_equal(record.y, Y)
    assert (record.sampling_rate, record.left_out) == (rate, 1)


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf, "50", None])
def test_a_rate_that_is_no_positive_number_is_refused(rate):
    with pytest.raises(InputError, match=f"sampling_rate: it is {rate!r}"):
        Record.of(U, Y, rate)


def test_an_integer_too_large_for_a_number_is_refused():
    for both, field in (([[1, 10**400], [1, 2]], "u"), ([[1, 2], [1, 10**400]], "y")):
        with pytest.raises(InputError, match=f"{field}: it holds an integer that is too large"):
            Record.of(*both, 1.0)


def test_masked_outputs_are_missing_and_complex_signals_refused():
    masked = Record.of(U, np.ma.masked_where(U == 5.0, np.arange(6.0)), 1.0)
    np.testing.assert_array_equal(np.isnan(masked.y), U == 5.0)
    with pytest.raises(InputError, match="u: it is complex"):
        Record.of(U + 0j, Y, 1.0)


def test_fewer_than_two_samples_are_no_record():
    for samples in (1, 0):
        with pytest.raises(InputError, match="two signals of one length, of two samples at least"):
            Record.of(U[:samples], Y[:samples], 1.0)


def test_two_samples_are_a_record_and_a_missing_input_is_refused():
    assert Record.of(U[:2], Y[:2], 1.0).time.tolist() == [0.0, 1.0]
    for missing in (np.nan, np.inf):
        with pytest.raises(InputError, match="u: the input has missing values"):
            Record.of(np.where(U == 5.0, missing, U), Y, 1.0)


@pytest.mark.parametrize("large", [1e300, -1e160])
def test_numbers_whose_squares_overflow_are_refused(large):
    u, y = np.array([1.0, 2.0, large, large]), np.array([1.0, np.nan, 2.0, 3.0])
    message = re.escape(f"sample 2 is {large:.4g}, too large to compute with. Give it in larger")
    with pytest.raises(InputError, match=f"u: {message}"):
        Record.of(u, y, 1.0)
    with pytest.raises(InputError, match=f"y: {message}"):
        Record.of([1.0, 2.0, 3.0, 4.0], u, 1.0)
    assert Record.of(u * (1e140 / large), y, 1.0).u.size == 4


def test_an_infinite_output_is_refused():
    with pytest.raises(InputError, match=r"y: sample 3 is infinite\. Give NaN"):
        Record.of(U, np.where(U == 5.0, -np.inf, Y), 1.0)


def test_names_and_units_are_those_that_signals_carry():
    plain = Record.of(U, Y, 1.0)
    assert (plain.inputs, plain.y_name, plain.y_units) == ([("input", "1")], "output", "1")
    series = Record.of(pd.Series(U, name="drive"), pd.Series(Y), 1.0)
    assert (series.inputs, series.y_name) == ([("drive", "1")], "output")
    u = xr.DataArray(U, dims="time", name="u", attrs={"units": "kV", "long_name": "voltage"})
    y = xr.DataArray(Y, dims="time", name="place", attrs={"units": "mm"})
    carried = Record.of(u, y, 1.0)
    assert carried.inputs == [("voltage", "kV")]
    assert (carried.y_name, carried.y_units) == ("place", "mm")
    given = Record.of(u, y, 1.0, units=("V", "m"), names=("a", "b"))
    assert (given.inputs, given.y_name, given.y_units) == ([("a", "V")], "b", "m")


@pytest.mark.parametrize("given", ["mm", ("V",), ["V", "mm", "s"]])
def test_units_and_names_are_pairs(given):
    pair = r"Give a pair, of input and output: \('{}', '{}'\)"
    told = re.escape(f"units: it is {given!r}. ") + pair.format("V", "mm")
    with pytest.raises(InputError, match=told):
        Record.of(U, Y, 1.0, units=given)
    told = re.escape(f"names: it is {given!r}. ") + pair.format("voltage", "displacement")
    with pytest.raises(InputError, match=told):
        Record.of(U, Y, 1.0, names=given)


def test_a_single_column_is_one_input():
    record = Record.of(U[:, None], Y, 1.0, units=(["V"], "mm"), names=(["a"], "b"))
    np.testing.assert_array_equal(record.u, U)
    assert (record.u_units, record.u_name) == ("V", "a")
    assert record.unit_of_one_input("A drawing") == "V"


def test_of_several_inputs_texts_are_one_for_all_or_one_for_each():
    both = np.column_stack([U, -U])
    assert Record.of(both, Y, 1.0).inputs == [("input 1", "1"), ("input 2", "1")]
    named = Record.of(both, Y, 1.0, units=(["V", "A"], "mm"), names=(["a", "b"], "c"))
    assert named.inputs == [("a", "V"), ("b", "A")]
    assert Record.of(both, Y, 1.0, units=("V", "mm")).inputs == [("input 1", "V"), ("input 2", "V")]
    with pytest.raises(InputError, match="units: there are 1 for 2 inputs"):
        Record.of(both, Y, 1.0, units=(["V"], "mm"))
    with pytest.raises(InputError, match="names: there are 3 for 2 inputs"):
        Record.of(both, Y, 1.0, names=(["a", "b", "c"], "y"))


def test_inputs_without_names_are_numbered_from_one():
    assert input_names(3) == ["input 1", "input 2", "input 3"]
    assert input_variables(1) == ["input"]
    assert input_variables(3) == ["input_1", "input_2", "input_3"]


# Parts


def test_a_part_begins_with_its_first_time_and_ends_before_its_last():
    record = Record.of(U, Y, 2.0)
    for ends, samples in (
        ((0.5, 1.5), slice(1, 3)),
        ((0.4, 1.6), slice(1, 4)),
        ((0.5, 1.0), slice(1, 2)),
        ((-7.0, 0.5), slice(0, 1)),
        ((1.5,), slice(3, 6)),
        ((1.5, np.inf), slice(3, 6)),
        ((2.5, 3.25), slice(5, 6)),  # one and a half samples after the last one
    ):
        found = record.part(*ends)
        np.testing.assert_array_equal(found.time, record.time[samples])
        np.testing.assert_array_equal(found.u, U[samples])
        np.testing.assert_array_equal(found.y, Y[samples])
    assert found.sampling_rate == 2.0


@pytest.mark.parametrize(("first", "last"), [(3, 7), (6, 9)])
@pytest.mark.parametrize("off", [-1e-9, 1e-9])
def test_times_that_rounding_moved_are_those_of_their_samples(first, last, off):
    record = Record.of(np.arange(10.0), np.arange(10.0), 10.0)
    found = record.part(first / 10 + off, last / 10 + off)
    np.testing.assert_array_equal(found.y, np.arange(first, last))
    assert record.part(0.1 + 0.2, 0.7).y[0] == 3.0


@pytest.mark.parametrize("ends", [(1.0, 1.0), (1.1, 1.4), (2.0, 1.0), (2.6, 3.0)])
def test_a_part_without_a_sample_is_refused(ends):
    with pytest.raises(InputError, match=r"first, last: no sample .* from 0 to 2\.5 s"):
        Record.of(U, Y, 2.0).part(*ends)


def test_a_part_that_ends_after_the_record_is_refused():
    with pytest.raises(InputError, match=r"last: the record ends at 2\.5 s, before 3\.26 s"):
        Record.of(U, Y, 2.0).part(0.0, 3.26)


# From files


def dataset(samples=8, **changes):
    time = np.arange(samples) / 4
    variables = {
        "input": ("time", np.sin(time), {"units": "V"}),
        "output": ("time", np.cos(time), {"units": "mm"}),
    } | changes
    return xr.Dataset(
        {name: each for name, each in variables.items() if each is not None},
        coords={"time": ("time", time, {"units": "s"})},
    )


def test_signals_carry_names_units_and_the_mean_rate():
    record = signals(dataset())
    assert record.inputs == [("input", "V")]
    assert (record.y_name, record.y_units) == ("output", "mm")
    assert record.sampling_rate == pytest.approx(4.0)
    assert record.left_out == 0
    long = {"units": "V", "long_name": "drive"}
    values = np.arange(8.0)
    found = signals(
        dataset(input_1=("time", values, long), input_2=("time", -values, {"units": "A"}))
    )
    assert found.inputs == [("drive", "V"), ("input_2", "A")]
    np.testing.assert_array_equal(found.u, np.column_stack([values, -values]))


@pytest.mark.parametrize(
    ("u", "held"),
    [
        ([np.nan, np.nan, 2.0, 3.0, np.nan, np.nan, 5.0, np.nan], [2, 2, 2, 3, 3, 3, 5, 5]),
        ([1.0, np.nan, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], [1, 1, 2, 3, 4, 5, 6, 7]),
    ],
)
def test_an_input_that_was_not_written_is_the_one_before_and_at_the_start_the_first(u, held):
    quality = np.where(np.isnan(u), 1, 0)
    record = signals(dataset(input=("time", u, {"units": "V"}), quality=("time", quality)))
    np.testing.assert_array_equal(record.u, held)
    np.testing.assert_array_equal(np.isnan(record.y), np.isnan(u))


@pytest.mark.parametrize("name", ["input", "output"])
def test_signals_without_units_are_refused(name):
    told = re.escape(f'{name}: its units are not given. Set attrs["units"]')
    with pytest.raises(InputError, match=told):
        signals(dataset(**{name: ("time", np.arange(8.0))}))


def test_samples_that_are_not_finite_are_left_out():
    u, y = np.arange(8.0), np.arange(8.0)
    u[2], y[5] = np.nan, np.inf
    record = signals(
        dataset(input=("time", u, {"units": "V"}), output=("time", y, {"units": "mm"}))
    )
    assert np.flatnonzero(np.isnan(record.y)).tolist() == [2, 5]
    assert record.u[2] == 1.0


def refused(words, file=FILE, **changes):
    with pytest.raises(InputError, match=words) as caught:
        check_record(dataset(**changes), file)
    assert caught.value.file == file


def test_a_record_of_two_samples_is_whole():
    check_record(dataset(2), FILE)


def test_what_a_record_lacks_is_named():
    values = np.arange(8.0)
    refused("input: its units are not given", input=("time", values))
    refused("output: its units are not given", output=("time", values))
    refused("input_2: its units", input_1=("time", values, {"units": "V"}),
            input_2=("time", values))  # fmt: skip
    refused("voltage or input: the variable is missing. It holds output, time", input=None)
    refused("displacement or output: the variable is missing. It holds input, time", output=None)
    with pytest.raises(InputError, match="time: there is no time"):
        check_record(dataset().drop_vars("time"), FILE)
    other = dataset()
    other["time"].attrs["units"] = "ms"
    with pytest.raises(InputError, match=r"time: its units are 'ms'\. They must be 's'"):
        check_record(other, FILE)


def test_values_that_are_no_numbers_are_counted_and_the_first_is_named():
    values = np.arange(8.0)
    values[[5, 2]] = np.nan, np.inf
    refused("input: 2 of 8 samples .* first at sample 2", input=("time", values, {"units": "V"}))
    refused("output: 2 of 8 samples .* first at sample 2", output=("time", values, {"units": "V"}))
    quality = ("time", np.where(np.isfinite(values), 0, 2))
    check_record(dataset(output=("time", values, {"units": "mm"}), quality=quality), FILE)
    time = dataset().assign_coords(time=("time", values, {"units": "s"}))
    with pytest.raises(InputError, match="time: 2 of 8 samples"):
        check_record(time, FILE)


def test_the_numbers_of_the_device_follow_each_other():
    check_record(dataset(device_index=("time", np.arange(7, 15, dtype=np.uint32))), FILE)
    index = np.array([7, 8, 10, 11, 13, 14, 15, 16], np.uint32)
    refused("device_index: the device's sample 8 is followed by 10", device_index=("time", index))
    falling = np.arange(8, 0, -1, dtype=np.uint32)
    refused("sample 8 is followed by 7", device_index=("time", falling))


def test_an_input_that_moves_in_flagged_samples_alone_is_constant():
    values = np.full(8, 2.5)
    values[[0, 3]] = 7.0
    flags = ("time", np.where(values == 7.0, 4, 0))
    moving = ("time", values, {"units": "V"})
    check_record(dataset(input=moving), FILE)
    refused("input: the input is constant at 2.5 V", input=moving, quality=flags)
    still = ("time", np.full(8, 1.5), {"units": "A"})
    refused("input_1: the input is constant at 1.5 A", input=None, input_1=still, input_2=moving,
            quality=flags)  # fmt: skip


def test_a_single_flag_is_counted_by_its_name():
    quality = ("time", np.array([0, 1, 1, 2, 0, 0, 3, 0]), {"flag_meanings": "late"})
    record = dataset(quality=quality)
    record["quality"].attrs["flag_masks"] = np.uint8(1)
    assert flag_counts(record) == {"late": 3}
    record["quality"].attrs["flag_meanings"] = "late lost"
    assert flag_counts(record) == {"flagged": 4}
    assert flag_counts(dataset(quality=("time", np.zeros(8, int)))) == {}
