"""Records made elsewhere: the files in config/cases."""

import re
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import create_model, model_validator

from dea.configuration.discrepancy import Split
from dea.configuration.files import read_yaml
from dea.configuration.gfrf import Gfrf
from dea.configuration.identification import Identification, Orders, Validation
from dea.configuration.problems import validated
from dea.configuration.record import RecordFile
from dea.configuration.section import NAME, Name, Section, key, partial, refuse
from dea.configuration.study import RESERVED, Study, check_simulation, check_tracker, settings
from dea.configuration.tracking import Tracking
from dea.errors import InputError
from dea.units import plain_units

# What names of designed records begin with: resolve_1, resolve_2 and so on, and resolve_fresh. They
# are keys of `records`, and of hardware names of excitations.
_DESIGNED = "resolve_"
FRESH = "fresh"
SECTIONS = ("identification", "orders", "validation", "tracking", "gfrf")


class Case(Section):
    """A record made elsewhere, and what to do with it (config/cases/README.md).

    Sections of the same name override those of config/config.yaml key by key.
    """

    title: str = key("name of the system, for people")
    record: RecordFile = key("the record to identify from")
    test_records: dict[Name, RecordFile] = key("records that identification never sees", default={})
    records: dict[Name, RecordFile] = key(
        "further records of the device, which the diagnosis explains together with the first",
        default={},
    )
    identification: Identification = key("keys of that section, for this case alone")
    orders: Orders = key("keys of that section, for this case alone")
    validation: Validation = key("keys of that section, for this case alone")
    tracking: Tracking = key("keys of that section, for this case alone")
    gfrf: Gfrf = key("keys of that section, for this case alone")
    simulation: str | None = key("the physics, by name or as a Python file", default=None)
    split: Split | None = key("how the record is split for the diagnosis", default=None)

    @model_validator(mode="after")
    def _inputs_agree(self) -> Self:
        count = len(self.record.driving)
        for section, others in (("test_records", self.test_records), ("records", self.records)):
            for name, other in others.items():
                if len(other.driving) != count:
                    raise refuse(
                        f"{section}.{name}",
                        f"the number of its inputs, {len(other.driving)}, is not that of the"
                        f" record, {count}",
                        "Name the inputs of the record, in the same order.",
                    )
        wanted = [plain_units(each.units) for each in (*self.record.driving, self.record.output)]
        for name, test in self.test_records.items():
            found = [plain_units(each.units) for each in (*test.driving, test.output)]
            if found != wanted:
                raise refuse(
                    f"test_records.{name}",
                    f"inputs and output are in {', '.join(found)}, those of the record in"
                    f" {', '.join(wanted)}",
                    "Convert the file to the units of the record.",
                )
        lags = self.identification.u_lags
        if isinstance(lags, list) and isinstance(lags[0], list) and len(lags) != count:
            raise refuse(
                "identification.u_lags",
                f"lags of {len(lags)} inputs for a record with {count}",
                "Give one list for every input, or one for all.",
            )
        return self

    @model_validator(mode="after")
    def _designed_records_are_meant(self) -> Self:
        """Refuse a record whose key `make resolve` would take for that of a designed one."""
        for name in self.records:
            if is_designed(name) and not re.fullmatch(designed(rf"([1-9]\d*|{FRESH})"), name):
                raise refuse(
                    f"records.{name}",
                    f"names that begin with {_DESIGNED} are those of designed records",
                    "Give it another name; for a designed one see next_experiment.md.",
                )
        return self

    @model_validator(mode="after")
    def _files_have_no_braces(self) -> Self:
        """Refuse a path that Snakemake would take for a pattern with wildcards."""
        files = {"record.file": self.record.file, "simulation": self.simulation or ""}
        for section, others in (("test_records", self.test_records), ("records", self.records)):
            files |= {f"{section}.{name}.file": other.file for name, other in others.items()}
        for field, file in files.items():
            if re.search("[{}]", file):
                raise refuse(
                    field,
                    f"{file!r} has braces, which the workflow takes for wildcards",
                    "Rename the file or its folder, without { and }.",
                )
        return self

    @model_validator(mode="after")
    def _tracker_runs(self) -> Self:
        check_tracker(self.gfrf, self.tracking)
        return self


_FILE: dict[str, Any] = {
    name: (partial(field.annotation), key(field.description or "", default={}))
    if name in SECTIONS
    else (field.annotation, field)
    for name, field in Case.model_fields.items()
}
# A case as its file may hold it: any keys of the sections that config/config.yaml has too.
CaseFile = create_model("CaseFile", __base__=Section, __doc__=Case.__doc__, **_FILE)


def designed(which: int | str) -> str:
    """Return the name of a designed record, by its number or as ``FRESH``."""
    return f"{_DESIGNED}{which}"


def is_designed(name: str) -> bool:
    """Return whether a record's name is that of a designed one."""
    return name.startswith(_DESIGNED)


def check_case(content: Any, study: Study, file: str | Path | None = None) -> Case:
    """Return a case whose sections are those of ``study`` with its own keys in their place.

    Raises
    ------
    InputError
        Naming the file, the key and the remedy.
    """
    if isinstance(content, Mapping):
        content = dict(content)
        for name in SECTIONS:
            own = content.get(name, {})
            if isinstance(own, Mapping):
                content[name] = settings(getattr(study, name)) | dict(own)
    return validated(Case, content, file)


def case_files(folder: str | Path, *endings: str) -> list[Path]:
    """Return the files of a folder with one of these endings, without those that are hidden.

    Editors and file managers keep hidden ones of their own beside a file.
    """
    return sorted(file for file in Path(folder).glob("[!.]*") if file.suffix in endings)


def read_cases(folder: str | Path, study: Study) -> dict[Path, Case]:
    """Read and check every case of a folder.

    Raises
    ------
    InputError
        As :func:`check_case`; also for a file whose name is taken by an actuator or a folder of
        results, or cannot be a name, or whose YAML is broken.
    """
    taken = {*RESERVED, *(actuator.name for actuator in study.actuators)}
    cases = {}
    for file in case_files(folder, ".yaml", ".yml"):
        if file.suffix == ".yml" or not re.fullmatch(NAME, file.stem):
            raise InputError(
                f"{file.name!r} is no name of a case",
                file=file,
                field="name of the file",
                remedy="Name it NAME.yaml, with letters, digits, _ and - alone in NAME.",
            )
        if file.stem in taken:
            raise InputError(
                f"{file.stem!r} is taken",
                file=file,
                field="name of the file",
                remedy="Give each actuator and case another name.",
            )
        content = read_yaml(file, what="the case", example="a file of config/cases")
        cases[file] = check_case(content, study, file)
    return cases


def simulation_of(case: Case, file: Path, known: Collection[str] | None = None) -> str:
    """Return the simulation that a case names, which is one of ``known`` or a Python file.

    Raises
    ------
    InputError
        If it names none; and where ``known`` is given, if there is none of that name.
    """
    if case.simulation is None:
        raise InputError(
            "it names no simulation",
            file=file,
            field="simulation",
            remedy="Name the physics that the record is compared with: `simulation: mine.py`",
        )
    if known is not None:
        try:
            check_simulation(case.simulation, known, file, "simulation")
        except InputError as error:
            remedy = f"{error.remedy} Or delete {file}."
            raise error.at(file=file, field="simulation", remedy=remedy) from error
    return case.simulation
