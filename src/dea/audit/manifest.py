"""``results/MANIFEST.json``: every result with its hash and its job, and every other file there."""

import fcntl
import hashlib
import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from dea import provenance
from dea.atomic_file import atomic
from dea.errors import InputError

FILE = provenance.RESULTS / "MANIFEST.json"
PAGE = provenance.RESULTS / "audit.md"  # what the last audit found
# Held by the run of this project (workflow/alone.sh), whose process it names.
LOCK = Path("build/lock")
# Folders of logs and timings, and the suffix of such a file: a job that failed leaves some too.
BESIDE = {"log": ".log", "benchmark": ".tsv"}
RESOLVED = provenance.RESULTS / "resolve"  # what `make resolve` makes
README = provenance.RESULTS / "README.md"
# Made by targets outside of the workflow, or by the audit itself: not compared.
UNLISTED = {
    provenance.RESULTS / name
    for name in (
        "MANIFEST.json",
        "MANIFEST.json.sig",
        "audit.md",
        "report.html",
        "benchmark.json",
        "calibration.csv",
        "coverage.csv",
        "coverage.md",
        "coverage_film.csv",
        "coverage_film.md",
        "mutants.json",
        "mutants.md",
        "figures/calibration.png",
        "tables/control_robustness.csv",
    )
}


@dataclass(frozen=True)
class Manifest:
    """What the results of this project are.

    ``products`` holds hash and job of each result by its path, ``jobs`` what each job was (the
    fields of :class:`dea.provenance.Job`, and ``run``), ``others`` the hashes of logs, timings and
    descriptions of jobs, ``packages`` the packages installed when the manifest was written. Any
    other file is in none of them, so that an audit names it.
    """

    products: Mapping[str, Mapping[str, str]]
    jobs: Mapping[str, Mapping[str, Any]]
    others: Mapping[str, str]
    packages: list[str]

    def sources(self, product: str) -> dict[str, str]:
        """Return the SHA-256 of all that a product was made from, by path."""
        job = self.jobs[self.products[product]["job"]]
        return provenance.sources(job, job["run"])

    def text(self) -> str:
        """Return what its file says: JSON that ends with its own hash."""
        content = json.dumps(asdict(self), sort_keys=True)
        sha = hashlib.sha256(content.encode()).hexdigest()
        return json.dumps({**asdict(self), "sha256": sha}, indent=1, sort_keys=True) + "\n"

    @property
    def digest(self) -> str:
        """SHA-256 of its file, in hex."""
        return hashlib.sha256(self.text().encode()).hexdigest()

    def write(self, file: Path = FILE) -> None:
        """Write it, whole or not at all."""
        with atomic(file) as partial:
            partial.write_text(self.text(), encoding="utf-8")

    @classmethod
    def read(cls, file: Path = FILE) -> Self:
        """Read it.

        Raises
        ------
        InputError
            If there is none, or it is not as it was written.
        """
        remedy = "Make it again by running a target, as make study"
        try:
            text = file.read_text(encoding="utf-8")
            content = json.loads(text)
            content.pop("sha256")
            found = cls(**content)
        except OSError as error:
            problem = "there is no manifest"
            if run := _run_in_progress():
                problem += f" while process {run} makes results"
                remedy = "Wait until it has ended"
            raise InputError(problem, file=file, remedy=remedy) from error
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise InputError(f"is damaged ({error})", file=file, remedy=remedy) from error
        if text != found.text():
            raise InputError("is not as it was written", file=file, remedy=remedy)
        return found


def _run_in_progress() -> str | None:
    """Return the process of the run that holds the project's lock, if one does."""
    try:
        with LOCK.open() as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return LOCK.read_text().strip() or "of a run"
    except OSError:
        return None
    return None


def withdraw() -> None:
    """Remove the manifest and what an audit said of it, since results are about to change."""
    FILE.unlink(missing_ok=True)
    PAGE.unlink(missing_ok=True)


def collect() -> Manifest:
    """Return the manifest of the results that there are, from what their jobs kept.

    A result that is described and is not there is one of them: it is missing. A description that
    cannot be read, or is incomplete, tells of none, and is none.
    """
    products, jobs, described = {}, {}, set()
    for file in sorted(provenance.FOLDER.rglob("*.json")):
        product = provenance.RESULTS / file.relative_to(provenance.FOLDER).with_suffix("")
        try:
            said = provenance.read_description(file)
        except (OSError, ValueError):
            continue
        products[str(product)] = {"sha256": said["sha256"], "job": said["identity"]}
        jobs[said["identity"]] = {**said["job"], "run": said["run"]}
        described.add(file)
    folders = [Path(path) for path in products if Path(path).is_dir()]
    others = {
        str(file): provenance.digest(file)
        for file in files(folders)
        if file in described or (str(file) not in products and _is_beside(file))
    }
    return Manifest(products, jobs, others, provenance.packages())


def _is_beside(file: Path) -> bool:
    """Return whether a file is kept beside results without a job that describes it."""
    if not file.is_file():
        return False
    if file == README or file.is_relative_to(RESOLVED):
        return True
    return file.suffix in {BESIDE.get(folder) for folder in file.parts[1:-1]}


def files(without: Collection[Path] = (), folder: Path = provenance.RESULTS) -> Iterator[Path]:
    """Yield every file below ``folder`` that lies in none of the folders ``without``.

    Links to folders are followed. One to a folder around it, and a folder that cannot be read, is
    yielded itself.
    """
    yield from _below(folder, set(without), frozenset())


def _below(folder: Path, without: set[Path], around: frozenset[Path]) -> Iterator[Path]:
    real = folder.resolve()
    try:
        inside = sorted(folder.iterdir())
    except OSError:
        inside = None
    if inside is None or real in around:
        yield folder
        return
    for path in inside:
        if not path.is_dir():
            yield path
        elif path not in without:
            yield from _below(path, without, around | {real})
