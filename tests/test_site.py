"""Every page of the documentation has a place in the site, and its links lead somewhere."""

import importlib.util
import re
from pathlib import Path

import pytest
import yaml

import dea

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    path
    for kind in ("README.md", "docs/**/*.md", "config/**/*.md", "results/README.md")
    for path in ROOT.glob(kind)
)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


class _Loader(yaml.SafeLoader):
    """Reads tags of mkdocs, which name functions, as nothing."""


_Loader.add_multi_constructor("", lambda loader, suffix, node: None)


def leaves(tree):
    if isinstance(tree, str):
        return [tree]
    branches = tree.values() if isinstance(tree, dict) else tree
    return [leaf for branch in branches for leaf in leaves(branch)]


def test_every_page_is_in_the_navigation():
    settings = yaml.load((ROOT / "mkdocs.yml").read_text(), _Loader)
    named = set(leaves(settings["nav"])) - {"index.md"}
    pages = {
        path.relative_to(ROOT / "docs").as_posix()
        for kind in ("*.md", "*.ipynb", "method/*.md")
        for path in (ROOT / "docs").glob(kind)
    }
    assert named - {"decisions/README.md"} == pages


def test_every_decision_is_in_their_table_in_order():
    folder = ROOT / "docs/decisions"
    rows = [row for row in (folder / "README.md").read_text().splitlines() if row.startswith("|")]
    listed = [re.findall(r"\((\d{4}-[^)]*\.md)\)", row) for row in rows]
    assert all(row == sorted(row) for row in listed)
    written = {file.name for file in folder.glob("0*.md")}
    assert sorted(name for row in listed for name in row) == sorted(written)


def test_every_public_name_of_the_library_has_a_place_in_the_reference():
    entries = re.findall(
        r"^::: \S+\.(\w+)$", (ROOT / "docs/reference.md").read_text(), re.MULTILINE
    )
    assert set(dea.__all__) <= set(entries)


def anchors(page):
    """The headings of a page as links name them."""
    bare = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", bare, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_leads_somewhere(page):
    bare = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(), flags=re.DOTALL)
    for link in LINK.findall(bare):
        if re.match("[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.fixture
def faults():
    spec = importlib.util.spec_from_file_location(
        "built_pages", ROOT / "docs" / "site" / "built_pages.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.faults


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        (
            '<a href="other.html#here">x</a> <a href="#__top">x</a> <a href="https://x.org">x</a>',
            "",
        ),
        ("<pre>cost $a_1$</pre> <code>x = $HOME</code> from $5 to $10", ""),
        ('<a class="y" href="other.md">x</a>', "page.html: no file other.md"),
        ('<a href="other.html#there">x</a>', "page.html: no heading other.html#there"),
        ('<script src="https://unpkg.com/a/b"></script>', "page.html: it loads https://unpkg.com/"),
        ("<p>the term $y_{t-1}u_{t-3}^2$ of", "page.html: the formula $y_{t-1}u_{t-3}^2$ was not"),
        ("<math><mi>x</mi>$$$$<mi>y</mi></math>", "page.html: two formulas became one"),
    ],
)
def test_what_is_wrong_with_a_built_page_is_named(tmp_path, faults, body, fault):
    (tmp_path / "page.html").write_text(body)
    (tmp_path / "other.html").write_text('<h2 id="here">Here</h2>')
    found = list(faults(tmp_path))
    assert len(found) == bool(fault)
    assert not fault or found[0].startswith(fault)


def test_formulas_are_converted_and_what_converts_them_is_installed():
    settings = yaml.load((ROOT / "mkdocs.yml").read_text(), _Loader)
    assert {"pymdownx.arithmatex": {"generic": True}} in settings["markdown_extensions"]
    assert re.search(
        r"^latex2mathml==", (ROOT / "docs/site/environment.txt").read_text(), re.MULTILINE
    )
