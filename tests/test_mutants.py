"""The mutants that the tests are tried with: where the code may be changed, and what is counted."""

from pathlib import Path

import pytest
from benchmarks.mutants.report import kill_rate, markdown
from benchmarks.mutants.sites import Mutant, mutants
from benchmarks.mutants.suite import TimedFile, select
from benchmarks.mutants.workplace import Workplace

ROOT = Path(__file__).parents[1]
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


def test_the_likeliest_tests_come_first_and_stay_in_the_budget():
    mutant = Mutant("src/dea/narx/terms.py", 1, 0, "parse", "NumberReplacer", 0)
    files = [
        TimedFile("tests/narx/test_narx_model.py", "", {"test_d": 1.0}),
        TimedFile("tests/narx/test_narx_other.py", "parse", {"test_b": 3.0, "test_c": 30.0}),
        TimedFile("tests/narx/test_narx_terms.py", "", {"test_a": 5.0}),
    ]
    chosen = select(mutant, files, budget=20.0)
    assert [test.split("::")[1] for test in chosen.tests] == ["test_a", "test_b", "test_d"]
    assert chosen.seconds == pytest.approx(9.0)
    assert len(select(mutant, files, budget=8.5).tests) == 2


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
    }  # fmt: skip
    report = markdown([row, row | {"outcome": "killed"}], seed=1, budget=60.0)
    assert "| narx | 1 | 0 | 1 | 0 | 50.0 |" in report
    assert report.count("+if not a:") == 1


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
        return 0 if mutated == source + "\n" else 1

    place._pytest = pytest_runs
    assert place.test("src/dea/narx/kernels.py", source + "\n", ["tests"], timeout=1.0) == 0
    assert seen == ["codec.g-1.py311.1.nbc", "codec.g-1.py311.nbi"]
    assert (tmp_path / "copy/src/dea/narx/kernels.py").read_text() == source
    assert len(list(compiled.rglob("*.nb?"))) == 8
