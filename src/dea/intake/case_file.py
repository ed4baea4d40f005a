"""The case file that intake writes, and how it tells its own from one that a person edited."""

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from dea.configuration.case import Case, case_files, check_case
from dea.configuration.files import read_yaml
from dea.configuration.problems import did_you_mean
from dea.configuration.section import NAME
from dea.configuration.study import FILE, RESERVED, Study, check_study
from dea.errors import InputError
from dea.intake.case import Inferred
from dea.store import atomic

_MARK = "# As written: "


class _Plain(yaml.SafeDumper):
    """Writes a value that occurs twice twice, where YAML would refer to the first."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def case_name(file: Path, name: str | None = None, sheet: str | None = None) -> str:
    """Return the name of a case: the one given, or that of the file with letters it may have.

    The ``sheet`` of a workbook, where it is named, is part of it: each sheet is another record.
    """
    if name is not None:
        if not re.fullmatch(NAME, name):
            raise InputError(
                f"{name!r} is no name of a case",
                field="NAME",
                remedy="Use letters, digits, _ and -",
            )
        return name
    whole = file.stem if sheet is None else f"{file.stem}_{sheet}"
    plain = re.sub(r"[^A-Za-z0-9_-]+", "_", whole).strip("_") or "record"
    return f"{plain}_case" if plain in RESERVED else plain


def known_name(name: str, folder: Path, *, actuators: bool, field: str = "NAME") -> str:
    """Return the name of a case in ``folder``, or where ``actuators`` may be meant of one of them.

    Parameters
    ----------
    field
        Where the name was given, for messages.

    Raises
    ------
    InputError
        With the nearest name that is known.
    """
    names = [actuator.name for actuator in _study().actuators] if actuators else []
    names += [file.stem for file in case_files(folder, ".yaml")]
    if name not in names:
        raise InputError(
            f"there is none called {name!r}",
            field=field,
            remedy=f"{did_you_mean(name, names)}Known: {', '.join(names)}",
        )
    return name


def read_case(file: Path) -> Case:
    """Read and check one case.

    Raises
    ------
    InputError
        As :func:`dea.configuration.case.check_case`.
    """
    content = read_yaml(file, what="the case", example="a file of config/cases")
    return check_case(content, _study(), file)


def earlier_case(file: Path, sheet: str | None, case: Path) -> Case | None:
    """Return the case that is there, if it is of the same file and sheet.

    Raises
    ------
    InputError
        If the case cannot be read.
    """
    if not case.exists():
        return None
    earlier = read_case(case)
    same = Path(earlier.record.file) == file and earlier.record.sheet == sheet
    return earlier if same else None


def write_case(inferred: Inferred, name: str, folder: Path, command: str) -> Path:
    """Write ``NAME.yaml``, unless a person has edited the one that is there.

    Parameters
    ----------
    command
        What was typed, for the first line of the file.

    Raises
    ------
    InputError
        If the name is an actuator's or that of a folder of results, the content does not fit the
        study's configuration, or the file there was written or edited by a person.
    """
    study = _study()
    of_actuator = name in {actuator.name for actuator in study.actuators}
    if of_actuator or name in RESERVED:
        whose = "an actuator's name" if of_actuator else "the name of a folder of results/"
        raise InputError(f"{name!r} is {whose}", field="NAME", remedy="Give another: NAME=other")
    file = folder / f"{name}.yaml"
    check_case(dict(inferred.content), study, file)
    text = _text(inferred, command)
    if file.exists() and _edited(file.read_text(encoding="utf-8")):
        run = _with_simulation(inferred.content, file) or (
            f"Run it as it is: `make case NAME={name}`"
        )
        raise InputError(
            "it is there already, written or edited by a person",
            file=file,
            remedy=f"{run}; or give NAME=other, or delete it",
        )
    if file.exists() and (other := _record_of(file)) != _source(inferred.content["record"]):
        raise InputError(
            f"it is there already, for {other}", file=file, remedy="Give another name: NAME=other"
        )
    with atomic(file) as partial:
        partial.write_text(text, encoding="utf-8")
    return file


def _with_simulation(content: Mapping[str, Any], file: Path) -> str | None:
    """Say what to edit in a case so that the simulation of other content is diagnosed with it."""
    if (simulation := content.get("simulation")) is None:
        return None
    edit = f"Write `simulation: {simulation}` into it"
    proposed = content["record"].get("resample")
    if read_case(file).record.resample not in (None, proposed):
        # The samples of a record are averaged for a model, which would hide thresholds.
        kept = f"make it `resample: {proposed}`" if proposed else "delete `resample`"
        edit = f"{edit} and {kept}"
    return f"{edit}: then `make diagnose NAME={file.stem}`"


def _record_of(file: Path) -> str:
    content = read_yaml(file, what="the case", example=str(file))
    return _source(content["record"])


def _source(record: Mapping[str, Any]) -> str:
    """Return the file of a record, and its sheet where it has one."""
    sheet = record.get("sheet")
    return str(record["file"]) if sheet is None else f"{record['file']}, sheet {sheet!r}"


def _study() -> Study:
    return check_study(read_yaml(FILE, what="the configuration", example=FILE))


def _text(inferred: Inferred, command: str) -> str:
    remarks = [f"Inferred by `{command}`. Any key may be edited: config/cases/README.md.",
               "Times are in s, lags in samples, frequencies in shares of the sampling rate"
               " (docs/configuration.md).",
               *inferred.inferred]  # fmt: skip
    body = yaml.dump(
        dict(inferred.content), Dumper=_Plain, sort_keys=False, allow_unicode=True, width=100,
        default_flow_style=None,
    )  # fmt: skip
    text = "".join(f"# {line}\n" for line in remarks) + body
    return f"{text}{_MARK}{_digest(text)}\n"


def _edited(text: str) -> bool:
    body, mark, digest = text.rpartition(_MARK)
    return not mark or digest.strip() != _digest(body)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]
