"""The verdicts of a campaign, kept as lines of JSON, from which an interrupted one goes on."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.faults.schedule import Schedule, loads
from benchmarks.stored import add, commit, known


@dataclass(frozen=True)
class Verdict:
    """A schedule and the laws that its run has broken."""

    schedule: Schedule
    broken: tuple[str, ...]
    status: int | None  # of the command
    driven: bool  # whether the output has left zero


class Verdicts:
    """The verdicts on the commit checked out; those on changed code are not read again."""

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self._commit = commit()
        self._verdicts: dict[str, Verdict] = {}
        if file is not None:
            self._verdicts = {row["drawn"]: _verdict(row) for row in known(file, self._commit)}

    def on(self, drawn: Schedule) -> Verdict | None:
        """Return the verdict on a schedule, None where there is none yet."""
        return self._verdicts.get(drawn.dumps())

    def add(self, drawn: Schedule, verdict: Verdict) -> None:
        """Keep the verdict on the schedule that was drawn; its own may be a reduced one."""
        self._verdicts[drawn.dumps()] = verdict
        if self._file is not None:
            row = {
                "commit": self._commit,
                "drawn": drawn.dumps(),
                "judged": verdict.schedule.dumps(),
                "broken": verdict.broken,
                "status": verdict.status,
                "driven": verdict.driven,
            }
            add(self._file, row)


def _verdict(row: dict[str, Any]) -> Verdict:
    return Verdict(
        schedule=loads(row["judged"]),
        broken=tuple(row["broken"]),
        status=row["status"],
        driven=row["driven"],
    )
