"""The label of an effect: its name, and where it acts, as in ``dead_zone@left``."""

from collections.abc import Iterable

_AT, _TO = "@", ">"
_AND = "+"
# What no name of an input or a state may hold.
RESERVED = _AT + _AND + _TO


def labelled(name: str, place: str | None) -> str:
    """Return the label of an effect; without a ``place`` it is the name alone."""
    return f"{name}{_AT}{place}" if place else name


def name_and_place(label: str) -> tuple[str, str]:
    """Return the name of an effect and its place, which is empty where the label has none."""
    name, _, place = label.partition(_AT)
    return name, place


def between(equation: str, reaction: str | None) -> str:
    """Return the place of a force on a state's ``equation`` that is taken from its ``reaction``.

    One from outside the device has no reaction.
    """
    return f"{equation}{_TO}{reaction}" if reaction else equation


def ends(place: str) -> tuple[str, str]:
    """Return the two states that a force acts between; of any other place the second is empty."""
    equation, _, reaction = place.partition(_TO)
    return equation, reaction


def place_in_words(place: str) -> str:
    """Return where an effect acts, as "at position" or "from left to right"; empty for no place."""
    equation, reaction = ends(place.replace("_", " "))
    if reaction:
        return f"from {equation} to {reaction}"
    return f"at {equation}" if equation else ""


def joined(labels: Iterable[str]) -> str:
    """Return the labels of several effects as one text."""
    return _AND.join(labels)


def parted(labels: str) -> tuple[str, ...]:
    """Return the labels that a text joins."""
    return tuple(labels.split(_AND))
