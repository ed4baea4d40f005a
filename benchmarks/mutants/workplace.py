"""A copy of the project to change: what is tested there, and the compiled functions it keeps."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import grimp

from dea.errors import InputError

LINKED = ("data", "records")  # measured records, which no test changes
# What is not the project's in its copy.
OWN = (*LINKED, "compiled", "arguments")
SKIPPED = "__pycache__"
INTERPRETER_OPTIONS = {
    "PYTHONDONTWRITEBYTECODE": "1",  # two mutants within a second look alike to its cache
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}
ALWAYS = ("-q", "-p", "no:cacheprovider", "--hypothesis-seed=0")
# A failure that does not come again is that of a busy machine.
OF_A_MUTANT = (
    "-x", "--reruns", "1", "-p", "no:xdist", "-p", "no:pytest_cov",
    "--hypothesis-profile=first_failure",
)  # fmt: skip
# The jobs of the workflow's tests run in processes of their own, on a study that takes a minute.
OF_ALL = (
    "--ignore=tests/workflow", "--dist", "loadfile", "--no-loadscope-reorder", "--cov",
    "--cov-context=test", "--cov-report=",
)  # fmt: skip


class Workplace:
    """A copy of the project in a folder of its own."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        _follow(root, folder)
        for part in LINKED:
            if (root / part).exists() and not (folder / part).exists():
                (folder / part).symlink_to(root / part)
        self._compiled = folder / "compiled"
        self._compiled.mkdir(exist_ok=True)
        self._graph = _import_graph(folder / "src")
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = False

    def run_all(self, workers: int, report: Path, ran: Path) -> int | None:
        """Run the whole suite; write its JUnit report and which lines each test ran.

        Return pytest's status.
        """
        arguments = [*OF_ALL, "--numprocesses", str(workers), f"--junitxml={report}"]
        return self._pytest(arguments, self._compiled, None, {"COVERAGE_FILE": str(ran)})

    def stop(self) -> None:
        """End the tests that run here, from another thread; no others begin."""
        self._stopped = True
        if self._process is not None:
            _end(self._process)

    def test(self, file: str, mutated: str, arguments: Sequence[str], timeout: float) -> int | None:
        """Run pytest on a mutated module; return its status, none where it took too long."""
        path = self.folder / file
        original, times = path.read_bytes(), path.stat()
        path.write_text(mutated)
        try:
            with self._compiled_elsewhere(file) as compiled:
                return self._pytest([*OF_A_MUTANT, *arguments], compiled, timeout)
        finally:
            path.write_bytes(original)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    @contextmanager
    def _compiled_elsewhere(self, file: str) -> Iterator[Path]:
        """Yield a folder with the compiled functions of the modules that ``file`` cannot reach.

        Numba compiles a function again where its own module changed, and not where one did that it
        calls or takes a constant from. What the functions of tests call is not in the graph. What
        is compiled of those modules meanwhile is kept for the next mutant.
        """
        module = ".".join(Path(file).with_suffix("").relative_to("src").parts)
        module = module.removesuffix(".__init__")
        changed = {module, *self._graph.find_downstream_modules(module)}
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            for kept in self._out_of_reach(self._compiled, changed):
                copy = Path(folder) / kept.relative_to(self._compiled)
                copy.parent.mkdir(exist_ok=True)
                os.link(kept, copy)
            yield Path(folder)
            for made in self._out_of_reach(Path(folder), changed):
                kept = self._compiled / made.relative_to(folder)
                kept.parent.mkdir(exist_ok=True)
                made.replace(kept)

    def _out_of_reach(self, folder: Path, changed: set[str]) -> list[Path]:
        """Return the files of compiled functions that are of none of the changed modules."""
        found = []
        for path in folder.rglob("*.nb?"):
            compiled = f".{path.parent.name.rpartition('_')[0]}.{path.name.split('.')[0]}"
            own = {name for name in self._graph.modules if f".{name}".endswith(compiled)}
            if own and own.isdisjoint(changed):
                found.append(path)
        return found

    def _pytest(
        self,
        arguments: Sequence[str],
        compiled: Path,
        timeout: float | None,
        variables: Mapping[str, str] | None = None,
    ) -> int | None:
        given = self.folder / "arguments"
        given.write_text("\n".join(arguments))
        environment = os.environ | INTERPRETER_OPTIONS | {
            "PYTHONPATH": str(self.folder / "src"),
            "NUMBA_CACHE_DIR": str(compiled), **(variables or {}),
        }  # fmt: skip
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *ALWAYS, f"@{given}"],
            cwd=self.folder, env=environment, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self._process = process
        try:
            if self._stopped:
                raise InterruptedError("the campaign has been ended")
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            # A test may have left processes behind, of which a next one would find the ports taken.
            _end(process)
            process.wait()


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process and all of its session."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def tracked(root: Path) -> list[Path]:
    """Return the project's files relative to ``root``: those that git knows or would add.

    Raises
    ------
    InputError
        If ``root`` is no repository.
    """
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        remedy = "Run the campaign in a clone: git says which files are the project's."
        raise InputError("it is no repository of git", file=root, remedy=remedy)
    names = sorted(set(filter(None, listed.stdout.split("\0"))))
    return [Path(name) for name in names if (root / name).is_file()]


def _follow(root: Path, copy: Path) -> None:
    """Make ``copy`` hold the files of ``root``; one that is so already keeps its time."""
    names = tracked(root)
    for path in _held(copy) - set(names):
        (copy / path).unlink()
    for name in names:
        source, target = root / name, copy / name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)


def _held(copy: Path) -> set[Path]:
    """Return the files in a copy that may be the project's, relative to it."""
    found: set[Path] = set()
    for folder, folders, files in os.walk(copy):
        here = Path(folder).relative_to(copy)
        skipped = OWN if here == Path() else (SKIPPED,)
        folders[:] = [name for name in folders if name not in skipped]
        found |= {here / name for name in files if name not in skipped}
    return found


def _import_graph(source: Path) -> grimp.ImportGraph:
    sys.path.insert(0, str(source))
    try:
        return grimp.build_graph("dea", cache_dir=None)
    finally:
        sys.path.remove(str(source))
