"""Diagnose a batch of blind trials from their records alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_diagnose(
    settings: Mapping[str, Any],
    records: Path,
    logs: Path,
    simulations: list[Path],
    verdicts: Path,
) -> None:
    """Write ``verdicts/NNNN.json`` and ``verdicts/NNNN.nc`` (its certificate) for each record.

    ``settings`` holds ``seed`` and ``discrepancy``; each record names its simulation, which is in
    the catalogue or one of the ``simulations``: these are given so that they count as inputs.
    ``rankings.json`` lists the explanations of each record by error, the chosen one first, so that
    answers can be scored where none was given.
    """
    import json

    from dea import store
    from dea.discrepancy import Settings, certificate_dataset, diagnose
    from dea.progress import part_of

    verdicts.mkdir(parents=True)
    rankings = {}
    files = sorted([*records.glob("*.nc"), *logs.glob("*.nc")], key=lambda path: path.stem)
    for number, file in enumerate(files, 1):
        record = store.read_record(file)
        with part_of(f"trial {number} of {len(files)}"):
            diagnosis = diagnose(
                record,
                record.attrs["simulation"],
                settings=Settings.of({**settings, "system": file.stem}),
            )
        diagnosis.verdict.write(verdicts / f"{file.stem}.json")
        store.write(
            certificate_dataset(diagnosis),
            verdicts / f"{file.stem}.nc",
            title=f"Proof of the extension on unused samples: blind trial {file.stem}",
            settings=settings,
        )
        chosen = diagnosis.decision.chosen
        others = [c for c in diagnosis.pool if c.finished and c is not chosen]
        rankings[file.stem] = [
            {"effects": candidate.names, "error": candidate.error}
            for candidate in ([chosen] if chosen else []) + others
        ]
    (verdicts / "rankings.json").write_text(json.dumps(rankings, indent=2) + "\n")


if __name__ == "__main__":
    run(trial_diagnose, inputs=("records", "logs", "simulations*"), outputs=("verdicts",))
