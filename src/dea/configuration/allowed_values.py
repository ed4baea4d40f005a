"""What a key allows, in words, from the JSON schema of its model."""

from collections.abc import Mapping
from typing import Any

from dea.configuration.section import NAME

Schema = Mapping[str, Any]
# Patterns of texts, in words.
WORDS = {
    NAME: "a name of letters, digits, _ and -",
    "^[0-9a-f]{64}$": "64 hexadecimal digits",
}


def resolved(node: Schema, definitions: Schema) -> Schema:
    """Follow the reference of ``node``; its own description and unit stay."""
    while "$ref" in node:
        own = {name: value for name, value in node.items() if name != "$ref"}
        node = {**definitions[node["$ref"].rsplit("/", 1)[-1]], **own}
    return node


def allowed(node: Schema, definitions: Schema, plural: bool = False) -> str:
    """Say what a value must be, such as ``a number above 0 s`` or ``one of stop, restart``."""
    node = resolved(node, definitions)
    if tag := node.get("discriminator"):
        return f"a mapping with {tag['propertyName']}: {' or '.join(tag['mapping'])}"
    if choices := node.get("anyOf", node.get("oneOf")):
        unit = {"unit": node["unit"]} if "unit" in node else {}
        kept = [unit | choice for choice in choices if choice.get("type") != "null"]
        return ", or ".join(dict.fromkeys(allowed(c, definitions, plural) for c in kept))
    if "const" in node:
        return str(node["const"])
    if "enum" in node:
        return f"one of {', '.join(map(str, node['enum']))}"
    kind = node.get("type")
    if kind in ("integer", "number"):
        return _number(node, plural)
    if kind == "array":
        return _list(node, definitions)
    if kind == "object":
        return _mapping(node, definitions)
    if kind == "string" and "pattern" in node:
        return WORDS.get(node["pattern"], f"text that matches {node['pattern']}")
    return {"boolean": "true or false", "string": "text"}.get(str(kind), "a value")


def _number(node: Schema, plural: bool) -> str:
    noun = "whole number" if node["type"] == "integer" else "number"
    text = f"{noun}s" if plural else f"a {noun}"
    low, high = node.get("minimum"), node.get("maximum")
    unit = f" {node['unit']}" if node.get("unit", "1") != "1" else ""
    if low is not None and high is not None:
        return f"{text} from {low:g} to {high:g}{unit}"
    bounds = [
        f"{words} {node[name]:g}"
        for name, words in (
            ("exclusiveMinimum", "above"),
            ("minimum", "of at least"),
            ("maximum", "up to"),
            ("exclusiveMaximum", "below"),
        )
        if name in node
    ]
    return f"{text} {' and '.join(bounds)}{unit}" if bounds else text + (unit and f" in{unit}")


def _list(node: Schema, definitions: Schema) -> str:
    # A list's unit is that of its items.
    items = {**node.get("items", {}), **{k: node[k] for k in ("unit",) if k in node}}
    of = allowed(items, definitions, plural=True)
    length = (node.get("minItems"), node.get("maxItems"))
    if length == (2, 2):
        return f"[low, high], two {of}"
    return f"a list of {of}{_least(node, 'minItems')}"


def _mapping(node: Schema, definitions: Schema) -> str:
    if names := node.get("properties"):
        return f"a mapping with the keys {', '.join(names)}"
    values = node.get("additionalProperties")
    of = f" to {allowed(values, definitions)}" if isinstance(values, dict) else ""
    return f"a mapping of names{of}{_least(node, 'minProperties')}"


def _least(node: Schema, bound: str) -> str:
    return f", at least {node[bound]}" if bound in node else ""
