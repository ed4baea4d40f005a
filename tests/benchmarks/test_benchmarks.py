"""The comparisons with other packages: what they compare, how they time it, what they print."""

import json
import signal
import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from benchmarks import acquisition, discrepancy, identification, tracking
from benchmarks.acquisition import Lateness, busy_core, punctuality
from benchmarks.command_line import PeerError, peer, run
from benchmarks.identification import CANDIDATES, Comparison, model_of
from benchmarks.row import HEAD, Row, table, table_of_cases
from benchmarks.timing import shortest
from dea.errors import InputError
from dea.narx import Orthogonal, nmse, select_terms
from dea.tracking import recursive_least_squares


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (2.76e-6, "2.76 µs"),
        (364e-6, "364 µs"),
        (0.0889, "88.9 ms"),
        (15.6, "15.6 s"),
        (2e-9, "2 ns"),
    ],
)
def test_a_time_has_three_digits_whatever_its_size(seconds, shown):
    (line,) = Row.of_times("what", seconds, 1.0, 2.0).lines()
    assert line.split("  ")[0].startswith("what")
    assert shown in " ".join(line.split())
    assert len(line) == len(HEAD)


def test_a_share_of_samples_is_printed_as_one_with_its_lateness():
    row = punctuality(Lateness(0.0077, 0.01, 0.99983), 600.0, busy=False)
    line, detail = row.lines()
    assert line.split()[-4:] == ["99.983", "%", "100", "%"]
    assert detail.strip() == "the latest by 7.7 ms, where 10 ms are in time"
    assert not row.met
    assert "ours_s" not in row.leaves()


def test_a_published_table_names_what_is_missed():
    rows = [
        Row.of_times("slow", 2.0, 1.0, 1.0),
        Row.of_times("worse", 1.0, 2.0, 1.0, lost=("DEA1", "DEA4"), cases={"DEA1": "2/1"}),
        Row.of_times("good", 1.0, 2.0, 1.0, cases={"DEA1": "1/2", "DEA2": "3/4"}),
        Row("no number", float("nan"), 1.0),
    ]
    missed = [line.split(" | ")[-1] for line in table(rows)[2:]]
    lost = "a lower error on DEA1, a lower error on DEA4 |"
    assert missed == ["the target |", lost, " |", "the target |"]
    assert table(rows)[2] == "| slow | 2 s | 1 s | 0.5x | 1x | the target |"
    head, _, *lines = table_of_cases(rows)
    assert head == "| what | DEA1 | DEA2 |"
    assert lines == ["| worse | 2/1 |  |", "| good | 1/2 | 3/4 |"]


def test_every_repetition_is_timed_and_the_last_result_returned():
    done = []
    found, seconds = shortest(lambda: done.append(1) or len(done), 3)
    assert found == 3
    assert 0.0 <= seconds < 0.1


def test_a_task_that_waits_takes_no_time_of_the_processor():
    _, seconds = shortest(partial(subprocess.run, ["sleep", "0.3"], check=True), 1)
    assert seconds < 0.2


def of_ours(data):
    """What the peers' program prints, made by a search of ours."""
    found = select_terms(data["u"], data["y"], search=Orthogonal(6))
    answer = {
        "seconds": 1.0,
        "terms": len(found.terms),
        "candidates": CANDIDATES,
        "run": found.simulate(data["u_test"], data["y_test"]).tolist(),
    }
    flat = model_of([[2001], [1001]], [0.1, 0.5])
    meta = answer | {"run": flat.simulate(data["u_test"], data["y_test"]).tolist()}
    simulation = {"seconds": 1.0, "equation": [[2001], [1001]], "parameters": [0.1, 0.5]}
    return {"FROLS": answer, "fastcan": answer, "MetaMSS": meta, "simulation": simulation}


@pytest.fixture
def identified(monkeypatch):
    """Have a small comparison; return the commands that the peers are asked with."""
    asked = []

    def said(name, command):
        asked.append(command)
        return "progress\n" + json.dumps(of_ours(np.load(command[2])))

    monkeypatch.setattr(identification, "said_by", said)
    monkeypatch.setattr(identification, "SAMPLES", 600)
    few = dict(list(identification.load_published(identification.MODELS).items())[1:2])
    monkeypatch.setattr(identification, "load_published", lambda file: few)
    compared = (Comparison("orthogonal search", Orthogonal, "FROLS", 0.2),)
    monkeypatch.setattr(identification, "COMPARISONS", compared)
    return asked


def test_searches_are_compared_at_equal_terms_and_free_runs_of_one_model(identified):
    search, simulation = identification.run("python")
    assert [command[-1] for command in identified] == [str(identification.REPEATS)]
    ours, theirs = search.cases["DEA2"].split()[-1].split("/")
    assert int(ours) <= int(theirs)
    assert search.lost == ("DEA2",)  # alike is not better
    assert simulation.name.startswith("free run of 2 terms, 600 samples")
    assert simulation.peer_s == 1.0


def test_a_peer_with_other_candidates_is_refused(identified, monkeypatch):
    honest = of_ours
    monkeypatch.setitem(globals(), "of_ours", lambda data: {
        name: each | {"candidates": 119} for name, each in honest(data).items()
    })  # fmt: skip
    with pytest.raises(AssertionError, match="119 candidates"):
        identification.run("python")


def test_a_free_run_of_another_model_is_refused(identified, monkeypatch):
    monkeypatch.setattr(
        identification, "model_of", lambda equation, parameters: model_of([[1001]], [0.4])
    )
    with pytest.raises(AssertionError):
        identification.run("python")


def test_the_codes_of_a_model_are_its_terms():
    model = model_of([[], [1003], [2001, 1001, 1001]], [1.0, 2.0, 3.0])
    assert [str(term) for term in model.terms] == ["1", "y(t-3)", "y(t-1)^2u(t-1)"]
    assert model.parameters.tolist() == [1.0, 2.0, 3.0]


def test_an_error_of_a_run_that_diverged_is_infinite():
    y = np.arange(4.0)
    assert identification._error(y, np.array([0.0, np.nan, 1.0, 2.0])) == np.inf
    assert identification._error(y, y + 0.1) == nmse(y, y + 0.1)


def recursion(Phi, y, theta, forgetting):
    """Recursive least squares as padasip writes it."""
    P, theta = np.eye(theta.size), theta.copy()
    for row, output in zip(Phi, y, strict=True):
        P = (P - np.outer(P @ row, row @ P) / (forgetting + row @ P @ row)) / forgetting
        theta += P @ row * (output - theta @ row)
    return theta


def test_recursions_are_timed_as_often_as_those_of_the_peers(monkeypatch):
    asked = []

    def said(name, command):
        data, forgetting = np.load(command[3]), float(command[4])
        asked.append((name, command[5]))
        if name == "padasip":
            theta = recursion(data["Phi"], data["y"], data["theta"], forgetting)
        else:
            found = recursive_least_squares(data["Phi"], data["y"], forgetting=forgetting)
            theta = found.theta[-1]
        return f"1.0 {' '.join(map(repr, theta.tolist()))}"

    monkeypatch.setattr(tracking, "said_by", said)
    monkeypatch.setattr(tracking, "SAMPLES", 400)
    monkeypatch.setattr(tracking, "ONLINE_SAMPLES", 400)
    half_an_hour, online, budget = tracking.run("python")
    assert half_an_hour.peer_s == online.peer_s == 1.0
    assert budget.peer_s == tracking.BUDGET
    repeats = str(tracking.REPEATS)
    assert asked == [("SysIdentPy", repeats), ("padasip", repeats)]


def test_the_membrane_is_timed_as_often_as_lsoda(monkeypatch):
    asked = []

    def timed(task, repeats):
        asked.append(repeats)
        return shortest(task, 1)

    monkeypatch.setattr(discrepancy, "PIECE", 100)
    monkeypatch.setattr(discrepancy, "shortest", timed)
    row = discrepancy._simulation()
    assert asked == [discrepancy.REPEATS] * 2
    assert row.name.startswith("free run of the membrane, 100 samples")


@pytest.mark.parametrize(
    ("program", "said"),
    [
        ("import sys; sys.exit('first\\nno such module')", "fake failed: no such module"),
        ("import os; os._exit(3)", "fake failed: it ended with status 3"),
    ],
)
def test_what_a_peer_said_last_is_told(program, said):
    with pytest.raises(PeerError) as refused:
        peer("fake", [sys.executable, "-c", program])
    assert str(refused.value) == said


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (InputError("the file does not exist", file="record.nc", remedy="Make it."),
         "error: record.nc: the file does not exist. Make it\n"),
        (PeerError("padasip failed: no memory"), "error: padasip failed: no memory\n"),
    ],
)  # fmt: skip
def test_a_program_that_cannot_run_says_so_on_one_line(error, line, capsys):
    def main():
        raise error

    with pytest.raises(SystemExit) as ended:
        run(main)
    assert ended.value.code == 2
    assert capsys.readouterr().err == line


@pytest.mark.parametrize(("status", "code"), [(None, None), (0, 0), (1, 1)])
def test_a_program_ends_with_its_status(status, code):
    with pytest.raises(SystemExit) as ended:
        run(lambda: status)
    assert ended.value.code == code


@pytest.fixture
def within_five_seconds():
    def late(number, frame):
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(5)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.usefixtures("within_five_seconds")
def test_a_drive_that_fails_leaves_no_core_busy(monkeypatch):
    started = []
    popen = subprocess.Popen

    def kept(*arguments, **settings):
        started.append(popen(*arguments, **settings))
        return started[0]

    monkeypatch.setattr(acquisition.subprocess, "Popen", kept)
    try:
        with pytest.raises(OSError, match="link"), busy_core():
            raise OSError("no link")
        assert started[0].poll() is not None
    finally:
        started[0].kill()
