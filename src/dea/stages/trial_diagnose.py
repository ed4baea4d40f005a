"""Diagnose a batch of blind trials from their records alone."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dea.stages.command import run


def trial_diagnose(settings: Mapping[str, Any], records: Path, verdicts: Path) -> None:
    """Write ``verdicts/NNNN.json`` for each record, and all rankings to ``rankings.json``.

    ``settings`` holds ``seed`` and ``discrepancy``. A ranking lists the explanations by error, the
    chosen one first, so that answers can be scored where none was given.
    """
    import json

    from dea import store
    from dea.discrepancy import Settings, diagnose

    verdicts.mkdir(parents=True)
    rankings = {}
    for record in sorted(records.glob("*.nc")):
        diagnosis = diagnose(
            store.read_record(record),
            settings["discrepancy"]["simulation"],
            settings=Settings.of({**settings, "system": record.stem}),
        )
        diagnosis.verdict.write(verdicts / f"{record.stem}.json")
        chosen = diagnosis.decision.chosen
        others = [c for c in diagnosis.pool if c.finished and c is not chosen]
        rankings[record.stem] = [
            {"effects": candidate.names, "error": candidate.error}
            for candidate in ([chosen] if chosen else []) + others
        ]
    (verdicts / "rankings.json").write_text(json.dumps(rankings, indent=2) + "\n")


if __name__ == "__main__":
    run(trial_diagnose, inputs=("records",), outputs=("verdicts",))
