"""Compare results with their manifest: files, links, code, environment."""

import dataclasses
import hashlib
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from dea import archive, provenance
from dea.audit.manifest import UNLISTED, Manifest, files
from dea.errors import InputError

ENVIRONMENT, SOURCE = Path("environment.txt"), Path("src")
# Snakemake leaves it in a folder that a job makes.
STAMP = ".snakemake_timestamp"
_PIN = re.compile(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)")


class Finding(NamedTuple):
    """Something that is not as it should be; ``path`` is the file, or the package."""

    path: str
    problem: str


def verify(manifest: Manifest) -> list[Finding]:
    """Return everything that differs from the manifest, files before what was made from them."""
    found = [
        *_files(manifest),
        *_jobs(manifest),
        *_links(manifest),
        *_records(manifest),
        *_code(manifest),
        *_environment(manifest),
    ]
    rank = {path: place for place, path in enumerate(in_order(manifest))}
    return sorted(dict.fromkeys(found), key=lambda one: rank.get(one.path, -1))


def notes(manifest: Manifest) -> list[str]:
    """Return sentences on what could not be compared, and does not have to be."""
    if _is_repository() or all(_held(commit) is not None for commit in _commits(manifest)):
        return []
    return [
        "This folder is no Git repository, so that no commit was looked up: the code was compared"
        " by its SHA-256."
    ]


def explained(finding: Finding, manifest: Manifest) -> str:
    """Return what is wrong, and of files of results what to do, as sentences."""
    return f"{finding.problem}. {_remedy(finding.path, manifest)}".rstrip()


def _remedy(path: str, manifest: Manifest) -> str:
    file = Path(path)
    if path in manifest.products:
        return "Delete it and run again." if file.exists() else "Run again to make it."
    if not file.is_relative_to(provenance.RESULTS) or file in UNLISTED:
        return ""
    if path not in manifest.others:
        return "Delete it; a run makes it again if it is a result."
    if file.is_relative_to(provenance.FOLDER):
        product = provenance.RESULTS / file.relative_to(provenance.FOLDER).with_suffix("")
        return f"Delete {product} and run again, which makes both."
    return "Another run lists it as it lies there."


def in_order(manifest: Manifest) -> list[str]:
    """Return the products, each after those that it was made from."""
    ordered: list[str] = []
    begun: set[str] = set()  # a simulation may have read what an earlier run had made from it

    def visit(path: str) -> None:
        if path in begun or path not in manifest.products:
            return
        begun.add(path)
        for source in manifest.sources(path):
            visit(source)
        ordered.append(path)

    for path in manifest.products:
        visit(path)
    return ordered


def resting_on(path: str, manifest: Manifest) -> list[str]:
    """Return the products that were made from a file, directly or not; the file may be code."""
    return [product for product in _spoilt({path}, manifest) if product != path]


def spoilt_by(finding: Finding, manifest: Manifest) -> list[str]:
    """Return the products that rest on what a finding is of.

    Of code that has changed these are the ones that were made with it as it was.
    """
    file = Path(finding.path)
    now = provenance.digest(file) if file.is_file() else None
    made_otherwise = {
        product
        for product, one in manifest.products.items()
        if manifest.jobs[one["job"]]["code"].get(finding.path, now) != now
    }
    if not made_otherwise:
        return resting_on(finding.path, manifest)
    return _spoilt(made_otherwise, manifest)


def _spoilt(files: set[str], manifest: Manifest) -> list[str]:
    """Return the products that are among the files, or were made from one, directly or not."""
    made_from = {
        product: {*manifest.sources(product), *manifest.jobs[one["job"]]["code"]}
        for product, one in manifest.products.items()
    }
    spoilt, before = set(files), 0
    while len(spoilt) > before:
        before = len(spoilt)
        spoilt |= {product for product, sources in made_from.items() if spoilt & sources}
    return [product for product in in_order(manifest) if product in spoilt]


def _files(manifest: Manifest) -> Iterator[Finding]:
    expected = {path: one["sha256"] for path, one in manifest.products.items()} | {
        **manifest.others
    }
    for path, sha in expected.items():
        if not Path(path).exists():
            yield Finding(path, f"is missing{_unwanted(path, manifest)}")
        elif provenance.digest(Path(path)) != sha:
            yield Finding(path, f"is not what was made (SHA-256 {sha[:12]}…)")
    folders = [Path(path) for path in manifest.products if Path(path).is_dir()]
    for file in files(folders):
        if str(file) not in expected and file not in UNLISTED:
            yield Finding(str(file), "was made by no job")
    for folder in folders:
        # The hash of a folder holds neither hidden files nor what links to folders lead to.
        hashed = {*provenance.contents(folder), folder / STAMP}
        for file in files(folder=folder):
            if file not in hashed:
                yield Finding(str(file), "was made by no job")


def _unwanted(path: str, manifest: Manifest) -> str:
    """Return what to do where a product is not made any more."""
    if path not in manifest.products:
        return ""
    return f"; if it is not wanted any more, delete {provenance.description_of(Path(path))} too"


def _jobs(manifest: Manifest) -> Iterator[Finding]:
    """Compare what jobs are said to have been with their identities, and with their products."""
    fields = [field.name for field in dataclasses.fields(provenance.Job)]
    for path, product in manifest.products.items():
        job = manifest.jobs[product["job"]]
        identity = provenance.Job(**{name: job[name] for name in fields}).identity
        description = provenance.description_of(Path(path))
        if identity != product["job"] or provenance.was_edited(description):
            yield Finding(path, "its description is not what its job kept")
        elif path not in job["command"]:
            yield Finding(path, "its description is that of a job which makes other results")


def _links(manifest: Manifest) -> Iterator[Finding]:
    for path in manifest.products:
        for source, sha in manifest.sources(path).items():
            if source in manifest.products:
                if manifest.products[source]["sha256"] != sha:
                    yield Finding(path, f"was made from another {source}")
            else:
                yield from _source(source, sha)


def _source(path: str, sha: str) -> Iterator[Finding]:
    if not Path(path).exists():
        yield Finding(path, "is missing")
    elif provenance.digest(Path(path)) != sha:
        yield Finding(path, "has changed since results were made from it")


def _records(manifest: Manifest) -> Iterator[Finding]:
    """Compare archived records with the manifests that results were made from: no more, no less."""
    sources = {source for job in manifest.jobs.values() for source in job["inputs"]}
    for source in map(Path, sorted(sources)):
        if source.name == archive.MANIFEST and source.is_relative_to(archive.ROOT):
            try:
                content = archive.check(source.parent)
            except InputError as error:
                yield Finding(str(error.file), error.problem)
                continue
            for file in files(folder=source.parent):
                if str(file.relative_to(source.parent)) not in {*content["files"], source.name}:
                    yield Finding(str(file), "is no file of the record")


def _code(manifest: Manifest) -> Iterator[Finding]:
    recorded = {
        (path, sha)
        for job in manifest.jobs.values()
        for path, sha in job["code"].items()
        if Path(path).is_relative_to(SOURCE)
    }
    for path, sha in sorted(recorded):
        if not Path(path).exists():
            yield Finding(path, "is missing")
        elif provenance.digest(Path(path)) != sha:
            yield Finding(path, "has changed since results were made with it")
    for commit in _commits(manifest):
        yield from _committed(commit, manifest)


def _commits(manifest: Manifest) -> list[str]:
    """Return the commits that say what the code was."""
    commits = {job["run"]["commit"] for job in manifest.jobs.values()}
    # No commit says what a tree with changes was, or code outside of a repository.
    return sorted(each for each in commits if re.fullmatch("[0-9a-f]{40}", each))


def _is_repository() -> bool:
    """Return whether this folder is a repository, and no folder inside one of something else."""
    return _git("rev-parse", "--show-prefix") == "\n"


def _held(commit: str) -> str | None:
    """Return what Git lists of the code of a commit; nothing where it knows no such commit."""
    return _git("ls-tree", "-r", commit, "--", SOURCE)


def _git(*arguments: str | Path) -> str | None:
    """Return what Git prints; nothing where it fails or is not installed."""
    try:
        return subprocess.run(
            ["git", *arguments], capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return None


def _committed(commit: str, manifest: Manifest) -> Iterator[Finding]:
    listed = _held(commit)
    if listed is None and not _is_repository():
        return  # a copy without its history, as `notes` says
    if listed is None:
        yield Finding(
            commit,
            "is no commit of this repository, and results were made from it. Where its history was"
            " cut short, fetch the rest: git fetch --unshallow",
        )
        return
    blobs = {line.split("\t")[1]: line.split()[2] for line in listed.splitlines()}
    paths = {
        path
        for job in manifest.jobs.values()
        if job["run"]["commit"] == commit
        for path in job["code"]
        if Path(path).is_relative_to(SOURCE) and Path(path).exists()
    }
    for path in sorted(paths):
        content = Path(path).read_bytes()
        # As Git names a file's content.
        blob = hashlib.sha1(b"blob %d\0" % len(content) + content, usedforsecurity=False)
        if blobs.get(path) != blob.hexdigest():
            yield Finding(path, f"is not what the commit {commit[:12]} holds")


def _environment(manifest: Manifest) -> Iterator[Finding]:
    installed = {_name(package): package for package in provenance.packages()}
    then = {_name(package): package for package in manifest.packages}
    for name in sorted(installed.keys() | then.keys()):
        if installed.get(name) != then.get(name):
            now = installed.get(name, "not installed")
            was = then.get(name, "not installed")
            yield Finding(name, f"is {now}, and was {was} when the results were made")
    known = provenance.environment()
    for path, product in manifest.products.items():
        if manifest.jobs[product["job"]]["environment"] != known:
            yield Finding(path, "was made with other packages than are installed now")
    if not ENVIRONMENT.is_file():
        yield Finding(str(ENVIRONMENT), "is missing")
        return
    for line in ENVIRONMENT.read_text(encoding="utf-8").splitlines():
        pin = _PIN.match(line)
        if pin and f"{_plain(pin[1])}-{pin[2]}" != _plain_version(installed.get(_plain(pin[1]))):
            now = installed.get(_plain(pin[1]), "not installed")
            yield Finding(_plain(pin[1]), f"is {now}, and {ENVIRONMENT} asks for {pin[0]}")


def _name(package: str) -> str:
    return _plain(package.rpartition("-")[0])


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _plain_version(package: str | None) -> str:
    name, _, number = (package or "-").rpartition("-")
    return f"{_plain(name)}-{number}"
