"""The mutants that the tests are tried with: where the code may be changed, and what is counted."""

import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from coverage import CoverageData

from benchmarks.bars import progress_bars
from benchmarks.mutants import campaign
from benchmarks.mutants.campaign import Campaign, judged
from benchmarks.mutants.judgements import judgements
from benchmarks.mutants.report import kill_rate, markdown
from benchmarks.mutants.sites import Mutant, mutants
from benchmarks.mutants.suite import Suite, TimedFile, read_suite, select
from benchmarks.mutants.syntax import statement
from benchmarks.mutants.workplace import Workplace
from dea.errors import InputError
from written_files import write_files

ROOT = Path(__file__).parents[2]
SOURCE = '''"""Adds 1 and 2."""
from numba import njit

@njit(cache=True)
def clip(x: int | None = None, *, top: "dict[3, 4]") -> float | None:
    """Return 1 + 2."""
    width: float | None = 7.0
    assert width > 5
    if x is None:
        raise ValueError(1 + 2)
    text = f"{1 + 2:.3f}"
    for a, b in zip(x, top, strict=True):
        width = min(width, a - b)
    return width
'''


@pytest.fixture
def places(tmp_path):
    (tmp_path / "module.py").write_text(SOURCE)
    return mutants(tmp_path, tmp_path / "module.py")


def test_logic_alone_is_changed(places):
    changed = set()
    for place in places:
        for mutant in place:
            assert mutant.is_another_program(SOURCE)
            lines = zip(SOURCE.splitlines(), mutant.apply(SOURCE).splitlines(), strict=True)
            [(before, after)] = [(old, new) for old, new in lines if old != new]
            changed.add((mutant.definition, before.strip(), " ".join(after.split())))
    assert changed == {
        ("clip", "width: float | None = 7.0", "width: float | None = 8.0"),
        ("clip", "width: float | None = 7.0", "width: float | None = 6.0"),
        ("clip", "if x is None:", "if x is not None:"),
        ("clip", "if x is None:", "if not x is None:"),
        ("clip", "for a, b in zip(x, top, strict=True):", "for a, b in []:"),
        ("clip", "width = min(width, a - b)", "width = min(width, a + b)"),
    }


def suite_of(ran, *files):
    data = CoverageData(no_disk=True)
    for context, lines in ran.items():
        data.set_context(context)
        data.add_lines({MUTANT.file: lines})
    return Suite(files, data, {})


MUTANT = Mutant("src/dea/narx/terms.py", 2, 0, "parse", "NumberReplacer", 0)
FILES = [
    TimedFile("tests/gfrf/test_gfrf_x.py", "", {"tests/gfrf/test_gfrf_x.py::test_e": 0.1}),
    TimedFile("tests/narx/test_narx_model.py", "", {"tests/narx/test_narx_model.py::test_d": 1.0}),
    TimedFile(
        "tests/narx/test_narx_other.py",
        "parse",
        {f"tests/narx/test_narx_other.py::{name}": 3.0 for name in ("test_b", "test_c[|-1]")}
        | {"tests/narx/test_narx_other.py::test_long": 15.0},
    ),
    TimedFile("tests/narx/test_narx_terms.py", "", {"tests/narx/test_narx_terms.py::test_a": 5.0}),
]
EVERY = {f"{name}|run": [2, 3] for file in FILES for name in file.seconds}
CALLED = "def parse():\n    x = [\n        1,\n    ]\n    return x\n"


def chosen(ran, budget=20.0):
    selection = select(MUTANT, CALLED, "narx", suite_of(ran, *FILES), budget)
    return [test.split("::")[1] for test in selection.tests]


def test_the_likeliest_tests_come_first_and_stay_in_the_budget():
    assert chosen(EVERY) == ["test_a", "test_b", "test_c[|-1]", "test_d", "test_e"]
    assert chosen(EVERY, budget=15.5) == ["test_a", "test_b", "test_c[|-1]", "test_d", "test_e"]
    # What the tests of a file with a longer one share may be what takes long.
    assert chosen(EVERY, budget=14.9) == [
        "test_a",
        "test_d",
        "test_e",
    ]
    assert select(MUTANT, CALLED, "narx", suite_of(EVERY, *FILES), 20.0).seconds == (
        pytest.approx(12.1)
    )


def test_the_second_half_of_the_budget_is_for_the_quickest_of_the_others():
    near, far = "tests/narx/test_narx_terms.py", "tests/x/test_x.py"
    files = [
        TimedFile(near, "", {f"{near}::test_{name}": 8.0 for name in "ab"}),
        TimedFile(far, "", {f"{far}::test_{name}": 1.0 for name in "cdefg"}),
    ]
    every = {f"{name}|run": [2] for file in files for name in file.seconds}
    found = select(MUTANT, CALLED, "narx", suite_of(every, *files), 20.0)
    assert [test[-1] for test in found.tests] == list("acdefg")
    assert found.seconds == pytest.approx(13.0)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("dead_zone", "effect('dead_zone')"),
        ("mode", "from dea.narx import (\n    kernels,\n    mode,\n)"),
        ("mode", "import dea.narx.mode"),
    ],
)
def test_a_file_that_names_the_module_comes_before_one_that_names_the_function(name, text):
    """And one whose own name only begins like the module's, as test_narx_model, after both."""
    mutant = Mutant(f"src/dea/narx/{name}.py", 2, 0, "parse", "NumberReplacer", 0)
    naming = TimedFile("tests/x/test_y.py", text, {"tests/x/test_y.py::test_z": 9.0})
    suite = suite_of({}, *FILES, naming)
    names = [test.split("::")[1] for test in select(mutant, CALLED, "narx", suite, 20.0).tests]
    assert names[:2] == ["test_z", "test_b"]


def test_files_of_the_room_come_before_quicker_ones_of_others():
    names = "tests/gfrf/test_gfrf_x.py", "tests/narx/test_narx_y.py"
    files = [
        TimedFile(name, "", {f"{name}::test_z": seconds})
        for name, seconds in zip(names, (1.0, 9.0), strict=True)
    ]
    every = {f"{name}|run": [2] for file in files for name in file.seconds}
    found = select(MUTANT, CALLED, "narx", suite_of(every, *files), 20.0)
    assert [test.split("/")[1] for test in found.tests] == ["narx", "gfrf"]


def test_only_tests_that_run_the_statement_are_asked():
    names = {name.split("::")[1]: name for file in FILES for name in file.seconds}
    ran = {f"{names['test_c[|-1]']}|run": [4], f"{names['test_e']}|run": [5], "": [2]}
    assert chosen(ran) == ["test_c[|-1]"]
    # What a fixture runs may be what any test of the file uses.
    assert chosen({f"{names['test_c[|-1]']}|setup": [3]}) == ["test_b", "test_c[|-1]"]


def test_where_no_test_is_seen_to_run_a_line_those_of_its_module_and_room_are_asked():
    ran = {"tests/gfrf/test_gfrf_x.py::test_e|run": [5], "": [2]}
    assert chosen(ran) == ["test_a", "test_b", "test_c[|-1]", "test_d", "test_e"]
    assert "test_e" not in chosen({"": [2]})


def test_the_tests_of_a_compiled_function_are_those_that_run_a_line_which_names_it():
    """Through the compiled function that calls it; a private name is one of its own file."""
    sources = {
        "src/dea/narx/kernels.py": "def _inner(x):\n    return x\n\n"
        "def outer(x):\n    return _inner(x)\n\ndef other(x):\n    return x\n",
        "src/dea/narx/model.py": "from dea.narx import kernels\n\ndef run(x):\n"
        "    first = kernels.outer(\n        x,\n    )\n    return kernels.other(first)\n",
        "src/dea/narx/lags.py": "def _inner(x):\n    return x\n\ndef lag(x):\n"
        "    return _inner(x)\n",
    }
    names = [f"{name}|run" for file in FILES for name in file.seconds]
    data = CoverageData(no_disk=True)
    for context, path, lines in [
        (names[0], "src/dea/narx/model.py", [4]),
        (names[1], "src/dea/narx/model.py", [7]),
        (names[2], "src/dea/narx/lags.py", [5]),
        ("", "src/dea/narx/kernels.py", [1, 4, 7]),
    ]:
        data.set_context(context)
        data.add_lines({path: lines})
    suite = Suite(FILES, data, sources)
    for line, name, expected in ((2, "_inner", 0), (5, "outer", 0), (8, "other", 1)):
        mutant = Mutant("src/dea/narx/kernels.py", line, 0, name, "NumberReplacer", 0)
        found = select(mutant, sources[mutant.file], "narx", suite, 20.0)
        assert found.tests == (names[expected].removesuffix("|run"),)


def test_files_that_call_a_compiled_function_through_a_helper_of_theirs_are_asked(tmp_path):
    text = {
        "tests/narx/test_narx_near.py": "import made_paths\n",
        "tests/narx/test_narx_far.py": "from numpy import outer_product\n",
        "tests/narx/test_narx_run.py": "",
        "tests/made_paths.py": "from made_kernels import along\n",
        "tests/made_kernels.py": "from dea.narx.kernels import outer\n",
    }
    write_files(tmp_path, text)
    cases = [
        f'<testcase classname="{name[:-3].replace("/", ".")}" name="test_a" time="1.0"/>'
        for name in text
        if "test_" in name
    ]
    report = tmp_path / "report.xml"
    report.write_text(f"<testsuite>{''.join(cases)}</testsuite>")
    sources = {
        "src/dea/narx/kernels.py": "@njit\ndef _inner(x):\n    return x\n\n"
        "@njit\ndef outer(x):\n    return _inner(x)\n",
        "src/dea/gfrf/model.py": "def run(x):\n    return outer(x)\n",
    }
    ran = CoverageData(str(tmp_path / "ran"))
    ran.set_context("tests/narx/test_narx_run.py::test_a|run")
    ran.add_lines({"src/dea/gfrf/model.py": [2]})
    ran.write()
    suite = replace(read_suite(tmp_path, report, tmp_path / "ran"), sources=sources)
    mutant = replace(MUTANT, file="src/dea/narx/kernels.py", line=3, definition="_inner")
    found = select(mutant, sources[mutant.file], "narx", suite, 20.0)
    assert sorted(found.tests) == [
        f"tests/narx/test_narx_{name}.py::test_a" for name in ("near", "run")
    ]


def test_of_a_compiled_function_that_no_function_names_all_tests_of_the_room_are_asked():
    """One test has run it uncompiled, when it was imported and checked."""
    source = "@njit\ndef slope(x):\n    return x\n\ndevice = Device(slope)\n"
    suite = suite_of({f"{next(iter(FILES[0].seconds))}|run": [3, 5]}, *FILES)
    suite = replace(suite, sources={MUTANT.file: source})
    mutant = replace(MUTANT, line=3, definition="slope")
    found = select(mutant, source, "narx", suite, 40.0)
    assert len(found.tests) == sum(len(file.seconds) for file in FILES)


def test_of_a_constant_all_tests_of_the_room_are_asked_and_not_the_one_that_imported_it():
    source = "LEAST = [\n    3,\n]\n\ndef parse(x=4):\n    return x\n"
    suite = suite_of({f"{next(iter(FILES[0].seconds))}|run": [1, 2, 5]}, *FILES)
    for line, definition in ((2, ""), (5, "parse")):
        mutant = replace(MUTANT, line=line, definition=definition)
        found = select(mutant, source, "narx", suite, 40.0)
        assert len(found.tests) == sum(len(file.seconds) for file in FILES)


def test_the_head_of_a_compound_statement_is_a_statement():
    source = "if (\n    a\n    < b\n):\n    c = 1\nelse:\n    c = 2\n"
    assert statement(source, 3) == range(1, 5)
    assert statement(source, 5) == range(5, 6)
    assert statement(source, 7) == range(7, 8)


def test_tests_that_fail_or_are_skipped_on_the_code_as_it_is_are_not_asked(tmp_path):
    (tmp_path / "tests/narx").mkdir(parents=True)
    (tmp_path / "tests/narx/test_x.py").write_text("")
    case = '<testcase classname="tests.narx.test_x{}" name="test_{}" time="2.5">{}</testcase>'
    (tmp_path / "report.xml").write_text(
        "<testsuites><testsuite>"
        + case.format(".Good", "a[1]", "")
        + case.format("", "b", '<failure message="" />')
        + case.format("", "c", '<skipped message="" />')
        + "</testsuite></testsuites>"
    )
    data = CoverageData(str(tmp_path / "ran"))
    data.add_lines({"src/dea/narx/x.py": [1]})
    data.write()
    suite = read_suite(tmp_path, tmp_path / "report.xml", tmp_path / "ran")
    [file] = suite.files
    assert file.seconds == {"tests/narx/test_x.py::Good::test_a[1]": 2.5}
    assert file.room == "narx"


def test_the_rate_counts_what_could_be_tested():
    outcomes = ["killed"] * 8 + ["timeout", "survived", "incompetent"]
    rate, low, high = kill_rate(outcomes)
    assert rate == 0.9
    assert low < 0.6 < 0.98 < high
    assert kill_rate(["incompetent"]) is None


def test_survivors_are_listed_with_their_change():
    row = {
        "room": "narx", "file": "src/dea/narx/x.py", "line": 3, "definition": "f",
        "operator": "AddNot", "outcome": "survived", "diff": ["-if a:", "+if not a:"],
        "control": None,
    }  # fmt: skip
    killed = row | {"outcome": "killed", "control": "killed"}
    report = markdown([row, killed], {}, seed=1, budget=60.0)
    assert "1 mutants were run beside: 1 of these runs failed" in " ".join(report.split())
    assert "| narx | 1 | 0 | 1 | 0 | 0 | 50.0 |" in report
    assert report.count("| `narx/x.py` f | `if a:` → `if not a:` |  |") == 1
    judged = {("src/dea/narx/x.py", "if a:", "if not a:"): "both do the same"}
    report = markdown([row, killed], judged, seed=1, budget=60.0)
    assert "| narx | 1 | 0 | 1 | 1 | 0 | 50.0 |" in report
    assert "| both do the same |" in report


def test_every_judgement_is_of_a_change_that_the_code_still_allows():
    for (file, before, after), why in judgements().items():
        code = " ".join((ROOT / file).read_text().split())
        assert before in code, f"{file} no longer has `{before}`"
        assert after != before
        assert why


def test_what_was_compiled_is_kept_where_the_mutant_cannot_reach_it(tmp_path):
    place = Workplace(ROOT, tmp_path / "copy")
    compiled = tmp_path / "copy" / "compiled"
    names = [
        "narx_1a2b/kernels.run-9.py311",
        "narx_1a2b/simulation.f-1.py311",
        "modbus_3c/codec.g-1.py311",
        "plant_4d/made_conditions.h-1.py311",  # of a test
    ]
    for name in names:
        (compiled / name).parent.mkdir(exist_ok=True)
        (compiled / f"{name}.nbi").touch()
        (compiled / f"{name}.1.nbc").touch()
    source = (ROOT / "src/dea/narx/kernels.py").read_text()
    seen = []

    def pytest_runs(arguments, folder, timeout):
        mutated = (tmp_path / "copy/src/dea/narx/kernels.py").read_text()
        seen.extend(sorted(path.name for path in folder.rglob("*.nb?")))
        for name in ("codec.g-1.py311.2.nbc", "../narx_1a2b/kernels.run-9.py311.2.nbc"):
            (folder / "modbus_3c" / name).parent.mkdir(exist_ok=True)
            (folder / "modbus_3c" / name).touch()
        return 0 if mutated == source + "\n" else 1

    place._pytest = pytest_runs
    assert place.test("src/dea/narx/kernels.py", source + "\n", ["tests"], timeout=1.0) == 0
    assert seen == ["codec.g-1.py311.1.nbc", "codec.g-1.py311.nbi"]
    assert (tmp_path / "copy/src/dea/narx/kernels.py").read_text() == source
    assert len(list(compiled.rglob("*.nb?"))) == 9
    assert (compiled / "modbus_3c/codec.g-1.py311.2.nbc").exists()


PROJECT = {
    "pyproject.toml": "[tool.pytest.ini_options]\npythonpath = ['src']\n",
    "README.md": "A project.\n",
    "config/limits.yaml": "limit: 1\n",
    "src/dea/__init__.py": "",
    "src/dea/terms.py": "def more(x):\n    return x + 1\n",
    "tests/conftest.py": "from hypothesis import settings\n\n"
    "settings.register_profile('first_failure')\n",
    "tests/test_terms.py": "from dea.terms import more\n\n\ndef test_more():\n"
    "    assert more(1) == 2\n",
    "tests/workflow/test_long.py": "def test_long():\n    raise AssertionError\n",
    ".gitignore": "build/\nresults/\n",
}


@pytest.fixture
def project(tmp_path):
    """A small project in a repository of its own."""
    root = tmp_path / "project"
    write_files(root, PROJECT)
    subprocess.run(["git", "init", "--quiet"], cwd=root, check=True)
    subprocess.run(["git", "add", "."], cwd=root, check=True)
    (root / "results").mkdir()
    (root / "results" / "made.nc").touch()
    return root


def campaign_of(root, rooms=("terms",)):
    return Campaign(root, root / "build", rooms, count=1, seed=1, budget=60.0, workers=1)


def files_of(folder):
    found = {str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file()}
    return {
        name for name in found if not name.startswith(("build", "results", "compiled", ".git/"))
    }


def test_a_copy_holds_what_git_knows_or_would_add(project, tmp_path):
    (project / "tests/test_new.py").touch()
    copy = Workplace(project, tmp_path / "copy").folder
    assert files_of(copy) == {*PROJECT, "tests/test_new.py"}
    before = (copy / "src/dea/terms.py").stat().st_mtime_ns
    (project / "tests/test_new.py").unlink()
    (project / "config/limits.yaml").write_text("limit: 2\n")
    (copy / "results").mkdir()
    (copy / "results/left_by_a_test").touch()
    Workplace(project, copy)
    assert files_of(copy) == set(PROJECT)
    assert not (copy / "results/left_by_a_test").exists()
    assert (copy / "config/limits.yaml").read_text() == "limit: 2\n"
    assert (copy / "src/dea/terms.py").stat().st_mtime_ns == before


def test_a_folder_that_git_does_not_know_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    (tmp_path / "project").mkdir()
    with pytest.raises(InputError, match="no repository"):
        Workplace(tmp_path / "project", tmp_path / "copy")


def test_what_a_test_may_read_decides_whether_the_suite_is_run_again(project):
    kept = campaign._state(project)
    (project / "README.md").write_text("Another page.\n")
    assert campaign._state(project) == kept
    (project / "config/limits.yaml").write_text("limit: 2\n")
    assert campaign._state(project) != kept


def test_the_tests_of_the_workflow_are_not_run(project):
    place = Workplace(project, project / "build/0")
    suite = campaign._suite(campaign_of(project), place, progress_bars())
    assert [file.path for file in suite.files] == ["tests/test_terms.py"]
    (report,) = (project / "build").glob("suite-*/report.xml")
    assert "test_long" not in report.read_text()


def test_a_file_that_fails_on_the_code_as_it_is_is_refused(project):
    (project / "tests/test_other.py").write_text("import nothing_like_it\n")
    with pytest.raises(InputError, match="test_other: it cannot be collected"):
        campaign.run(campaign_of(project), project / "results/mutants.json")
    assert not list((project / "build").glob("suite-*/report.xml"))


def test_a_room_without_a_place_to_change_is_refused_before_any_test(project, monkeypatch):
    def refuses(*arguments):
        raise AssertionError("the suite is run")

    monkeypatch.setattr(campaign, "_suite", refuses)
    with pytest.raises(InputError, match="can be changed"):
        campaign.run(campaign_of(project, ("narx",)), project / "results/mutants.json")


def alive(process):
    stat = Path(f"/proc/{process}/stat")
    return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"


@pytest.mark.slow
@pytest.mark.parametrize("when", ["the suite", "a mutant"])
def test_a_campaign_that_is_ended_ends_its_tests(project, when, tmp_path):
    """At once, though a mutant's tests may take minutes."""
    long = "pathlib.Path({said!r}).write_text(str(os.getpid())), time.sleep(60)".format(
        said=str(tmp_path / "process")
    )
    waits = {"the suite": "more(1) == 2", "a mutant": "more(1) != 2"}[when]
    (project / "tests/test_terms.py").write_text(
        "import os, pathlib, time\nfrom dea.terms import more\n\n\ndef test_more():\n"
        f"    if {waits}:\n        {long}\n"
    )
    program = (
        "import sys, pathlib, benchmarks.mutants.__main__ as m; "
        f"m.ROOT = pathlib.Path({str(project)!r}); "
        "m.main(['--count', '1', '--cores', '1', '--room', 'terms'])"
    )
    printed = tmp_path / "printed"
    with printed.open("w") as output:
        process = subprocess.Popen(
            [sys.executable, "-c", program], cwd=ROOT, stdout=output, stderr=subprocess.STDOUT
        )
    try:
        said = tmp_path / "process"
        until(lambda: process.poll() is not None or (said.exists() and said.read_text()), 60.0)
        assert process.poll() is None, printed.read_text()
        process.terminate()
        assert process.wait(10.0) == 128 + signal.SIGTERM
        until(lambda: not alive(int(said.read_text())), 5.0)
    finally:
        process.kill()


def until(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("status", "outcome"),
    [(0, "survived"), (1, "killed"), (-11, "killed"), (None, "timeout"), (2, "incompetent")],
)
def test_a_signal_that_ends_the_tests_notices_the_mutant(status, outcome):
    assert judged(status) == outcome
