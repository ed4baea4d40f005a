"""Functional mock-up units: the C code of a model, packed for other simulators (FMI 2.0)."""

import hashlib
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from dea.control.c_code import CCode, has_feedthrough, number, to_c
from dea.errors import InputError
from dea.narx import NarxModel

_FMI = Path(__file__).with_name("fmi")
_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip archive can state
_FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")
# FMI 2.0 names no other system that this package runs on.
_PLATFORMS = {("linux", "x86_64"): ("linux64", "so"), ("darwin", "x86_64"): ("darwin64", "dylib")}

_DESCRIPTION = """\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription
  fmiVersion="2.0"
  modelName={name}
  guid={guid}
  description="Polynomial NARX model"
  generationTool="dea-study"
  variableNamingConvention="flat"
  numberOfEventIndicators="0">
  <CoSimulation
    modelIdentifier={name}
    canHandleVariableCommunicationStepSize="false"
    canBeInstantiatedOnlyOncePerProcess="false"
    canGetAndSetFMUstate="true"
    canSerializeFMUstate="true">
    <SourceFiles>
      <File name="model.c"/>
      <File name="fmi2.c"/>
    </SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
{units}
  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError"/>
  </LogCategories>
  <DefaultExperiment startTime="0" stopTime={stop} stepSize={period}/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input" variability="discrete">
      <Real start={start} unit={u_units}/>
    </ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="discrete">
      <Real unit={y_units}/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="2" dependencies={known}/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index="2" dependencies={known}/>
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""

_IDENTITY = """\
/* The model that fmi2.c wraps. */
#ifndef IDENTITY_H
#define IDENTITY_H

#include "model.h"

#define FMU_MODEL(part) {name}_##part
#define FMU_GUID "{guid}"
#define FMU_INPUT_START ({start})
#define FMU_PERIOD ({guard}_SAMPLING_PERIOD)

#endif
"""


def write_fmu(
    model: NarxModel,
    path: str | Path,
    sampling_rate: float,
    *,
    name: str = "model",
    u_units: str = "1",
    y_units: str = "1",
    compiler: str | None = "cc",
) -> None:
    """Write a co-simulation unit of FMI 2.0 that computes the free run of ``model``.

    Its input ``u`` and output ``y`` are in physical units. At a communication point the output is
    y(t) of the equation; each step passes one sampling period, or a whole number of them, through
    which the input is held. It begins at rest at the operating point. The C sources are in it.

    Parameters
    ----------
    sampling_rate
        In Hz.
    name
        Of the model in the unit; a C identifier.
    compiler
        Of C, which makes the binary of this machine's system. None leaves it out: some simulators
        compile the sources themselves.

    Raises
    ------
    InputError
        As :func:`dea.control.to_c`; if there is no such compiler, or FMI 2.0 has no name for this
        machine's system.
    """
    code = to_c(model, sampling_rate, name=name)
    guid = f"{{{hashlib.sha256(''.join(code).encode()).hexdigest()}}}"
    start = number(model.scaling.u_offset)
    description = _DESCRIPTION.format(
        name=quoteattr(name),
        guid=quoteattr(guid),
        units="\n".join(f"    <Unit name={quoteattr(u)}/>" for u in sorted({u_units, y_units})),
        period=quoteattr(number(1.0 / sampling_rate)),
        stop=quoteattr(number(1000.0 / sampling_rate)),
        start=quoteattr(start),
        u_units=quoteattr(u_units),
        y_units=quoteattr(y_units),
        known=quoteattr("1" if has_feedthrough(model) else ""),
    )
    identity = _IDENTITY.format(name=name, guard=name.upper(), guid=guid, start=start)
    with tempfile.TemporaryDirectory() as folder:
        _write_sources(Path(folder), code, identity)
        members = {
            f"sources/{file.name}": file.read_bytes() for file in sorted(Path(folder).iterdir())
        }
        if compiler is not None:
            system, suffix = _platform()
            binary = _compiled(Path(folder), compiler, f"{name}.{suffix}")
            members[f"binaries/{system}/{binary.name}"] = binary.read_bytes()
        _pack(Path(path), {"modelDescription.xml": description.encode(), **members})


def _write_sources(folder: Path, code: CCode, identity: str) -> None:
    code.write(folder / "model.h", folder / "model.c")
    (folder / "identity.h").write_text(identity, encoding="utf-8")
    for name in ("fmi2.h", "fmi2.c"):
        (folder / name).write_text((_FMI / name).read_text(encoding="utf-8"), encoding="utf-8")


def _platform() -> tuple[str, str]:
    """Return what FMI 2.0 calls this system, and how its libraries end."""
    here = sys.platform, platform.machine()
    if here not in _PLATFORMS:
        raise InputError(
            f"FMI 2.0 has no binaries for {' on '.join(here)}",
            field="compiler",
            remedy="Write the unit with its sources alone: compiler=None.",
        )
    return _PLATFORMS[here]


def _compiled(folder: Path, compiler: str, name: str) -> Path:
    command = shutil.which(compiler)
    if command is None:
        raise InputError(
            f"there is no C compiler {compiler!r}",
            field="compiler",
            remedy="Install one (Debian: gcc libc6-dev), or give None for sources alone.",
        )
    # Relative names, so that the binary does not depend on where it was made.
    subprocess.run([command, *_FLAGS, "model.c", "fmi2.c", "-o", name], cwd=folder, check=True)
    return folder / name


def _pack(path: Path, members: dict[str, bytes]) -> None:
    """Write a zip archive whose bytes depend on its members alone, whole or not at all."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        with zipfile.ZipFile(partial, "w") as archive:
            for name, content in members.items():
                entry = zipfile.ZipInfo(name, _DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, content)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
