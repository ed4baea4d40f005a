"""What the documents name is there: tests, files, names in files, keys of the configuration."""

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from dea.configuration.discrepancy import Budget, Rules
from dea.configuration.resolution import Resolution

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    page
    for kind in ("README.md", "docs/**/*.md", "config/**/*.md", "results/README.md")
    for page in ROOT.glob(kind)
)
SECTIONS = {"rules": Rules, "budget": Budget, "resolution": Resolution}
FOLDERS = ("benchmarks", "config", "docs", "examples", "src", "tests", "workflow")
CODE = re.compile(r"`([^`]+)`")
# An attribute of the library, as `dea.progress.heard_by`; not `python -m dea.progress`.
ATTRIBUTE = re.compile(r"(?<![\w./-])(?<!-m )dea(?:\.[A-Za-z]\w*)+")
NAME_IN_FILE = re.compile(r"`(\w+)`\s+(?:of|in)\s+`([\w./]+\.py)`")
# Segments that stand for a name of the reader's own: `config/cases/mine.yaml`, `tables/NAME.py`.
PLACEHOLDER = re.compile(r"\bmine\b|\b[A-Z]{2,}\b")


@cache
def files():
    own = [path for path in ROOT.iterdir() if path.is_file() or path.name in FOLDERS]
    found = own + [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    return {"/" + path.relative_to(ROOT).as_posix() for path in found}


@cache
def written_tests():
    modules = [path.read_text() for path in (ROOT / "tests").rglob("test_*.py")]
    return {name for text in modules for name in re.findall(r"^ *def (test_\w+)", text, re.M)}


def in_code(text):
    bare = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return [" ".join(each.split()) for each in CODE.findall(bare)]


def is_path(name):
    if not re.fullmatch(r"[\w./-]+", name):
        return False
    return name.endswith(".py") or name.startswith(tuple(f"{each}/" for each in (*FOLDERS, "dea")))


def exists(path):
    if PLACEHOLDER.search(Path(path).name):
        path = path.rpartition("/")[0]
    path = path.rstrip("/")
    return not path or any(file.endswith("/" + path) for file in files())


def defined(module):
    """The names that a module assigns or defines, and the keys of its tables."""
    tree = ast.parse(module.read_text())
    assigned = {
        node.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    kinds = ast.FunctionDef | ast.ClassDef
    keys = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    return assigned | keys | {node.name for node in ast.walk(tree) if isinstance(node, kinds)}


def missing(text):
    """What a text names and the project lacks."""
    for name in in_code(text):
        section, _, field = name.partition(".")
        if is_path(name):
            if not exists(name):
                yield name
        elif section in SECTIONS and re.fullmatch(r"\w+\.(?!nc)\w+", name):
            if field not in SECTIONS[section].model_fields:
                yield name
        elif re.fullmatch(r"test_\w+", name) and name not in written_tests() | {"test_records"}:
            yield name
    for name, path in NAME_IN_FILE.findall(text):
        modules = [ROOT / file[1:] for file in files() if file.endswith("/" + path)]
        if not any(name in defined(module) for module in modules):
            yield f"{name} of {path}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_what_a_document_names_exists(page):
    assert not list(missing(page.read_text()))


@pytest.mark.parametrize(
    "name",
    [
        "`test_the_fit_ends_somewhere`",
        "`dea/discrepancy/no_module.py`",
        "`docs/no_page.md`",
        "`rules.no_rule`",
        "`budget.no_budget`",
        "`KNOWN` of\n`dea/configuration/device.py`",
    ],
)
def test_what_does_not_exist_is_found(name):
    assert list(missing(f"This is {name}.\n"))


def attributes(text):
    """What the code of a text names of the library."""
    blocks = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    return {name for code in [*in_code(text), *blocks] for name in ATTRIBUTE.findall(code)}


NO_ATTRIBUTE = """
import sys
from operator import attrgetter

import dea

for name in sys.argv[1:]:
    try:
        attrgetter(name.removeprefix("dea."))(dea)
    except AttributeError as error:
        print(name, error)
"""


def test_what_the_documents_name_of_the_library_is_there_after_importing_it_alone():
    named = set().union(*(attributes(page.read_text()) for page in PAGES))
    assert {"dea.progress.heard_by", "dea.sklearn.NarxRegressor", "dea.diagnose"} <= named
    amiss = subprocess.run(
        [sys.executable, "-c", NO_ATTRIBUTE, *sorted(named), "dea.no_room", "dea.narx.no_name"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert [line.split()[0] for line in amiss.stdout.splitlines()] == [
        "dea.no_room",
        "dea.narx.no_name",
    ]
