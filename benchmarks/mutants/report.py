"""The outcome of a campaign as a table of rooms and a list of survivors."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.mutants.judgements import Change, change
from dea.trials import wilson

HEAD = """# Mutants

{count} mutants, drawn with seed {seed}, each put before at most {budget:g} s of the tests that run
its line. A mutant with which no test can be run (incompetent) is left out of the rate; one with
which the tests do not end in time (timeout) counts as killed, and a survivor that was judged to be
no fault as survived. On the code as it is, the tests of {controls} mutants were run beside:
{failed} of these runs failed.

"""
TABLE = (
    "| room | killed | timeout | survived | no fault | incompetent | kill rate (%)"
    " | 95 % interval (%) |",
    "|---|---|---|---|---|---|---|---|",
)


def kill_rate(outcomes: Sequence[str]) -> tuple[float, float, float] | None:
    """Return the share of competent mutants that tests noticed, and Wilson's 95 % interval."""
    counts = Counter(outcomes)
    noticed = counts["killed"] + counts["timeout"]
    if noticed + counts["survived"] == 0:
        return None
    rate = wilson(noticed, noticed + counts["survived"])
    return rate.value, rate.low, rate.high


def markdown(
    rows: Sequence[Mapping[str, Any]], judged: Mapping[Change, str], seed: int, budget: float
) -> str:
    """Return the report: outcomes by room, then every survivor with its change."""
    found = values(rows, judged)
    head = HEAD.format(
        count=len(rows), seed=seed, budget=budget,
        controls=found["controls"], failed=found["failed controls"],
    )  # fmt: skip
    lines = [*found["rooms"], "", f"## Survivors ({found['survived']})", "", *found["survivors"]]
    return head + "\n".join(lines) + "\n"


def values(rows: Sequence[Mapping[str, Any]], judged: Mapping[Change, str]) -> dict[str, Any]:
    """Return numbers and tables of a campaign, for its report and for the documents."""
    rooms = sorted({row["room"] for row in rows})
    controls = [row["control"] for row in rows if row["control"] is not None]
    survivors = sorted(
        (row for row in rows if row["outcome"] == "survived"),
        key=lambda row: (row["room"], row["file"], row["line"]),
    )
    rate = kill_rate([row["outcome"] for row in rows])
    return {
        "count": len(rows),
        "survived": len(survivors),
        "no fault": sum(change(row) in judged for row in survivors),
        "rate": rate and rate[0],
        "interval": rate and rate[1:],
        "controls": len(controls),
        "failed controls": sum(control != "survived" for control in controls),
        "rooms": [
            *TABLE,
            *(_line(room, [row for row in rows if row["room"] == room], judged) for room in rooms),
            _line("all", rows, judged),
        ],
        "survivors": [
            "| where | change | judged no fault, because |",
            "|---|---|---|",
            *(_survivor(row, judged.get(change(row), "")) for row in survivors),
        ],
    }


def _line(room: str, rows: Sequence[Mapping[str, Any]], judged: Mapping[Change, str]) -> str:
    outcomes = [row["outcome"] for row in rows]
    counts, rate = Counter(outcomes), kill_rate(outcomes)
    no_fault = sum(row["outcome"] == "survived" and change(row) in judged for row in rows)
    cells = [
        room, counts["killed"], counts["timeout"], counts["survived"], no_fault,
        counts["incompetent"],
    ]  # fmt: skip
    if rate is None:
        cells += ["", ""]
    else:
        value, low, high = (100.0 * part for part in rate)
        cells += [f"{value:.1f}", f"{low:.1f} to {high:.1f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def _survivor(row: Mapping[str, Any], why: str) -> str:
    file, before, after = change(row)
    place = f"`{file.removeprefix('src/dea/')}` {row['definition']}".strip()
    cells = (place, f"`{before}` → `{after}`", why)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
