import sys
from pathlib import Path

import pytest

from written_files import write_files

sys.path.insert(0, str(Path(__file__).parents[2] / "workflow"))

import imports

TYPING_ONLY = """
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from house.b import g
"""


@pytest.fixture
def source(tmp_path, monkeypatch):
    files = {
        "house/__init__.py": TYPING_ONLY,
        "house/errors.py": "",
        "house/a.py": "import numpy\nfrom house.errors import InputError\n",
        "house/b/__init__.py": "from .inner import g\n",
        "house/b/inner.py": "def g():\n    from house import c\n",
        "house/c.py": "import house.errors\n",
        "house/alone.py": "",
    }
    write_files(tmp_path, files)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(imports, "SOURCE", tmp_path)
    monkeypatch.setattr(imports, "PACKAGE", "house")
    imports._graph.cache_clear()
    yield tmp_path
    imports._graph.cache_clear()


def names(source, *modules):
    return {str(Path(file).relative_to(source)) for file in imports.modules(*modules)}


def test_a_module_depends_on_what_it_imports_and_the_packages_above(source):
    assert names(source, "house.a") == {"house/__init__.py", "house/a.py", "house/errors.py"}


def test_imports_inside_functions_relative_ones_and_those_of_packages_count(source):
    assert names(source, "house.b") == {
        "house/__init__.py",
        "house/b/__init__.py",
        "house/b/inner.py",
        "house/c.py",
        "house/errors.py",
    }


def test_what_only_the_type_checker_reads_does_not_count(source):
    assert names(source, "house.alone") == {"house/__init__.py", "house/alone.py"}


def test_several_modules_are_joined_without_doubles(source):
    both = imports.modules("house.a", "house.b")
    assert len(both) == len(set(both)) == 6


def test_a_misspelt_module_is_refused(source):
    with pytest.raises(ValueError, match=r"no module house\.d"):
        imports.modules("house.d")


def test_the_list_of_code_is_named_by_what_it_says(source, monkeypatch):
    """An edit makes another input, whatever the date of the list."""
    monkeypatch.chdir(source)
    monkeypatch.setattr(imports, "LISTS", Path("build/code"))
    first = imports.listed(["house/c.py"])
    assert imports.listed(["house/c.py"]) == first
    Path("house/c.py").write_text("import house.alone\n")
    imports.content.cache_clear()
    second = imports.listed(["house/c.py"])
    assert second != first
    assert Path(first).read_text() != Path(second).read_text()


def test_a_file_that_is_not_there_has_no_content(tmp_path):
    assert imports.content(str(tmp_path / "nothing.csv")) == ""
