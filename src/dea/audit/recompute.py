"""Run jobs of a manifest again in an empty folder and compare what they make."""

import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dea import provenance
from dea.audit.manifest import Manifest
from dea.audit.verify import Finding

# Of numbers that another processor or another linear algebra rounds otherwise.
TOLERANCE = 1e-6
# Holds the times of one run: no other run repeats them.
NEVER_THE_SAME = "link.nc"


def recompute(manifest: Manifest, count: int, seed: int) -> Iterator[tuple[str, list[Finding]]]:
    """Run ``count`` jobs, drawn with ``seed``, again; yield the products of each and what differs.

    Each runs in a folder of its own that holds nothing but its inputs, the code and the config.
    """
    jobs = sorted(manifest.jobs)
    for identity in random.Random(seed).sample(jobs, min(count, len(jobs))):
        products = sorted(p for p, one in manifest.products.items() if one["job"] == identity)
        with tempfile.TemporaryDirectory() as root:
            # As deep as the project, so that a path to a file outside of it stays within the root.
            folder = Path(root, *Path.cwd().parts[1:])
            folder.mkdir(parents=True)
            problem = _run(manifest, identity, folder)
            if problem:
                findings = [Finding(products[0], problem)]
            else:
                run = manifest.jobs[identity]["run"]
                findings = [
                    Finding(product, difference)
                    for product in products
                    if (difference := _difference(manifest, product, folder, run))
                ]
        yield ", ".join(products), findings


def _run(manifest: Manifest, identity: str, folder: Path) -> str | None:
    """Run a job in ``folder``; return what went wrong."""
    job = manifest.jobs[identity]
    for name in ("src", "config", "build", "data", "records"):
        if Path(name).exists():
            (folder / name).symlink_to(Path(name).resolve())
    for source in provenance.sources(job, job["run"]):
        _bring(manifest, source, folder)
    for product in [p for p, one in manifest.products.items() if one["job"] == identity]:
        (folder / product).parent.mkdir(parents=True, exist_ok=True)
    module, *options = job["command"]
    command = [sys.executable, "-m", module, *options, *job["run"]["options"],
               "--settings", json.dumps(job["settings"])]  # fmt: skip
    environment = os.environ | {
        provenance.JOB: f"results/{job['name']}.log",
        provenance.RULE: job["rule"],
        provenance.CODE: " ".join(job["code"]),
        provenance.COMMIT: job["run"]["commit"],
        # Not through the link: compiled functions are kept for one place of the source.
        "PYTHONPATH": str(Path("src").resolve()),
    }
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return f"its job fails when it is run again: {last}"
    return None


def _bring(manifest: Manifest, source: str, folder: Path) -> None:
    """Copy a result with what says that it is one: its description, and its own sources.

    Of a file outside of the project a link lies where its path leads from ``folder``.
    """
    made_from = [source]
    if source in manifest.products:
        made_from += manifest.sources(source)
        made_from.append(str(provenance.description_of(Path(source))))
    for name in made_from:
        target = folder / name
        # A file with an absolute path is read where it is.
        if target.exists() or Path(name).is_absolute():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.resolve().is_relative_to(folder.resolve()):
            target.symlink_to(Path(name).resolve())
        elif Path(name).is_dir():
            shutil.copytree(name, target)
        else:
            shutil.copyfile(name, target)


def _difference(
    manifest: Manifest, product: str, folder: Path, run: Mapping[str, Any]
) -> str | None:
    """Return how a product differs from its repetition, ``None`` where it does not."""
    again = folder / product
    if Path(product).name == NEVER_THE_SAME or Path(product).name.endswith(f"_{NEVER_THE_SAME}"):
        return None
    if provenance.digest(again) == manifest.products[product]["sha256"]:
        return None
    here = provenance.run_facts()
    same_machine = all(
        here.get(key) == run.get(key) for key in ("processor", "blas", "instructions")
    )
    if same_machine or again.suffix != ".nc":
        return "is other bytes when it is made again"
    with (
        xr.open_dataset(product, decode_times=False) as one,
        xr.open_dataset(again, decode_times=False) as other,
    ):
        for name in one.variables:
            if name not in other or not _close(one[name].values, other[name].values):
                return f"{name} differs by more than {TOLERANCE:g} when it is made again"
    return None


def _close(one: np.ndarray, other: np.ndarray) -> bool:
    if one.shape != other.shape:
        return False
    if one.dtype.kind not in "fc":
        return bool(np.array_equal(one, other))
    size = float(np.max(np.abs(one[np.isfinite(one)]), initial=0.0))
    return bool(np.allclose(one, other, rtol=TOLERANCE, atol=TOLERANCE * size, equal_nan=True))
