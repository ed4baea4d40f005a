"""Recording hardware into ``records/``, with the bench in the place of the device."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from dea import archive, store
from dea.acquisition import ZeroNotVerifiedError
from dea.acquisition.commissioned import write_report
from dea.errors import InputError
from dea.modbus import read_device
from dea.stages.record import main
from dea.stages.take_record import take_record

ROOT = Path(__file__).parents[2]


@pytest.fixture
def study(tmp_path, monkeypatch, serve_bench):
    """A study of one actuator, film1, whose device is a served bench."""
    bench = serve_bench()
    shutil.copytree(ROOT / "config", tmp_path / "config")
    device = tmp_path / "config/devices/mine.yaml"
    description = yaml.safe_load((device.parent / "virtual_bench.yaml").read_text())
    description["endpoint"] = {"host": "127.0.0.1", "port": bench.endpoint.port}
    device.write_text(yaml.safe_dump(description))
    file = tmp_path / "config/config.yaml"
    config = yaml.safe_load(file.read_text())
    config["actuators"] = [
        {"name": "film1", "device": "config/devices/mine.yaml"},
        {"name": "dea1", "device": "config/devices/mine.yaml", "bench": "dea1"},
    ]
    # The small study's sections suit a short record.
    small = yaml.safe_load((ROOT / "tests/workflow/small.yaml").read_text())
    for name, changed in small.pop("excitation").items():
        config["excitation"][name] |= changed
    for name in small.keys() - {"actuators"}:
        config[name] |= small[name]
    config["acquisition"]["ramp_rate"] = 20.0
    file.write_text(yaml.safe_dump(config))
    monkeypatch.chdir(tmp_path)
    return bench


def test_a_record_is_kept_with_what_made_it(study, capsys, tmp_path):
    main(["film1", "--operator", "A. Volta"])
    folder = Path(capsys.readouterr().out.strip())
    content = archive.check(folder)
    assert content["operator"] == "A. Volta"
    assert content["settings"]["excitation"]["duration"] == 150
    assert {"record.nc", "link.nc", "device.yaml", "config.yaml"} == set(content["files"])
    record = store.read(folder / "record.nc")
    index = record.device_index.values
    assert np.array_equal(record.displacement_counts, study.displacement[index])
    take_record({}, folder / archive.MANIFEST, tmp_path / "r.nc", tmp_path / "l.nc")
    assert (tmp_path / "r.nc").read_bytes() == (folder / "record.nc").read_bytes()


def guard(tmp_path):
    """Give the device a safety section, and a report that it was commissioned as it is."""
    device = tmp_path / "config/devices/mine.yaml"
    description = yaml.safe_load(device.read_text())
    device.write_text(yaml.safe_dump(description | {"safety": {"max_rate": 100.0}}))
    write_report(read_device(device), {"device": "virtual bench"})


def test_high_voltage_is_armed_in_so_many_words(study, capsys, tmp_path):
    guard(tmp_path)
    for words in (["film1"], ["film1", "--operator", " "]):
        with pytest.raises(SystemExit) as exit_:
            main(words)
        assert exit_.value.code == 2
        message = capsys.readouterr().err
        assert "nobody has armed the high voltage" in message
        assert "OPERATOR=NAME" in message
        assert message.count("\n") == 1
    assert not Path("records").exists()
    assert not study.displacement.size


@pytest.mark.parametrize("words", [["--operator", "A. Volta"], []])
def test_who_armed_stands_in_record_and_manifest(study, capsys, tmp_path, words):
    guard(tmp_path)
    file = tmp_path / "config/config.yaml"
    config = yaml.safe_load(file.read_text())
    config["acquisition"]["armed_by"] = "L. Galvani"
    file.write_text(yaml.safe_dump(config))
    main(["film1", *words])
    folder = Path(capsys.readouterr().out.strip())
    name = words[-1] if words else "L. Galvani"
    assert archive.manifest(folder)["operator"] == name
    assert store.read(folder / "record.nc").attrs["armed_by"] == name


def test_a_start_that_is_refused_leaves_no_folder(study, capsys, tmp_path):
    guard(tmp_path)
    (tmp_path / "config/devices/mine.commissioned.json").unlink()
    with pytest.raises(SystemExit) as exit_:
        main(["film1", "--operator", "A. Volta"])
    assert exit_.value.code == 2
    assert "not commissioned" in capsys.readouterr().err
    assert not list(Path("records").glob("*"))


def test_a_record_whose_clock_is_off_is_kept_and_said_to_be_useless(study, clock_off, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(["film1"])
    assert exit_.value.code == 1
    (folder,) = Path("records/film1").iterdir()
    *_, counts, clock, kept = capsys.readouterr().err.strip().splitlines()
    assert counts == "7500 samples: 0 good, 7500 clock"
    for words in (
        "51 Hz",
        "50 Hz",
        "2.00%",
        "1.00%",
        "config/devices/mine.yaml",
        "record it again",
    ):
        assert words in clock
    assert str(folder) in kept
    content = archive.check(folder)
    assert content["flagged"] == {"clock": 7500}
    assert content["fault"] == clock
    with pytest.raises(InputError, match=r"r\.nc: quality: 7500 of 7500 .*\(clock 7500\)"):
        take(folder)


def take(folder):
    """Return what the study makes of a record."""
    taken = folder.parents[2] / "r.nc"
    take_record({}, folder / archive.MANIFEST, taken, taken.with_name("l.nc"))
    return store.signals(store.read(taken))


def test_a_record_says_what_was_flagged(study, capsys):
    main(["film1"])
    told = capsys.readouterr()
    assert "7500 samples: 7500 good" in told.err
    content = archive.manifest(Path(told.out.strip()))
    assert (content["samples"], content["flagged"]) == (7500, {})
    assert "fault" not in content


def test_a_failed_record_keeps_its_samples_and_gets_no_name(study, capsys, monkeypatch):
    def full(*_, **__):
        raise OSError("No space left on device")

    monkeypatch.setattr("dea.stages.record.write", full)
    with pytest.raises(SystemExit) as exit_:
        main(["film1"])
    assert exit_.value.code == 1
    said = capsys.readouterr().err
    (folder,) = Path("records/film1").iterdir()
    assert f"No space left on device. Every sample is in {folder}/samples.partial" in said
    assert folder.name.endswith(".partial")
    assert (folder / "samples.partial").stat().st_size > 150 * 50


def test_an_account_without_a_name_keeps_its_records(study, capsys, monkeypatch):
    def nameless():
        raise KeyError("getpwuid(): uid not found: 4711")

    monkeypatch.setattr("getpass.getuser", nameless)
    main(["film1"])
    content = archive.check(Path(capsys.readouterr().out.strip()))
    assert content["operator"] == f"user {os.getuid()}"


def test_an_output_that_is_not_shown_to_be_at_zero_is_told_apart(study, capsys, monkeypatch):
    def stuck(*_, **__):
        error = ZeroNotVerifiedError("the output reads 2 V after the ramp to zero.")
        error.add_note("Its samples are kept.")
        raise error

    monkeypatch.setattr("dea.acquisition.acquire_watched", stuck)
    with pytest.raises(SystemExit) as exit_:
        main(["film1"])
    assert exit_.value.code == 3
    said = capsys.readouterr().err
    assert "DANGER: the output reads 2 V after the ramp to zero. Its samples are kept." in said


@pytest.mark.parametrize(
    ("name", "said"),
    [("film2", "Did you mean 'film1'?"), ("dea1", "the study acquires it by itself")],
)
def test_an_actuator_that_cannot_be_recorded_is_named(study, capsys, name, said):
    with pytest.raises(SystemExit) as exit_:
        main([name])
    assert exit_.value.code == 2
    assert said in capsys.readouterr().err
    assert not Path("records").exists()


def test_a_changed_record_is_not_taken_into_the_study(study, capsys, tmp_path):
    main(["film1"])
    folder = Path(capsys.readouterr().out.strip())
    folder.chmod(0o755)
    manifest = json.loads((folder / archive.MANIFEST).read_text())
    (folder / "record.nc").chmod(0o644)
    (folder / "record.nc").write_bytes((folder / "record.nc").read_bytes()[:-1])
    assert manifest["files"]["record.nc"]
    with pytest.raises(ValueError, match=r"record\.nc: is not what was recorded"):
        take_record({}, folder / archive.MANIFEST, tmp_path / "r.nc", tmp_path / "l.nc")
    assert not (tmp_path / "r.nc").exists()


def test_an_excitation_that_is_none_is_told_in_one_line(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["film1", "--excitation", "probe"])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said == (
        "error: EXCITATION: there is no excitation 'probe'. Did you mean 'probed'?"
        " Use one of record, second, probed\n"
    )
