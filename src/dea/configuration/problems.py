"""From pydantic's errors to one line that names file, key, remedy and the nearest key."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from dea.configuration.allowed_values import Schema, allowed, resolved
from dea.errors import InputError

_Model = TypeVar("_Model", bound=BaseModel)
# Similarity above which another key is suggested: one letter of three may differ, or two swapped.
NEAR = 0.65


def validated(
    model: type[_Model], content: Any, file: str | Path | None = None, place: str = ""
) -> _Model:
    """Return ``content`` as a ``model``.

    Parameters
    ----------
    place
        Dotted key of ``content`` in ``file``, for messages.

    Raises
    ------
    InputError
        Naming ``file``, the first wrong key, what would be right and how many more are wrong.
    """
    try:
        return model.model_validate(content)
    except ValidationError as error:
        details = error.errors(include_url=False)
    raise _input_error(model, details, file, place)


def unknown_key(name: str, known: Sequence[str]) -> tuple[str, str]:
    """Return problem and remedy of a key that is none of ``known``."""
    return f"unknown key {name!r}", f"{did_you_mean(name, known)}Known here: {', '.join(known)}."


def did_you_mean(name: str, known: Collection[str]) -> str:
    """Return the question whether the nearest of ``known`` was meant; empty where none is near."""
    near = get_close_matches(name, known, n=1, cutoff=NEAR)
    return f"Did you mean {near[0]!r}? " if near else ""


def _input_error(
    model: type[BaseModel], details: Sequence[ErrorDetails], file: str | Path | None, place: str
) -> InputError:
    schema = _schema(model)
    # A misspelt key is also a missing one; and a value that fits no member of a union is reported
    # once for each member.
    found: dict[str, tuple[str, str]] = {}
    for detail in sorted(details, key=lambda detail: detail["type"] != "extra_forbidden"):
        path, problem, remedy = _said(detail, schema)
        # What a validator refuses has the right type, and is then told most exactly.
        if detail["type"] == "relation" or _joined(place, path) not in found:
            found[_joined(place, path)] = (problem, remedy)
    field, (problem, remedy) = next(iter(found.items()))
    meant = [key for key in list(found)[1:] if f"{key.rsplit('.', 1)[-1]!r}?" in remedy]
    others = [key for key in list(found)[1:] if key not in meant]
    more = f" Wrong too: {', '.join(others)}." if others else ""
    return InputError(problem, file=file, field=field or None, remedy=f"{remedy}{more}")


@cache
def _schema(model: type[BaseModel]) -> Schema:
    return model.model_json_schema()


def _said(detail: ErrorDetails, schema: Schema) -> tuple[str, str, str]:
    """Return dotted key, problem and remedy of one error."""
    node, path, rest = _located(detail["loc"], schema)
    definitions = schema.get("$defs", {})
    given, context = detail.get("input"), detail.get("ctx", {})
    match detail["type"]:
        case "extra_forbidden":
            problem, remedy = unknown_key(str(rest), list(node["properties"]))
            if path and rest in schema.get("properties", {}):
                section = path.partition("[")[0].partition(".")[0]
                remedy = f"It goes beside `{section}`, not into it, and holds for the whole file."
            return _joined(path, str(rest)), problem, remedy
        case "missing":
            wanted = node["properties"].get(rest, {}) if rest else node
            about = resolved(wanted, definitions).get("description", "")
            remedy = f"Give {allowed(wanted, definitions)}" + (f": {about}." if about else ".")
            return _joined(path, str(rest or "")), "missing", remedy
        case "relation":
            return _joined(path, context["place"]), context["problem"], context["remedy"]
        case "union_tag_invalid" | "union_tag_not_found":
            tag = context["discriminator"].strip("'")
            kinds = ", ".join(node["discriminator"]["mapping"])
            problem = f"unknown {tag} {context['tag']!r}" if "tag" in context else "missing"
            near = get_close_matches(tag, [str(k) for k in given or ()], n=1, cutoff=NEAR)
            hint = f" Is {near[0]!r} meant to be {tag!r}?" if problem == "missing" and near else ""
            return _joined(path, tag), problem, f"Use one of {kinds}.{hint}"
    if rest == "[key]":
        return path, f"{given!r} is no name", "Use letters, digits, _ and - alone."
    if given is None:
        return path, "missing" if path else "it is empty", f"Give {allowed(node, definitions)}."
    return path, f"it is {_shown(given)}", f"Give {allowed(node, definitions)}."


def _located(place: Sequence[str | int], schema: Schema) -> tuple[Schema, str, str | int | None]:
    """Return the schema node at ``place``, its dotted key and the last step that is no part of it.

    pydantic puts the names of union members between the keys; they are left out.
    """
    definitions = schema.get("$defs", {})
    node, path, rest = schema, "", None
    for step in place:
        node, rest = resolved(node, definitions), None
        if (member := _member(node, step)) is not None:
            node = member
        elif (inner := _inner(node, step, definitions)) is not None:
            node, path = inner, _joined(path, step)
        else:
            rest = step
    node = resolved(node, definitions)
    # An optional section is a section or nothing.
    for choice in node.get("anyOf", ()):
        if "properties" in (section := resolved(choice, definitions)):
            node = section
    return node, path, rest


def _member(node: Schema, step: str | int) -> Schema | None:
    """Return the member of a union that ``step`` names, by its tag or its model."""
    if step in (tags := node.get("discriminator", {}).get("mapping", {})):
        return {"$ref": tags[step]}
    members: Iterator[Schema] = (
        choice for choice in node.get("anyOf", ()) if choice.get("$ref", "").endswith(f"/{step}")
    )
    return next(members, None)


def _inner(node: Schema, step: str | int, definitions: Schema) -> Schema | None:
    if isinstance(step, int) and "items" in node:
        own = {"unit": node["unit"]} if "unit" in node else {}
        return {**node["items"], **own}
    if step in node.get("properties", {}):
        found: Schema = node["properties"][step]
        return found
    for values in (node.get("additionalProperties"), *node.get("patternProperties", {}).values()):
        if isinstance(values, Mapping):
            return values
    for choice in node.get("anyOf", ()):
        if (found_in := _inner(resolved(choice, definitions), step, definitions)) is not None:
            return found_in
    return None


def _joined(place: str, step: str | int) -> str:
    if isinstance(step, int):
        return f"{place}[{step}]"
    return f"{place}.{step}" if place and step else place or step


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
