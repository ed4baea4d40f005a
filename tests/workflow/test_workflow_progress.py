"""What a person reads while the workflow runs."""

import importlib.util
import logging
import sys
import time

import pytest
from copied_project import ROOT
from snakemake_interface_logger_plugins.common import LogEvent


@pytest.fixture
def handler(monkeypatch):
    folder = ROOT / "workflow" / "snakemake_logger_plugin_progress" / "__init__.py"
    spec = importlib.util.spec_from_file_location("snakemake_logger_plugin_progress", folder)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    return module.LogHandler(None, None)


def tell(handler, message="", level=logging.INFO, **fields):
    record = logging.LogRecord("snakemake", level, "", 0, message, None, None)
    vars(record).update({"output": ["made.nc"], **fields})
    handler.emit(record)


def test_each_step_is_a_line_with_what_is_left(handler, capsys):
    tell(handler, event=LogEvent.RUN_INFO, stats={"select": 2, "total": 2})
    for i, name in enumerate(("dea1", "dea2")):
        tell(handler, event=LogEvent.JOB_INFO, jobid=i, rule_name="select", log=[],
             wildcards={"system": name})  # fmt: skip
    tell(handler, event=LogEvent.JOB_FINISHED, job_id=1)
    tell(handler, event=LogEvent.PROGRESS, done=1, total=2)
    tell(handler, event=LogEvent.JOB_FINISHED, job_id=0)
    said = [line[10:] for line in capsys.readouterr().err.splitlines()]
    assert said[:3] == ["2 steps to do", "dea1: select", "dea2: select  (2 in parallel)"]
    assert said[3].startswith("dea2: select took 0 s; 1 of 2 left, about ")
    assert said[4] == "dea1: select took 0 s; 0 of 2 left"
    assert len(said) == 5


def test_one_step_is_one(handler, capsys):
    tell(handler, event=LogEvent.RUN_INFO, stats={"select": 1, "total": 1})
    assert capsys.readouterr().err.rstrip().endswith("1 step to do")


def test_a_goal_keeps_the_name_of_its_case(handler, capsys):
    tell(handler, event=LogEvent.JOB_INFO, jobid=0, rule_name="case_lab_Run_2", wildcards={},
         output=[], log=[])  # fmt: skip
    assert capsys.readouterr().err.rstrip().endswith("case_lab_Run_2")


def test_what_is_left_is_foreseen_once_a_tenth_is_done(handler, capsys):
    tell(handler, event=LogEvent.RUN_INFO, stats={"select": 20, "total": 20})
    for i in range(2):
        tell(handler, event=LogEvent.JOB_INFO, jobid=i, rule_name="select", log=[], wildcards={})
        tell(handler, event=LogEvent.JOB_FINISHED, job_id=i)
    said = [line for line in capsys.readouterr().err.splitlines() if "left" in line]
    assert said[0].endswith("select took 0 s; 19 of 20 left")
    assert "18 of 20 left, about " in said[1]


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            'WorkflowError in file "common.smk", line 37:\nmine.yaml: titel: unknown key.\n'
            '  File "common.smk", line 40, in <module>',
            "mine.yaml: titel: unknown key.",
        ),
        (
            "InputFunctionException in rule a:\nError:\n  WorkflowError:\n    no file.\n"
            "Wildcards:\n  case=x\nTraceback:",
            "no file.",
        ),
        (
            "MissingRuleException:\nNo rule to produce results/dea9/model.nc (if you use input"
            " functions make sure that they don't raise unexpected exceptions).",
            "results/dea9/model.nc: no step makes it. results/README.md says what there is",
        ),
    ],
)
def test_a_mistake_is_one_line(handler, capsys, message, said):
    tell(handler, message, logging.ERROR, event=LogEvent.ERROR)
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.count("\n") == 1


def test_after_ctrl_c_steps_were_stopped_and_none_failed(handler, capsys):
    tell(
        handler,
        event=LogEvent.JOB_INFO,
        jobid=0,
        rule_name="track",
        log=[],
        wildcards={"system": "a"},
    )
    tell(handler, "Terminating processes on user request, this might take some time.")
    tell(handler, event=LogEvent.JOB_ERROR, jobid=0, rule_name="track")
    shown = capsys.readouterr().err
    assert "finished steps are kept" in shown
    assert "a: track was stopped" in shown
    assert "failed" not in shown


def test_snakemakes_own_account_of_a_failed_job_is_left_out(handler, capsys):
    tell(handler, "RuleException:\nCalledProcessError in file x", logging.ERROR)
    assert not capsys.readouterr().err


@pytest.mark.slow
def test_of_a_long_step_the_terminal_says_what_it_is_doing(handler, capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[type(handler).__module__], "STILL", 0.0)
    log, none = tmp_path / "diagnose.log", tmp_path / "not_begun.log"
    log.write_text("step: the simulation alone\nstep: pairs, 3 of 9 done\na warning\n")
    for name, file in (("dea1", log), ("dea2", none)):
        tell(handler, event=LogEvent.JOB_INFO, jobid=name, rule_name="diagnose",
             wildcards={"system": name}, log=[str(file)])  # fmt: skip
    time.sleep(2.5)
    said = {line[10:] for line in capsys.readouterr().err.splitlines()}
    assert "dea1: diagnose has been running for 1 s; pairs, 3 of 9 done" in said
    assert "dea2: diagnose has been running for 1 s" in said
