"""Which job made a file: its settings, inputs, code and environment, and whether it still is.

A job keeps a description beside each of its products, ``results/provenance/PATH.json`` for
``results/PATH``. What it says of settings and hashes is the same wherever and whenever the
job runs, and has an identity, which the product itself may carry (:func:`current_job`). Commit,
processor and linear algebra of the run stand apart.
"""

import fcntl
import hashlib
import json
import os
import platform
import shutil
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, get_origin, get_type_hints

from dea.atomic_file import atomic
from dea.checksum import sha256
from dea.errors import InputError

RESULTS = Path("results")
FOLDER = RESULTS / "provenance"
# What the workflow says of a job; without them a program runs outside of the workflow.
JOB, RULE, CODE, COMMIT, RUN = "DEA_JOB", "DEA_RULE", "DEA_CODE", "DEA_COMMIT", "DEA_RUN"
# Key of a description: the SHA-256 of all else that it says.
WHOLE = "description"
# What a description holds, each of its kind; `run` may hold `blas` and `read` too.
_OF_ALL = {"job": dict, "identity": str, "run": dict, "sha256": str}
_OF_RUN = {"processor": str, "commit": str, "instructions": dict, "options": list}
# With these a user makes numerical libraries take other instructions than the processor's best.
INSTRUCTIONS = "NUMBA_CPU_NAME", "OPENBLAS_CORETYPE"

_current: list["Job"] = []
# SHA-256 of what the job has read beside its inputs, by path.
_read: dict[str, str] = {}


@dataclass(frozen=True)
class Job:
    """What determines the products of a job of ``rule``, its name that of its log.

    ``inputs`` and ``code`` hold the SHA-256 of each file by its path; ``environment`` is that of
    the names and versions of all installed packages.
    """

    name: str
    rule: str
    command: list[str]
    settings: Mapping[str, Any]
    inputs: Mapping[str, str]
    code: Mapping[str, str]
    environment: str

    @property
    def identity(self) -> str:
        """SHA-256 of all of it, in hex."""
        return _hash_of(asdict(self))


_OF_JOB = {name: get_origin(kind) or kind for name, kind in get_type_hints(Job).items()}


@contextmanager
def job(
    command: list[str],
    settings: Mapping[str, Any],
    *,
    inputs: Iterable[Path],
    outputs: Iterable[Path],
    free: Iterable[str] = (),
) -> Iterator[None]:
    """Run the block as a job of the workflow, if this process runs one.

    Inputs that are results are compared with what their own jobs say; after the block the
    description of this job is kept beside each of its outputs. ``free`` are options of the command
    that no result depends on.

    Raises
    ------
    InputError
        If a result among ``inputs`` is not what its own job made, or was made from something else
        than what lies there now.
    """
    if JOB not in os.environ:
        yield
        return
    products = list(outputs)
    with _alone(Path(os.environ[JOB])):
        for file in [*products, *map(description_of, products)]:
            _forget_partial(file)
        _forget_folders(products)
        found = {str(path): digest(path) for path in inputs}
        for path, sha in found.items():
            check(Path(path), sha)
        code = {path: digest(Path(path)) for path in os.environ[CODE].split()}
        name, rule = _name(os.environ[JOB]), os.environ[RULE]
        described = Job(name, rule, command, dict(settings), found, code, environment())
        _current[:] = [described]
        _read.clear()
        try:
            yield
        finally:
            _current.clear()
        beside = {path: sha for path, sha in sorted(_read.items()) if path not in found}
        run = run_facts() | {"options": list(free)} | ({"read": beside} if beside else {})
        for product in products:
            _describe(product, described, run)


def note_read(files: Iterable[Path]) -> None:
    """Keep with the job that runs, if one does, that it has read these files.

    They are no part of its identity, since they are known only once it runs.
    """
    if _current:
        _read.update({str(file): digest(file) for file in files})


@contextmanager
def _alone(log: Path) -> Iterator[None]:
    """Wait until no other process runs the job with this log, as an earlier run's may.

    Jobs outlive a workflow that is killed. One that has not begun by then leaves its products to
    the next run, which may have made them meanwhile.

    Raises
    ------
    InputError
        If the run that began this job has ended.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("a") as file:
        # Some shared file systems of clusters know no such locks.
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX)
        if RUN in os.environ and not Path("/proc", os.environ[RUN]).exists():
            raise InputError(
                "the run that began this job has ended", file=log, remedy="Run the workflow again"
            )
        yield


def _forget_partial(file: Path) -> None:
    """Remove what a killed process left of a file that it did not finish."""
    for partial in file.parent.glob(f".{file.name}.*.partial"):
        partial.unlink()


def _forget_folders(products: Iterable[Path]) -> None:
    """Remove products that are folders, which a job of an earlier run may have made meanwhile.

    Snakemake removes them when it begins a job, and cannot know of that one.
    """
    for product in products:
        if product.is_dir():
            shutil.rmtree(product)


def _describe(product: Path, described: Job, run: Mapping[str, Any]) -> None:
    content = {"job": asdict(described), "identity": described.identity, "run": run}
    content["sha256"] = digest(product)
    text = json.dumps({**content, WHOLE: _hash_of(content)}, indent=1, sort_keys=True)
    with atomic(description_of(product)) as partial:
        partial.write_text(f"{text}\n", encoding="utf-8")


def read_description(file: Path) -> dict[str, Any]:
    """Return what a description says; it holds at least what the jobs of now write.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no description, or lacks something that one says.
    """
    said: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    whole = (
        _holds(said, _OF_ALL)
        and _holds(said["job"], _OF_JOB)
        and said["job"].keys() == _OF_JOB.keys()
        and _holds(said["run"], _OF_RUN)
        and isinstance(said["run"].get("blas", ""), str)
        and isinstance(said["run"].get("read", {}), dict)
    )
    if not whole:
        raise ValueError("it is no description of a job")
    return said


def _holds(content: Any, kinds: Mapping[str, type]) -> bool:
    """Return whether this is a mapping with a value of the right kind for each key."""
    return isinstance(content, dict) and all(
        isinstance(content.get(key), kind) for key, kind in kinds.items()
    )


def was_edited(description: Path) -> bool:
    """Return whether a description is another than the one that its job kept.

    The identity does not tell of the run, which differs between two runs of the same job. One that
    was kept before descriptions had a hash of their own, or that cannot be read, tells nothing.
    """
    try:
        said = json.loads(description.read_text(encoding="utf-8"))
        return WHOLE in said and said.pop(WHOLE) != _hash_of(said)
    except (OSError, ValueError, AttributeError, TypeError):
        return False


def _hash_of(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def current_job() -> str:
    """Return the name and identity of the job that runs, empty where none does."""
    return f"{_current[0].name} {_current[0].identity}" if _current else ""


def _name(log: str) -> str:
    """Return a job's name from its log: ``dea1/select`` of results/dea1/log/select.log."""
    path = Path(log).with_suffix("")
    return "/".join(part for part in path.parts[1:] if part != "log")


def description_of(product: Path) -> Path:
    """Return where the description of a product is kept."""
    relative = product.relative_to(RESULTS)
    return FOLDER / relative.with_name(f"{relative.name}.json")


def sources(job: Mapping[str, Any], run: Mapping[str, Any]) -> dict[str, str]:
    """Return the SHA-256 of all that a described job was made from, by path.

    Its inputs, and what it has read beside them as its run noted it.
    """
    return {**job["inputs"], **run.get("read", {})}


def check(path: Path, sha: str) -> None:
    """Check that a result is what its job made, from what lies there now; other files pass.

    Raises
    ------
    InputError
        Naming the file, and what to do.
    """
    if not path.is_relative_to(RESULTS):
        return
    remedy = "Delete it and run again"
    try:
        said = read_description(description_of(path))
    except (OSError, ValueError) as error:
        raise InputError(
            f"nothing says which job made it ({error!r})", file=path, remedy=remedy
        ) from error
    if sha != said["sha256"]:
        raise InputError(
            f"it is not what the job {said['job']['name']} made (SHA-256 {said['sha256'][:12]}…)",
            file=path,
            remedy=remedy,
        )
    for source, then in sources(said["job"], said["run"]).items():
        if not Path(source).exists() or digest(Path(source)) != then:
            raise InputError(f"it was made from another {source}", file=path, remedy=remedy)


def digest(path: Path) -> str:
    """Return the SHA-256 of a file, or of the names and contents of the files in a folder."""
    if path.is_dir():
        parts = {str(file.relative_to(path)): digest(file) for file in contents(path)}
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()
    return sha256(path)


def contents(folder: Path) -> list[Path]:
    """Return the files of a folder that its digest is of: no hidden ones, none behind links."""
    found = sorted(folder.rglob("*"))
    return [file for file in found if file.is_file() and not file.name.startswith(".")]


def packages() -> list[str]:
    """Return the installed packages as ``name-version``, and the Python that runs them."""
    # Names of folders, since reading the metadata of each package takes a tenth of a second.
    installed = {
        Path(entry).stem
        for folder in {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
        for entry in os.listdir(folder)
        if entry.endswith(".dist-info") and not entry.startswith("dea_study-")
    }
    return [f"python-{platform.python_version()}", *sorted(installed)]


def environment() -> str:
    """Return the SHA-256 of :func:`packages`."""
    return hashlib.sha256("\n".join(packages()).encode()).hexdigest()


def run_facts() -> dict[str, Any]:
    """Return what a rounding error may depend on, and the commit that was checked out."""
    facts: dict[str, Any] = {"processor": _processor(), "commit": os.environ.get(COMMIT, "unknown")}
    if numpy := sys.modules.get("numpy"):
        blas = numpy.show_config(mode="dicts")["Build Dependencies"]["blas"]
        facts["blas"] = f"{blas['name']} {blas['version']}"
    facts["instructions"] = {name: os.environ[name] for name in INSTRUCTIONS if name in os.environ}
    return facts


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
