"""The page on blind trials lists every form with its use, as the catalogue has it."""

from pathlib import Path

from dea.plant import EFFECTS

PAGE = (Path(__file__).parents[2] / "docs" / "trials.md").read_text()


def test_every_form_is_listed_with_its_use_and_publication():
    for effect in EFFECTS.values():
        for form in effect.forms:
            rest = f"{form.use} | {form.source} |"
            listed = f"| `{effect.name}` | `{form.name}` | {rest}", f"| `{form.name}` | {rest}"
            assert any(line in PAGE for line in listed), form.name
