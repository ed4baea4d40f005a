"""The outcome of a campaign as a table of rooms and a list of survivors."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from dea.trials import wilson

OUTCOMES = ("killed", "timeout", "survived", "incompetent")
HEAD = """# Mutants

{count} mutants, drawn with seed {seed}, each put before at most {budget:g} s of the tests that run
its line. A mutant with which no test can be run (incompetent) is left out of the rate; one with
which the tests do not end in time (timeout) counts as killed. On the code as it is, the tests of
{controls} mutants were run beside: {failed} of these runs failed.

| room | killed | timeout | survived | incompetent | kill rate (%) | 95 % interval (%) |
|---|---|---|---|---|---|---|
"""


def kill_rate(outcomes: Sequence[str]) -> tuple[float, float, float] | None:
    """Return the share of competent mutants that tests noticed, and Wilson's 95 % interval."""
    counts = Counter(outcomes)
    noticed = counts["killed"] + counts["timeout"]
    if noticed + counts["survived"] == 0:
        return None
    rate = wilson(noticed, noticed + counts["survived"])
    return rate.value, rate.low, rate.high


def markdown(rows: Sequence[Mapping[str, Any]], seed: int, budget: float) -> str:
    """Return the report: outcomes by room, then every survivor with its change."""
    rooms = sorted({row["room"] for row in rows})
    controls = [row["control"] for row in rows if row["control"] is not None]
    failed = sum(control != "survived" for control in controls)
    text = HEAD.format(
        count=len(rows), seed=seed, budget=budget, controls=len(controls), failed=failed
    )
    for room in rooms:
        text += _line(room, [row["outcome"] for row in rows if row["room"] == room])
    text += _line("all", [row["outcome"] for row in rows])
    survivors = sorted(
        (row for row in rows if row["outcome"] == "survived"),
        key=lambda row: (row["room"], row["file"], row["line"]),
    )
    text += f"\n## Survivors ({len(survivors)})\n"
    for row in survivors:
        text += f"\n`{row['file']}:{row['line']}` {row['definition']} ({row['operator']})\n"
        text += "```diff\n" + "\n".join(row["diff"]) + "\n```\n"
    return text


def _line(room: str, outcomes: Sequence[str]) -> str:
    counts = Counter(outcomes)
    cells = [room, *(str(counts[outcome]) for outcome in OUTCOMES)]
    rate = kill_rate(outcomes)
    if rate is None:
        cells += ["", ""]
    else:
        value, low, high = (100.0 * part for part in rate)
        cells += [f"{value:.1f}", f"{low:.1f} to {high:.1f}"]
    return "| " + " | ".join(cells) + " |\n"
