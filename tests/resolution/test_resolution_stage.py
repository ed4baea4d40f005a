"""The command: records by hand for a case, and driven ones for an actuator."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr
import yaml
from made_devices import INTERVAL, LIMITS, as_record, hidden
from made_outcomes import resolution_of

import made_carriage
from dea import archive, modbus, store
from dea.configuration.bench import BENCH, read_bench
from dea.configuration.files import read_yaml
from dea.configuration.study import check_study
from dea.discrepancy import Samples, read_verdict
from dea.errors import DeviceError, InputError
from dea.resolution import CERTIFICATE, Design, ResolutionOutcome, allowed_by_device
from dea.simulation import catalogue, load_extended, load_simulation, measured_scales, prepared
from dea.stages.driven import Driven
from dea.stages.resolve import main, resolve

pytestmark = pytest.mark.usefixtures("few_excitations")

ROOT = Path(__file__).parents[2]
COLUMNS = {
    "sampling_interval": INTERVAL,
    "input": {"column": "u", "units": "V"},
    "output": {"column": "y", "units": "V"},
}
DEVICE = hidden("transport_delay", [0.15])


def kept(folder, name, u, seed, device=DEVICE):
    """Record the device by hand, as a file beside the case and as the workflow imports it."""
    record = device(u, seed)
    for variable in ("input", "output"):
        record[variable].attrs["long_name"] = variable
    record["time"].attrs["long_name"] = "time"
    store.write(record, folder / f"{name}.nc", title=name)
    return {"file": f"data/{name}.csv", **COLUMNS}


@pytest.fixture
def case(tmp_path, monkeypatch):
    """A study whose case is a carriage that no program drives; returns the file of the case."""
    shutil.copytree(ROOT / "config", tmp_path / "config")
    shutil.copy(made_carriage.__file__, tmp_path / "carriage.py")
    monkeypatch.chdir(tmp_path)
    study = yaml.safe_load(Path("config/config.yaml").read_text())
    budget = {"finished": 6, "beam": 2, "effects": 1, "starts": 2, "shakes": 0, "restarted": 0}
    study["discrepancy"] |= {
        "effects": ["sensor_lag", "transport_delay", "electrode_lag"],
        "warm_up": 0.0,
        "budget": budget,
    }
    study["resolution"] = {"duration": 20.0, "rate": 20.0, "output_margin": 5.0}
    Path("config/config.yaml").write_text(yaml.safe_dump(study))
    t = np.arange(1500) * INTERVAL
    u = 0.3 * np.sin(2 * np.pi * 0.5 * t) + 0.1 * np.sin(2 * np.pi * 0.8 * t)
    file = Path("config/cases/carriage.yaml")
    file.write_text(
        yaml.safe_dump(
            {
                "title": "A carriage",
                "record": kept(Path("results/carriage"), "record", u, 0),
                "simulation": "carriage.py",
            }
        )
    )
    return file


def hand_in(file, key, u, seed, device=DEVICE):
    content = yaml.safe_load(file.read_text())
    record = kept(Path("results/carriage/further"), key, u, seed, device)
    content.setdefault("records", {})[key] = record
    file.write_text(yaml.safe_dump(content))


def other_way_round(u, seed):
    return as_record(u, -DEVICE(u, seed)["output"].values)


@pytest.mark.slow
def test_a_case_is_resolved_by_hand(case, capsys):
    folder = Path("results/resolve/carriage")
    Path("results/MANIFEST.json").touch()
    main(["carriage", "--threads", "1"])
    assert "Next: results/resolve/carriage/next_experiment.md" in capsys.readouterr().out
    page = (folder / "next_experiment.md").read_text()
    for words in ("resolve_1", "transport_delay", "make resolve NAME=carriage", "V/s"):
        assert words in page
    u = np.loadtxt(folder / "next_excitation.csv", delimiter=",", skiprows=1)[:, 1]
    np.testing.assert_array_equal(
        u, np.loadtxt(folder / "round_1/excitation.csv", delimiter=",", skiprows=1)[:, 1]
    )
    first = (folder / "next_excitation.csv").read_bytes()
    hand_in(case, "resolve_1", -u, 1)
    with pytest.raises(InputError, match=r"resolve_1: its input is not the excitation of"):
        resolve("carriage", "me", 1)
    hand_in(case, "resolve_1", u, 1)
    main(["carriage", "--threads", "1"])
    assert (folder / "round_1/excitation.csv").read_bytes() == first
    assert (folder / "round_1/posterior.json").exists()
    assert "resolve_fresh" in (folder / "next_experiment.md").read_text()
    fresh = np.loadtxt(folder / "next_excitation.csv", delimiter=",", skiprows=1)[:, 1]
    hand_in(case, "resolve_fresh", fresh, 2)
    main(["carriage", "--threads", "1"])
    said = capsys.readouterr().out
    assert "decided: 1 designed record," in said
    assert "On a fresh record: error" in said
    assert not (folder / "next_experiment.md").exists()
    found = store.read(folder / "resolution.nc")
    for key in ("resolve_1", "resolve_fresh"):
        file = Path(f"results/carriage/further/{key}.nc")
        assert found.attrs[f"sha256_{key}"] == store.sha256(file)
    # Results have changed: what lists them is made again when the run has ended.
    assert not Path("results/MANIFEST.json").exists()
    assert found["names"].values[-1] == "transport_delay"
    assert (folder / "probability.pdf").stat().st_size > 1000
    assert "carriage" in (folder.parent / "rounds.md").read_text()
    hand_in(
        case,
        "resolve_fresh",
        fresh,
        2,
        lambda u, seed: as_record(u, -DEVICE(u, seed)["output"].values),
    )
    main(["carriage", "--threads", "1"])
    assert "contradicted: 1 designed record," in capsys.readouterr().out
    assert store.read(folder / "resolution.nc")["names"].values[-1] == ""
    assert read_verdict(folder / "round_1/verdict.json").names == ()


@pytest.mark.parametrize(
    ("withdrawn", "effects"),
    [(None, ["sensor_lag"]), (ResolutionOutcome.CONTRADICTED, [])],
)
def test_the_simulation_of_a_round_is_kept(source, withdrawn, effects):
    u = np.sin(np.arange(300) / 20)
    alone = prepared(load_simulation(made_carriage.__file__), u, INTERVAL, 1e-4)
    values = alone.layout.prior_means
    scales = measured_scales(alone, values, Samples(u, u, INTERVAL))
    lagging = alone.attach(catalogue()["sensor_lag"], scales)
    start = np.concatenate([values, lagging.attached[0].effect.starts(scales)[0]])
    found = resolution_of(ResolutionOutcome.DECIDED).rounds[0]
    diagnosis = SimpleNamespace(
        **vars(found.after.diagnosis)
        | {
            "nominal": SimpleNamespace(extended=alone, values=values),
            "final": SimpleNamespace(extended=lagging, values=start),
            "problem": SimpleNamespace(recorded_interval=INTERVAL),
        }
    )
    after = replace(found.after, diagnosis=diagnosis, withdrawn=withdrawn)
    own = source("film1")
    own.folder_of(1).mkdir(parents=True)
    own.keep(replace(found, after=after))
    kept, same, interval = load_extended(own.folder_of(1) / "extended_simulation.yaml")
    assert [each.effect.name for each in kept.attached] == effects
    fitted = diagnosis.final if effects else diagnosis.nominal
    expected = fitted.extended.simulate(fitted.values, u, INTERVAL)
    np.testing.assert_array_equal(kept.simulate(same, u, interval), expected)


def test_a_run_that_fails_leaves_nothing_that_an_earlier_one_decided(case, monkeypatch):
    hand_in(case, "resolve_1", np.zeros(3), 1)
    found = resolution_of(ResolutionOutcome.DECIDED)
    monkeypatch.setattr("dea.resolution.resolve", lambda *given, **options: found)
    monkeypatch.setattr("dea.stages.resolve._draw", lambda *given: None)
    resolve("carriage", "me", 1)
    folder = Path("results/resolve/carriage")
    (folder / "probability.png").touch()
    shutil.copytree(folder, folder.with_name("another"))
    found.last.verdict.write(folder / "round_1/verdict.json")
    (folder / "round_1/posterior.json").touch()
    (folder / "round_1/extended_simulation.yaml").touch()
    (folder / "round_1/design.json").touch()
    assert "decided" in (folder.parent / "rounds.csv").read_text()
    monkeypatch.setattr("dea.resolution.resolve", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        resolve("carriage", "me", 1)
    assert [str(file.relative_to(folder)) for file in folder.rglob("*.*")] == [
        "round_1/design.json"
    ]
    for kind in ("csv", "md", "tex"):
        table = (folder.parent / f"rounds.{kind}").read_text()
        assert "carriage" not in table
        assert "another" in table
    (folder.parent / "another/resolution.nc").unlink()
    with pytest.raises(KeyboardInterrupt):
        resolve("carriage", "me", 1)
    assert not list(folder.parent.glob("rounds.*"))


def edited(file, *keys, value):
    """Give a key of a YAML file another value."""
    content = yaml.safe_load(Path(file).read_text())
    place = content
    for key in keys[:-1]:
        place = place.setdefault(key, {})
    place[keys[-1]] = value
    Path(file).write_text(yaml.safe_dump(content))


def designed_anew(name, monkeypatch):
    """Resolve as far as the first design; return whether it was made in this run."""
    made = Mock(return_value=Design(np.linspace(0.0, 0.1, 40), -5.0, ("a", "b"), 3.0, "free"))

    def as_far_as_the_first_design(records, simulation, source, limits, **options):
        source.design(1, records, made)
        raise KeyboardInterrupt

    monkeypatch.setattr("dea.resolution.resolve", as_far_as_the_first_design)
    with pytest.raises(KeyboardInterrupt):
        resolve(name, "me", 1)
    return made.called


def test_what_is_to_be_played_next_is_the_new_design_where_the_run_fails(case, monkeypatch):
    levels = iter([0.1, 0.2])

    def one_design(records, simulation, source, limits, **options):
        u = np.linspace(0.0, next(levels), 40)
        source.design(1, records, lambda: Design(u, -5.0, ("a", "b"), 3.0, "free"))
        return replace(resolution_of(ResolutionOutcome.OPEN), rounds=(), pending=1)

    monkeypatch.setattr("dea.resolution.resolve", one_design)
    monkeypatch.setattr("dea.store.write", Mock(side_effect=OSError("the disk is full")))
    played = Path("results/resolve/carriage/next_excitation.csv")
    for seed, level in ((1, 0.1), (2, 0.2)):
        edited("config/config.yaml", "seed", value=seed)
        with pytest.raises(OSError, match="the disk is full"):
            resolve("carriage", "me", 1)
        assert np.loadtxt(played, delimiter=",", skiprows=1)[-1, 1] == level


STUDY, CASE = "config/config.yaml", "config/cases/carriage.yaml"


@pytest.mark.parametrize(
    ("file", "keys", "value"),
    [
        (STUDY, ("resolution", "duration"), 3.0),
        (STUDY, ("resolution", "output_margin"), 0.1),
        (STUDY, ("resolution", "rate"), 30.0),
        (STUDY, ("resolution", "level"), 0.05),
        (STUDY, ("resolution", "first"), 1000),
        (STUDY, ("seed",), 5),
        (STUDY, ("discrepancy", "budget", "starts"), 3),
        (CASE, ("split", "slowest_time"), 0.2),
        (CASE, ("simulation",), "own.py"),
    ],
)
def test_a_design_that_was_not_played_is_made_anew_for_other_settings(
    case, monkeypatch, file, keys, value
):
    shutil.copy("carriage.py", "own.py")
    assert designed_anew("carriage", monkeypatch)
    assert not designed_anew("carriage", monkeypatch)
    edited(file, *keys, value=value)
    assert designed_anew("carriage", monkeypatch)
    # What was played is what was designed then.
    hand_in(case, "resolve_1", np.zeros(3), 1)
    edited(STUDY, "seed", value=7)
    assert not designed_anew("carriage", monkeypatch)


def test_a_design_that_was_not_played_is_made_anew_for_other_physics_and_records(case, monkeypatch):
    Path("damping.txt").write_text("0.5")
    with Path("carriage.py").open("a") as simulation:
        simulation.write("\nopen('damping.txt').close()\n")
    assert designed_anew("carriage", monkeypatch)
    assert not designed_anew("carriage", monkeypatch)
    Path("damping.txt").write_text("0.6")
    assert designed_anew("carriage", monkeypatch)
    with Path("carriage.py").open("a") as simulation:
        simulation.write("# another accuracy\n")
    assert designed_anew("carriage", monkeypatch)
    hand_in(case, "other", np.sin(np.arange(100) / 10), 1)
    assert designed_anew("carriage", monkeypatch)
    assert not designed_anew("carriage", monkeypatch)
    edited(case, "title", value="A carriage with a name for people")
    assert not designed_anew("carriage", monkeypatch)


@pytest.mark.parametrize(
    ("file", "keys", "value"),
    [
        ("config/devices/mine.yaml", ("registers", "output", "limits"), [0.0, 3.0]),
        ("config/devices/mine.yaml", ("safety", "max_rate"), 100.0),
        (STUDY, ("excitation", "record", "high"), 3.0),
    ],
)
def test_a_design_that_was_not_driven_is_made_anew_for_other_limits_of_the_device(
    source, monkeypatch, file, keys, value
):
    source("film1")
    assert designed_anew("film1", monkeypatch)
    assert not designed_anew("film1", monkeypatch)
    edited(file, *keys, value=value)
    assert designed_anew("film1", monkeypatch)


@pytest.mark.parametrize(
    ("given", "wrong", "wanted"),
    [
        (["resolve_2"], "resolve_2", "resolve_1"),
        (["resolve_fresh"], "resolve_fresh", "resolve_1"),
        (["resolve_1", "resolve_3", "resolve_fresh"], "resolve_3", "resolve_2"),
    ],
)
def test_a_designed_record_that_no_round_has_asked_for_is_refused(case, given, wrong, wanted):
    for key in given:
        hand_in(case, key, np.sin(np.arange(100) / 10), 1)
    said = f"carriage.yaml: records.{wrong}: there is no record {wanted}, which comes before it"
    with pytest.raises(InputError, match=said):
        resolve("carriage", "me", 1)


def at_51_hz(u, seed):
    record = DEVICE(u, seed)
    time = record["time"]
    return record.assign_coords(time=time.copy(data=time.values * 50 / 51))


def columns_swapped(u, seed):
    return as_record(0.5 * np.roll(u, 5), u)


@pytest.mark.parametrize(
    ("change", "device", "said"),
    [
        (lambda u: u[:250], DEVICE, "it has 250 of 300 samples. Play and record all of it"),
        (lambda u: u, at_51_hz, "it is sampled at 51 Hz, the excitation at 50 Hz. Play and record"),
        (lambda u: u, columns_swapped, "its output is. Exchange the columns"),
        (lambda u: 1e3 * u, DEVICE, "it is 1000 times the excitation. Play it unscaled"),
        (lambda u: u + 0.5, DEVICE, "it is 1 times the excitation, plus 0.5 V"),
        (
            lambda u: np.concatenate([np.full(50, u[0]), u, np.zeros(9)]),
            DEVICE,
            r"the excitation begins at its sample 50, at 1 s. Leave out .* `rows: \[50, 350\]`",
        ),
        (lambda u: np.random.default_rng(0).uniform(-1, 1, 300), DEVICE, "Play that excitation"),
    ],
)
def test_a_record_that_was_not_made_as_asked_is_refused_with_what_is_wrong(
    case, monkeypatch, change, device, said
):
    u = np.sin(2 * np.pi * (np.arange(300) / 150) ** 2)
    hand_in(case, "resolve_1", change(u), 1, device)

    def as_far_as_the_first_record(records, simulation, source, limits, **options):
        source.record(1, u)

    monkeypatch.setattr("dea.resolution.resolve", as_far_as_the_first_record)
    said = r"carriage.yaml: records.resolve_1: its input is not the excitation of \S*\.csv.*" + said
    with pytest.raises(InputError, match=said):
        resolve("carriage", "me", 1)


@pytest.mark.parametrize(
    "given", [["another"], ["another", "resolve_1"], ["resolve_2", "resolve_1", "resolve_fresh"]]
)
def test_designed_records_in_their_order_are_taken(case, monkeypatch, given):
    for key in given:
        hand_in(case, key, np.sin(np.arange(100) / 10), 1)
    designed_anew("carriage", monkeypatch)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("carriag", "there is no actuator or case 'carriag'. Did you mean 'carriage'?"),
        (
            "dea1",
            "results/dea1/record.nc: there is no record. Make it: make results/dea1/record.nc",
        ),
    ],
)
def test_what_cannot_be_resolved_is_said_in_one_line(case, capsys, name, said):
    stale = Path("results/carriag/record.nc")
    stale.parent.mkdir()
    stale.touch()
    with pytest.raises(SystemExit) as exit_:
        main([name])
    assert exit_.value.code == 2
    message = capsys.readouterr().err
    assert said in message
    assert message.count("\n") == 1


def test_a_diagnosis_that_is_ended_says_so_in_one_line(case, capsys, monkeypatch):
    def ended(*arguments, **settings):
        raise KeyboardInterrupt

    monkeypatch.setattr("dea.resolution.resolve", ended)
    with pytest.raises(SystemExit) as exit_:
        main(["carriage"])
    assert exit_.value.code == 130
    assert "the same command goes on" in capsys.readouterr().err


def test_a_case_without_physics_and_a_changed_excitation_are_refused(case, capsys):
    content = yaml.safe_load(case.read_text())
    case.write_text(yaml.safe_dump({k: v for k, v in content.items() if k != "simulation"}))
    Path("results/MANIFEST.json").touch()
    with pytest.raises(InputError, match="it names no simulation"):
        resolve("carriage", "me", 1)
    # No result has changed.
    assert Path("results/MANIFEST.json").exists()


def begin_from(file, seed=0, **attributes):
    """Write the first record of an actuator."""
    u = np.sin(np.arange(60) / 10)
    store.write(DEVICE(u, seed).assign_attrs(attributes), file, title="The first record")


@pytest.fixture
def source(tmp_path, monkeypatch, serve_bench):
    """Return what makes the source of records of an actuator: hardware, or virtual."""
    served = serve_bench()
    shutil.copytree(ROOT / "config", tmp_path / "config")
    monkeypatch.chdir(tmp_path)
    description = yaml.safe_load(Path("config/devices/virtual_bench.yaml").read_text())
    description["endpoint"] = {"host": "127.0.0.1", "port": served.endpoint.port}
    Path("config/devices/mine.yaml").write_text(yaml.safe_dump(description))
    content = read_yaml("config/config.yaml", what="", example="")
    content["acquisition"]["ramp_rate"] = 20.0
    content["actuators"] = [
        {"name": "film1", "device": "config/devices/mine.yaml"},
        {"name": "dea1", "device": "config/devices/virtual_bench.yaml", "bench": "dea1"},
    ]
    study, bench = check_study(content), read_bench(BENCH)
    config = yaml.safe_dump(content)
    Path("config/config.yaml").write_text(config)
    first = Path("results/film1/record.nc")
    begin_from(first)

    def make(name):
        actuator = next(each for each in study.actuators if each.name == name)
        device = modbus.read_device(Path(actuator.device))
        folder = Path("results/resolve") / name
        return Driven(folder, first, LIMITS, {}, study, config, bench, actuator, device, "A. Volta")

    return make


def put(source, number, u):
    place = source.folder_of(number)
    place.mkdir(parents=True, exist_ok=True)
    text = "".join(f"{k},{v!r}\n" for k, v in enumerate(u.tolist()))
    (place / "excitation.csv").write_text("time,input\n" + text)


def test_a_record_of_hardware_is_archived_and_not_driven_again(source):
    own, u = source("film1"), 1.5 + 0.2 * np.sin(np.arange(100) / 10)
    put(own, 1, u)
    record = own.record(1, u)
    np.testing.assert_allclose(record["voltage"], u, atol=1e-3)
    (folder,) = Path("records/film1").iterdir()
    assert archive.check(folder)["excitation"] == "resolve_1"
    assert archive.check(folder)["operator"] == "A. Volta"
    # A loop that was ended before it took the record from the archive finds it there.
    (own.folder_of(1) / "record.nc").unlink()
    again = own.record(1, u)
    assert len(list(Path("records/film1").iterdir())) == 1
    np.testing.assert_array_equal(again["displacement"], record["displacement"])


def test_the_configuration_is_kept_that_drove_a_record(source):
    own, u = source("film1"), 1.5 + 0.2 * np.sin(np.arange(50) / 10)
    put(own, 1, u)
    file = Path("config/config.yaml")
    read = file.read_text()
    file.write_text(read.replace("ramp_rate: 20.0", "ramp_rate: 10.0"))
    own.record(1, u)
    (folder,) = Path("records/film1").iterdir()
    assert (folder / "config.yaml").read_text() == read


def test_hardware_with_high_voltage_is_armed_before_any_design(source, capsys):
    device = Path("config/devices/mine.yaml")
    device.write_text(device.read_text() + "safety: {max_rate: 100.0}\n")
    with pytest.raises(SystemExit) as exit_:
        main(["film1"])
    assert exit_.value.code == 2
    message = capsys.readouterr().err
    assert "nobody has armed the high voltage" in message
    assert "OPERATOR=NAME" in message
    assert not Path("records").exists()


def test_a_record_whose_clock_was_off_is_not_taken_again(source, clock_off):
    own, u = source("film1"), 1.5 + 0.2 * np.sin(np.arange(100) / 10)
    put(own, 1, u)
    with pytest.raises(DeviceError, match="is kept, and no sample of it is good"):
        own.record(1, u)
    assert len(list(Path("records/film1").iterdir())) == 1
    assert not own.recorded(1)


def test_a_record_that_another_first_record_led_to_is_not_taken(source):
    own = source("film1")
    put(own, CERTIFICATE, np.full(50, 1.5))
    played = own._settings(CERTIFICATE)
    with archive.unfinished("film1") as folder:
        archive.seal(folder, {"excitation": played["excitation_name"], "settings": played})
    assert own.recorded(CERTIFICATE)
    begin_from(own.first, seed=1)
    assert not own.recorded(CERTIFICATE)


def test_a_first_record_is_known_by_its_signals(source):
    """Versions, jobs and names for people change when the project is updated or a case edited."""
    own = source("film1")
    made = Design(np.linspace(1.2, 1.3, 40), -5.0, ("a", "b"), 3.0, "free")
    own.design(1, (), lambda: made)
    played = own._settings(1)
    with archive.unfinished("film1") as folder:
        archive.seal(folder, {"excitation": played["excitation_name"], "settings": played})
    begin_from(own.first, job="made by another version")
    with xr.open_dataset(own.first) as written:
        record = written.load()
    record["output"].attrs["long_name"] = "position of the carriage"
    store.write(record, own.first, title="renamed")
    assert own.recorded(1)
    np.testing.assert_array_equal(own.design(1, (), lambda: None).u, made.u)
    record["output"].attrs["units"] = "mm"
    store.write(record, own.first, title="other units")
    assert not own.recorded(1)
    with pytest.raises(InputError, match=r"designed for another record than results/film1/record"):
        own.design(1, (), lambda: made)


def test_what_names_the_file_of_its_first_record_is_found(source):
    """As records in `records/` do that were made when the file was what identified it."""
    own = source("film1")
    made = Design(np.linspace(1.2, 1.3, 40), -5.0, ("a", "b"), 3.0, "free")
    own.design(1, (), lambda: made)
    file = own.folder_of(1) / "design.json"
    of_file = {"first_record": store.sha256(own.first)}
    file.write_text(json.dumps(json.loads(file.read_text()) | of_file))
    played = own._settings(1) | of_file
    with archive.unfinished("film1") as folder:
        archive.seal(folder, {"excitation": played["excitation_name"], "settings": played})
    assert own.recorded(1)
    np.testing.assert_array_equal(own.design(1, (), lambda: None).u, made.u)
    begin_from(own.first, job="written anew")
    assert not own.recorded(1)


@pytest.mark.slow
def test_a_virtual_actuator_is_driven_once(source):
    own, u = source("dea1"), 1.5 + 0.2 * np.sin(np.arange(100) / 10)
    put(own, 1, u)
    record = own.record(1, u)
    file = own.folder_of(1) / "record.nc"
    before = file.stat().st_mtime_ns
    np.testing.assert_array_equal(own.record(1, u)["displacement"], record["displacement"])
    assert file.stat().st_mtime_ns == before
    assert not Path("records").exists()


def test_a_virtual_actuator_that_was_edited_since_the_study_was_read_is_not_driven(source):
    own, u = source("dea1"), 1.5 + 0.2 * np.sin(np.arange(100) / 10)
    put(own, 1, u)
    edited(BENCH, "actuators", "dea1", "leakage_ageing", value=3.0)
    with pytest.raises(InputError, match=r"bench\.yaml: actuators\.dea1: has changed since"):
        own.record(1, u)
    assert not own.file(1).exists()


def test_a_voltage_beyond_the_limits_is_refused_before_anything_is_driven(source):
    own, u = source("film1"), np.full(100, 3.9)
    put(own, 1, u)
    with pytest.raises(InputError, match=r"asks for 3\.9 V, outside"):
        own.record(1, u)
    assert not Path("records").exists()


def test_a_design_that_was_changed_or_is_of_another_record_is_refused(source):
    own = source("film1")
    own.write_table = lambda path, u: put(own, 1, u)
    made = Design(np.linspace(1.2, 1.3, 40), -5.0, ("a", "b"), 3.0, "free")
    kept = own.design(1, (), lambda: made)
    np.testing.assert_array_equal(kept.u, made.u)
    assert (kept.closest, kept.distance) == (("a", "b"), 3.0)
    begin_from(own.first, seed=1)
    with pytest.raises(InputError, match="designed for another record"):
        own.design(1, (), lambda: made)
    begin_from(own.first)
    put(own, 1, np.linspace(1.2, 1.4, 40))
    with pytest.raises(InputError, match="is not the excitation that was designed"):
        own.design(1, (), lambda: made)


@pytest.mark.parametrize("text", ["", '{"first_record": "a', "[]", "{}", None])
def test_a_design_that_is_damaged_is_refused_with_a_remedy(source, text):
    own = source("film1")
    made = Design(np.linspace(1.2, 1.3, 40), -5.0, ("a", "b"), 3.0, "free")
    own.design(1, (), lambda: made)
    if text is None:
        (own.folder_of(1) / "excitation.csv").unlink()
    else:
        (own.folder_of(1) / "design.json").write_text(text)
    with pytest.raises(InputError, match="delete results/resolve/film1/round_1 to design it again"):
        own.design(1, (), lambda: made)
    shutil.rmtree(own.folder_of(1))
    np.testing.assert_array_equal(own.design(1, (), lambda: made).u, made.u)


def test_a_design_that_was_not_driven_obeys_the_limits_of_today(source):
    own = source("dea1")
    own.write_table = lambda path, u: put(own, 1, u)
    fast, slow = np.array([0.0, 0.4, 0.0]), np.array([0.0, 0.1, 0.0])
    own.design(1, (), lambda: Design(fast, -5.0, ("a", "b"), 3.0, "free"))
    own.limits = replace(LIMITS, rate=10.0)
    anew = own.design(1, (), lambda: Design(slow, -4.0, ("a", "b"), 2.0, "free"))
    np.testing.assert_array_equal(anew.u, slow)
    own.limits = replace(LIMITS, high=0.05)
    assert own.design(1, (), lambda: None) is None
    # What has been driven is kept, whatever the limits are now.
    (own.folder_of(1) / "record.nc").touch()
    np.testing.assert_array_equal(own.design(1, (), lambda: None).u, slow)


def test_a_design_whose_making_was_ended_is_made_anew(source, monkeypatch):
    own = source("dea1")
    own.write_table = lambda path, u: put(own, 1, u)
    fast, slow = np.array([0.0, 0.4, 0.0]), np.array([0.0, 0.1, 0.0])
    own.design(1, (), lambda: Design(fast, -5.0, ("a", "b"), 3.0, "free"))
    own.limits = replace(LIMITS, rate=10.0)
    made = Design(slow, -4.0, ("a", "b"), 2.0, "free")
    with monkeypatch.context() as ended:
        ended.setattr("dea.resolution.kept._write_json", Mock(side_effect=KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            own.design(1, (), lambda: made)
    np.testing.assert_array_equal(own.design(1, (), lambda: made).u, slow)


def test_the_smaller_of_the_rates_that_are_given_holds(source):
    own = source("film1")
    record = hidden("transport_delay", [0.15])(np.linspace(0.0, 1.0, 50), 0)
    for asked, allowed, rate in ((20.0, 0.5, 0.5), (0.2, 0.5, 0.2), (None, 0.5, 0.5)):
        asks = own.study.resolution.model_copy(update={"rate": asked})
        study = own.study.model_copy(update={"resolution": asks})
        device = replace(own.device, safety=SimpleNamespace(max_rate=allowed))
        assert allowed_by_device(study, device, record).rate == rate
