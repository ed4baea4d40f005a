"""The first voltage on a device, and what is shown and asked for before any."""

import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
import yaml

from dea.acquisition import AcquisitionSettings, ClosedLoop, acquire, refuse_unarmed
from dea.acquisition.__main__ import main
from dea.acquisition.commissioned import refuse_uncommissioned, report_file, write_report
from dea.acquisition.commissioning import _delay, commission
from dea.errors import DeviceError, InputError
from dea.modbus import read_device

SETTINGS = AcquisitionSettings(ramp_rate=5.0, timeout=0.5, reconnect_time=2.0, armed_by="A. Person")
SAFETY = {
    "amplifier_gain": 1000, "film": {"thickness": 50.0, "capacitance": 2.0},
    "interlocks": {"reading": {"name": "applied_output", "value": 0}},
}  # fmt: skip


def test_a_staircase_shows_gain_offset_and_noise_of_a_read_back(module, tmp_path):
    noise = np.random.default_rng(2)
    module.read_back = lambda count: max(0, 1.1 * count + 65 + noise.normal(0, 13))
    target = module.description()
    echo = replace(target["applied_output"], tolerance=0.03)
    target = replace(target, registers=dict(target.registers) | {"applied_output": echo})
    report = commission(target, tmp_path / "c.partial", SETTINGS, 0.03)
    assert max(module.path()[1]) == pytest.approx(0.03 * 4.0, abs=1e-3)
    assert module.volts == 0.0
    assert report["highest"] == pytest.approx(0.03 * 4.0)
    assert report["read_back_gain"] == pytest.approx(1.1, abs=0.02)
    assert report["read_back_offset"] == pytest.approx(0.01, abs=0.002)
    assert 0 < report["read_back_delay"] < 0.03
    assert report["read_together"] == [["displacement"], ["applied_output"]]
    assert report["read_back_noise"] == pytest.approx(0.002, rel=0.5)
    assert report["armed_by"] == "A. Person"
    assert not list(tmp_path.iterdir())


def test_the_staircase_of_an_output_below_zero_leads_down(module, tmp_path):
    below = {"range": [-10, 0], "unit": "V"}
    module._count = 65535  # 0 V
    registers = {
        "output": {"address": 0, **below, "limits": [-4, 0], "access": "write"},
        "applied_output": {"address": 1, **below},
        "displacement": {"address": 0, "table": "input", "range": [0, 10], "unit": "mm"},
    }
    report = commission(
        module.description(registers=registers), tmp_path / "c.partial", SETTINGS, 0.03
    )
    assert report["highest"] == pytest.approx(-0.03 * 4.0)
    assert report["read_back_gain"] == pytest.approx(1.0, abs=1e-3)


def test_a_report_outlives_a_terminal_that_has_gone(module, tmp_path, monkeypatch):
    path = description(module, tmp_path)

    def gone(*_, **__):
        raise BrokenPipeError

    monkeypatch.setattr("dea.acquisition.__main__.staircase", lambda *_: {"device": "plain"})
    monkeypatch.setattr("builtins.print", gone)
    with pytest.raises(SystemExit):
        main(["commission", "--device", str(path), "--arm", "A. Person"])
    assert json.loads(report_file(path).read_text())["device"] == "plain"


def test_what_a_device_measured_beside_the_staircase_is_left_out(module, tmp_path):
    target = module.description()
    index = replace(target["displacement"], name="device_index", address=5, table="holding")
    target = replace(target, registers=dict(target.registers) | {"device_index": index})

    def jump_once(count):
        if len(module.history) >= 100:
            module.index = 3
        return count

    module.read_back = jump_once
    report = commission(target, tmp_path / "c.partial", SETTINGS, 0.03)
    assert report["read_back_gain"] == pytest.approx(1.0, abs=1e-3)
    assert 0 <= report["read_back_delay"] < 0.02
    assert report["flagged_samples"] >= 3


def test_a_staircase_without_a_good_sample_is_said_in_a_line(module, tmp_path, capsys):
    path = description(module, tmp_path, safety={"max_rate": 100})
    # A sensor that is not connected reads the end of its range.
    told = yaml.safe_load(path.read_text())
    told["registers"]["displacement"] |= {"address": 9, "table": "holding"}
    path.write_text(yaml.safe_dump(told))
    with pytest.raises(SystemExit) as exit_:
        main(["commission", "--device", str(path), "--arm", "A. Person", "--ramp-rate", "5"])
    assert exit_.value.code == 1
    message = capsys.readouterr().err
    assert "250 samples: 0 good, " in message
    counts = {kind: int(count) for count, kind in re.findall(r"(\d+) (lost|saturated)", message)}
    # What a busy machine loses is not read.
    assert sum(counts.values()) == 250
    assert counts["saturated"] > 125
    assert not report_file(path).exists()
    assert module.volts == 0.0


@pytest.mark.parametrize(
    ("works", "found", "share"),
    [(True, "tripped", 0.03), (True, "tripped", 0.0301), (False, "did not trip", 0.03)],
)
def test_the_watchdog_is_tripped_on_purpose(serve_bench, tmp_path, works, found, share):
    """A count above the top of the staircase, and one below it."""
    bench = serve_bench(virtual_clock=False, watchdog_time=0.5)
    if not works:
        bench.player.watchdog.expired = lambda now: False
    report = commission(bench.endpoint, tmp_path / "c.partial", SETTINGS, share)
    assert report["watchdog"] == found
    assert bench.player.applied == 0
    assert bench.player.watchdog.trips == works
    assert not bench.player.watchdog.latched


def written(module):
    """The counts written, after some zeros."""
    return [0] * 4 + [round(volts / 10 * 65535) for _, volts in module.history]


def description(module, folder, **changes):
    """A file that describes the module."""
    scale = {"range": [0, 10], "unit": "V"}
    path = folder / "device.yaml"
    path.write_text(yaml.safe_dump({
        "name": "plain module", "unit_id": 1, "sampling_rate": 50, "quarantine": 0.2,
        "endpoint": {"host": "127.0.0.1", "port": module.port}, "safety": SAFETY,
        "registers": {"output": {"address": 0, **scale, "limits": [0, 4], "access": "write"},
                      "applied_output": {"address": 1, **scale},
                      "displacement": {"address": 0, "table": "input", **scale, "unit": "mm"}},
    } | changes))  # fmt: skip
    return path


def drive(path, folder, *options):
    words = ["drive", "--mode", "polled", "--kind", "binary", "--duration", "2", "--low", "1",
             "--high", "2", "--device", str(path), "--output", str(folder / "r.nc")]  # fmt: skip
    main([*words, *options])


def test_a_dry_run_shows_what_would_be_done_and_writes_nothing(module, tmp_path, capsys):
    path = description(module, tmp_path)
    drive(path, tmp_path, "--dry-run")
    shown = capsys.readouterr().out
    for line in ("0 to 2", "high voltage    2000", "field           40", "charge          4"):
        assert line[:17].strip() in shown
        assert line.split()[-1] in shown
    assert not module.history
    assert list(tmp_path.iterdir()) == [path]


def test_a_device_with_a_safety_model_is_commissioned_first(module, tmp_path, capsys):
    path = description(module, tmp_path)
    with pytest.raises(SystemExit):
        drive(path, tmp_path, "--arm", "A. Person")
    assert "not commissioned" in capsys.readouterr().err
    assert not module.history
    report = write_report(read_device(path), {"device": "plain module"})
    assert json.loads(report.read_text())["device"] == "plain module"
    refuse_uncommissioned(read_device(path))
    description(module, tmp_path, sampling_rate=40)
    with pytest.raises(InputError, match="changed since it was commissioned"):
        refuse_uncommissioned(read_device(path))


@pytest.mark.parametrize("where", [{"port": 5}, {"unit_id": 2}])
def test_a_report_commissions_no_device_at_another_place(module, tmp_path, where):
    path = description(module, tmp_path)
    device = read_device(path)
    write_report(device, {"device": "plain module"})
    with pytest.raises(InputError, match=r"was commissioned is at 127.* this one at") as caught:
        refuse_uncommissioned(replace(device, **where))
    assert caught.value.field == "endpoint"
    refuse_uncommissioned(device.at(host="localhost"))


def test_a_report_that_does_not_say_where_commissions_nothing(module, tmp_path):
    path = description(module, tmp_path)
    report = json.loads(write_report(read_device(path), {}).read_text())
    del report["endpoint"]
    report_file(path).write_text(json.dumps(report))
    with pytest.raises(InputError, match="an unknown place"):
        refuse_uncommissioned(read_device(path))


def test_a_virtual_device_is_neither_commissioned_nor_armed(module, tmp_path):
    device = read_device(description(module, tmp_path))
    with pytest.raises(InputError, match="nobody has armed"):
        refuse_unarmed(device, "")
    refuse_uncommissioned(replace(device, virtual=True))
    refuse_unarmed(replace(device, virtual=True), "")


def test_a_program_of_ones_own_drives_no_device_that_was_not_commissioned(module, tmp_path):
    device = read_device(description(module, tmp_path, safety={"max_rate": 100}))
    settings = replace(SETTINGS, mode="polled", ramp_rate=50.0)
    loop = ClosedLoop(lambda _: 1.0, samples=5, start=1.0, rate=20)
    for excitation in (np.ones(5), loop):
        with pytest.raises(InputError, match="not commissioned"):
            acquire(device, excitation, tmp_path / "a.partial", settings)
    assert not module.history
    report = commission(device, tmp_path / "c.partial", SETTINGS, 0.03)
    write_report(device, report)
    assert acquire(device, np.ones(5), tmp_path / "a.partial", settings).record.sizes["time"] == 5


@pytest.mark.parametrize(
    ("found", "field", "why"),
    [
        ({"watchdog": "did not trip"}, "watchdog", "did not trip when the guardian was killed"),
        ({"read_back_delay": np.nan}, "read_back_delay", "could not be measured"),
        ({"round_trip_longest": np.inf}, "round_trip_longest", "could not be measured"),
        ({"read_back_gain": 0.0}, "read_back_gain", "reads 0 times what was asked for"),
        ({"read_back_gain": 1000.0}, "read_back_gain", "reads 1e+03 times"),
    ],
)
def test_a_report_of_a_failed_check_commissions_nothing(
    module, tmp_path, capsys, found, field, why
):
    path = description(module, tmp_path)
    report = {"watchdog": "tripped", "read_back_gain": 1.0, "read_back_delay": 0.01} | found
    with pytest.raises(DeviceError, match=rf"{field}: .*commission --arm YOUR.NAME --device"):
        write_report(read_device(path), report)
    with pytest.raises(SystemExit) as exit_:
        drive(path, tmp_path, "--arm", "A. Person")
    assert exit_.value.code == 2
    message = capsys.readouterr().err
    assert f"device.commissioned.json: {field}: " in message
    assert why in message
    assert "commission --arm YOUR.NAME" in message
    assert message.count("\n") == 1
    assert not module.history


@pytest.mark.parametrize("left", ["", "{", "[]"])
def test_a_damaged_report_commissions_nothing(module, tmp_path, left):
    path = description(module, tmp_path)
    report_file(path).write_text(left)
    with pytest.raises(InputError, match=r"device\.commissioned\.json: is "):
        refuse_uncommissioned(read_device(path))


def test_a_read_back_that_stands_still_is_not_commissioned(module, tmp_path, capsys):
    """At a few per cent it is within the tolerance of a drive."""
    path = description(module, tmp_path, safety={"max_rate": 100})
    module.read_back = lambda count: 0
    with pytest.raises(SystemExit) as exit_:
        main(["commission", "--device", str(path), "--arm", "A. Person", "--ramp-rate", "5"])
    assert exit_.value.code == 1
    assert "read_back_gain: the applied output reads" in capsys.readouterr().err
    with pytest.raises(InputError, match="read_back_gain"):
        refuse_uncommissioned(read_device(path))


@pytest.mark.parametrize("samples", [1, 3])
def test_the_delay_of_a_read_back_is_measured(module, tmp_path, samples):
    """The module shows what it was given so many writes before."""
    module.read_back = lambda count: written(module)[-1 - samples]
    target = module.description()
    echo = replace(target["applied_output"], tolerance=1.0)
    target = replace(target, registers=dict(target.registers) | {"applied_output": echo})
    report = commission(target, tmp_path / "c.partial", SETTINGS, 0.03)
    periods = report["read_back_delay"] * target.sampling_rate
    assert samples - 0.5 < periods < samples + 0.9


def test_a_stair_whose_end_was_left_out_says_nothing_of_the_delay():
    hold, period = 10, 0.02
    asked = np.repeat([1.0, 2.0, 3.0], hold)
    shown = np.append(np.zeros(2), asked[:-2])
    shown[hold - 3 : hold] = np.nan  # the next step has nothing to begin from
    index = np.arange(asked.size)
    record = xr.Dataset(
        {name: ("time", values) for name, values in
         [("voltage_requested", asked), ("voltage", shown), ("device_index", index)]}
    )  # fmt: skip
    times = {"device_index": index, "write_time": index * period, "read_time": index * period}
    link = xr.Dataset({name: ("sample", values) for name, values in times.items()})
    assert _delay(record, link, hold) == pytest.approx(2 * period)
    shown[2 * hold - 3 : 2 * hold] = np.nan
    assert np.isnan(_delay(record.assign(voltage=("time", shown)), link, hold))


def test_a_disk_without_room_is_refused_before_any_voltage(module, tmp_path, capsys, monkeypatch):
    path = description(module, tmp_path, safety=None)
    small = SimpleNamespace(free=9_000_000)
    monkeypatch.setattr("shutil.disk_usage", lambda _: small)
    with pytest.raises(SystemExit) as exit_:
        drive(path, tmp_path)
    assert exit_.value.code == 2
    assert "samples need 10 MB, and the disk of" in capsys.readouterr().err
    assert not module.history
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_cannot_be_made_is_refused_before_any_voltage(module, tmp_path, capsys):
    path = description(module, tmp_path, safety=None)
    (tmp_path / "file").write_text("")
    with pytest.raises(SystemExit) as exit_:
        drive(path, tmp_path / "file")
    assert exit_.value.code == 2
    assert "cannot be written" in capsys.readouterr().err
    assert not module.history


def test_who_armed_the_device_stands_in_the_record(module, tmp_path):
    settings = replace(SETTINGS, mode="polled", ramp_rate=50.0)
    record = acquire(module.description(), np.full(5, 1.0), tmp_path / "a.partial", settings).record
    assert record.attrs["armed_by"] == "A. Person"


def test_a_record_that_exists_is_refused_before_any_voltage(module, tmp_path, capsys):
    path = description(module, tmp_path, safety=None)
    (tmp_path / "r.nc").write_text("a record")
    with pytest.raises(SystemExit):
        drive(path, tmp_path)
    assert "exists" in capsys.readouterr().err
    assert not module.history
    assert (tmp_path / "r.nc").read_text() == "a record"


def test_undescribed_addresses_between_registers_do_not_stop_a_start(module, tmp_path):
    module.only = {0, 1, 5}  # reading any other address is refused
    target = module.description()
    index = replace(target["displacement"], name="device_index", address=5, table="holding")
    target = replace(target, registers=dict(target.registers) | {"device_index": index})
    module.index = 65530
    settings = replace(SETTINGS, mode="polled", ramp_rate=50.0, paced=False)
    record = acquire(target, np.full(20, 1.0), tmp_path / "a.partial", settings).record
    assert record.sizes["time"] == 20
    assert np.array_equal(np.diff(record.device_index), np.ones(19)), "a 16-bit index wraps"
