"""Records with flagged samples: read, masked, and counted."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from dea.errors import InputError
from dea.store import Record, check_record, flag_counts, signals

FILE = Path("record.nc")
N = 20


def flagged(*samples, lost=()):
    """Return a record with those samples flagged late, and some of them lost."""
    u, y = np.arange(N, dtype=float), 0.5 * np.arange(N)
    quality = np.zeros(N, np.uint8)
    quality[list(samples)] = 4
    for place in lost:
        u[place] = y[place] = np.nan
        quality[place] |= 2
    units = {"voltage": "V", "displacement": "mm", "quality": "1"}
    values = {"voltage": u, "displacement": y, "quality": quality}
    record = xr.Dataset(
        {name: ("time", values[name], {"units": unit}) for name, unit in units.items()},
        coords={"time": ("time", np.arange(N) / 50, {"units": "s"})},
    )
    record["quality"].attrs["flag_meanings"] = "held lost late"
    return record


def test_flagged_samples_are_left_out_and_counted():
    record = flagged(3, 7, lost=(7,))
    check_record(record, FILE)
    found = signals(record)
    assert np.flatnonzero(np.isnan(found.y)).tolist() == [3, 7]
    assert found.left_out == 2
    assert found.u[3] == 3.0  # what was applied is known
    assert found.u[7] == 6.0  # a sample that was never written held the last


@pytest.mark.parametrize(
    ("u", "y"), [((9,), (9, 1)), ((9,), (8,)), ((9, 2), (9, 2)), ((3, 3, 3), (3,)), ((1,), (1,))]
)
def test_signals_of_other_shapes_are_no_record(u, y):
    with pytest.raises(InputError, match="input and output have shapes") as error:
        Record.of(np.ones(u), np.ones(y), 50.0)
    assert error.value.remedy


def test_a_record_without_a_good_sample_is_refused():
    with pytest.raises(InputError, match="20 of 20 samples are flagged"):
        check_record(flagged(*range(N)), FILE)
    with pytest.raises(InputError, match="20 of 20 samples are flagged"):
        signals(flagged(*range(N)))


def test_the_flags_that_are_set_are_named_and_counted():
    record = flagged(*range(N), lost=(7, 9))
    assert flag_counts(record) == {"flagged": N}  # a record made elsewhere says no more
    record["quality"].attrs["flag_masks"] = np.array([1, 2, 4], np.uint8)
    assert flag_counts(record) == {"lost": 2, "late": 20}
    with pytest.raises(InputError, match=r"20 of 20 samples are flagged \(lost 2, late 20\)"):
        signals(record)
    assert flag_counts(record.drop_vars("quality")) == {}


@pytest.mark.parametrize("flag", [256, 1.0])
def test_flags_that_a_record_does_not_name_are_counted_together(flag):
    record = flagged()
    record["quality"] = "time", np.full(N, flag)
    with pytest.raises(InputError, match=r"20 of 20 samples are flagged \(flagged 20\)"):
        signals(record)


def test_what_is_no_number_and_not_flagged_is_refused():
    record = flagged()
    record["displacement"][4] = np.nan
    with pytest.raises(InputError, match="the first at sample 4"):
        check_record(record, FILE)
