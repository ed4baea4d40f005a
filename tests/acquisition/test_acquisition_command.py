"""The command lines of bench and acquisition, and the stage of the workflow."""

import json
import os
import pty
import re
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from rich.console import Console

from dea import store
from dea.acquisition import AcquisitionSettings, latch, watched
from dea.acquisition import acquire as drive_device
from dea.acquisition.__main__ import _plain, main
from dea.acquisition.command_line import typed
from dea.acquisition.display import SHOWN, Display, health
from dea.acquisition.link_log import LinkLog
from dea.acquisition.partial import PartialFile
from dea.acquisition.samples import DrivenSamples, Quality
from dea.acquisition.watched import acquire_watched
from dea.bench.__main__ import main as serve
from dea.configuration.bench import read_bench
from dea.errors import InputError
from dea.modbus import read_device
from dea.plant import ServedRig
from dea.progress import tell
from dea.stages.acquire import acquire
from dea.stages.driving import excitation

ROOT = Path(__file__).parents[2]
DEVICE = ROOT / "config/devices/virtual_bench.yaml"


def words_to_drive(bench, output):
    return ["drive", "--device", str(DEVICE), "--port", str(bench.endpoint.port),
            "--duration", "6", "--ramp-rate", "20", "--output", str(output)]  # fmt: skip


def drive(bench, output, *options):
    main([*words_to_drive(bench, output), *options])


@pytest.mark.parametrize("options", [[], ["--live"]])
def test_drive_writes_a_record_and_its_link(serve_bench, tmp_path, capfd, options):
    bench, output = serve_bench(), tmp_path / "record.nc"
    drive(bench, output, *options)
    record = store.read(output)
    index = record.device_index.values
    assert np.array_equal(record.displacement_counts, bench.displacement[index])
    assert record.attrs["device_description"] == DEVICE.read_text()
    made_by = json.loads(record.attrs["settings"])
    assert made_by["acquisition"]["mode"] == "buffered"
    assert made_by["acquisition"]["ramp_rate"] == 20.0
    assert made_by["excitation"] | {"kind": "gaussian", "duration": 6.0} == made_by["excitation"]
    assert record.attrs["seed"] == "0"
    link = store.read(tmp_path / "record_link.nc", "link")
    assert int(link.samples.sum()) >= index.size
    assert int(link.round_trip_count.sum()) == link.sizes["exchange"]
    assert [p.name for p in tmp_path.glob("*.partial")] == []
    shown = capfd.readouterr().err
    assert "samples" in shown
    assert "no errors" in shown
    assert ("output in V" in shown) == bool(options)


def test_a_record_keeps_the_description_that_the_device_was_driven_with(
    serve_bench, tmp_path, monkeypatch
):
    bench, output, edited = serve_bench(), tmp_path / "record.nc", tmp_path / "device.yaml"
    edited.write_text(DEVICE.read_text())
    acquired = watched.acquire

    def edit_meanwhile(*given, **named):
        found = acquired(*given, **named)
        edited.write_text(DEVICE.read_text() + "\n# edited\n")
        return found

    monkeypatch.setattr(watched, "acquire", edit_meanwhile)
    drive(bench, output, "--device", str(edited))
    for file in (output, tmp_path / "record_link.nc"):
        attributes = store.read(file).attrs
        assert attributes["device_description"] == DEVICE.read_text()
    assert store.read(output).attrs["sha256_device"] == store.sha256(DEVICE)


def test_check_prints_what_the_device_says(serve_bench, capsys):
    bench = serve_bench()
    main(["check", "--device", str(DEVICE), "--port", str(bench.endpoint.port)])
    shown = capsys.readouterr().out
    assert re.search(r"identity +dea-bench", shown)
    assert re.search(r"output_range_high +15 V", shown)
    assert re.search(r"device_rate +50 Hz", shown)
    assert shown.endswith(f"virtual bench agrees with its description, {DEVICE}\n")
    assert "OUTSIDE" not in shown
    assert not bench.applied.any()


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (100000.0, "100000"), (7, "7"), (0.25, "0.25"), ("dea-bench", "dea-bench"),
        ([1.0, 0.5], "[1, 0.5]"),
    ],
)  # fmt: skip
def test_whole_numbers_are_printed_as_such(value, shown):
    assert _plain(value) == shown


def test_an_output_beyond_its_limits_is_remarked(module, tmp_path, capsys):
    file = tmp_path / "mine.yaml"
    described = yaml.safe_load((ROOT / "config/devices/analogue_module.yaml").read_text())
    described["endpoint"]["port"] = module.port
    described["registers"]["output"]["access"] = "read_write"
    described["registers"]["levels"] = {"address": 20, "count": 3, "offset": 0.5}
    file.write_text(yaml.safe_dump(described))
    module._write(32768)
    main(["check", "--device", str(file)])
    shown = capsys.readouterr().out
    assert re.search(r"levels +\[0\.5, 0\.5, 0\.5\]\n", shown)
    assert re.search(r"output +5\.00\d* V  OUTSIDE its limits, 0 to 3.76 V: `zero` takes it", shown)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"endpoint": {"host": "nowhere.invalid", "port": 502}},
         "mine.yaml: endpoint: analogue module at nowhere.invalid:502 does not answer: unknown host"
         " 'nowhere.invalid'. Correct host and port"),
        ({}, "mine.yaml: unit_id, registers.output: the device does not answer as described: the"
         " device refused function 3 with Modbus exception 11 (the gateway's target failed to"
         " respond: is unit_id wrong?). Correct the unit id"),
    ],
)  # fmt: skip
def test_a_check_that_fails_names_the_description(module, tmp_path, capsys, changes, message):
    file = tmp_path / "mine.yaml"
    described = yaml.safe_load((ROOT / "config/devices/analogue_module.yaml").read_text())
    described["endpoint"]["port"] = module.port
    file.write_text(yaml.safe_dump(described | changes, sort_keys=False))
    module.refuse_with = 11
    with pytest.raises(SystemExit) as caught:
        main(["check", "--device", str(file)])
    assert caught.value.code == 2
    assert message in capsys.readouterr().err


def test_a_wrong_voltage_is_an_error_without_a_traceback(serve_bench, tmp_path, capsys):
    bench = serve_bench()
    with pytest.raises(SystemExit) as caught:
        drive(bench, tmp_path / "record.nc", "--high", "9")
    assert caught.value.code == 2
    message = capsys.readouterr().err
    assert "virtual_bench.yaml: registers.output.limits: sample" in message
    assert "Traceback" not in message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--seed", "-1"], "seed: it is -1. Give a whole number of at least 0"),
        (
            ["--duration", "1e12"],
            "duration: it is 1000000000000.0. Give a number above 0 and up to",
        ),
        (
            ["--duration", "2.1e6"],
            "duration: it is 2100000.0. Give a number above 0 and up to 2e+06",
        ),
        (["--duration", "nan"], "duration: it is nan. Give a number above 0 and up to"),
        (["--low", "nan"], "low: it is nan. Give a number"),
        (["--low", "4"], "low: 4 is not below high, 3.75"),
        (["--setting", "[1]"], "setting: it is [1]. Give a mapping"),
        (["--setting", '{"duration": 3}'], "setting.duration: it has an option of its own"),
        (["--setting", '{"bnad": 3}'], "bnad: unknown key 'bnad'. Did you mean 'band'?"),
        (["--setting", '{"band": "x"}'], "band: it is 'x'. Give a number above 0 Hz"),
        (
            ["--kind", "staircase", "--setting", '{"levels": 1}'],
            "levels: it is 1. Give a whole number of at least 2",
        ),
        (["--port", "70000"], "port: it is 70000. Give a whole number from 0 to 65535"),
    ],
)
def test_a_wrong_option_is_an_error_of_one_line(tmp_path, capsys, options, message):
    output = tmp_path / "record.nc"
    with pytest.raises(SystemExit) as ended:
        main(["drive", "--device", str(DEVICE), "--dry-run", "--output", str(output), *options])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {message}"), said
    assert said.count("\n") == 1


def test_a_number_of_a_setting_may_be_text(tmp_path, capsys):
    words = ["drive", "--device", str(DEVICE), "--dry-run", "--output", str(tmp_path / "record.nc")]
    main([*words, "--setting", '{"band": 2.0}'])
    shown = capsys.readouterr().out
    main([*words, "--setting", '{"band": "2.0"}'])
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("share", ["nan", "0", "5"])
def test_a_share_that_is_none_commissions_nothing(tmp_path, capsys, share):
    with pytest.raises(SystemExit) as ended:
        main(["commission", "--device", str(DEVICE), "--share", share])
    assert ended.value.code == 2
    assert f"error: share: it is {float(share)}. Give a number above 0" in capsys.readouterr().err


def test_a_broken_acquisition_is_rescued_with_its_flags(serve_bench, tmp_path, capsys):
    bench, output = serve_bench(ring_length=200, fifo_length=512), tmp_path / "record.nc"
    with pytest.raises(SystemExit) as caught:  # the ring is too short for the samples waiting
        drive(bench, output)
    assert caught.value.code == 1
    assert "overwritten before they were read" in capsys.readouterr().err
    assert not output.exists()
    recover = [
        "recover",
        str(tmp_path / "record.partial"),
        "--output",
        str(tmp_path / "rescued.nc"),
    ]
    with pytest.raises(SystemExit):
        main([*recover, "--device", str(DEVICE.with_name("analogue_module.yaml"))])
    assert "recorded from 'virtual bench'" in capsys.readouterr().err
    assert not (tmp_path / "rescued.nc").exists()
    main([*recover, "--device", str(DEVICE)])
    shown = capsys.readouterr().out
    assert "flagged" in shown
    assert "damaged" not in shown
    assert "overwritten before they were read" in shown
    rescued = store.read(tmp_path / "rescued.nc", "record")
    lost = rescued.quality.values == Quality.LOST
    assert lost.any()
    assert np.isnan(rescued.displacement.values[lost]).all()
    index = rescued.device_index.values[~lost]
    assert np.array_equal(rescued.displacement_counts.values[~lost], bench.displacement[index])


def test_what_was_held_beside_the_plan_is_no_sample_of_it(tmp_path, capsys):
    partial = tmp_path / "record.partial"
    held = samples(5)._replace(
        position=np.array([0, 1, 1, 1, 2]),
        quality=np.array([0, 0, 1, 1, 0]),
        displacement=np.arange(100, 105),
    )
    with PartialFile(partial, {"device": "virtual bench", "lead": 0, "length": 4}) as file:
        file.samples(held)
    main(["recover", str(partial), "--output", str(tmp_path / "r.nc"), "--device", str(DEVICE)])
    assert "3 of 4 samples, 2 flagged" in capsys.readouterr().out


def left_behind(bench, folder, **settings):
    """Leave a partial file; return its record, and the description, a file of its own."""
    described = folder / "device.yaml"
    described.write_text(DEVICE.read_text())
    device = read_device(described).at(port=bench.endpoint.port)
    volts = 2.4 + 1.2 * np.sin(np.arange(300) * 0.1)
    settings = AcquisitionSettings(ramp_rate=20.0, **settings)
    return drive_device(device, volts, folder / "record.partial", settings).record, described


def test_a_file_is_rescued_by_the_description_that_it_was_recorded_with(
    serve_bench, tmp_path, capsys
):
    whole, described = left_behind(serve_bench(), tmp_path)
    edited = yaml.safe_load(described.read_text())
    edited["registers"]["displacement"]["range"][1] *= 2
    described.write_text(yaml.safe_dump(edited))
    recover = ["recover", str(tmp_path / "record.partial"), "--output", str(tmp_path / "r.nc")]
    with pytest.raises(SystemExit) as caught:
        main([*recover, "--device", str(described)])
    assert caught.value.code == 2
    assert "another description than" in capsys.readouterr().err
    main(recover)
    rescued = store.read(tmp_path / "r.nc", "record")
    np.testing.assert_array_equal(rescued.displacement, whole.displacement)
    np.testing.assert_array_equal(rescued.voltage, whole.voltage)
    assert rescued.attrs["device_description"] == DEVICE.read_text()
    assert rescued.attrs["sha256_device"] == store.sha256(DEVICE)
    assert "registers" not in rescued.attrs["notes"]
    assert json.loads(rescued.attrs["settings"])["acquisition"]["ramp_rate"] == 20.0


@pytest.mark.parametrize(("tolerance", "flagged"), [(0.01, True), (0.05, False)])
def test_a_file_is_rescued_with_the_flags_of_the_clock(
    serve_bench, clock_off, tmp_path, tolerance, flagged
):
    whole, _ = left_behind(serve_bench(), tmp_path, clock_tolerance=tolerance)
    main(["recover", str(tmp_path / "record.partial"), "--output", str(tmp_path / "r.nc")])
    rescued = store.read(tmp_path / "r.nc", "record")
    np.testing.assert_array_equal(rescued.quality, whole.quality)
    assert bool((rescued.quality & Quality.CLOCK).all()) == flagged


def test_a_file_without_a_description_asks_for_one(tmp_path, capsys):
    partial = tmp_path / "record.partial"
    with PartialFile(partial, {"device": "virtual bench", "lead": 0, "length": 4}) as file:
        file.samples(samples(5))
    with pytest.raises(SystemExit):
        main(["recover", str(partial), "--output", str(tmp_path / "r.nc")])
    assert "holds no description of its device. Give the one" in capsys.readouterr().err


def test_recover_overwrites_nothing(serve_bench, tmp_path, capsys):
    partial, kept = tmp_path / "record.partial", tmp_path / "rescued.nc"
    partial.write_bytes(b"")
    kept.write_text("a record")
    with pytest.raises(SystemExit) as caught:
        main(["recover", str(partial), "--output", str(kept), "--device", str(DEVICE)])
    assert caught.value.code == 2
    assert "rescued.nc: exists" in capsys.readouterr().err
    assert kept.read_text() == "a record"


def test_a_file_that_was_made_meanwhile_is_not_overwritten(
    serve_bench, tmp_path, capsys, monkeypatch
):
    bench, output = serve_bench(), tmp_path / "record.nc"
    link = tmp_path / "record_link.nc"

    def meanwhile(*given, **named):
        acquired = acquire_watched(*given, **named)
        link.write_text("of another run")
        return acquired

    monkeypatch.setattr("dea.acquisition.__main__.acquire_watched", meanwhile)
    with pytest.raises(SystemExit):
        drive(bench, output)
    said = capsys.readouterr().err
    assert "record_link.nc: exists" in said
    assert "record.partial" in said
    assert link.read_text() == "of another run"
    assert not output.exists()
    main(["recover", str(tmp_path / "record.partial"), "--output", str(output),
          "--device", str(DEVICE)])  # fmt: skip
    assert not store.read(output, "record").quality.any()


def test_a_disk_that_is_full_at_the_end_is_named_with_what_it_holds(
    serve_bench, tmp_path, capsys, monkeypatch
):
    def full(*_, **__):
        raise RuntimeError("NetCDF: HDF error")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", full)
    with pytest.raises(SystemExit) as caught:
        drive(serve_bench(), tmp_path / "record.nc")
    assert caught.value.code == 1
    *_, said = capsys.readouterr().err.splitlines()
    assert re.search(r"record_link\.nc: cannot be written .*: the disk has \d+ MB left", said)
    assert f"Every sample is in {tmp_path / 'record.partial'}: recover it." in said
    assert [path.name for path in tmp_path.iterdir()] == ["record.partial"]


def test_a_record_whose_clock_is_off_is_kept_with_exit_status_1(
    serve_bench, clock_off, tmp_path, capsys
):
    with pytest.raises(SystemExit) as caught:
        drive(serve_bench(), tmp_path / "record.nc")
    assert caught.value.code == 1
    said = capsys.readouterr().err
    assert "51 Hz" in said
    assert "record.nc is kept, and no sample of it is good" in said
    assert (store.read(tmp_path / "record.nc").quality & Quality.CLOCK).all()


def test_another_runs_link_file_is_refused_before_any_voltage(serve_bench, tmp_path, capsys):
    bench = serve_bench()
    (tmp_path / "record_link.nc").write_text("of another run")
    with pytest.raises(SystemExit):
        drive(bench, tmp_path / "record.nc")
    assert "record_link.nc: exists" in capsys.readouterr().err
    assert not bench.applied.any()


def samples(size):
    steps = np.arange(size)
    return DrivenSamples(steps, steps, steps, steps * 10, steps * 20, steps * 0, steps, steps)


def test_the_display_shows_rate_round_trips_and_errors():
    log = LinkLog()
    log.send_time, log.receive_time = [0.0, 1.0], [0.002, 1.008]
    log.errors["no reply"] += 3
    assert health(50.0, log) == "50/s  round trip 5.0 ms, worst 8.0  3 no reply"
    assert health(0.0, LinkLog()).endswith("no errors")
    console = Console(record=True, width=100, height=40, file=open(os.devnull, "w"))  # noqa: SIM115
    with Display(read_device(DEVICE), 100, live=True, console=console) as display:
        display(samples(100), log)
    shown = console.export_text(clear=False)
    assert "displacement in mm" in shown
    assert "100/100 samples" in shown
    console.export_text(clear=True)
    with Display(read_device(DEVICE), 100, console=console):
        pass
    assert not console.export_text().strip(), "nothing is drawn of a device that was refused"


@pytest.mark.parametrize("words", [["status"], ["zero"], ["acknowledge", "--by", "A. Person"],
                                   ["dismiss", "--amplifier-is-off"]])  # fmt: skip
def test_nothing_is_said_of_a_host_that_is_not_known(capsys, words):
    with pytest.raises(SystemExit) as exit_:
        main([*words, "--device", str(DEVICE), "--host", "nowhere.invalid"])
    assert exit_.value.code == 2
    told = capsys.readouterr()
    assert not told.out
    assert "endpoint.host: the host 'nowhere.invalid' is not known now" in told.err


@pytest.mark.parametrize("words", [["status"], ["zero"], ["acknowledge", "--by", "A. Person"],
                                   ["dismiss", "--amplifier-is-off"],
                                   ["commission", "--arm", "A. Person"]])  # fmt: skip
def test_what_is_done_to_an_output_must_say_to_which(capsys, words):
    """With the bench as the default, an amplifier would stay on after ``zero``."""
    with pytest.raises(SystemExit) as exit_:
        main(words)
    assert exit_.value.code == 2
    told = capsys.readouterr()
    assert not told.out
    assert "--device: it says which output is meant, and is missing" in told.err


def test_a_command_in_a_message_means_the_device_of_the_message():
    device = read_device(DEVICE)
    assert typed("zero", device).endswith(f"acquisition zero --device {DEVICE}")
    assert typed("zero", device.at(device.host, device.port)) == typed("zero", device)
    moved = typed("zero", device.at("amplifier", 1502))
    assert moved.endswith(f"--device {DEVICE} --host amplifier --port 1502")


@contextmanager
def unread(kind):
    """Have a standard error whose reader has gone."""
    reader, writer = os.pipe() if kind == "pipe" else pty.openpty()
    os.close(reader)
    before, sys.stderr = sys.stderr, os.fdopen(writer, "w", buffering=1)
    try:
        yield sys.stderr
    finally:
        gone, sys.stderr = sys.stderr, before
        with suppress(OSError):
            gone.close()


@pytest.mark.parametrize("kind", ["pipe", "terminal"])
def test_a_closed_terminal_costs_no_record(serve_bench, tmp_path, capfd, kind):
    bench, output = serve_bench(), tmp_path / "record.nc"
    with unread(kind) as stream:
        drive(bench, output)
        assert sys.stderr is stream
    assert not store.read(output).quality.any()
    assert not list(tmp_path.glob("*.partial"))
    os.write(1, b"standard output is as it was")
    assert capfd.readouterr().out.endswith("standard output is as it was")


def test_a_program_without_standard_error_drives(serve_bench, tmp_path):
    words = words_to_drive(serve_bench(), tmp_path / "record.nc")
    command = ["sh", "-c", 'exec "$0" "$@" 2>&-', sys.executable, "-m", "dea.acquisition", *words]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout
    assert not store.read(tmp_path / "record.nc").quality.any()


@pytest.mark.parametrize("kind", ["pipe", "terminal"])
def test_zero_is_reached_though_nobody_reads_what_is_told(monkeypatch, capsys, kind):
    monkeypatch.setattr("dea.acquisition.by_hand.zero", lambda *_: tell("on its way") or "0 V")
    with unread(kind):
        main(["zero", "--device", str(DEVICE)])
    assert capsys.readouterr().out == "0 V\n"


BENCH = ROOT / "config/bench.yaml"


def settings(**changes):
    return {
        "seed": 1, "system": "dea1", "excitation_name": "record",
        "excitation": {"kind": "gaussian", "duration": 20, "low": 1.1, "high": 3.75},
        "acquisition": {"mode": "buffered", "ramp_rate": 5.0},
        "bench": {"actuator": "dea1", "config": str(BENCH), "watchdog_time": 20.0,
                  "plant": read_bench(BENCH).actuators["dea1"].model_dump()},
    } | changes  # fmt: skip


def test_the_stage_writes_the_same_bytes_twice(tmp_path):
    for name in ("a", "b"):
        acquire(settings(), DEVICE, tmp_path / name / "record.nc", tmp_path / name / "link.nc")
    records = [(tmp_path / name / "record.nc").read_bytes() for name in ("a", "b")]
    assert records[0] == records[1]
    record = store.read(tmp_path / "a/record.nc")
    assert record.sizes["time"] == 1000
    assert not record.quality.any()
    assert float(record.displacement.std()) / float(record.voltage.std()) * 1e2 > 0.2
    device = read_device(DEVICE)
    own, other = (excitation(settings(system=name), device).volts for name in ("dea1", "dea2"))
    np.testing.assert_allclose(record.voltage, own, atol=1e-3)
    assert not np.array_equal(own, other)


@pytest.mark.parametrize("high", [3.9, 16.0])
def test_the_stage_names_the_config_key_of_a_voltage_too_high(tmp_path, high):
    excitation = {"kind": "binary", "duration": 20, "low": 1.1, "high": high}
    with pytest.raises(InputError, match=f"asks for {high:g} V, outside 0 to 3.76 V") as caught:
        acquire(settings(excitation=excitation), DEVICE, tmp_path / "record.nc", tmp_path / "l.nc")
    assert caught.value.file == "config/config.yaml"
    assert caught.value.field == "excitation.record.low, high"
    assert "registers.output.limits" in caught.value.remedy


def bench_process(*options):
    return subprocess.Popen(
        [sys.executable, "-m", "dea.bench", *options], cwd=ROOT, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def test_the_bench_warns_where_it_listens_to_the_network():
    with bench_process("--actuator", "dea1", "--host", "0.0.0.0", "--port", "0",
                       "--until-stdin-closes") as process:  # fmt: skip
        assert json.loads(process.stdout.readline())["host"] == "0.0.0.0"
        _, complaint = process.communicate()
    assert "warning: 0.0.0.0 can be reached from the network" in complaint


def description(folder, **changes):
    """A file that describes the bench with changes."""
    path = folder / "device.yaml"
    path.write_text(yaml.safe_dump(yaml.safe_load(DEVICE.read_text()) | changes))
    return str(path)


def without(name):
    registers = dict(yaml.safe_load(DEVICE.read_text())["registers"])
    del registers[name]
    return registers


@pytest.mark.parametrize(
    ("actuator", "changes", "options", "message"),
    [
        ("nobody", {}, [], "there is no actuator 'nobody'"),
        ("dea1", {"sampling_rate": 100}, [], "sampling_rate: 100 Hz. The bench samples at 50 Hz"),
        ("dea1", {"registers": without("block_crc")}, [], "no register 'block_crc'"),
        ("dea1", {"registers": without("boot")}, [], "no register 'boot'"),
        ("dea1", {"registers": without("boot") | {"boot": {"address": 17}}}, [],
         "device.yaml: registers.boot: "),
        ("dea1", {"registers": without("identity")
                  | {"identity": {"address": 0, "type": "string", "count": 4}}}, [],
         "device.yaml: registers.identity: 'dea-bench' is longer than the 8 characters held"),
        ("dea1", {"framing": "serial", "serial": {"port": "x"}}, [], "cannot be reached by serial"),
        ("dea1", {}, ["--port", "70000"], "port: it is 70000. Give a whole number from 0 to 65535"),
        ("dea1", {}, ["--seed", "-1"], "seed: it is -1. Give a whole number of at least 0"),
        ("dea1", {}, ["--watchdog", "nan"], "watchdog_time: it is nan. Give a number above 0 s"),
        ("dea1", {"framing": "tls"}, [], "Give --tls-certificate and --tls-key"),
        ("dea1", {"framing": "tls"}, ["--tls-certificate", "missing.pem"], "missing.pem"),
    ],
)  # fmt: skip
def test_the_bench_says_what_is_wrong(tmp_path, capsys, actuator, changes, options, message):
    with pytest.raises(SystemExit) as caught:
        serve(["--actuator", actuator, "--config", str(ROOT / "config/bench.yaml"),
               "--device", description(tmp_path, **changes), *options])  # fmt: skip
    assert caught.value.code == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert not shown.out


def test_the_truth_of_a_trial_is_written_whole_also_into_a_new_folder(tmp_path, monkeypatch):
    rig = ServedRig.__new__(ServedRig)
    rig._pieces = [np.arange(3.0), np.ones(2)]
    server = SimpleNamespace(
        host="127.0.0.1", device=SimpleNamespace(player=SimpleNamespace(plant=rig))
    )
    monkeypatch.setattr("dea.bench.__main__._server", lambda _: server)
    monkeypatch.setattr("dea.bench.__main__._run", lambda *_: None)
    monkeypatch.setattr("asyncio.run", lambda _: None)
    truth = tmp_path / "new" / "0001.npy"
    serve(["--trial", "sealed.json", "--truth", str(truth)])
    assert np.load(truth).tolist() == [0.0, 1.0, 2.0, 1.0, 1.0]
    assert list(truth.parent.iterdir()) == [truth]


def test_the_display_keeps_the_last_seconds_alone():
    device = read_device(DEVICE)
    second = round(device.sampling_rate)
    console = Console(width=100, height=40, file=open(os.devnull, "w"))  # noqa: SIM115
    with Display(device, 3 * SHOWN * second, live=True, console=console) as display:
        for begun in range(3 * int(SHOWN)):
            drawn = samples(second)
            index = begun * second + drawn.device_index
            display(drawn._replace(device_index=index), LinkLog())
        times = np.concatenate([signals[0] for signals in display._signals])
    assert times[-1] == pytest.approx(3 * SHOWN, abs=1.0)
    assert SHOWN <= times[-1] - times[0] <= SHOWN + 1.0  # pieces of a second are kept whole


@pytest.mark.parametrize(
    ("reason", "told"),
    [(None, "nothing has tripped"), ("too much current", "acknowledged: too much current")],
)
def test_what_was_acknowledged_is_told(monkeypatch, capsys, reason, told):
    monkeypatch.setattr(latch, "acknowledge", lambda device, by: reason)
    main(["acknowledge", "--device", str(DEVICE), "--by", "A. Person"])
    assert capsys.readouterr().out.strip() == told
