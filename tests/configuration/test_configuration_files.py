"""Every key of every file of config/: misspelt, out of range, in the JSON schema, on the page."""

import copy
import re
from pathlib import Path

import jsonschema
import pytest
import yaml
from pydantic import create_model

from changed_content import changed
from dea.configuration.bench import Plant
from dea.configuration.case import Case, check_case
from dea.configuration.page import FILES, json_schema, page
from dea.configuration.problems import validated
from dea.configuration.section import Section
from dea.configuration.study import check_study
from dea.errors import InputError

ROOT = Path(__file__).parents[2]
SHIPPED = [
    (path, file)
    for file in FILES
    for path in sorted(ROOT.glob(file))
]  # fmt: skip
STUDY = yaml.safe_load((ROOT / "config/config.yaml").read_text())
# Where a mapping's keys are names of the user's own, ``*`` standing for any one of them.
OWN_NAMES = {
    "config/cases/*.yaml": ["records", "test_records"],
    "config/devices/*.yaml": ["registers"],
    "config/bench.yaml": ["actuators"],
    "config/published_models.yaml": ["models", "models.*"],
    "config/published_errors.yaml": ["errors", "errors.*", "extensions", "extensions.*"],
    "config/public_records.yaml": ["", "*.csv.sampled.columns"],
}


def check(file, content):
    if file == "config/cases/*.yaml":
        check_case(content, check_study(STUDY), "file.yaml")
    else:
        validated(FILES[file], content, "file.yaml")


def places(node, place=()):
    """Yield the place of every value below ``node``."""
    items = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in items:
        yield (*place, key)
        if isinstance(value, dict | list):
            yield from places(value, (*place, key))


def at(content, place):
    for step in place:
        content = content[step]
    return content


def dotted(place):
    return re.sub(r"\.\[", "[", ".".join(f"[{s}]" if isinstance(s, int) else s for s in place))


def is_own_name(file, place):
    above = ".".join(map(str, place[:-1]))
    patterns = [re.escape(name).replace(r"\*", r"[^.]+") for name in OWN_NAMES.get(file, [])]
    return any(re.fullmatch(pattern, above) for pattern in patterns)


@pytest.mark.parametrize(("path", "file"), SHIPPED, ids=lambda value: Path(value).stem)
def test_every_key_with_a_letter_too_many_is_refused_with_the_nearest(path, file):
    content = yaml.safe_load(path.read_text())
    keys = [p for p in places(content) if isinstance(p[-1], str) and not is_own_name(file, p)]
    assert keys
    for place in keys:
        wrong = copy.deepcopy(content)
        section = at(wrong, place[:-1])
        misspelt = place[-1] + place[-1][-1]
        section[misspelt] = section.pop(place[-1])
        with pytest.raises(InputError) as caught:
            check(file, wrong)
        said = str(caught.value)
        if place[-1] == "kind":  # without it nothing says which keys there are
            assert caught.value.field == dotted(place)
            continue
        assert said.startswith(f"file.yaml: {dotted((*place[:-1], misspelt))}: "), said
        assert f"Did you mean {place[-1]!r}?" in said
        assert "\n" not in said


@pytest.mark.parametrize(("path", "file"), SHIPPED, ids=lambda value: Path(value).stem)
def test_every_number_out_of_range_is_refused_with_key_and_range(path, file):
    content = yaml.safe_load(path.read_text())
    for place in places(content):
        value = at(content, place)
        if isinstance(value, bool) or not isinstance(value, int | float) or place[-1] == "expect":
            continue
        for bad in (float("nan"), *outside(file, content, place)):
            with pytest.raises(InputError) as caught:
                check(file, changed(content, place, bad))
            field = dotted(place)
            assert field.startswith(caught.value.field), (place, bad, str(caught.value))
            assert re.search(r"Give .*(number|low)", str(caught.value))
            assert "\n" not in str(caught.value)


def outside(file, content, place):
    """Return numbers beyond the bounds that the refusal of a value that is none tells."""
    with pytest.raises(InputError) as caught:
        check(file, changed(content, place, float("nan")))
    said = str(caught.value).split("Give ")[1]
    found = []
    # Of a value that may be one of several things, the range of the widest is left.
    lows = re.findall(r"(above|of at least|from) (-?\d[\d.e+-]*\b)", said)
    if lows:
        words, number = min(lows, key=lambda low: float(low[1]))
        found.append(float(number) - (words != "above") * max(1.0, abs(float(number))))
    if highs := re.findall(r"(?:up to| to) (-?\d[\d.e+-]*\b)", said):
        found.append(max(map(float, highs)) * 2 + 1.0)
    return [int(number) if number == int(number) else number for number in found]


@pytest.mark.parametrize(("path", "file"), SHIPPED, ids=lambda value: Path(value).stem)
def test_the_json_schema_accepts_what_the_study_ships_and_refuses_a_misspelt_key(path, file):
    schema = json_schema(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    content = yaml.safe_load(path.read_text())
    validator.validate(content)
    key = next(p for p in places(content) if not is_own_name(file, p))
    wrong = copy.deepcopy(content)
    section = at(wrong, key[:-1])
    section[f"{key[-1]}x"] = section.pop(key[-1])
    assert not validator.is_valid(wrong)


def test_every_key_has_a_unit_or_none_and_a_description():
    for file in FILES:
        for name, definition in json_schema(file).get("$defs", {}).items():
            for key, node in definition.get("properties", {}).items():
                assert node.get("description"), f"{file}: {name}.{key}"


def test_the_page_of_the_documentation_is_up_to_date():
    written = (ROOT / "docs/configuration.md").read_text()
    assert written == page(), "run `make configuration`"


def test_every_key_that_may_be_left_away_has_a_default_on_the_page():
    shown = page()
    for model in (*FILES.values(), Case, Plant):
        for name, section in model.model_json_schema().get("$defs", {}).items():
            table = shown.partition(f"\n### {name}\n")[2].partition("\n#")[0]
            for key in section.get("properties", ()) if table else ():
                row = next(line for line in table.splitlines() if line.startswith(f"| `{key}` |"))
                default = re.split(r"(?<!\\)\|", row)[3].strip()
                assert bool(default) == (key not in section.get("required", ())), (name, key)


def test_two_sections_of_one_name_are_refused_on_the_page(monkeypatch):
    class Films(Section):
        """A file with another section called Film than that of the bench."""

        film: create_model("Film", __base__=Section, __doc__="Another film.")

    monkeypatch.setitem(FILES, "config/films.yaml", Films)
    with pytest.raises(ValueError, match="another section is named Film too"):
        page()
