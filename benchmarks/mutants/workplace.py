"""A copy of the project to change: what is tested there, and the compiled functions it keeps."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import grimp

PARTS = (
    "Snakefile", "Makefile", "pyproject.toml", "benchmarks", "config", "src", "tests", "workflow",
    "docs",
)  # fmt: skip
LINKED = ("data", "records")  # measured records, which no test changes
SKIPPED = "__pycache__"
INTERPRETER_OPTIONS = {
    "PYTHONDONTWRITEBYTECODE": "1",  # two mutants within a second look alike to its cache
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
}
PYTEST = (
    "-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:xdist",
    "--hypothesis-seed=0", "--hypothesis-profile=first_failure",
)  # fmt: skip


class Workplace:
    """A copy of the project in a folder of its own."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for part in PARTS:
            _follow(root / part, folder / part)
        for part in LINKED:
            if (root / part).exists() and not (folder / part).exists():
                (folder / part).symlink_to(root / part)
        self._compiled = folder / "compiled"
        self._compiled.mkdir(exist_ok=True)
        self._graph = _import_graph(folder / "src")

    def warm(self, arguments: Sequence[str]) -> tuple[int | None, bool]:
        """Run pytest on the code as it is, and keep what numba compiles; return whether it did."""
        before = sum(1 for _ in self._compiled.rglob("*.nbc"))
        status = self._pytest(arguments, self._compiled, None)
        return status, sum(1 for _ in self._compiled.rglob("*.nbc")) > before

    def test(self, file: str, mutated: str, arguments: Sequence[str], timeout: float) -> int | None:
        """Run pytest on a mutated module; return its status, none where it took too long."""
        path = self.folder / file
        original, times = path.read_bytes(), path.stat()
        path.write_text(mutated)
        try:
            with self._compiled_elsewhere(file) as compiled:
                return self._pytest(arguments, compiled, timeout)
        finally:
            path.write_bytes(original)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    @contextmanager
    def _compiled_elsewhere(self, file: str) -> Iterator[Path]:
        """Yield a folder with the compiled functions of the modules that ``file`` cannot reach.

        Numba compiles a function again where its own module changed, and not where one did that it
        calls or takes a constant from. What the functions of tests call is not in the graph.
        """
        module = ".".join(Path(file).with_suffix("").relative_to("src").parts)
        module = module.removesuffix(".__init__")
        changed = {module, *self._graph.find_downstream_modules(module)}
        modules = self._graph.modules
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            for kept in self._compiled.rglob("*.nb?"):
                compiled = f"{kept.parent.name.rpartition('_')[0]}.{kept.name.split('.')[0]}"
                own = {name for name in modules if f".{name}".endswith(f".{compiled}")}
                if own and own.isdisjoint(changed):
                    copy = Path(folder) / kept.relative_to(self._compiled)
                    copy.parent.mkdir(exist_ok=True)
                    os.link(kept, copy)
            yield Path(folder)

    def _pytest(
        self, arguments: Sequence[str], compiled: Path, timeout: float | None
    ) -> int | None:
        given = self.folder / "arguments"
        given.write_text("\n".join(arguments))
        environment = os.environ | INTERPRETER_OPTIONS | {
            "PYTHONPATH": str(self.folder / "src"),
            "NUMBA_CACHE_DIR": str(compiled),
        }  # fmt: skip
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *PYTEST, f"@{given}"],
            cwd=self.folder, env=environment, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            # A test may have left processes behind, of which a next one would find the ports taken.
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _follow(source: Path, copy: Path) -> None:
    """Make ``copy`` the same as ``source``; a file that is so already keeps its time."""
    if source.is_dir():
        copy.mkdir(exist_ok=True)
        names = {path.name for path in source.iterdir() if not path.match(SKIPPED)}
        for path in copy.iterdir():
            if path.name not in names and not path.match(SKIPPED):
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        for name in names:
            _follow(source / name, copy / name)
    elif not copy.exists() or copy.read_bytes() != source.read_bytes():
        shutil.copy(source, copy)


def _import_graph(source: Path) -> grimp.ImportGraph:
    sys.path.insert(0, str(source))
    try:
        return grimp.build_graph("dea", cache_dir=None)
    finally:
        sys.path.remove(str(source))
