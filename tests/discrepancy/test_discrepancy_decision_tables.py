"""The tables of the decision in the documents have every status and reason of the code."""

import ast
import re
from pathlib import Path

from dea.discrepancy import Reason, Status

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "src/dea/discrepancy/decision").glob("*.py"))
PAGE = ROOT / "docs/method/diagnosis.md"
TREES = [ast.parse(module.read_text()) for module in MODULES]
NONE = "none"


def reasons_in(node):
    """The members of ``Reason`` that a node names."""
    return {
        part.attr
        for part in ast.walk(node)
        if isinstance(part, ast.Attribute) and getattr(part.value, "id", "") == "Reason"
    }


def function(name):
    [found] = [
        node
        for tree in TREES
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name == name
    ]
    return found


def reasons_of(node, tree):
    """The reasons that an expression may be."""
    if node is None:
        return {NONE}
    if isinstance(node, ast.Call):
        return reasons_in(function(node.func.id)) | {NONE}
    if isinstance(node, ast.Name):
        sources = [
            part.iter if isinstance(part, ast.For) else part.value
            for part in ast.walk(tree)
            if isinstance(part, ast.For | ast.Assign)
            and node.id in {name.id for name in ast.walk(target(part)) if hasattr(name, "id")}
        ]
        return {reason for source in sources for reason in reasons_of(source, tree)}
    return reasons_in(node)


def target(node):
    return node.target if isinstance(node, ast.For) else node.targets[0]


def outcomes_of_the_code():
    found = set()
    for tree in TREES:
        for call in ast.walk(tree):
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Decision":
                given = {keyword.arg: keyword.value for keyword in call.keywords}
                reason = given.get("reason", call.args[3] if len(call.args) > 3 else None)
                status = Status[call.args[0].attr].value
                found |= {(status, each) for each in reasons_of(reason, tree)}
    return found


def outcomes_of_the_page():
    found = set()
    statuses = "|".join(Status)
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        held = [match for cell in cells[:-1] if (match := re.match(f"`({statuses})`", cell))]
        reasons = set(re.findall(r"`([A-Z_]+)`", cells[-1]))
        if line.startswith("|") and held and reasons:
            reasons |= {NONE} if cells[-1].startswith("none") else set()
            found |= {(held[-1][1], reason) for reason in reasons}
    return found


def test_the_tables_have_every_outcome_and_no_other():
    assert outcomes_of_the_page() == outcomes_of_the_code()


def test_every_reason_is_in_the_tables():
    assert {reason for _, reason in outcomes_of_the_page()} == {*Reason.__members__, NONE}
