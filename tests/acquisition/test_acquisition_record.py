"""From samples to datasets."""

import numpy as np
from made_device import described

from dea.acquisition.link_log import LinkLog
from dea.acquisition.record import link_dataset, record_dataset
from dea.acquisition.samples import DrivenSamples, Quality


def device(**registers):
    given = {
        "output": {"address": 0, "scale": 0.001, "unit": "V", "access": "write"},
        "displacement": {"address": 1, "scale": 0.01, "offset": -1, "unit": "mm"},
    }
    return described(given | registers)


def samples(quality):
    steps = np.arange(len(quality))
    return DrivenSamples(
        steps, 100 + steps, 1000 + steps, 2000 + steps, 300 + steps, np.array(quality),
        steps / 50, steps / 50 + 0.001,
    )  # fmt: skip


def test_the_record_is_the_excitation_without_its_ramps():
    record = record_dataset(device(), samples([0] * 10), lead=3, length=5)
    assert np.allclose(record.time, np.arange(5) / 50)
    assert record.device_index.values.tolist() == [103, 104, 105, 106, 107]
    assert np.allclose(record.voltage, 2.003 + 0.001 * np.arange(5))
    assert np.allclose(record.voltage_requested, 1.003 + 0.001 * np.arange(5))
    assert np.allclose(record.displacement, 2.03 + 0.01 * np.arange(5))
    assert {v.attrs["units"] for v in record.variables.values()} == {"s", "V", "mm", "1", "count"}


def test_the_applied_output_has_its_own_scale():
    echo = {"address": 2, "table": "input", "scale": 0.002, "unit": "V"}
    record = record_dataset(device(applied_output=echo), samples([0] * 4), lead=0, length=4)
    assert np.allclose(record.voltage, 4.0 + 0.002 * np.arange(4))
    assert np.allclose(record.voltage_requested, 1.0 + 0.001 * np.arange(4))


def test_lost_samples_have_no_value_and_keep_their_flag():
    record = record_dataset(device(), samples([0, Quality.LOST, Quality.LATE]), lead=0, length=3)
    assert np.isnan(record.voltage.values).tolist() == [False, True, False]
    assert np.isnan(record.displacement.values).tolist() == [False, True, False]
    assert record.quality.values.tolist() == [0, 2, 4]
    assert (
        record.quality.attrs["flag_meanings"]
        == "held lost late undriven clamped stuck saturated clock"
    )
    assert record.quality.attrs["flag_masks"].tolist() == [2**bit for bit in range(8)]


def test_the_link_counts_every_exchange_once():
    log = LinkLog(reconnects=2, retries=[0, 1, 0], samples=[0, 55, 55], jitter=[0.1])
    log.send_time, log.receive_time = [0.0, 1.0, 2.0], [0.001, 1.002, 2.5]
    log.errors.update({"no reply": 3, "checksum": 1})
    link = link_dataset(log, samples([0] * 3))
    assert int(link.round_trip_count.sum()) == 3
    for trip in (0.001, 0.002, 0.5):
        inside = (link.round_trip_low <= trip) & (trip < link.round_trip_high)
        assert int(link.round_trip_count[inside].sum()) == 1
    assert link.samples.values.tolist() == [0, 55, 55]
    assert dict(zip(link.error_kind.values, link.errors.values, strict=True)) == log.errors
    assert int(link.reconnects) == 2


def test_an_acquisition_without_errors_is_a_dataset_too():
    link = link_dataset(LinkLog(), samples([0] * 3))
    assert link.sizes["exchange"] == link.sizes["kind"] == 0


def test_an_output_without_a_read_back_is_said_to_be_as_written():
    echo = {"address": 2, "table": "input", "scale": 0.002, "unit": "V"}
    seen = record_dataset(device(applied_output=echo), samples([0] * 4), lead=0, length=4)
    unseen = record_dataset(device(), samples([0] * 4), lead=0, length=4)
    assert seen.voltage.attrs["long_name"].endswith("as the device echoed it")
    for name in ("voltage", "voltage_counts"):
        assert "as written" in unseen[name].attrs["long_name"]
