"""Which files of ``src/dea`` a stage depends on, read from its import statements.

Listing them as inputs of a rule makes an edited module rerun what depends on it and nothing else.
"""

import ast
from functools import cache
from pathlib import Path

SOURCE = Path("src")


def modules(*names: str) -> list[str]:
    """Return the files of the modules ``names`` and of all they import, directly or not."""
    found: set[Path] = set()
    pending = [file for name in names for file in _files(name)]
    while pending:
        file = pending.pop()
        if file not in found:
            found.add(file)
            pending.extend(_imported(file))
    return sorted(map(str, found))


@cache
def _imported(file: Path) -> tuple[Path, ...]:
    names: list[str] = []
    for node in _statements(ast.parse(file.read_text()).body):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return tuple(path for name in names if name.split(".")[0] == "dea" for path in _files(name))


def _statements(body: list[ast.stmt]) -> list[ast.AST]:
    """Every statement but those that only the type checker reads."""
    nodes: list[ast.AST] = []
    for statement in body:
        if isinstance(statement, ast.If) and ast.unparse(statement.test).endswith("TYPE_CHECKING"):
            continue
        nodes += list(ast.walk(statement))
    return nodes


def _files(name: str) -> list[Path]:
    """The file of a module and the packages above it; nothing for a name that is no module."""
    parts = name.split(".")
    packages = [SOURCE.joinpath(*parts[: i + 1], "__init__.py") for i in range(len(parts))]
    module = SOURCE.joinpath(*parts).with_suffix(".py")
    return [file for file in (*packages, module) if file.exists()]
