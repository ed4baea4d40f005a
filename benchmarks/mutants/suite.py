"""Which tests are asked about a mutant: those of its room, the likeliest to notice it first."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from benchmarks.mutants.sites import Mutant


@dataclass(frozen=True)
class TimedFile:
    """A file of tests, and the seconds that each test of it takes on the code as it is."""

    path: str  # relative to the project
    text: str
    seconds: dict[str, float]  # by the test's name, in the order of the file

    @property
    def total(self) -> float:
        """Seconds of all tests."""
        return sum(self.seconds.values())


@dataclass(frozen=True)
class Selection:
    """The tests that a mutant is put before, in order."""

    tests: tuple[str, ...]  # pytest's names
    seconds: float  # on the code as it is
    state: str  # a hash of the tests' files


def test_files(root: Path, room: str) -> list[Path]:
    """Return the files of tests of a room."""
    files = sorted((root / "tests").rglob("test_*.py"))
    return [file for file in files if room in file.parts or file.stem == f"test_{room}"]


def read_report(report: Path) -> dict[str, float]:
    """Return the seconds of each test in a JUnit report, in the order they ran."""
    return {
        f"{'::'.join(_classes(case))}{case.attrib['name']}": float(case.attrib["time"])
        for case in ElementTree.parse(report).iter("testcase")
        if case.find("skipped") is None
    }


def select(mutant: Mutant, files: Sequence[TimedFile], budget: float) -> Selection:
    """Return the tests to run, at most ``budget`` seconds of them.

    First the files that carry the module's name, then those that name the function changed or
    import the module, then the others of its room; among these the quicker ones before. A test
    that alone takes more than half of the budget is left out.
    """
    tests: list[str] = []
    seconds, state = 0.0, sha256()
    for file in sorted(files, key=lambda file: (_distance(mutant, file), file.total)):
        for name, time in file.seconds.items():
            if time <= budget / 2 and seconds + time <= budget:
                tests.append(f"{file.path}::{name}")
                seconds += time
        state.update(file.text.encode())
    return Selection(tuple(tests), seconds, state.hexdigest())


def _distance(mutant: Mutant, file: TimedFile) -> int:
    module = Path(mutant.file).with_suffix("").relative_to("src")
    if module.name.strip("_") in Path(file.path).stem:
        return 0
    dotted = ".".join(module.parts)
    if (mutant.definition and mutant.definition in file.text) or dotted in file.text:
        return 1
    return 2


def _classes(case: ElementTree.Element) -> list[str]:
    """Return the classes a test is in, each name of which starts with a capital."""
    names = [name for name in case.attrib["classname"].split(".") if name[:1].isupper()]
    return [*names, ""] if names else []
