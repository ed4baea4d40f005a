"""The page of the documentation that lists every key, and JSON schemas, from the models."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from dea.configuration.allowed_values import Schema, allowed, resolved
from dea.configuration.bench import BenchFile, Plant
from dea.configuration.case import Case, CaseFile
from dea.configuration.device import DeviceDescription
from dea.configuration.public_records import PublicRecords
from dea.configuration.published import PublishedErrors, PublishedModels
from dea.configuration.study import Study

FILES: dict[str, type[BaseModel]] = {
    "config/config.yaml": Study,
    "config/cases/*.yaml": CaseFile,
    "config/devices/*.yaml": DeviceDescription,
    "config/bench.yaml": BenchFile,
    "config/published_models.yaml": PublishedModels,
    "config/published_errors.yaml": PublishedErrors,
    "config/public_records.yaml": PublicRecords,
}
# Models that the page shows instead, with the same keys and less repetition.
_SHOWN: dict[str, tuple[type[BaseModel], str]] = {
    "config/cases/*.yaml": (
        Case,
        "Of the sections that config/config.yaml has too, a case gives the keys that differ.",
    ),
    "config/bench.yaml": (
        Plant,
        "Every value is written as `{value: …, unit: …, source: …}`, the unit as listed here."
        " `actuators.NAME` gives values of the film that differ for that actuator, and `plain`"
        " those of any section that differ for the actuator of the blind trials.",
    ),
}
_HEAD = """# Configuration

Every key of the files in `config/`: what it may be, its unit and its default. A key without a
default must be given. The tables follow from the models in `src/dea/configuration`, which check the
files before anything runs: `make configuration` writes this page anew, and
`python -m dea.configuration schema config/config.yaml` prints the JSON schema of a file, with which
an editor can check it.
"""


def json_schema(file: str) -> dict[str, Any]:
    """Return the JSON schema of one of :data:`FILES`."""
    draft = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": draft, **FILES[file].model_json_schema()}


def page() -> str:
    """Return ``docs/configuration.md``.

    Raises
    ------
    ValueError
        Two sections have the same name: the second would have no table, and links to it would lead
        to the first.
    """
    described: dict[str, Schema] = {}
    lines = [_HEAD]
    for file in FILES:
        model, note = _SHOWN.get(file, (FILES[file], ""))
        schema = model.model_json_schema()
        definitions = schema.get("$defs", {})
        lines += [f"## {file}\n", f"{schema['description']}\n", *([f"{note}\n"] if note else [])]
        lines += _table(schema, definitions)
        for name in _reached(schema, definitions):
            if name not in described:
                described[name] = definitions[name]
                lines += [f"### {name}\n", f"{definitions[name]['description']}\n"]
                lines += _table(definitions[name], definitions)
            elif described[name] != definitions[name]:
                raise ValueError(f"{file}: another section is named {name} too; rename one of them")
    # Docstrings are written in reStructuredText, whose code has two marks on each side.
    return "\n".join(lines).replace("``", "`")


def _table(section: Schema, definitions: Schema) -> Iterator[str]:
    yield "| key | allowed | default | meaning |"
    yield "| --- | --- | --- | --- |"
    own_names = {"NAME": section.get("additionalProperties")}
    keys = section.get("properties", own_names)
    # pydantic leaves the list out where no key is required.
    required = section.get("required", ()) if "properties" in section else own_names
    for name, node in keys.items():
        default = "" if name in required else _default(node)
        said = f"{_allowed(node, definitions)} | {default} | {node.get('description', '')}"
        yield f"| `{name}` | {said} |"
    yield ""


def _default(node: Schema) -> str:
    default = node.get("default")
    if default in (None, {}, ""):
        return "none"
    return f"`{str(default).lower() if isinstance(default, bool) else default}`"


def _allowed(node: Schema, definitions: Schema) -> str:
    links = " or ".join(f"[{name}](#{name.lower()})" for name in _references(node, definitions))
    if not links:
        return allowed(node, definitions).replace("|", "\\|")
    return f"{_container(node)}{links}"


def _container(node: Schema) -> str:
    if "array" in (each.get("type") for each in (node, *node.get("anyOf", ()))):
        return "list of "
    if "additionalProperties" in node or "patternProperties" in node:
        return "by name: "
    return ""


def _references(node: Any, definitions: Schema) -> list[str]:
    """Return the sections that a value is made of, without those inside them."""
    if isinstance(node, dict):
        if "$ref" in node:
            name = node["$ref"].rsplit("/", 1)[-1]
            return [name] if resolved(node, definitions).get("type") == "object" else []
        parts: list[Any] = [
            part for key, part in node.items() if key not in ("default", "discriminator")
        ]
    else:
        parts = node if isinstance(node, list) else []
    found = [name for part in parts for name in _references(part, definitions)]
    return list(dict.fromkeys(found))


def _reached(section: Schema, definitions: Schema) -> Iterator[str]:
    """Yield every section below ``section``, in the order in which a reader meets it."""
    keys = {key: section[key] for key in ("properties", "additionalProperties") if key in section}
    for name in _references(keys, definitions):
        yield name
        yield from _reached(definitions[name], definitions)
