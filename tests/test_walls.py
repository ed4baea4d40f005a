"""The walls between the rooms, read from the import statements."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src" / "dea"

TRUTH = {"plant", "bench"}
FORBIDDEN = {
    "configuration": {
        *TRUTH,
        "simulation",
        "discrepancy",
        "acquisition",
        "modbus",
        "narx",
        "tracking",
        "gfrf",
        "store",
        "stages",
        "figures",
    },
    "simulation": {*TRUTH, "discrepancy", "acquisition", "stages", "figures"},
    "discrepancy": {*TRUTH, "acquisition", "stages", "figures"},
    "plant": {
        "simulation",
        "discrepancy",
        "bench",
        "acquisition",
        "narx",
        "tracking",
        "gfrf",
        "stages",
        "figures",
    },
    "bench": {
        "simulation",
        "discrepancy",
        "acquisition",
        "narx",
        "tracking",
        "gfrf",
        "stages",
        "figures",
    },
    "narx": {*TRUTH, "discrepancy", "acquisition", "stages", "figures"},
    "tracking": {*TRUTH, "discrepancy", "acquisition", "stages", "figures"},
    "gfrf": {*TRUTH, "discrepancy", "acquisition", "stages", "figures"},
    "acquisition": {*TRUTH, "discrepancy", "narx", "tracking", "gfrf", "stages", "figures"},
    "modbus": {*TRUTH, "discrepancy", "acquisition", "narx", "tracking", "gfrf", "figures"},
    "store": {*TRUTH, "discrepancy", "acquisition", "narx", "tracking", "gfrf", "figures"},
    "trials": {
        *TRUTH,
        "discrepancy",
        "acquisition",
        "narx",
        "tracking",
        "gfrf",
        "stages",
        "figures",
    },
    "figures": {*TRUTH, "discrepancy", "acquisition", "narx", "tracking", "gfrf", "stages"},
}


def imported(file: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def files(room: str) -> list[Path]:
    return sorted((SOURCE / room).rglob("*.py"))


@pytest.mark.parametrize("room", FORBIDDEN)
def test_a_room_keeps_out_of_the_rooms_it_may_not_know(room):
    assert files(room)
    reached = {
        (file.name, name)
        for file in files(room)
        for name in imported(file)
        for other in FORBIDDEN[room]
        if name == f"dea.{other}" or name.startswith(f"dea.{other}.")
    }
    assert not reached


def test_nothing_in_the_library_imports_snakemake():
    for file in SOURCE.rglob("*.py"):
        assert not {name for name in imported(file) if name.split(".")[0] == "snakemake"}, file


def exported(package: str) -> set[str]:
    """Names in the ``__all__`` of a package, which may be those of its modules too."""
    init = SOURCE.joinpath(*package.split(".")[1:], "__init__.py")
    if not package.startswith("dea") or not init.exists():
        return set()
    for node in ast.parse(init.read_text()).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return set(ast.literal_eval(node.value))
    return set()


def entered(file: Path) -> set[str]:
    """Everything imported that could be a module, but for what its package exports by name."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            hidden = {alias.name for alias in node.names} - exported(node.module)
            names |= {node.module} | {f"{node.module}.{name}" for name in hidden}
    return names


# Rooms whose modules are imported one by one, so that a job depends on those it needs alone.
OPEN = {"stages", "figures", "configuration"}


def test_rooms_are_entered_by_their_public_surface():
    inner = {}
    for file in SOURCE.rglob("*.py"):
        room = file.relative_to(SOURCE).parts[0]
        for name in entered(file):
            parts = name.split(".")
            if parts[0] == "dea" and len(parts) > 2 and parts[1] not in {room, *OPEN}:
                package = SOURCE.joinpath(*parts[1:])
                if package.with_suffix(".py").exists() or package.is_dir():
                    inner.setdefault(str(file.relative_to(SOURCE)), set()).add(name)
    assert not inner
