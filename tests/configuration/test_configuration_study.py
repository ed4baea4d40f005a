"""config/config.yaml and the cases: what is wrong is named on one line, with the nearest key."""

from pathlib import Path

import pytest
import yaml

from changed_content import REMOVED, changed
from dea.configuration.case import SECTIONS, check_case, read_cases, simulation_of
from dea.configuration.lags import largest_lag
from dea.configuration.named_files import check_actuators
from dea.configuration.rates import check_rate
from dea.configuration.study import check_names, check_study, settings
from dea.errors import InputError

CONFIG = Path(__file__).parents[2] / "config"
STUDY = yaml.safe_load((CONFIG / "config.yaml").read_text())
CASES = {path: yaml.safe_load(path.read_text()) for path in sorted(CONFIG.glob("cases/*.yaml"))}


NOISE = {"duration": 1.5, "low": 1.1, "high": 3.75, "band": 0.5}
STAIRS = {"kind": "staircase", "duration": 1800, "low": 1.1, "high": 3.75}


def test_the_settings_of_jobs_are_those_that_were_written():
    assert settings(check_study(STUDY)) == STUDY


def test_a_model_may_be_without_lags_of_its_output():
    study = check_study(changed(STUDY, ["identification", "y_lags"], []))
    assert study.identification.y_lags == []
    check_rate(study, 50.0, "dea1")
    assert largest_lag([], [0, 3]) == 3
    assert largest_lag([]) == 0


@pytest.mark.parametrize(
    ("section", "own"),
    [
        ("identification", {"start": 500.1, "length": 100.2}),
        ("orders", {"start": 1700.4, "length": 99.9}),
        ("forecast", {"start": 1700.4, "horizons": [99.9]}),
    ],
)
def test_a_segment_may_end_where_rounding_alone_puts_it_beyond(section, own):
    """In floating point 500.1 + 100.2 lies beyond 600.3, and 1700.4 + 99.9 beyond 1800.3."""
    whole = changed(STUDY, ["excitation", "record", "duration"], 1800.3)
    orders = {"start": 600.3} if section == "identification" else {}
    content = whole | {"orders": whole["orders"] | orders}
    check_study(content | {section: content[section] | own})


def test_a_null_is_a_key_that_is_not_given():
    trackers = STUDY["tracking"]["trackers"]
    without = check_study(changed(STUDY, ["tracking", "trackers", "rls"], None))
    assert list(settings(without)["tracking"]["trackers"]) == [n for n in trackers if n != "rls"]
    silverbox = CASES[CONFIG / "cases/silverbox.yaml"]
    case = check_case(silverbox | {"simulation": None, "split": None}, check_study(STUDY))
    assert not {"simulation", "split"} & set(settings(case))


@pytest.mark.parametrize("file", CASES, ids=lambda path: path.stem)
def test_a_case_overrides_sections_key_by_key(file):
    own = CASES[file]
    # A key that is null takes the study's value away.
    sections = {name: STUDY[name] | own.get(name, {}) for name in SECTIONS}
    expected = own | {
        name: {key: value for key, value in section.items() if value is not None}
        for name, section in sections.items()
    }
    assert settings(check_case(own, check_study(STUDY))) == expected


@pytest.mark.parametrize(
    ("place", "value", "field", "words"),
    [
        (["actuators", 0, "acquisition"], {"mode": "polled"}, "actuators[0].acquisition",
         "unknown key 'acquisition'. It goes beside `actuators`, not into it"),
        (["control", "reference", "frequency"], 0.02, "control.reference.frequency",
         "noise up to 0.04 Hz has no period in the 20 s of a turn"),
        (["control", "reference", "rise"], 3, "control.reference.rise", "longer than hold, 2 s"),
        (["control", "reference", "hold"], 30, "control.reference.hold", "longer than turn, 20 s"),
        (["excitation", "probing", "settle"], 0.5, "excitation.probing.settle", "at least 1 s"),
        (["excitation", "record"], NOISE | {"kind": "gaussian"}, "excitation.record.band",
         "0.5 Hz has no period in the 1.5 s"),
        (["excitation", "record"], NOISE | {"kind": "bursts"}, "excitation.record.band",
         "no period"),
        (["excitation", "record"], NOISE | {"kind": "binary"}, "excitation.record.band",
         "no period"),
        (["identification", "y_lags"], -3, "identification.y_lags", "whole number of at least 1"),
        (["identification", "y_lags"], [1, 1], "identification.y_lags", "names one value twice"),
        (["identification", "y_lags"], [0, 1], "identification.y_lags", "at least 1"),
        (["identification", "degree"], True, "identification.degree", "whole number"),
        (["identification", "degree"], 2.5, "identification.degree", "whole number"),
        (["identification", "length"], 1801, "identification.length", "inside the record"),
        (["identification", "search"], "best", "identification.search", "forward"),
        (["identification", "start"], float("nan"), "identification.start", "at least 0 s"),
        (["identification"], REMOVED, "identification", "missing"),
        (["seed"], None, "seed", "missing"),
        (["seed"], -1, "seed", "at least 0"),
        (["actuators"], [], "actuators", "list"),
        (["actuators", 1, "name"], "a b", "actuators[1].name", "letters"),
        (["actuators", 1, "name"], "dea1", "actuators[1].name", "'dea1' is taken"),
        (["actuators", 1, "name"], "tables", "actuators[1].name", "'tables' is taken"),
        (["excitation", "record", "kind"], "gausian", "excitation.record.kind", "gaussian"),
        (["excitation", "record", "kind"], REMOVED, "excitation.record.kind", "gaussian"),
        (["excitation", "record"], {"kidn": "binary"}, "excitation.record.kind", "Is 'kidn' meant"),
        (["excitation", "record"], [1], "excitation.record", "a mapping with kind: binary or"),
        (["excitation", "record", "period"], 3, "excitation.record.period", "Known here"),
        (["excitation", "record", "duration"], 1e300, "excitation.record.duration", "to 2e+06 s"),
        (["excitation", "record", "low"], 9, "excitation.record.low", "not below high, 3.75"),
        (["excitation", "second", "period"], 301, "excitation.second.period", "longer than"),
        (["excitation", "record"], STAIRS | {"hold": 0.4}, "excitation.record.rise", "hold, 0.4 s"),
        (["excitation", "record"], STAIRS | {"rest": 0.4}, "excitation.record.rise", "rest, 0.4 s"),
        (["excitation", "second", "band"], 0.01, "excitation.second.band", "first line"),
        (["acquisition", "mode"], "blocks", "acquisition.mode", "buffered, polled"),
        (["acquisition", "timeout"], 0, "acquisition.timeout", "at least 0.001 s"),
        (["bench", "watchdog_time"], 0, "bench.watchdog_time", "above 0 s"),
        (["identification", "u_lags"], [], "identification.u_lags", "at least 1"),
        (["identification", "threshold"], 1.1, "identification.threshold", "from 0 to 1"),
        (["orders", "length"], 1201, "orders.length", "ends at 1801 s, after the record"),
        (["validation", "windows"], [], "validation.windows", "list"),
        (["recovery", "excitation"], ["white"] * 2, "recovery.excitation", "'white'] names one"),
        (["discrepancy", "effects"], ["end_stop"] * 2, "discrepancy.effects", "Give each value"),
        (["validation", "windows", 1, 1], 929, "validation.windows[1]", "29 s long, the first 30"),
        (["validation", "before"], 101, "validation.windows[0]", "begins at 100 s"),
        (["validation", "windows", 1], [900], "validation.windows[1]", "[low, high]"),
        (["validation", "windows", 1], [930, 900], "validation.windows[1]", "cross"),
        (["validation", "windows", 1], [900, 900], "validation.windows[1]", "both ends are 900"),
        (["validation", "windows", 2], [1771, 1801], "validation.windows[2]", "outside the record"),
        (["figures", "zoom"], [1790, 1820], "figures.zoom", "outside the record of 1800 s"),
        (["recovery", "band"], 25, "recovery.band", "half of 50 Hz"),
        (["recovery", "excitation"], ["pink"], "recovery.excitation[0]", "coloured, white"),
        (["tracking", "trackers"], {}, "tracking.trackers", "no tracker"),
        (["tracking", "trackers", "rls", "forgetting"], 1.1, "tracking.trackers.rls.forgetting",
         "above 0 and up to 1"),
        (["tracking", "trackers", "local"], REMOVED, "gfrf.tracker", "rls, kalman"),
        (["gfrf", "highest"], 0.51, "gfrf.highest", "up to 0.5"),
        (["gfrf", "lowest"], 0.2, "gfrf.lowest", "not below highest"),
        (["gfrf", "count"], 1, "gfrf.count", "at least 2"),
        (["gfrf", "plane_count"], 1, "gfrf.plane_count", "at least 2"),
        (["gfrf", "plane_times", 1], 1.5, "gfrf.plane_times[1]", "from 0 to 1"),
        (["gfrf"], 7, "gfrf", "mapping"),
        (["orders", "start"], 599, "orders.start", "end of the segment"),
        (["excitation", "record", "band"], 0.04, "excitation.probing.lowest", "0.04 Hz, where"),
        (["trials", "count"], "six", "trials.count", "from 1 to 9999"),
        (["trials", "count"], 10_000, "trials.count", "from 1 to 9999"),
        (["trials", "first"], 9_800, "trials.count", "fewer trials"),
        (["discrepancy", "budget", "effects"], 4, "discrepancy.budget.effects", "from 1 to 3"),
        (["discrepancy", "rules", "clean"], 0, "discrepancy.rules.clean", "above 0 floors"),
        (["discrepancy", "rules", "margin"], 10, "discrepancy.rules.margin", "and below 0.5"),
        (["discrepancy", "rules", "rival_margin"], 0.05, "discrepancy.rules.rival_margin",
         "at least 1"),
        (["discrepancy", "workers"], 2, "discrepancy.workers", "Known here"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_file_key_and_remedy_on_one_line(place, value, field, words):
    with pytest.raises(InputError) as caught:
        check_study(changed(STUDY, place, value))
    assert caught.value.field == field
    assert caught.value.remedy
    assert str(caught.value).startswith("config/config.yaml: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_every_mistake_is_mentioned():
    wrong = changed(changed(STUDY, ["seed"], -1), ["gfrf", "count"], 0)
    with pytest.raises(InputError, match=r"seed: it is -1.*Wrong too: gfrf\.count$"):
        check_study(wrong)


@pytest.mark.parametrize(
    ("text", "number"), [("6", 6), ("1e1", "trials.count"), ("0", "trials.count")]
)
def test_a_whole_number_of_the_command_line_comes_as_text(text, number):
    wrong = changed(STUDY, ["trials", "count"], text)
    if isinstance(number, int):
        assert settings(check_study(wrong))["trials"]["count"] == number
    else:
        with pytest.raises(InputError, match=number):
            check_study(wrong)


def test_nested_numbers_of_the_command_line_come_as_text():
    budget = {"finished": "2", "beam": "1", "effects": "1", "shake_above": "1.2"}
    found = settings(check_study(changed(STUDY, ["discrepancy", "budget"], budget)))
    expected = {"finished": 2, "beam": 1, "effects": 1, "shake_above": 1.2}
    assert found["discrepancy"]["budget"] == expected


def test_a_number_that_yaml_reads_as_text_is_a_number():
    assert yaml.safe_load("1e-5") == "1e-5"
    found = check_study(changed(STUDY, ["identification", "threshold"], "1e-5"))
    assert found.identification.threshold == 1e-5


MINE = {
    "title": "Mine",
    "record": {
        "file": "mine.csv",
        "sampling_interval": 0.1,
        "input": {"column": "u", "units": "V"},
        "output": {"column": "y", "units": "mm"},
    },
}


@pytest.mark.parametrize(
    ("place", "value", "field", "words"),
    [
        (["record", "time"], {"column": "t", "units": "s"}, "record.time", "both of time"),
        (["record", "sampling_interval"], REMOVED, "record.time", "neither of time"),
        (["record", "sampling_interval"], 0, "record.sampling_interval", "above 0 s"),
        (["record", "rows"], [1], "record.rows", "two whole numbers"),
        (["record", "input", "colum"], "u", "record.input.colum", "Did you mean 'column'?"),
        (["record", "output", "units"], REMOVED, "record.output.units", "missing"),
        (["test_records"], {"a/b": MINE["record"]}, "test_records.a/b", "letters, digits"),
        (["test_records"], {"later": {}}, "test_records.later.output", "missing"),
        (["records"], {"resolve_motor": MINE["record"]}, "records.resolve_motor", "another name"),
        (["records"], {"resolve_0": MINE["record"]}, "records.resolve_0", "designed records"),
        (["record", "file"], "run{x}.csv", "record.file", "'run{x}.csv' has braces"),
        (["records"], {"b": MINE["record"] | {"file": "a}"}}, "records.b.file", "Rename the file"),
        (
            ["test_records"],
            {"b": MINE["record"] | {"file": "{a}/b.csv"}},
            "test_records.b.file",
            "or its folder",
        ),
        (["simulation"], "{mine}.py", "simulation", "has braces"),
        (["identification"], {"y_lag": 2}, "identification.y_lag", "Did you mean 'y_lags'?"),
        (["identification"], {"y_lags": 0}, "identification.y_lags", "at least 1"),
        (["identification"], 3, "identification", "mapping"),
        (["gfrf"], {"tracker": "rsl"}, "gfrf.tracker", "rls, kalman"),
        (["tracking"], {"trackers": {"rls": {}}}, "tracking.trackers.rls.forgetting", "missing"),
        (["split"], {"warmup": 1}, "split.warmup", "Did you mean 'warm_up'?"),
        (["title"], REMOVED, "title", "missing"),
        (["figures"], {}, "figures", "unknown key"),
    ],
)
def test_a_wrong_case_is_named_with_its_file(place, value, field, words):
    with pytest.raises(InputError) as caught:
        check_case(changed(MINE, place, value), check_study(STUDY), "mine.yaml")
    assert caught.value.field == field
    assert str(caught.value).startswith(f"mine.yaml: {field}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_designed_records_may_be_handed_in():
    designed = dict.fromkeys(("resolve_1", "resolve_12", "resolve_fresh"), MINE["record"])
    assert set(check_case(MINE | {"records": designed}, check_study(STUDY)).records) == set(
        designed
    )


@pytest.mark.parametrize(("column", "role"), [("u", "input"), ("y", "output")])
def test_the_time_of_a_record_is_neither_input_nor_output(column, role):
    time = {"column": column, "units": "s"}
    record = {k: v for k, v in MINE["record"].items() if k != "sampling_interval"} | {"time": time}
    with pytest.raises(InputError, match=f"column '{column}' is {role} and the time") as caught:
        check_case(MINE | {"record": record}, check_study(STUDY), "mine.yaml")
    assert caught.value.field == "record.time"


def test_a_record_whose_time_has_other_units_is_refused():
    time = {"column": "t", "units": "V"}
    record = {k: v for k, v in MINE["record"].items() if k != "sampling_interval"} | {"time": time}
    with pytest.raises(InputError, match=r"its units are 'V'.*Units of time are s, ms"):
        check_case(MINE | {"record": record}, check_study(STUDY), "mine.yaml")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("dea1", "title: Mine", "'dea1' is taken"),
        ("figures", "title: Mine", "'figures' is taken"),
        ("mine", "title: [", "not valid YAML"),
        ("mine", "just words", "it is 'just words'"),
        ("mine", "", "it is empty"),
        (
            "mine",
            "title: Mine\ntitle: Yours",
            "line 2, column 1: the key 'title' is given twice. Delete one of the two",
        ),
        ("mine", "title:\n  2024-99-99", "line 2, column 3: '2024-99-99' is no date. Correct it"),
        ("mine", "a: !!int abc", "line 1, column 4: 'abc' is no whole number"),
        ("mine", "a: [1, 0x_]", "line 1, column 8: '0x_' is no whole number"),
        ("mine", f"a: {'9' * 5000}", r"line 1, column 4: '9{57}\.\.\.' is no whole number"),
        ("mine", "a: !!float x", "'x' is no number"),
        ("mine", "a: !!bool maybe", "'maybe' is no truth value"),
        ("mine", "a: !!timestamp soon", "'soon' is no date"),
        ("mine", "title: Mine\n\tname: 1", "line 2, column 1: .*spaces, not tabs"),
        ("my case", "title: Mine", "'my case.yaml' is no name of a case"),
    ],
)
def test_a_wrong_file_of_a_case_is_named(tmp_path, name, text, words):
    (tmp_path / f"{name}.yaml").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_cases(tmp_path, check_study(STUDY))
    assert caught.value.file == tmp_path / f"{name}.yaml"
    assert "\n" not in str(caught.value)


def test_a_case_with_another_suffix_is_not_left_out_silently(tmp_path):
    (tmp_path / "mine.yml").write_text("title: Mine")
    with pytest.raises(InputError, match=r"'mine\.yml' is no name of a case.*NAME\.yaml"):
        read_cases(tmp_path, check_study(STUDY))


def test_hidden_files_beside_cases_are_none(tmp_path):
    for name in (".#mine.yaml", "._mine.yaml", ".mine.yml"):
        (tmp_path / name).write_bytes(b"\x00\x05")
    assert read_cases(tmp_path, check_study(STUDY)) == {}


def test_simulations_and_effects_are_those_of_the_catalogue(tmp_path):
    names = ["dea_film"], ["dead_zone", "end_stop"]
    check_names(check_study(STUDY), *names)
    offered = check_study(changed(STUDY, ["discrepancy", "effects"], ["end_stop", "dead_zon"]))
    with pytest.raises(InputError, match=r"effects\[1\]: .*'dead_zon'.*mean 'dead_zone'"):
        check_names(offered, *names)
    for name, words in (
        ("dea_fil", "Did you mean 'dea_film'"),
        (str(tmp_path / "mine.py"), "no file '.*mine.py'"),
    ):
        misnamed = check_study(changed(STUDY, ["discrepancy", "simulation"], name))
        with pytest.raises(InputError, match=f"discrepancy.simulation: .*{words}"):
            check_names(misnamed, *names)
    (tmp_path / "mine.py").touch()
    check_names(misnamed, *names)
    case = check_case(CASES[CONFIG / "cases/silverbox.yaml"], check_study(STUDY))
    with pytest.raises(InputError, match=r"mine.yaml: simulation: .*'mass_spring_damper'"):
        simulation_of(case, Path("mine.yaml"), ["dea_film"])
    assert simulation_of(case, Path("mine.yaml"), [case.simulation]) == case.simulation
    without = case.model_copy(update={"simulation": None})
    with pytest.raises(InputError, match=r"mine.yaml: simulation: it names no simulation\. Name"):
        simulation_of(without, Path("mine.yaml"), ["dea_film"])


def test_actuators_need_a_device_description_and_a_bench_that_knows_them(tmp_path, monkeypatch):
    monkeypatch.chdir(CONFIG.parent)
    study = check_study(STUDY)
    served = [f"dea{i}" for i in range(1, 7)]
    check_actuators(study, served, "bench.yaml")
    with pytest.raises(InputError, match=r"actuators\[1\]\.bench: dea2 is to be 'dea2', which"):
        check_actuators(study, ["dea1"], "bench.yaml")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"actuators\[0\]\.device: there is no file"):
        check_actuators(study, served, "bench.yaml")
    device = tmp_path / study.actuators[0].device
    device.parent.mkdir(parents=True)
    device.write_text((CONFIG / "devices" / device.name).read_text().replace("unit_id", "unit_di"))
    with pytest.raises(InputError, match=r"virtual_bench.yaml: unit_di: .*'unit_id'"):
        check_actuators(study, served, "bench.yaml")


@pytest.mark.parametrize(
    ("place", "value", "field", "words"),
    [
        (["excitation", "record", "band"], 25.0, "excitation.record.band", "of the 50 Hz of"),
        (["excitation", "probing", "highest"], 25.0, "excitation.probing.highest", "25 Hz is not"),
        (["identification", "length"], 0.3, "identification.length", "15 samples"),
        (["orders", "length"], 0.3, "orders.length", "lags of 5 take more than 15"),
        (["validation", "before"], 0.18, "validation.before", "hold 9 samples"),
        (["forecast", "window"], 0.18, "forecast.window", "hold 9 samples"),
        (["validation", "max_lag"], 750, "validation.max_lag", "holds 1500 at the 50 Hz of"),
        (["control", "hold"], 0.02, "control.hold", "0.02 s hold 1 samples at the 50 Hz"),
        (["control", "approach"], 0.005, "control.approach", "it takes at least 1"),
        (["control", "reference", "rise"], 0.005, "control.reference.rise", "0.005 s hold 0"),
        (["control", "reference", "frequency"], 25.0, "control.reference.frequency", "25 Hz is"),
        (
            ["excitation", "probing", "lowest"],
            0.07,
            "excitation.probing.lowest",
            "its period holds 714.286 samples at the 50 Hz",
        ),
    ],
)
def test_what_the_rate_of_a_device_does_not_allow_is_refused(
    monkeypatch, place, value, field, words
):
    monkeypatch.chdir(CONFIG.parent)
    served = [f"dea{i}" for i in range(1, 7)]
    with pytest.raises(InputError, match=words) as caught:
        check_actuators(check_study(changed(STUDY, place, value)), served, "bench.yaml")
    assert caught.value.field == field
    assert caught.value.file == "config/config.yaml"
    assert "virtual_bench.yaml" in str(caught.value)


# What a device of 1 Hz allows.
SLOW = [
    (["excitation", "record", "band"], 0.2),
    (["excitation", "second", "band"], 0.2),
    (["validation", "max_lag"], 10),
    (["control", "reference", "frequency"], 0.2),
]


def test_a_heartbeat_that_the_mode_of_the_study_does_not_keep_is_refused(tmp_path, monkeypatch):
    slow = changed(STUDY, ["excitation", "probing"], REMOVED)
    for place, value in SLOW:
        slow = changed(slow, place, value)
    study = check_study(slow)
    device = tmp_path / study.actuators[0].device
    device.parent.mkdir(parents=True)
    text = (CONFIG / "devices" / device.name).read_text()
    text = text.replace("sampling_rate: 50 ", "sampling_rate: 1 ")
    alive = "  alive: {address: 900, access: write}"
    safety = "safety: {heartbeat: {name: alive, period: 0.3}}"
    device.write_text(f"{text.rstrip()}\n{alive}\n{safety}\n")
    monkeypatch.chdir(tmp_path)
    served = [f"dea{i}" for i in range(1, 7)]
    check_actuators(study, served, "bench.yaml")
    polled = study.acquisition.model_copy(update={"mode": "polled"})
    with pytest.raises(InputError, match=r"yaml: safety\.heartbeat\.period: 0\.3 s, and a polled"):
        check_actuators(study.model_copy(update={"acquisition": polled}), served, "bench.yaml")


INPUTS = [{"column": "a", "units": "V"}, {"column": "b", "units": "%"}]


def of_several(record):
    """The same record with two inputs."""
    return {name: value for name, value in record.items() if name != "input"} | {"inputs": INPUTS}


def test_a_test_record_is_in_the_units_of_the_record():
    other = changed(MINE["record"], ["output", "units"], "um")
    with pytest.raises(InputError, match="in V, um, those of the record in V, mm") as caught:
        check_case(MINE | {"test_records": {"later": other}}, check_study(STUDY))
    assert caught.value.field == "test_records.later"


def test_a_test_record_may_spell_the_units_of_the_record_in_another_way():
    record = MINE["record"] | {"output": {"column": "T", "units": "°C"}}
    later = MINE["record"] | {"output": {"column": "T", "units": "degC"}}
    case = check_case(
        MINE | {"record": record, "test_records": {"later": later}}, check_study(STUDY)
    )
    assert case.test_records["later"].output.units == "degC"


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"test_records": {"later": MINE["record"]}}, "test_records.later", "inputs, 1, is not"),
        ({"identification": {"u_lags": [[1], [1], [2]]}}, "identification.u_lags", "lags of 3"),
    ],
)
def test_a_case_with_several_inputs_must_agree_with_itself(changes, field, words):
    own = {name: value for name, value in MINE.items() if name not in ("simulation", "split")}
    case = own | {"record": of_several(MINE["record"]), "test_records": {}, "records": {}}
    check_case(case, check_study(STUDY))
    with pytest.raises(InputError, match=words) as caught:
        check_case(case | changes, check_study(STUDY))
    assert caught.value.field == field
