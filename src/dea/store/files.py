"""Write datasets whole, with their provenance; read them back with their contract checked."""

import hashlib
import json
import platform
import shutil
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import xarray as xr

from dea.atomic_file import atomic
from dea.checksum import sha256
from dea.errors import InputError
from dea.provenance import current_job
from dea.store.contracts import CONTRACTS, check_units

_PACKAGES = ("dea-study", "numpy", "scipy", "numba", "xarray", "netCDF4", "pymodbus", "snakemake")
# What the libraries raise where a file is no NetCDF, or where bytes of one have changed.
_DAMAGED = (OSError, RuntimeError, ValueError, KeyError, AttributeError)


def write(
    dataset: xr.Dataset,
    path: str | Path,
    *,
    title: str,
    inputs: Mapping[str, str | Path | bytes] | None = None,
    settings: Mapping[str, Any] | None = None,
    seed: int | None = None,
) -> None:
    """Write ``dataset`` to ``path`` with the provenance that lets it be audited.

    Parameters
    ----------
    inputs
        Files the dataset was made from, or what they held where they may have changed since; their
        SHA-256 is stored.
    settings, seed
        The resolved config leaves and the seed that shaped it.

    Raises
    ------
    InputError
        If the dataset breaks the contract of its file name; nothing is written then.
    OSError
        If the disk does not take it; what was there before is left as it was.
    """
    path = Path(path)
    contract = _check_contract(dataset, path)
    check_units(dataset, path)
    attributes = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"dea-study {version('dea-study')}",
        "history": f"written by dea-study from {', '.join(inputs) if inputs else 'no file'}",
        "contract": contract,
        "settings": json.dumps(settings or {}, sort_keys=True),
        "packages": json.dumps(_versions(), sort_keys=True),
    }
    if seed is not None:
        attributes["seed"] = str(seed)
    if job := current_job():
        attributes["job"] = job
    for name, file in (inputs or {}).items():
        attributes[f"sha256_{name}"] = (
            hashlib.sha256(file).hexdigest() if isinstance(file, bytes) else sha256(file)
        )
    whole = dataset.assign_attrs({**dataset.attrs, **attributes})
    encoding = {
        name: {"zlib": True, "complevel": 1, "shuffle": True}
        for name, variable in whole.variables.items()
        if variable.ndim and variable.dtype.kind in "iufb"
    }
    with atomic(path) as partial:
        try:
            whole.to_netcdf(partial, engine="netcdf4", format="NETCDF4", encoding=encoding)
        except (OSError, RuntimeError) as error:  # the library does not say what the disk has said
            free = shutil.disk_usage(path.parent).free
            raise OSError(
                f"{path}: cannot be written ({error}): the disk has {free / 1e6:.0f} MB left"
            ) from error


def read(path: str | Path, contract: str | None = None) -> xr.Dataset:
    """Read a dataset into memory and check its contract (by default that of the file's name).

    Raises
    ------
    InputError
        If the file is missing, is not NetCDF, is damaged or breaks the contract.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(
            "the file does not exist", file=path, remedy="Correct the path, or make it first"
        )
    try:
        # Times are plain seconds since the start, which the decoder would turn into dates.
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as opened:
            dataset = opened.load()
    except _DAMAGED as error:
        raise InputError(
            f"cannot be read as NetCDF ({error})",
            file=path,
            remedy="Make it again; a record of another format is read by read_record with its"
            " columns named, or by a case of config/cases",
        ) from error
    _check_contract(dataset, path, contract)
    return dataset


def _check_contract(dataset: xr.Dataset, path: Path, asked: str | None = None) -> str:
    """Check the contract that is asked for, or that a dataset or its file's name gives; return it.

    The name of a file may be that of no contract.
    """
    given = asked or dataset.attrs.get("contract")
    name = str(given or path.stem)
    if name in CONTRACTS:
        CONTRACTS[name].check(dataset, path)
    elif given is not None and name != path.stem:
        raise InputError(
            f"there is no contract {name!r}",
            file=path,
            field="contract",
            remedy=f"There are {', '.join(CONTRACTS)}",
        )
    return name


@cache
def _versions() -> dict[str, str]:
    """Return the versions of Python and of those packages that are installed."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found
