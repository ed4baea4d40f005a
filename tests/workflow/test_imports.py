import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "workflow"))

import imports

TYPING_ONLY = """
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from dea.b import g
"""


@pytest.fixture
def source(tmp_path, monkeypatch):
    files = {
        "dea/__init__.py": TYPING_ONLY,
        "dea/errors.py": "",
        "dea/a.py": "import numpy\nfrom dea.errors import InputError\n",
        "dea/b/__init__.py": "from dea.b.inner import g\n",
        "dea/b/inner.py": "def g():\n    from dea import c\n",
        "dea/c.py": "import dea.errors\n",
        "dea/alone.py": "",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(imports, "SOURCE", tmp_path)
    imports._imported.cache_clear()
    return tmp_path


def names(source, *modules):
    return {str(Path(file).relative_to(source)) for file in imports.modules(*modules)}


def test_a_module_depends_on_what_it_imports_and_the_packages_above(source):
    assert names(source, "dea.a") == {"dea/__init__.py", "dea/a.py", "dea/errors.py"}


def test_imports_inside_functions_and_through_packages_count(source):
    assert names(source, "dea.b") == {
        "dea/__init__.py",
        "dea/b/__init__.py",
        "dea/b/inner.py",
        "dea/c.py",
        "dea/errors.py",
    }


def test_what_only_the_type_checker_reads_does_not_count(source):
    assert names(source, "dea.alone") == {"dea/__init__.py", "dea/alone.py"}


def test_several_modules_are_joined_without_doubles(source):
    both = imports.modules("dea.a", "dea.b")
    assert len(both) == len(set(both)) == 6
