"""Which tests are asked about a mutant: those that run its line, the likeliest ones first."""

import re
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from coverage import CoverageData

from benchmarks.mutants.sites import Mutant
from benchmarks.mutants.syntax import compiled, in_function, mentions, statement
from dea.errors import InputError

# Lines that run in the set-up of a test may be those of a fixture that its whole file shares.
_SETUP = "|setup"


@dataclass(frozen=True)
class TimedFile:
    """A file of tests, and the seconds that each test of it takes on the code as it is."""

    path: str  # relative to the project
    text: str
    seconds: Mapping[str, float]  # of those that pass, by pytest's name, in the order they ran
    helpers: str = ""  # the text of the modules beside the tests that it imports

    @property
    def whole(self) -> str:
        """Its text with that of its helpers."""
        return self.text + self.helpers

    @cached_property
    def names(self) -> frozenset[str]:
        """Every word of it and of its helpers."""
        return frozenset(re.findall(r"\w+", self.whole))

    @property
    def room(self) -> str:
        """The folder of ``tests`` it is in, or what its name says."""
        parts = Path(self.path).parts
        return parts[1] if len(parts) > 2 else Path(self.path).stem.removeprefix("test_")


@dataclass(frozen=True)
class Suite:
    """All tests, and what each of them ran on the code as it is."""

    files: Sequence[TimedFile]
    ran: CoverageData  # by pytest's name and phase of each test
    sources: Mapping[str, str]  # of the package, by path relative to the project

    def running(self, file: str, lines: Iterable[int] | None = None) -> set[str]:
        """Return the tests that run any of these lines of a file, or any line of it at all.

        Where a line runs while a test is set up, all tests of that test's file count.
        """
        contexts = self.ran.contexts_by_lineno(file)
        wanted = contexts if lines is None else [line for line in lines if line in contexts]
        found = {context for line in wanted for context in contexts[line] if context}
        shared = {context.split("::")[0] for context in found if context.endswith(_SETUP)}
        return {context.rpartition("|")[0] for context in found} | {
            name for each in self.files if each.path in shared for name in each.seconds
        }

    def calling(self, file: str, function: str) -> tuple[set[str], set[str]]:
        """Return the tests that run a line which names a function, and what others may name.

        These are the function and those of which no test is seen to run the line that calls it, as
        of compiled ones. Where such a one names the function, the lines that name that one are
        asked for in its place. Lines outside functions run once for all tests, whichever of them is
        first. A private name is one of its own file.
        """
        found: set[str] = set()
        left, seen = [(file, function)], {(file, function)}
        while left:
            home, name = left.pop()
            for path, text in self.sources.items():
                if name not in text or (name.startswith("_") and path != home):
                    continue
                for line, around in mentions(text, name):
                    if not around:
                        continue
                    tests = self.running(path, statement(text, line))
                    found |= tests
                    if not tests and (path, around) not in seen:
                        seen.add((path, around))
                        left.append((path, around))
        return found, {name for _, name in seen}


@dataclass(frozen=True)
class Selection:
    """The tests that a mutant is put before, in order."""

    tests: tuple[str, ...]  # pytest's names
    seconds: float  # on the code as it is
    state: str  # a hash of the tests' files


def read_suite(root: Path, report: Path, ran: Path) -> Suite:
    """Return the tests that passed in one run, from its JUnit report and coverage's data.

    Raises
    ------
    InputError
        If a file of tests cannot be collected.
    """
    seconds: dict[str, dict[str, float]] = defaultdict(dict)
    for case in ElementTree.parse(report).iter("testcase"):
        error = case.find("error")
        if error is not None and error.get("message") == "collection failure":
            remedy = "Mend it, or what it needs and the copy does not hold."
            raise InputError("it cannot be collected", file=case.attrib["name"], remedy=remedy)
        if any(case.find(outcome) is not None for outcome in ("skipped", "failure", "error")):
            continue
        module, classes = _file_and_classes(case.attrib["classname"])
        name = "::".join([module, *classes, case.attrib["name"]])
        seconds[module][name] = float(case.attrib["time"])
    data = CoverageData(str(ran))
    data.read()
    modules = {
        path.stem: path.read_text()
        for path in root.glob("tests/**/*.py")
        if not path.stem.startswith("test_")
    }
    texts = {path: (root / path).read_text() for path in sorted(seconds)}
    files = [
        TimedFile(path, text, seconds[path], "".join(_helpers(text, modules)))
        for path, text in texts.items()
    ]
    sources = {
        str(path.relative_to(root)): path.read_text() for path in sorted(root.glob("src/**/*.py"))
    }
    return Suite(files, data, sources)


def select(mutant: Mutant, source: str, room: str, suite: Suite, budget: float) -> Selection:
    """Return the tests to run, at most ``budget`` seconds of them.

    First come the files that carry the module's name in theirs, then those that import it or name
    it in their text, as an effect's, then those that name the function changed, then those of the
    room, then the others; among these the quicker ones before. Half of the budget is for them in
    that order, the other half for the quickest of those that are left, of which it holds the most.
    A test that alone takes more than half of the budget is left out, and a file with one that takes
    more than all of it, since what its tests share may be what takes long.
    """
    asked = _asked(mutant, source, room, suite)
    chosen = [
        (file, {name: time for name, time in file.seconds.items() if name in asked})
        for file in suite.files
        if max(file.seconds.values()) <= budget
    ]

    def nearest(pair: tuple[TimedFile, Mapping[str, float]]) -> tuple[int, bool, float]:
        file, each = pair
        return _distance(mutant, file), file.room != room, sum(each.values())

    chosen.sort(key=nearest)
    times = {name: time for _, each in chosen for name, time in each.items()}
    kept, seconds = set(), 0.0
    for order, limit in ((times, budget / 2), (sorted(times, key=times.__getitem__), budget)):
        for name in order:
            if name not in kept and seconds + times[name] <= limit:
                kept.add(name)
                seconds += times[name]
    state = sha256()
    for file, each in chosen:
        if each:
            state.update(file.whole.encode())
    return Selection(tuple(name for name in times if name in kept), seconds, state.hexdigest())


def _asked(mutant: Mutant, source: str, room: str, suite: Suite) -> set[str]:
    """Return the tests that may notice a mutant.

    They are those that run the changed line. Where its function is compiled, or run by none of
    them: those that run a line which names it or a compiled function that calls it, and those of
    files that name its module, or use its package and name one of these. Where there are none, as
    of constants and in other processes: those of files that name it or its module, those that run
    its module, and those of its room.
    """

    def of(files: Iterable[TimedFile]) -> set[str]:
        return {name for file in files for name in file.seconds}

    naming = [file for file in suite.files if _distance(mutant, file) < 3]
    # A line outside functions runs once for all tests, whichever of them is first.
    if in_function(source, mutant.line):
        running = suite.running(mutant.file, statement(source, mutant.line))
        if running and not compiled(source, mutant.definition):
            return running
        # What a check of a compiled function runs of it uncompiled are lines of few tests.
        called, names = suite.calling(mutant.file, mutant.definition)
        if called:
            package = ".".join(Path(mutant.file).with_suffix("").parts[1:3])
            users = (file for file in suite.files if package in file.whole)
            naming += [file for file in users if names & file.names]
            return running | called | of(naming)
    in_room = [file for file in suite.files if file.room == room]
    return suite.running(mutant.file) | of(naming) | of(in_room)


def _distance(mutant: Mutant, file: TimedFile) -> int:
    module = Path(mutant.file).with_suffix("").relative_to("src")
    name = module.name.strip("_")
    if f"_{name}_" in f"_{Path(file.path).stem}_":
        return 0
    package, dotted = ".".join(module.parts[:-1]), ".".join(module.parts)
    imported = re.search(rf"from {re.escape(package)} import [^)]*?\b{module.name}\b", file.text)
    if dotted in file.text or imported or ("_" in name and module.name in file.text):
        return 1
    if mutant.definition and mutant.definition in file.text:
        return 2
    return 3


def _helpers(text: str, modules: Mapping[str, str]) -> list[str]:
    """Return the texts of the modules beside the tests that a text imports, and those import."""
    left, found = [text], dict[str, str]()
    while left:
        names = re.findall(r"^(?:from|import) (\w+)", left.pop(), re.MULTILINE)
        further = {name: modules[name] for name in names if name in modules and name not in found}
        found |= further
        left += further.values()
    return list(found.values())


def _file_and_classes(dotted: str) -> tuple[str, list[str]]:
    """Return the file of a test and the classes it is in, each of which starts with a capital."""
    parts = dotted.split(".")
    classes = [part for part in parts if part[:1].isupper()]
    return "/".join(parts[: len(parts) - len(classes)]) + ".py", classes
