"""Functional mock-up units: the C code of a model, packed for other simulators."""

import hashlib
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Literal, NamedTuple
from xml.sax.saxutils import quoteattr

from dea.atomic_file import atomic
from dea.control.c_code import CCode, has_feedthrough, number, to_c
from dea.control.fmu_templates import BUILD_3, DESCRIPTION_2, DESCRIPTION_3, IDENTITY
from dea.errors import InputError
from dea.narx import NarxModel, rate_of

_FMI = Path(__file__).with_name("fmi")
_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip archive can state
_FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")


class _Standard(NamedTuple):
    """What differs between versions of FMI.

    ``input_reference`` is what dependencies are stated by, ``platforms`` the names of the systems
    that this package runs on, as the standard has them.
    """

    wrapper: str
    description: str
    build: str | None
    input_reference: str
    platforms: dict[tuple[str, str], str]


_STANDARDS = {
    "2.0": _Standard(
        "fmi2", DESCRIPTION_2, None, "1",
        {("linux", "x86_64"): "linux64", ("darwin", "x86_64"): "darwin64"},
    ),
    "3.0": _Standard(
        "fmi3", DESCRIPTION_3, BUILD_3, "0",
        {("linux", "x86_64"): "x86_64-linux", ("linux", "aarch64"): "aarch64-linux",
         ("darwin", "x86_64"): "x86_64-darwin", ("darwin", "arm64"): "aarch64-darwin"},
    ),
}  # fmt: skip
_SUFFIXES = {"linux": "so", "darwin": "dylib"}


def write_fmu(
    model: NarxModel,
    path: str | Path,
    sampling_rate: float | None = None,
    *,
    name: str = "model",
    u_units: str | None = None,
    y_units: str | None = None,
    version: Literal["2.0", "3.0"] = "2.0",
    compiler: str | None = "cc",
) -> None:
    """Write a co-simulation unit that computes the free run of ``model``.

    Its input ``u`` and output ``y`` are in physical units. At a communication point the output is
    y(t) of the equation; each step passes one sampling period, or a whole number of them, through
    which the input is held. It begins at rest at the operating point. The C sources are in it.

    Parameters
    ----------
    sampling_rate
        In Hz. By default that of the model's own record.
    name
        Of the model in the unit; a C identifier.
    u_units, y_units
        By default those of the model's own record.
    version
        Of the Functional Mock-up Interface.
    compiler
        Of C, which makes the binary of this machine's system. None leaves it out: some simulators
        compile the sources themselves.

    Raises
    ------
    InputError
        As :func:`dea.control.to_c`; if there is no such version or compiler, or the version has no
        name for this machine's system.
    """
    if version not in _STANDARDS:
        raise InputError(
            f"there is no unit of FMI {version}",
            field="version",
            remedy=f"Choose from {', '.join(_STANDARDS)}.",
        )
    standard = _STANDARDS[version]
    scaling = model.of_one_input("A functional mock-up unit")
    rate = rate_of(model.labels, sampling_rate)
    ((_, own_units),) = model.named_inputs
    u_units, y_units = u_units or own_units, y_units or model.labels.y_units
    code = to_c(model, rate, name=name)
    guid = f"{{{hashlib.sha256(''.join(code).encode()).hexdigest()}}}"
    start = number(scaling.u_offset)
    description = standard.description.format(
        name=quoteattr(name),
        guid=quoteattr(guid),
        units="\n".join(f"    <Unit name={quoteattr(u)}/>" for u in sorted({u_units, y_units})),
        period=quoteattr(number(1.0 / rate)),
        stop=quoteattr(number(1000.0 / rate)),
        start=quoteattr(start),
        u_units=quoteattr(u_units),
        y_units=quoteattr(y_units),
        known=quoteattr(standard.input_reference if has_feedthrough(model) else ""),
    )
    identity = IDENTITY.format(
        name=name, guard=name.upper(), guid=guid, start=start, wrapper=f"{standard.wrapper}.c"
    )
    with tempfile.TemporaryDirectory() as folder:
        _write_sources(Path(folder), code, identity, standard.wrapper)
        if standard.build is not None:
            build = standard.build.format(name=quoteattr(name))
            (Path(folder) / "buildDescription.xml").write_text(build, encoding="utf-8")
        members = {
            f"sources/{file.name}": file.read_bytes() for file in sorted(Path(folder).iterdir())
        }
        if compiler is not None:
            system = _platform(version)
            library = f"{name}.{_SUFFIXES[sys.platform]}"
            binary = _compiled(Path(folder), compiler, standard.wrapper, library)
            members[f"binaries/{system}/{binary.name}"] = binary.read_bytes()
        _pack(Path(path), {"modelDescription.xml": description.encode(), **members})


def _write_sources(folder: Path, code: CCode, identity: str, wrapper: str) -> None:
    code.write(folder / "model.h", folder / "model.c")
    (folder / "identity.h").write_text(identity, encoding="utf-8")
    for name in ("unit.h", f"{wrapper}.h", f"{wrapper}.c"):
        (folder / name).write_text((_FMI / name).read_text(encoding="utf-8"), encoding="utf-8")


def _platform(version: str) -> str:
    """Return what this version of FMI calls this system."""
    here = sys.platform, platform.machine()
    known = _STANDARDS[version].platforms
    if here not in known:
        raise InputError(
            f"FMI {version} has no binaries for {' on '.join(here)}",
            field="compiler",
            remedy="Write the unit with its sources alone: compiler=None.",
        )
    return known[here]


def _compiled(folder: Path, compiler: str, wrapper: str, name: str) -> Path:
    command = shutil.which(compiler)
    if command is None:
        raise InputError(
            f"there is no C compiler {compiler!r}",
            field="compiler",
            remedy="Install one (Debian: gcc libc6-dev), or give None for sources alone.",
        )
    # Relative names, so that the binary does not depend on where it was made.
    sources = "model.c", f"{wrapper}.c"
    called = [command, *_FLAGS, *sources, "-o", name]
    try:
        subprocess.run(called, cwd=folder, check=True, capture_output=True, text=True)
    except subprocess.CalledProcessError as error:
        said = (error.stderr or error.stdout).strip().splitlines() or [f"status {error.returncode}"]
        told = next((line for line in said if "error:" in line), said[0])
        raise InputError(
            f"{compiler} cannot compile it: {told}",
            field="compiler",
            remedy="Install the headers of the C library too (Debian: libc6-dev), or give None"
            " for sources alone.",
        ) from error
    return folder / name


def _pack(path: Path, members: dict[str, bytes]) -> None:
    """Write a zip archive whose bytes depend on its members alone, whole or not at all."""
    with atomic(path) as partial, zipfile.ZipFile(partial, "w") as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
