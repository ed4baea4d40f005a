"""The walls between the rooms: those that the import contracts of pyproject.toml cannot state."""

import importlib
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]

# Rooms whose modules are imported one by one, so that a job depends on those it needs alone.
OPEN = {"configuration", "figures", "tables"}


@pytest.fixture(scope="module")
def graph():
    return grimp.build_graph("dea", exclude_type_checking_imports=True, cache_dir=None)


def imports_between_rooms(graph):
    for importer in sorted(graph.modules):
        for imported in sorted(graph.find_modules_directly_imported_by(importer)):
            rooms = importer.split(".")[1:2], imported.split(".")[1:2]
            if rooms[0] != rooms[1] and rooms[1]:
                yield importer, imported


def exported(graph, importer, imported):
    """Whether only a name of the package is imported, which a module of it happens to share."""
    package, _, name = imported.rpartition(".")
    lines = graph.get_import_details(importer=importer, imported=imported)
    return name in getattr(importlib.import_module(package), "__all__", ()) and all(
        line["line_contents"].startswith(f"from {package} import ") for line in lines
    )


def test_rooms_are_entered_by_their_public_surface(graph):
    inner = [
        f"{importer} -> {imported}"
        for importer, imported in imports_between_rooms(graph)
        if len(imported.split(".")) > 2
        and imported.split(".")[1] not in OPEN
        and not exported(graph, importer, imported)
    ]
    assert not inner


def test_figures_and_tables_may_import_no_room_that_their_contract_does_not_name(graph):
    """A new room is to be added to the contract, or here."""
    rooms = {module.split(".")[1] for module in graph.modules if "." in module}
    allowed = {
        "arrays",
        "configuration",
        "effect_label",
        "errors",
        "number_format",
        "provenance",
        "store",
        "terms",
    }
    linter = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    [contract] = [c for c in linter["contracts"] if c["name"].startswith("Figures and tables")]
    others = rooms - allowed - {"figures", "tables"}
    assert set(contract["forbidden_modules"]) == {f"dea.{room}" for room in others}


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("discrepancy/report/new.py", "from dea.plant import film"),
        ("discrepancy/report/new.py", "from ...bench import device"),
        ("discrepancy/problem/new.py", "from dea.discrepancy.evidence.null import null_gain"),
        ("discrepancy/new.py", ""),
        ("bench/new.py", "def lazily():\n    import dea.discrepancy"),
        ("narx/new.py", "from dea.gfrf import frequency_response"),
        ("narx/new.py", "import dea"),
        ("tracking/new.py", "from dea import acquisition"),
        ("store/new.py", "import snakemake"),
        ("store/new.py", "from snakemake_interface_common.errors import WorkflowError"),
        ("store/new.py", "from benchmarks import stored"),
        ("sklearn.py", "from dea import simulation"),
        ("figures/new.py", "from dea import modbus"),
        ("tables/new.py", "def lazily():\n    from dea.excitation import design"),
        ("new_room/__init__.py", ""),
    ],
)
def test_a_breach_of_the_contracts_is_found(module, line, tmp_path):
    shutil.copytree(
        ROOT / "src" / "dea", tmp_path / "dea", ignore=shutil.ignore_patterns("__pycache__")
    )
    breach = tmp_path / "dea" / module
    breach.parent.mkdir(exist_ok=True)
    breach.write_text(line + "\n")
    linter = [Path(sys.executable).parent / "lint-imports", "--no-cache"]
    result = subprocess.run(
        [*linter, "--config", ROOT / "pyproject.toml"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert result.returncode == 1, result.stdout
    assert "1 broken" in result.stdout or "2 broken" in result.stdout
    assert module.removesuffix(".py").replace("/", ".").removesuffix(".__init__") in result.stdout
