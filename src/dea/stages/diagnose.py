"""Name what the simulation of a record is missing, and write the evidence for it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dea.stages.command import run


def diagnose(
    settings: Mapping[str, Any],
    record: Path,
    further: list[Path],
    tests: list[Path],
    localisation: Path,
    candidates: Path,
    verdict: Path,
    nominal: Path,
    extended: Path,
    certificate: Path,
    threads: int,
) -> None:
    """Diagnose records with the simulation the settings name, on so many ``threads``.

    ``further`` records of the device are explained together with the first.
    """
    from dea import store
    from dea.discrepancy import (
        Settings,
        candidates_dataset,
        certificate_dataset,
        diagnose,
        localisation_dataset,
        save_simulation,
    )
    from dea.errors import InputError

    name = settings["system"]
    try:
        found = diagnose(
            [store.read_record(path) for path in (record, *further)],
            settings["simulation"],
            test_records={path.stem: store.read_record(path) for path in tests},
            settings=Settings.of(settings),
            workers=threads,
        )
    except InputError as error:
        remedy = f"{error.remedy} (case {name})" if error.remedy else f"Case {name}"
        file = error.file or _file_of(error.field or "", [record, *further], tests)
        raise error.at(file=file, remedy=remedy) from error
    inputs = {
        "record": record,
        **{f"further_{path.stem}": path for path in further},
        **{f"test_{path.stem}": path for path in tests},
    }
    for dataset, path, title in (
        (localisation_dataset(found), localisation, "Where simulation and record disagree"),
        (candidates_dataset(found), candidates, "Effects that could be missing"),
        (certificate_dataset(found), certificate, "Proof of the extension on unused samples"),
    ):
        store.write(
            dataset,
            path,
            title=f"{title}: {name}",
            inputs=inputs,
            settings=settings,
            seed=settings["seed"],
        )
    for fit, path in ((found.nominal, nominal), (found.final, extended)):
        save_simulation(found, fit, path)
    found.verdict.write(verdict)


def _file_of(field: str, records: Sequence[Path], tests: Sequence[Path]) -> Path:
    """Return the file of the record, or test record, that the field of an error names."""
    named = {f"record {number}": path for number, path in enumerate(records, start=1)}
    named |= {f"test_records.{path.stem}": path for path in tests}
    return next((p for name, p in named.items() if f"{field}.".startswith(f"{name}.")), records[0])


if __name__ == "__main__":
    run(
        diagnose,
        inputs=("record", "further*", "tests*"),
        outputs=("localisation", "candidates", "verdict", "nominal", "extended", "certificate"),
        numbers=("threads",),
        named=("simulation",),
    )
