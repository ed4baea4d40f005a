"""What the jobs that drive an actuator play, and what a record says of it."""

import numpy as np
import pytest
import xarray as xr

from dea.acquisition import AcquiredRecord, Quality
from dea.configuration.excitation import sections
from dea.errors import InputError
from dea.modbus import read_device
from dea.stages.driving import excitation

EXCITATIONS = {
    "record": {"kind": "gaussian", "duration": 120, "low": 1.1, "high": 3.75, "band": 1.0},
    "second": {"kind": "multisine", "duration": 60, "low": 1.1, "high": 3.75},
    "probing": {
        "times": [30.0], "bias": 2.4, "rms": 0.05, "lowest": 0.2, "highest": 10, "band": 1.0,
        "realisations": 2, "periods": 2, "settle": 5,
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def device():
    return read_device("config/devices/virtual_bench.yaml")


def settings(name, **probing):
    chosen = {**EXCITATIONS, "probing": EXCITATIONS["probing"] | probing}
    return {"seed": 1, "system": "dea1", "excitation_name": name} | sections(chosen, name)


def test_a_probed_run_repeats_the_record_outside_of_its_stretches(device):
    record = excitation(settings("record"), device)
    probed = excitation(settings("probed"), device)
    changed = np.flatnonzero(record.volts != probed.volts)
    assert (changed[0], changed[-1]) == (1500, 1500 + 30 * 50 + 49)
    assert record.noise_seed != probed.noise_seed
    assert not record.labels.data_vars


def test_its_record_says_which_samples_are_whole_periods(device):
    probed = excitation(settings("probed"), device)
    measured = {
        "voltage": ("time", probed.volts),
        "quality": ("time", np.zeros(6000, np.uint8)),
    }
    plain = xr.Dataset(measured, coords={"time": np.arange(6000) / 50})
    record, link = probed.label(AcquiredRecord(plain, xr.Dataset()))
    assert record.attrs["probing_period"] == 5.0
    assert record["probing"].attrs["units"] == "1"
    inside = record["realisation"].values > 0
    assert inside.sum() == 2 * 2 * 250
    periods = record["voltage"].values[inside].reshape(4, 250)
    np.testing.assert_allclose(periods[0], periods[1])
    assert not link.data_vars


@pytest.mark.parametrize("flags", [Quality.HELD | Quality.LOST, Quality.HELD])
def test_samples_beside_those_of_the_plan_have_no_label(device, flags):
    """A polled device's are lost, those of a device with a buffer are read."""
    probed = excitation(settings("probed"), device)
    extra = np.arange(2000, 2003)
    quality = np.zeros(6003, np.uint8)
    quality[extra] = flags
    played = xr.Dataset({"quality": ("time", quality)}, coords={"time": np.arange(6003) / 50})
    record = probed.label(AcquiredRecord(played, xr.Dataset())).record
    for name, label in probed.labels.items():
        values = record[name].values
        assert values.dtype == label.dtype
        np.testing.assert_array_equal(np.delete(values, extra), label)
        assert not values[extra].any()


def test_multisines_outside_the_limits_are_refused_by_their_own_keys(device):
    with pytest.raises(InputError, match=r"excitation\.probing\.bias, rms"):
        excitation(settings("probed", bias=14.9, rms=3.0), device)


def test_an_excitation_that_cannot_be_designed_is_refused_by_its_own_key(device):
    wrong = settings("record")
    wrong["excitation"] = wrong["excitation"] | {"band": 30.0}
    with pytest.raises(InputError, match=r"^config/config\.yaml: excitation\.record\.band: .* 30"):
        excitation(wrong, device)


def test_a_probed_run_without_probing_says_what_is_missing():
    with pytest.raises(InputError, match=r"excitation\.probing: it is not given"):
        sections({"record": EXCITATIONS["record"]}, "probed")
