import subprocess
from pathlib import Path

import numpy as np
import pytest

from dea.errors import InputError
from dea.intake import Answers, UnansweredError
from dea.intake.questions import command
from dea.intake.roles import find_roles
from dea.store import ForeignTable
from dea.units import SECONDS

FILE = Path("mine.csv")
NOTHING = Answers()


def roles(units, answers=NOTHING, constants=None):
    known = {name: unit for name, unit in units.items() if unit}
    columns = [name for name in units if name not in (constants or {})]
    table = ForeignTable(dict.fromkeys(columns, np.arange(5.0)), known, constants or {})
    return find_roles(table, answers, FILE, "case", {"FILE": "mine.csv"})


def test_clear_names_and_units_need_no_answer():
    found = roles({"t": "ms", "u": "V", "y": "mm"})
    assert (found.time, found.inputs, found.output) == (("t", "ms"), (("u", "V"),), ("y", "mm"))


@pytest.mark.parametrize("unit", SECONDS)
def test_a_first_column_in_a_unit_of_time_is_the_time(unit):
    assert roles({"first": unit, "u": "V", "y": "mm"}).time == ("first", unit)


def test_of_two_columns_the_other_is_the_other():
    found = roles({"time": "s", "volts": "V", "displacement": "um"})
    assert found.inputs == (("volts", "V"),)
    assert found.output == ("displacement", "um")


@pytest.mark.parametrize(
    ("driving", "measured"),
    [("Voltage", "Position in chamber"), ("Laser out of plane", "Piezo"), ("Piezo", "Length_in")],
)
def test_a_preposition_makes_no_column_the_input_or_the_output(driving, measured):
    with pytest.raises(UnansweredError, match="which column is the input"):
        roles({"time": "s", driving: "V", measured: "mm"})


@pytest.mark.parametrize(
    ("driving", "measured"),
    [("in", "out"), ("In 1", "OUT 1"), ("in2", "out_2"), ("voltage", "displacement in frame"),
     ("drive_in", "length_in")],
)  # fmt: skip
def test_names_beside_a_preposition_count(driving, measured):
    found = roles({"time": "s", measured: "mm", driving: "V"})
    assert (found.inputs, found.output) == (((driving, "V"),), (measured, "mm"))


@pytest.mark.parametrize(
    ("columns", "role"),
    [
        ({"t": "s", "u1": "V", "u2": "V", "y": "mm"}, "input"),
        ({"t": "s", "u": "V", "input2": "V", "y": "mm"}, "input"),
        ({"t": "s", "drive left": "V", "drive2": "V", "y": "mm"}, "input"),
        ({"t": "s", "u": "V", "y1": "mm", "y2": "mm"}, "output"),
        ({"t": "s", "u": "V", "y": "mm", "out_2": "mm"}, "output"),
    ],
)
def test_of_several_inputs_or_outputs_none_is_dropped_without_a_word(columns, role):
    with pytest.raises(UnansweredError, match=f"which column is the {role}") as caught:
        roles(columns)
    assert f"{role.upper()}=COLUMN" in caught.value.command
    candidates = [name for name in columns if columns[name] == ("V" if role == "input" else "mm")]
    for name in candidates:
        found = roles(columns, Answers(**{role: name}))
        assert (found.inputs[0] if role == "input" else found.output)[0] == name


@pytest.mark.parametrize("measured", ["drive_temp", "drive temperature 1", "bearing_drive"])
def test_what_is_measured_at_a_drive_is_not_the_input(measured):
    with pytest.raises(UnansweredError, match="which column is the input"):
        roles({"time": "s", measured: "degC", "torque": "Nm", "y": "rpm"})


def test_a_number_behind_a_word_leaves_it_the_word_of_a_longer_name():
    found = roles({"t": "s", "u": "V", "measured2 position": "mm", "current": "A"})
    assert (found.inputs, found.output) == ((("u", "V"),), ("measured2 position", "mm"))


def test_a_candidate_that_the_user_gives_another_role_is_none():
    found = roles({"t": "s", "u1": "V", "u2": "mm"}, Answers(output="u2"))
    assert (found.inputs, found.output) == ((("u1", "V"),), ("u2", "mm"))


def test_everything_unknown_is_asked_at_once_with_the_command_that_answers():
    with pytest.raises(UnansweredError) as caught:
        roles({"a": None, "b": None})
    text = str(caught.value)
    assert "which column is the input" in text
    assert "how many samples" in text
    assert "make case FILE=mine.csv INPUT=a:UNITS OUTPUT=b:UNITS RATE=SAMPLES_PER_SECOND" in text


def test_only_what_is_unknown_is_asked():
    columns = {"t": "s", "left": "V", "right": "V", "position": "mm"}
    with pytest.raises(UnansweredError) as caught:
        roles(columns, Answers(output="position"))
    assert "it does not say which column is the input (several: INPUT=A:UNITS,B:UNITS).\n" in str(
        caught.value
    )
    assert caught.value.command == "make case FILE=mine.csv INPUT=COLUMN OUTPUT=position:mm"
    with pytest.raises(UnansweredError) as caught:
        roles(columns | {"right": None}, Answers(input="left"))
    assert "which column is the output, and its units.\n" in str(caught.value)
    assert "OUTPUT=COLUMN:UNITS" in caught.value.command


def test_a_rate_leaves_the_column_of_times_unused():
    found = roles({"t": "s", "volts": "V", "y": "mm"}, Answers(rate=50.0))
    assert (found.interval, found.time, found.inputs) == (0.02, None, (("volts", "V"),))
    assert found.inferred == (
        "time: 50 samples per second; column 't' is not used",
        "input: column 'volts', the only other one",
        "output: column 'y', by the names",
    )


def test_columns_that_are_not_used_are_named():
    units = {"t": "s", "u": "V", "y": "mm", "room": "degC", "n": None}
    assert roles(units).inferred[-1] == "not used: columns 'room', 'n'"


def test_a_rate_leaves_the_column_that_is_named_as_the_time_unused():
    found = roles({"volts": "V", "tick": "ms", "y": "mm"}, Answers(time="tick", rate=50.0))
    assert (found.interval, found.time, found.inputs) == (0.02, None, (("volts", "V"),))
    assert found.inferred[0] == "time: 50 samples per second; column 'tick' is not used"


def test_the_columns_stand_in_line_however_long_their_units():
    with pytest.raises(UnansweredError) as caught:
        roles({"a": "furlongs", "b": None})
    header, *rows = caught.value.columns.splitlines()
    assert {row.index("0 to 4") for row in rows} == {header.index("values")}


def test_the_answer_is_enough():
    found = roles({"a b": None, "c": "K"}, Answers("a b:%", "c", rate=10.0))
    assert (found.inputs, found.output, found.interval) == ((("a b", "%"),), ("c", "K"), 0.1)


def test_units_alone_are_asked_where_names_are_clear():
    with pytest.raises(UnansweredError) as caught:
        roles({"t": "s", "u": None, "y": "mm"})
    assert caught.value.command == "make case FILE=mine.csv INPUT=u:UNITS OUTPUT=y:mm"
    assert "which column" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time_ms", "ms"),
        ("t_us", "us"),
        ("millis", "ms"),
        ("time_hours", "h"),
        ("t_usec", "us"),
        ("Time (sec", "s"),
        ("time", "s"),
    ],
)
def test_the_name_of_a_time_may_tell_its_units(name, unit):
    assert roles({name: None, "u": "V", "y": "mm"}).time == (name, unit)


@pytest.mark.parametrize("warm", ["T_film", "T film", "t_film", "temperature T"])
def test_a_temperature_that_ascends_is_no_time(warm):
    with pytest.raises(UnansweredError, match="how many samples"):
        roles({"u": "V", "y": "mm", warm: None}, Answers(input="u", output="y"))


@pytest.mark.parametrize(
    ("columns", "time"),
    [
        ({"T": "degC", "u": "V", "y": "mm", "t": "s"}, ("t", "s")),
        ({"elapsed": "s", "u": "V", "y": "mm", "T": "degC"}, ("elapsed", "s")),
        ({"elapsed": "s", "u": "V", "y": "mm", "T": None}, ("elapsed", "s")),
        ({"time of flight": "m", "u": "V", "y": "mm", "time": None}, ("time", "s")),
        ({"T": None, "u": "V", "y": "mm", "t": "ms"}, ("t", "ms")),
        ({"timestamp": None, "u": "V", "y": "mm", "time": "ms"}, ("time", "ms")),
        ({"timestamp": None, "u": "V", "y": "mm", "time_us": None}, ("time_us", "us")),
        ({"lag": "ms", "u": "V", "y": "mm", "time": None}, ("time", "s")),
        ({"t": None, "u": "V", "y": "mm", "charge_time": None}, ("t", "s")),
        ({"charge_time": None, "u": "V", "y": "mm", "Time": None}, ("Time", "s")),
        ({"date": None, "time": None, "u": "V", "y": "mm"}, ("time", "s")),
        ({"u": "V", "y": "mm", "date time": None, "time lag": None}, ("date time", "s")),
    ],
)
def test_of_likely_times_the_one_in_a_unit_of_time_is_taken(columns, time):
    assert roles(columns, Answers(input="u", output="y")).time == time


@pytest.mark.parametrize("passed_over", [[3.0] * 5, [3.0, 1.0, 2.0, 5.0, 0.0]])
def test_of_columns_that_may_be_a_time_one_that_ascends_is_taken(passed_over):
    columns = dict.fromkeys(["u", "y", "charge time", "measurement time"], np.arange(5.0))
    columns["charge time"] = np.array(passed_over)
    found = find_roles(
        ForeignTable(columns, {"u": "V", "y": "mm"}), NOTHING, FILE, "case", {"FILE": "mine.csv"}
    )
    assert found.time == ("measurement time", "s")


def test_a_time_that_falls_back_is_refused_though_another_column_ascends():
    columns = dict.fromkeys(["u", "y", "t", "charge_time"], np.arange(5.0))
    columns["t"] = np.array([0.0, 1.0, 2.0, 0.0, 1.0])
    table = ForeignTable(columns, {"u": "V", "y": "mm"})
    with pytest.raises(InputError, match="column 't': it falls back"):
        find_roles(table, NOTHING, FILE, "case", {})


def timed(values, answers=NOTHING, name="t"):
    columns = {name: np.asarray(values, float), "u": np.arange(5.0), "y": np.arange(5.0)}
    table = ForeignTable(columns, {"u": "V", "y": "mm"})
    return find_roles(table, answers, FILE, "case", {"FILE": "mine.csv"})


STEPS = np.arange(5.0)


@pytest.mark.parametrize(
    "values",
    [1e-5 * STEPS, 0.02 * STEPS, STEPS, 2.5 * STEPS, 1.7e9 + 0.02 * STEPS, [0, 0, 0, 1, 1]],
)
def test_times_without_units_are_in_seconds_where_they_look_so(values):
    found = timed(values)
    assert found.time == ("t", "s")
    assert "time: column 't', taken to be in s; if it is in ms, TIME=t:ms" in found.inferred


@pytest.mark.parametrize(
    "values", [20 * STEPS, 2 * STEPS, 1.7e12 + STEPS, 12.5 * STEPS, 1e-7 * STEPS]
)
def test_the_units_of_a_time_are_asked_for_where_it_may_be_another(values):
    with pytest.raises(UnansweredError, match=r"the units of the time 't' \(s, ms, us, ") as caught:
        timed(values)
    assert caught.value.command == "make case FILE=mine.csv INPUT=u:V OUTPUT=y:mm TIME=t:UNITS"
    assert timed(values, Answers(time="t:ms")).time == ("t", "ms")
    assert timed(values, Answers(time="t:s")).time == ("t", "s")
    with pytest.raises(UnansweredError, match="the units of the time"):
        timed(values, Answers(time="t"))
    assert timed(values, name="t_ms").time == ("t_ms", "ms")


def test_units_that_are_given_count_more_than_a_name():
    assert roles({"time_ms": "us", "u": "V", "y": "mm"}).time == ("time_ms", "us")
    answers = Answers(time="time_ms:s")
    assert roles({"time_ms": None, "u": "V", "y": "mm"}, answers).time == ("time_ms", "s")


@pytest.mark.parametrize(
    ("said", "meant"), [("Volts", "V"), ("(m/s)^2", "(m/s)^2"), ("µm", "um"), ("-", "1")]
)
def test_units_may_be_answered_in_any_spelling(said, meant):
    found = roles({"t": "s", "u": None, "y": "mm"}, Answers(input=f"u:{said}"))
    assert found.inputs == (("u", meant),)


@pytest.mark.parametrize("said", ["ms", "msec", "milliseconds"])
def test_units_of_time_may_be_answered_in_any_spelling(said):
    found = roles({"when": None, "u": "V", "y": "mm"}, Answers(time=f"when:{said}"))
    assert found.time == ("when", "ms")


@pytest.mark.parametrize(
    ("constants", "interval"),
    [
        ({"Ts": 4.0}, 4.0),
        ({"fs": 50.0}, 0.02),
        ({"rate": 50.0}, 0.02),
        ({"Sampling rate": 50.0}, 0.02),
        ({"d.sample_rate": 50.0}, 0.02),
        ({"slew_rate": 20.0, "fs": 50.0}, 0.02),
    ],
)
def test_a_lone_number_may_be_the_interval_or_the_rate(constants, interval):
    assert roles({"u": "V", "y": "mm"}, constants=constants).interval == interval


@pytest.mark.parametrize("name", ["slew_rate", "flow rate", "d.flow.rate", "rate_limit"])
def test_the_rate_of_something_else_is_not_that_of_the_samples(name):
    with pytest.raises(UnansweredError, match="how many samples"):
        roles({"u": "V", "y": "mm"}, constants={name: 20.0})


@pytest.mark.parametrize(
    ("units", "constants", "interval"),
    [
        ({"Ts": "ms"}, {"Ts": 20.0}, 0.02),
        ({"fs": "kHz"}, {"fs": 5.0}, 2e-4),
        ({"fs": "Hz"}, {"fs": 50.0}, 0.02),
    ],
)
def test_the_interval_or_rate_is_in_its_units(units, constants, interval):
    found = roles({"u": "V", "y": "mm"} | units, constants=constants)
    assert found.interval == pytest.approx(interval, rel=1e-12)


def test_an_interval_in_unknown_units_is_asked_for():
    with pytest.raises(UnansweredError, match="how many samples"):
        roles({"u": "V", "y": "mm", "Ts": "ticks"}, constants={"Ts": 20.0})


@pytest.mark.parametrize(
    ("answers", "message"),
    [
        (Answers(input="v:V"), "INPUT: it has no column 'v'. Its columns of numbers are t, u, y"),
        (Answers(time="t:xyz"), "TIME: 'xyz' is no unit of time. Units of time are s, ms, us"),
        (Answers(time="u"), "TIME: 'V' is no unit of time"),
        (Answers(input="u:V", output="u:V"), "'u' is input and output"),
    ],
)
def test_a_wrong_answer_is_refused(answers, message):
    with pytest.raises(InputError, match=message):
        roles({"t": "s", "u": "V", "y": "mm"}, answers)


@pytest.mark.parametrize("role", ["input", "output"])
def test_the_time_is_neither_input_nor_output(role):
    columns = {"t": "s", "u": "V", "y": "mm"}
    with pytest.raises(InputError, match=f"'t' is {role} and the time. Name two columns"):
        roles(columns, Answers(**{role: "t:s"}))
    found = roles(columns, Answers(**{role: "t:s"}, rate=50.0))
    assert (found.inputs[0] if role == "input" else found.output) == ("t", "s")


@pytest.mark.parametrize("name", ["F(x)y", "u&v", "a$c", "it's", 'an "x"', "a`b", "u", "two words"])
def test_a_command_can_be_typed_whatever_the_names_of_columns(name, tmp_path):
    (tmp_path / "Makefile").write_text(
        "case:\n\t@printf %s '$(subst ','\\'',$(INPUT))'\n", encoding="utf-8"
    )
    typed = command("case", {"INPUT": f"{name}:V"})
    said = subprocess.run(typed, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert said.stdout == f"{name}:V"


def test_several_inputs_are_named_with_commas():
    units = {"time": "s", "heater, left": None, "heater": "%", "fan": "V", "temperature": "degC"}
    found = roles(units, Answers("heater:%, fan", "temperature"))
    assert found.inputs == (("heater", "%"), ("fan", "V"))
    assert roles(units, Answers("heater, left:%", "temperature")).inputs == (("heater, left", "%"),)
    with pytest.raises(UnansweredError) as caught:
        roles(units | {"fan": None}, Answers("heater,fan", "temperature"))
    assert "the units of 'fan'" in str(caught.value)
    assert "make case FILE=mine.csv INPUT=heater:%,fan:UNITS" in str(caught.value)
    with pytest.raises(InputError, match="names a column twice"):
        roles(units, Answers("heater:%,heater:%", "temperature"))
