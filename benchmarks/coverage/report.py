"""The campaign's tables."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.coverage.campaign import Counted
from benchmarks.coverage.judged import QUANTITIES
from benchmarks.coverage.statistics import Coverage, coverage

LEGEND = """\
Share of 95 % intervals that contain the truth, with its own 95 % interval, over all plants.
Targets: 92 to 98 % for responses, 90 to 98 % for parameters. `!` marks a share whose interval lies
outside of the target, `?` one whose interval is neither in nor outside: the records do not decide.
"""
TARGETS = dict.fromkeys(QUANTITIES, (0.92, 0.98)) | {"parameters": (0.90, 0.98)}
COLUMNS = (
    "plant", "drift", "input", "noise", "estimate", "quantity", "coverage", "low", "high",
    "target_low", "target_high", "verdict", "records", "points", "withheld", "reason",
)  # fmt: skip


def verdict(found: Coverage, target: tuple[float, float]) -> str:
    """Say how a coverage stands to its target: as its whole interval does, else undecided."""
    if not found.records:
        return "withheld"
    if found.high < target[0]:
        return "below"
    if found.low > target[1]:
        return "above"
    return "within" if target[0] <= found.low and found.high <= target[1] else "undecided"


def rows(counted: Sequence[Counted]) -> list[dict[str, object]]:
    """Return a row for each plant, and one for all plants together, of each quantity."""
    groups: dict[tuple[str, ...], list[Counted]] = {}
    for one in counted:
        cell = one.cell
        rest = (cell.drifting, cell.kind, cell.noise, cell.estimate)
        groups.setdefault(("all", *rest), []).append(one)
        groups.setdefault((cell.plant, *rest), []).append(one)
    return [
        _row(key, quantity, group) for key, group in groups.items() for quantity in group[0].inside
    ]


def _row(key: tuple[str, ...], quantity: str, group: list[Counted]) -> dict[str, object]:
    found = coverage(_stacked([one.inside[quantity] for one in group]))
    target = TARGETS[quantity]
    withheld = float(np.mean([one.withheld for one in group]))
    reason = next((one.reason for one in group if one.reason), "")
    values = (*key, quantity, round(found.share, 4), round(found.low, 4), round(found.high, 4),
              *target, verdict(found, target), found.records, found.points, round(withheld, 3),
              reason)  # fmt: skip
    return dict(zip(COLUMNS, values, strict=True))


def _stacked(inside: list[np.ndarray]) -> np.ndarray:
    """Return records of plants with different numbers of points as one, filled with missing."""
    points = max(one.shape[1] for one in inside)
    filled = [
        np.pad(one, ((0, 0), (0, points - one.shape[1])), constant_values=np.nan) for one in inside
    ]
    return np.vstack(filled)


def written(table: Sequence[dict[str, object]], output: Path) -> tuple[list[str], str]:
    """Write a table as ``.csv`` and ``.md``; return the lines of the latter, and its whole text."""
    lines = as_markdown(table)
    text = "\n".join([LEGEND, *lines, ""])
    output.parent.mkdir(parents=True, exist_ok=True)
    output.with_suffix(".csv").write_text(as_csv(table))
    output.with_suffix(".md").write_text(text)
    return lines, text


def as_csv(table: Sequence[dict[str, object]]) -> str:
    """Return all rows."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    return text.getvalue()


def as_markdown(table: Sequence[dict[str, object]]) -> list[str]:
    """Return the rows of all plants together as lines, one for each estimate."""
    lines = [
        "| drift | input | noise | estimate | withheld | " + " | ".join(QUANTITIES) + " |",
        "|" + "---|" * (5 + len(QUANTITIES)),
    ]
    groups: dict[tuple[object, ...], dict[object, dict[str, object]]] = {}
    for row in table:
        if row["plant"] == "all":
            key = (row["drift"] or "none", row["input"], row["noise"], row["estimate"])
            groups.setdefault(key, {})[row["quantity"]] = row
    for names, found in groups.items():
        withheld = 100 * float(str(next(iter(found.values()))["withheld"]))
        shown = [_shown(found.get(quantity)) for quantity in QUANTITIES]
        digits = 0 if withheld in (0, 100) or 1 <= withheld <= 99 else 1  # 99.6 % is not all
        lines.append(
            "| " + " | ".join([*map(str, names), f"{withheld:.{digits}f} %", *shown]) + " |"
        )
    return lines


def _shown(row: dict[str, object] | None) -> str:
    if row is None:
        return ""
    if row["verdict"] == "withheld":
        return "withheld"
    mark = {"within": "", "undecided": " ?"}.get(str(row["verdict"]), " !")
    share, low, high = (100 * float(str(row[name])) for name in ("coverage", "low", "high"))
    return f"{share:.1f} ({low:.0f}–{high:.0f}){mark}"
